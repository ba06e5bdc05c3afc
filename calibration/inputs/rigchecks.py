"""What a rig file's schema cannot say: channels that are needed, factors that erase a column, keys without
effect."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from calibration.errors import CalibrationInputError
from calibration.inputs.declaration import Column, Response
from calibration.inputs.twomotors import COUNTED, check_no_motors, check_two_motors

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


def _check_friction_law(law: dict[str, Any], has_term: bool, refuse: Any) -> None:
    if not has_term:
        refuse("friction_law: is the shape of the term coulomb, which no response has; estimate it")
    dip = ("stiction_ratio", "stribeck_speed")
    for name in dip:
        if name not in law and ({*dip, "stribeck_exponent"} & set(law)):
            refuse(f"friction_law: '{name}' is missing; a dip from rest has {' and '.join(dip)}")
    if not {*dip, "bristle_travel"} & set(law):
        refuse("friction_law: says nothing; give stiction_ratio and stribeck_speed, bristle_travel, or all")


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


def check(
    path: Path, data: dict[str, Any], columns: dict[str, Column], responses: tuple[Response, ...]
) -> None:
    """Refuse, with one line, what is missing, contradicts itself or has no effect."""

    def refuse(text: str) -> None:
        raise CalibrationInputError(path, text)

    if data.get("format", "table") == "table":
        for key in ("columns",) if "motors" in data else ("columns", "response"):
            if key not in data:
                refuse(f"'{key}' is missing")
        _check_columns(data, columns, refuse)
    else:
        _check_format(data, refuse)
    if "motors" in data:
        check_two_motors(data, columns, refuse)
    else:
        check_no_motors(data, refuse)
        _check_responses(columns, responses, refuse)
        _check_periods(data, data.get("format") == "phd2" or responses[0].channel == "position", refuse)
        if "controller" in data:
            _check_controller(data, columns, refuse)
        _check_electrical(data, columns, refuse)
        _check_model(data, columns, responses, refuse)
    _check_runs(data, refuse)


#: what the two formats that say their columns themselves leave to declare
DRIVE = {"rig", "note", "format", "turn", "stages", "motors", "friction", "encoder_periods"}


def _check_format(data: dict[str, Any], refuse: Any) -> None:
    """A log whose format says its columns: only the drive behind it is declared."""
    for key in data:
        if key not in DRIVE:
            refuse(f"{key}: a log of format {data['format']} says it itself; leave it out")
    if data["format"] == "axis-log" and "motors" not in data:
        refuse("format: axis-log: needs motors, friction and stages, the drive behind the log")
    if data["format"] == "phd2" and "motors" in data:
        refuse("motors: a guide log shows none; leave it out")


def _check_periods(data: dict[str, Any], drifts: bool, refuse: Any) -> None:
    """A stage turns with the position, or with the clock where the position has a constant rate."""
    for stage in data.get("stages", []):
        if drifts and "period" in stage:
            refuse(f"stages.{stage['name']}: at constant rate the clock counts; give period_s")
        if not drifts and "period_s" in stage:
            refuse(
                f"stages.{stage['name']}: period_s is for a drive at constant rate (response: position);"
                " give period"
            )


def _check_columns(data: dict[str, Any], columns: dict[str, Column], refuse: Any) -> None:
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
        if column.window_s is not None and name not in COUNTED:
            refuse(f"columns.{name}.window_s: is for {', '.join(COUNTED)} beside motors; leave it out")


def _check_responses(columns: dict[str, Column], responses: tuple[Response, ...], refuse: Any) -> None:
    have = ", ".join(columns)
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
    if "position" in channels and len(channels) > 1:
        refuse("response: a position at constant rate is explained alone; leave the others out")


def _check_model(
    data: dict[str, Any], columns: dict[str, Column], responses: tuple[Response, ...], refuse: Any
) -> None:
    force = any(r.is_force for r in responses)
    if not force:
        forces = (set(data.get("estimate", ())) - {"offset", "drift"}) | set(data.get("constants", {}))
        if forces:
            refuse(f"{min(forces)}: is a term of forces, but no response is one")
    if "friction_law" in data:
        terms = {*data.get("estimate", ("coulomb",)), *data.get("constants", {})}
        _check_friction_law(data["friction_law"], force and "coulomb" in terms, refuse)
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
    if wall and wall["from"] == "time" and "time" not in data.get("columns", {}):
        refuse("wall_time.from: 'time' needs a time column")
