"""Rig files: YAML that maps another drive's columns, units, constants and gear stages to the channels."""

from __future__ import annotations

import difflib
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from calibration.errors import CalibrationInputError
from plant.yamltext import TextError, check_yaml, read_text


@dataclass(frozen=True)
class Column:
    """Where a channel is in the file, its unit, and the factor to the rig's unit."""

    column: str | int
    unit: str
    scale: float = 1.0
    wrap: float | None = None


@dataclass(frozen=True)
class Stage:
    """A rotating part: its period in position units, or in seconds for a drive at constant rate."""

    name: str
    period: float | None
    period_s: float | None
    harmonics: int
    kind: str | None


@dataclass(frozen=True)
class Rig:
    """A rig file, checked."""

    name: str
    path: Path
    columns: dict[str, Column]
    response: dict[str, Any]
    estimate: tuple[str, ...]
    stages: tuple[Stage, ...]
    constants: dict[str, float]
    runs: dict[str, Any]
    delimiter: str | None
    names: tuple[str, ...]
    hold_out: float
    smooth_s: float | None
    analyse_period_s: float | None
    raw: dict[str, Any] = field(default_factory=dict)


DELIMITERS = {"comma": ",", "tab": "\t", "space": " ", "semicolon": ";"}


def load_rig(path: Path) -> Rig:
    """Load and check a rig file; raises CalibrationInputError naming the field and, where it helps, the
    line."""
    import yaml
    from jsonschema import Draft202012Validator

    try:
        text = read_text(path)
        check_yaml(text)
    except OSError as error:
        raise CalibrationInputError(path, f"cannot be read ({error.strerror})") from None
    except TextError as error:
        raise CalibrationInputError(path, error.what, error.line) from None
    try:
        data = yaml.safe_load(text)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        raise CalibrationInputError(
            path, f"is not YAML: {error.problem}", mark.line + 1 if mark else None
        ) from None
    if not isinstance(data, dict):
        raise CalibrationInputError(
            path, "is no rig file: a mapping with 'rig', 'columns' and 'response' is needed"
        )
    schema = json.loads(Path(__file__).with_name("rig.schema.json").read_text(encoding="utf-8"))
    errors = sorted(
        Draft202012Validator(schema).iter_errors(data), key=lambda e: list(map(str, e.absolute_path))
    )
    if errors:
        _complain(path, text, schema, errors[0])
    return _build(path, data)


def _complain(path: Path, text: str, schema: dict[str, Any], error: Any) -> None:
    place = ".".join(str(p) for p in error.absolute_path) or "top level"
    word = str(error.instance) if not isinstance(error.instance, dict) else ""
    message, choices = str(error.message), []
    if error.validator == "additionalProperties" and isinstance(error.instance, dict):
        choices = list(error.schema.get("properties", {}))
        word = next(k for k in error.instance if k not in choices)
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
        k: Column(v["column"], v["unit"], float(v.get("scale", 1.0)), v.get("wrap"))
        for k, v in data["columns"].items()
    }
    channel = data["response"]["channel"]
    if channel not in columns:
        raise CalibrationInputError(
            path, f"response.channel: '{channel}' is not among the columns ({', '.join(columns)})"
        )
    _check(path, data, columns)
    return Rig(
        name=data["rig"],
        path=path,
        columns=columns,
        response=data["response"],
        estimate=tuple(data.get("estimate", ("coulomb", "viscous", "offset"))),
        stages=tuple(_stages(path, data.get("stages", []))),
        constants={k: float(v["value"]) for k, v in data.get("constants", {}).items()},
        runs=data.get("runs", {}),
        names=tuple(data.get("names", ())),
        delimiter=DELIMITERS.get(data.get("delimiter", "")),
        hold_out=float(data.get("hold_out_fraction", 0.4)),
        smooth_s=data.get("smooth_s"),
        analyse_period_s=data.get("analyse_period_s"),
        raw=data,
    )


def _check(path: Path, data: dict[str, Any], columns: dict[str, Column]) -> None:
    """What the schema cannot say: channels that are needed, factors that erase a column, the unit of time."""
    for needed in ("time", "position"):
        if needed not in columns:
            raise CalibrationInputError(path, f"columns: '{needed}' is missing")
    if columns["time"].unit != "s":
        raise CalibrationInputError(
            path,
            f"columns.time.unit: '{columns['time'].unit}', must be s; give the file's unit as a factor,"
            " such as scale: 0.001 for ms",
        )
    zero = next((k for k, c in columns.items() if c.scale == 0), None)
    if zero is not None:
        raise CalibrationInputError(path, f"columns.{zero}.scale: 0 erases the column")
    response = data["response"]
    if response.get("gain", 1) == 0:
        raise CalibrationInputError(path, "response.gain: 0 erases the response")
    below = response.get("divide_by")
    if below is not None and below not in columns:
        raise CalibrationInputError(
            path, f"response.divide_by: '{below}' is not among the columns ({', '.join(columns)})"
        )
    runs = data.get("runs", {})
    if runs.get("by") == "column" and "column" not in runs:
        raise CalibrationInputError(path, "runs.by: 'column' needs runs.column, the column's name")
    names = [item["name"] for item in data.get("stages", [])]
    twice = next((n for n in names if names.count(n) > 1), None)
    if twice is not None:
        raise CalibrationInputError(path, f"stages: '{twice}' is given twice")


def _stages(path: Path, items: list[dict[str, Any]]) -> list[Stage]:
    """Resolve tooth counts to periods: a stage with `of` turns teeth[0]/teeth[1] as fast as the one named."""
    known: dict[str, Stage] = {}
    for item in items:
        period, period_s = item.get("period"), item.get("period_s")
        if "teeth" in item:
            other = known.get(item.get("of", ""))
            if other is None:
                raise CalibrationInputError(
                    path, f"stages.{item['name']}: 'of' must name a stage given before it"
                )
            factor = item["teeth"][1] / item["teeth"][0]
            period = other.period * factor if other.period else None
            period_s = other.period_s * factor if other.period_s else None
        if period is None and period_s is None:
            raise CalibrationInputError(
                path, f"stages.{item['name']}: give 'period', 'period_s', or 'teeth' with 'of'"
            )
        known[item["name"]] = Stage(
            item["name"], period, period_s, item.get("harmonics", 2), item.get("kind")
        )
    return list(known.values())
