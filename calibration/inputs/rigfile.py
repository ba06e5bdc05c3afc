"""Rig files: read, held against the schema, and against what a schema cannot say."""

from __future__ import annotations

import difflib
import json
from pathlib import Path
from typing import Any

from calibration.errors import CalibrationInputError
from calibration.inputs.declaration import Column, Controller, Friction, FrictionLaw, Motors, Response, Rig
from calibration.inputs.rigchecks import check
from calibration.inputs.stages import stages_of
from calibration.inputs.yamltext import load_yaml

DELIMITERS = {"comma": ",", "tab": "\t", "space": " ", "semicolon": ";"}
SCHEMA = Path(__file__).with_name("rig.schema.json")
DEFAULT_HOLD_OUT = 0.4  # of every file: ASSUMPTION, enough blocks on either side


def load_rig(path: Path) -> Rig:
    """Load and check a rig file; raises CalibrationInputError naming the field and, where it helps, the
    line."""
    from jsonschema import Draft202012Validator

    data, text = load_yaml(path)
    if not isinstance(data, dict):
        raise CalibrationInputError(
            path, "is no rig file: a mapping with 'rig', 'columns' and 'response' is needed"
        )
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    errors = sorted(
        Draft202012Validator(schema).iter_errors(data), key=lambda e: list(map(str, e.absolute_path))
    )
    if errors:
        _complain(path, text, errors[0])
    return _build(path, data)


def _complain(path: Path, text: str, error: Any) -> None:
    """One line for the first mistake: field, what is wrong, the nearest word that would be right."""
    if error.validator == "oneOf" and error.context:  # the branch that fits the kind of value that was given
        branch = 1 if isinstance(error.instance, list) else 0
        inner = [e for e in error.context if e.schema_path[0] == branch]
        error = inner[0] if inner else error
    place = ".".join(str(p) for p in error.absolute_path) or "top level"
    word = str(error.instance) if not isinstance(error.instance, dict | list) else ""
    message, choices = str(error.message), []
    if error.validator == "additionalProperties" and isinstance(error.instance, dict):
        choices = list(error.schema.get("properties", {}))
        word = next(k for k in map(str, error.instance) if k not in choices)
        message = f"unknown field '{word}'"
    elif error.validator == "enum":
        choices = [str(v) for v in error.validator_value]
        message = f"'{word}' is not one of {', '.join(choices)}"
    near = difflib.get_close_matches(word, choices, n=1, cutoff=0.5)
    hint = f"; did you mean '{near[0]}'?" if near else ""
    key = word or str(error.absolute_path[-1] if error.absolute_path else "")
    line = next((k for k, row in enumerate(text.splitlines(), 1) if key and key in row), None)
    raise CalibrationInputError(path, f"{place}: {message}{hint}", line)


def _build(path: Path, data: dict[str, Any]) -> Rig:
    columns = {
        k: Column(
            v["column"],
            v["unit"],
            float(v.get("scale", 1.0)),
            float(v.get("offset", 0.0)),
            v.get("wrap"),
            float(v.get("delay_s", 0.0)),
            v.get("window_s"),
        )
        for k, v in data.get("columns", {}).items()
    }
    told = data.get("response", [])
    given = told if isinstance(told, list) else [told]
    responses = tuple(
        Response(r["channel"], r["unit"], float(r.get("gain", 1.0)), r.get("divide_by"), r.get("ratio"))
        for r in given
    )
    check(path, data, columns, responses)
    return Rig(
        name=data["rig"],
        path=path,
        columns=columns,
        responses=responses,
        estimate=tuple(data.get("estimate", ())),
        stages=tuple(stages_of(path, data.get("stages", []))),
        constants={k: float(v["value"]) for k, v in data.get("constants", {}).items()},
        runs=data.get("runs", {}),
        wall_time=data.get("wall_time", {}),
        names=tuple(data.get("names", ())),
        delimiter=DELIMITERS.get(data.get("delimiter", "")),
        hold_out=float(data.get("hold_out_fraction", DEFAULT_HOLD_OUT)),
        smooth_s=data.get("smooth_s"),
        analyse_period_s=data.get("analyse_period_s"),
        turn=data.get("turn"),
        sample_period_s=data.get("sample_period_s"),
        controller=_controller(data.get("controller")),
        supply_V=data.get("supply_V"),
        format=data.get("format", "table"),
        motors=_motors(data.get("motors")),
        friction=tuple(_friction(f) for f in data.get("friction", ())),
        friction_law=_friction_law(data.get("friction_law")),
        encoder_periods=data.get("encoder_periods"),
        raw=data,
    )


def _motors(given: dict[str, Any] | None) -> Motors | None:
    if given is None:
        return None
    low, high = (float(x) for x in given["rotor_inertia_kgm2"])
    return Motors(
        float(given["counter_torque"]),
        float(given["torque_constant_Nm_per_A"]),
        float(given["resistance_ohm"]),
        (low, high),
        float(given["train_stiffness_Nm_per_rad"]),
        tuple(float(x) for x in given.get("stiffness_readings", (1.0,))),
    )


def _friction(given: dict[str, Any]) -> Friction:
    return Friction(
        given.get("state", ""),
        float(given["coulomb_Nm"]),
        float(given["stiction_Nm"]),
        float(given["stribeck_rate_rad_per_s"]),
        float(given.get("stribeck_exponent", 2.0)),
        float(given["viscous_Nms_per_rad"]),
        float(given["bristle_stiffness_Nm_per_rad"]),
    )


def _friction_law(given: dict[str, Any] | None) -> FrictionLaw | None:
    if given is None:
        return None
    return FrictionLaw(**{k: float(v) for k, v in given.items() if k != "source"})


def _controller(given: dict[str, Any] | None) -> Controller | None:
    if given is None:
        return None
    return Controller(given["law"], {k: float(v) for k, v in given["gains"].items()}, given.get("limit"))
