"""Rig files: read, held against the schema, and against what a schema cannot say."""

from __future__ import annotations

import difflib
import json
from pathlib import Path
from typing import Any

from calibration.errors import CalibrationInputError
from calibration.inputs.declaration import Column, Controller, Response, Rig
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
        )
        for k, v in data["columns"].items()
    }
    given = data["response"] if isinstance(data["response"], list) else [data["response"]]
    responses = tuple(
        Response(r["channel"], r["unit"], float(r.get("gain", 1.0)), r.get("divide_by"), r.get("ratio"))
        for r in given
    )
    _check(path, data, columns, responses)
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
        raw=data,
    )


def _controller(given: dict[str, Any] | None) -> Controller | None:
    if given is None:
        return None
    return Controller(given["law"], {k: float(v) for k, v in given["gains"].items()}, given.get("limit"))


FORWARD = {"rate_feedforward", "acceleration_feedforward"}
#: gains that a law must have, and those that it may
GAINS = {
    "pid": ({"p"}, {"p", "i", "d"} | FORWARD),
    "cascade": ({"position", "velocity"}, {"position", "velocity"} | FORWARD),
}


def _check_controller(data: dict[str, Any], columns: dict[str, Column], refuse: Any) -> None:
    law, gains = data["controller"]["law"], set(data["controller"]["gains"])
    must, may = GAINS[law]
    for name in sorted(must - gains):
        refuse(f"controller.gains: '{name}' is missing; a {law} has it")
    for name in sorted(gains - may):
        refuse(f"controller.gains.{name}: a {law} has none; it has {', '.join(sorted(may))}")
    if "reference" not in columns or "effort" not in columns:
        refuse("controller: needs the columns reference and effort, which the law connects")
    if columns["reference"].unit != columns["position"].unit:
        refuse("columns.reference.unit: must be the position's for a controller; give a scale")


def _check_electrical(data: dict[str, Any], columns: dict[str, Column], refuse: Any) -> None:
    """Volts are measured, or a duty of a supply; a balance of them needs the current."""
    for name in ("voltage", "duty"):
        if name in columns and "current" not in columns:
            refuse(
                f"columns.{name}: a balance of volts needs the current; give columns.current or leave it out"
            )
    if "voltage" in columns and "duty" in columns:
        refuse("columns.duty: the voltage is given; leave one of the two out")
    if "duty" in columns and ("supply" in columns) == ("supply_V" in data):
        refuse("columns.duty: needs what a duty of 1 gives, a column of the supply or supply_V, and only one")
    if "duty" not in columns and "supply_V" in data:
        refuse("supply_V: is for a column of the duty; leave it out")
    for name, unit in (("voltage", "V"), ("duty", "1"), ("current", "A")):
        if name in columns and {"voltage", "duty"} & set(columns) and columns[name].unit != unit:
            refuse(
                f"columns.{name}.unit: '{columns[name].unit}', must be {unit} for a balance of volts;"
                " give a scale"
            )


def _check(
    path: Path, data: dict[str, Any], columns: dict[str, Column], responses: tuple[Response, ...]
) -> None:
    """What the schema cannot say: channels that are needed, factors that erase a column, keys without
    effect."""

    def refuse(text: str) -> None:
        raise CalibrationInputError(path, text)

    have = ", ".join(columns)
    if "time" not in columns and "sample_period_s" not in data:
        refuse("columns: 'time' is missing; without a time column give sample_period_s")
    if "time" in columns and "sample_period_s" in data:
        refuse("sample_period_s: there is a time column; give one of the two")
    if "position" not in columns:
        refuse("columns: 'position' is missing")
    if "time" in columns and columns["time"].unit != "s":
        refuse(
            f"columns.time.unit: '{columns['time'].unit}', must be s; give the file's unit as a factor,"
            " such as scale: 0.001 for ms"
        )
    for name, column in columns.items():
        if column.scale == 0:
            refuse(f"columns.{name}.scale: 0 erases the column")
    channels = [r.channel for r in responses]
    for r in responses:
        if r.channel not in columns and r.channel != "acceleration":
            refuse(f"response.channel: '{r.channel}' is not among the columns ({have})")
        if r.ratio is not None and r.channel != "position2":
            refuse("response.ratio: is for a second sensor (channel: position2)")
        if r.gain == 0:
            refuse("response.gain: 0 erases the response")
        if r.divide_by is not None and r.divide_by not in columns:
            refuse(f"response.divide_by: '{r.divide_by}' is not among the columns ({have})")
        if channels.count(r.channel) > 1:
            refuse(f"response: '{r.channel}' is given twice")
    if "controller" in data:
        _check_controller(data, columns, refuse)
    _check_electrical(data, columns, refuse)
    _check_model(data, columns, responses, refuse)
    _check_runs(data, refuse)


def _check_model(
    data: dict[str, Any], columns: dict[str, Column], responses: tuple[Response, ...], refuse: Any
) -> None:
    force = any(r.is_force for r in responses)
    if not force:
        forces = (set(data.get("estimate", ())) - {"offset", "drift"}) | set(data.get("constants", {}))
        if forces:
            refuse(f"{min(forces)}: is a term of forces, but no response is one")
    both = set(data.get("estimate", ())) & set(data.get("constants", {}))
    if both:
        refuse(f"constants.{min(both)}: is estimated too; a number is known or estimated")
    if "acceleration" in [r.channel for r in responses] and (
        "inertia" in data.get("estimate", ()) or "inertia" in data.get("constants", {})
    ):
        refuse("inertia: a response of acceleration is a balance per unit of inertia; leave it out")
    used = {"time", "position", "velocity", "acceleration", "temperature", "supply", "reference"}
    used |= {r.channel for r in responses} | {r.divide_by for r in responses if r.divide_by}
    if any(r.channel == "position2" for r in responses):
        used |= {"effort", "force", "current"}
    if "controller" in data:
        used.add("effort")
    if {"voltage", "duty"} & set(columns):
        used |= {"voltage", "duty", "current"}
    for name in columns:
        if name not in used:
            refuse(f"columns.{name}: nothing uses it with this response; leave it out")


def _check_runs(data: dict[str, Any], refuse: Any) -> None:
    runs, wall = data.get("runs", {}), data.get("wall_time", {})
    if runs.get("by") == "column" and "column" not in runs:
        refuse("runs.by: 'column' needs runs.column, the column's name")
    if "column" in runs and runs.get("by") != "column":
        refuse("runs.column: is used with by: column only")
    if "minimum_travel" in runs and runs.get("by") != "turning_points":
        refuse("runs.minimum_travel: is used with by: turning_points only")
    if wall and wall["from"] == "name" and "format" not in wall:
        refuse("wall_time.from: 'name' needs wall_time.format, such as '%Hh%Mm%S'")
    for key, needs in (("format", "name"), ("gap_s", "order")):
        if key in wall and wall["from"] != needs:
            refuse(f"wall_time.{key}: is used with from: {needs} only")
    if wall and wall["from"] == "time" and "time" not in data["columns"]:
        refuse("wall_time.from: 'time' needs a time column")
