"""An axis with two motors in a rig file: what its declaration must hold, and its records as runs in SI."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from math import pi
from typing import Any

import numpy as np

from calibration.errors import CalibrationInputError
from calibration.inputs.declaration import Column, Rig
from calibration.inputs.ends import converter_end
from calibration.inputs.record import Record
from calibration.inputs.train import KINDS, train_of
from calibration.inputs.units import units_per_turn
from calibration.readers.run import Array, Run

COUNTED = ("velocity", "motor_a", "motor_b")  # rates that a counter counts over a window
#: channel -> unit, None for an angle (position) or an angle per s
UNITS: dict[str, str | None] = {
    "position": None,
    "velocity": None,
    "motor_a": None,
    "motor_b": None,
    "reference_rate": None,
    "effort": "1",
    "current_a": "A",
    "current_b": "A",
    "supply": "V",
    "temperature": "degC",
}
ARCSEC = pi / 648000.0
FIRST = datetime(2000, 1, 1, tzinfo=UTC)  # of a clock that nobody declared a date for
WHOLE = 1e-3  # of a count of steps, by which a text file's digits may miss a whole one
FINEST = 1e-7  # of a column's range: its step, where none can be told
#: what the other balances are declared by
OTHERS = (
    "response",
    "estimate",
    "constants",
    "controller",
    "friction_law",
    "smooth_s",
    "analyse_period_s",
    "hold_out_fraction",
)


def check_no_motors(data: dict[str, Any], refuse: Any) -> None:
    """Keys and stages that only an axis with two motors has."""
    for key in ("friction", "encoder_periods"):
        if key in data:
            refuse(f"{key}: is for a drive with motors; leave it out")
    for stage in data.get("stages", []):
        if stage.get("kind") in ("axis", "motor", "roller", "sensor"):
            refuse(f"stages.{stage['name']}.kind: '{stage['kind']}' is for a drive with motors; leave it out")


def check_two_motors(data: dict[str, Any], columns: dict[str, Column], refuse: Any) -> None:
    """Friction, a gear table with an axis and a motor, columns in units that SI can be had from."""
    if "friction" not in data:
        refuse("motors: needs friction, the declared LuGre model")
    for key in OTHERS:
        if key in data:
            refuse(f"{key}: a drive with motors has its own balances; leave it out")
    kinds = [g.get("kind") for g in data.get("stages", [])]
    for kind in ("axis", "motor"):
        if kinds.count(kind) != 1:
            refuse(f"stages: a drive with motors has one stage of kind {kind}, here are {kinds.count(kind)}")
    if kinds.count("roller") > 1:
        refuse("stages: the velocity's encoder has one roller")
    for stage in data["stages"]:
        if stage.get("kind") not in KINDS:
            known = ", ".join(k for k in KINDS if k)
            refuse(f"stages.{stage['name']}.kind: '{stage['kind']}', beside motors one of {known}")
        if "period_s" in stage:
            refuse(f"stages.{stage['name']}: an axis with motors turns at any rate; give period or teeth")
    low, high = data["motors"]["rotor_inertia_kgm2"]
    if low > high:
        refuse("motors.rotor_inertia_kgm2: [least, most]")
    if data.get("format", "table") == "table":
        _check_columns(data, columns, refuse)


def _check_columns(data: dict[str, Any], columns: dict[str, Column], refuse: Any) -> None:
    if "effort" not in columns:
        refuse("columns: 'effort' is missing; a drive with motors needs it")
    if ("supply" in columns) == ("supply_V" in data):
        refuse("motors: an effort of 1 gives what? a column of the supply or supply_V, and only one")
    for a, b in (("current_a", "current_b"), ("motor_a", "motor_b")):
        if (a in columns) != (b in columns):
            refuse(f"columns: '{a if b in columns else b}' is missing; one motor's says nothing without it")
    for name, column in columns.items():
        if name == "time":
            continue
        if name not in UNITS:
            refuse(f"columns.{name}: nothing uses it beside motors; leave it out")
        wanted = UNITS[name]
        if wanted is not None and column.unit != wanted:
            refuse(f"columns.{name}.unit: '{column.unit}', must be {wanted} beside motors; give a scale")
        if wanted is None and _rad(column.unit, name) is None:
            what = "an angle" if name == "position" else "an angle per s"
            refuse(f"columns.{name}.unit: '{column.unit}', must be {what} beside motors; give a scale")


def _rad(unit: str, channel: str) -> float | None:
    """rad (or rad/s) per unit; None for a unit that is none of an angle."""
    word, slash, per = unit.partition("/")
    if channel == "position":
        turn = units_per_turn(unit)
    else:
        turn = units_per_turn(word) if slash and per.strip() == "s" else None
    return 2 * pi / turn if turn else None


def runs_of(records: list[Record], rig: Rig) -> list[Run]:
    """The records as runs of an axis: columns in SI, the clock in s, scales from the columns' steps."""
    assert rig.motors is not None
    train = train_of(rig)
    out = []
    for r in records:
        si: dict[str, Array] = {"t": r.columns["t"]}
        steps: dict[str, float] = {}
        for name, x in r.columns.items():
            if name == "t":
                continue
            factor = _rad(rig.columns[name].unit, name) if UNITS[name] is None else 1.0
            called = "setpoint" if name == "reference_rate" else name
            si[called] = x * (factor or 1.0)
            step = r.signals[name].quantum
            steps[called] = (
                step * (factor or 1.0)
                if step
                else FINEST * (float(np.nanmax(si[called]) - np.nanmin(si[called])) or 1.0)
            )
        for name in ("current_a", "current_b"):
            if name in si and float(np.nanmin(si[name])) < -3 * steps[name]:
                raise CalibrationInputError(
                    r.path,
                    "is negative: a motor pulls one way only here, and its current counts as it pulls; give a"
                    " scale of -1 or leave the column out",
                    None,
                    str(rig.columns[name].column),
                )
        out.append(
            Run(
                r.name, r.path, _session(r, rig), si, {}, _header(r, rig), _scales(r, rig, train.ratio, steps)
            )
        )
    _end_of_currents(out)
    return out


def _end_of_currents(runs: list[Run]) -> None:
    """Tell every run where the currents' converter ends, when they pile up there."""
    end = converter_end(runs, ("current_a", "current_b"))
    if end is None:
        return
    for r in runs:
        r.scales["adc_end_A"] = end - r.scales["adc_A_per_count"] / 2
        rows = sum(int(np.sum(r.columns[n] >= end)) for n in ("current_a", "current_b"))
        if rows:
            r.notes.append(f"{r.name}: {rows} currents stop at {end:.4g} A, left out")


def _session(r: Record, rig: Rig) -> str:
    """Files that share the position's zero are one session."""
    return rig.name if rig.runs.get("origin") == "shared" else r.name


def _header(r: Record, rig: Rig) -> dict[str, str]:
    """As an axis log's: the start on the clock that all files share, from any day."""
    start = FIRST + timedelta(seconds=r.start_s or 0.0)
    loop = "closed" if "reference_rate" in rig.columns else "open"
    return {"axis": rig.name, "loop": loop, "start_utc": start.isoformat()}


def _full_scale(step: float) -> float:
    """Steps of the effort to full supply, whole where they are all but whole."""
    full = 1.0 / step
    return float(round(full)) if abs(full - round(full)) < WHOLE * full else full


def _scales(r: Record, rig: Rig, ratio: float, steps: dict[str, float]) -> dict[str, float]:
    """What the axis logs' headers say (readers/drive.py), from a table's columns."""
    assert rig.motors is not None

    def window(name: str) -> float:
        column = rig.columns.get(name)
        return (column.window_s if column is not None else None) or r.period_s

    current = max(steps.get("current_a", 0.0), steps.get("current_b", 0.0))
    return {
        "sample_period_s": r.period_s,
        "velocity_window_s": window("velocity"),
        "tach_window_s": window("motor_a"),
        "position_arcsec_per_count": steps["position"] / ARCSEC,
        "velocity_arcsec_per_count": steps.get("velocity", steps["position"]) * window("velocity") / ARCSEC,
        "adc_A_per_count": current or 1e-3,
        "adc_end_A": float("inf"),
        "tach_counts_per_turn": 2 * pi / (steps["motor_a"] * window("motor_a"))
        if "motor_a" in steps
        else 4096.0,
        "effort_full_scale": _full_scale(steps["effort"]),
        "supply_V": rig.supply_V or float(np.nanmean(r.columns["supply"])),
        "counter_torque": rig.motors.counter_torque,
        "gear_ratio": ratio,
    }
