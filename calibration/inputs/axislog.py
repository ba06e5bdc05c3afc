"""Axis log, version 1 (log-format.md): header, CSV, counters unwrapped, counts turned into SI units."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime
from math import pi
from pathlib import Path

import numpy as np

from calibration.arrays import Array, Mask
from calibration.errors import CalibrationInputError
from calibration.inputs import thresholds as limits
from calibration.inputs.counters import unwrap
from calibration.inputs.header import parse_header
from calibration.inputs.run import Run
from calibration.inputs.stuck import check_counted
from calibration.inputs.text import check_width, load_utf8, read_numbers, split
from plant.units import ARCSEC

Scales = dict[str, float]


@dataclass(frozen=True)
class Counted:
    """A column of the format.

    unit: the one it is logged in. si: SI units per such unit, by the header's scales. called: its name from
    there on, where it is another one. wrap: the length of its counter, counts.
    """

    unit: str
    si: Callable[[Scales], float] = lambda _: 1.0
    called: str = ""
    wrap: int = 0


TACH = ("counts per 10 ms", lambda s: 2 * pi / s["tach_counts_per_turn"] / s["tach_window_s"])
COLUMNS = {
    "t": Counted("s"),
    "setpoint": Counted("arcsec/s", lambda s: ARCSEC),
    "effort": Counted("1/3000 of supply", lambda s: 1 / s["effort_full_scale"]),
    "position": Counted("29-bit counts", lambda s: s["position_arcsec_per_count"] * ARCSEC, wrap=2**29),
    "velocity": Counted(
        "counts per 5 ms", lambda s: s["velocity_arcsec_per_count"] * ARCSEC / s["velocity_window_s"]
    ),
    "adc_a": Counted("counts", lambda s: s["adc_A_per_count"], "current_a"),
    "adc_b": Counted("counts", lambda s: s["adc_A_per_count"], "current_b"),
    "tach_a": Counted(*TACH, "motor_a"),
    "tach_b": Counted(*TACH, "motor_b"),
    "aux": Counted("17-bit counts", lambda s: s["aux_arcsec_per_count"] * ARCSEC, wrap=2**17),
    "focus": Counted(""),
    "supply": Counted("V"),
    "temperature": Counted("degC"),
}
REQUIRED = ("t", "effort", "position")


def is_axis_log(text: str) -> bool:
    """True when the text starts like an axis log."""
    return any(line.startswith("#") and "axis-log" in line for line in text[:4000].splitlines())


def read_axis_log(path: Path, text: str | None = None) -> Run:
    """Read one axis log; raises CalibrationInputError naming file, line and column."""
    text = load_utf8(path) if text is None else text
    lines = text.split("\n", limits.LONGEST_HEADER)
    header, scales, start = parse_header(path, lines)
    while start < len(lines) and not lines[start].strip():
        start += 1
    if start >= len(lines):
        raise CalibrationInputError(path, "the log ends after its header: no column row, no data", start)
    if start == limits.LONGEST_HEADER:
        raise CalibrationInputError(path, f"no column row in the first {start} lines", start + 1)
    names, first = split(lines[start], ","), start + 2
    check_width(path, len(names), start + 1)
    _check_names(path, names, start + 1)
    *_, body = text.split("\n", start + 1)
    if len(lines) == start + 1 or not body.strip():
        raise CalibrationInputError(path, "the log has a column row and no data rows", first)
    known = [k for k, name in enumerate(names) if name in COLUMNS]
    found = read_numbers(path, body, names, first, wanted=set(known))
    raw = {names[k]: found[k] for k in known}
    if np.isnan(raw["t"][-1:]).any() and np.isfinite(raw["t"][:-1]).all():  # cut off while writing
        raw = {name: values[:-1] for name, values in raw.items()}
    _check_time(path, raw["t"], scales["sample_period_s"], first)
    _check_values(path, raw, scales["effort_full_scale"], first)
    if not np.any(raw.get("aux", True)):  # a network without that board logs 0
        del raw["aux"]
    factors = {name: COLUMNS[name].si(scales) for name in raw}
    joined = {n: unwrap(x, COLUMNS[n].wrap) if COLUMNS[n].wrap else x for n, x in raw.items()}
    si = {COLUMNS[n].called or n: x * factors[n] for n, x in joined.items()}
    scales["adc_end_A"] = limits.LAST_COUNT * scales["adc_A_per_count"]
    run = Run(path.stem, path, header["session"], si, raw, header, scales)
    with suppress(ValueError):  # else only the files' order is known
        run.start_s = datetime.fromisoformat(header["start_utc"]).timestamp()
    check_counted(run, factors, first)
    return run


def _check_names(path: Path, names: list[str], line: int) -> None:
    if len(names) == 1 and any(mark in names[0] for mark in ";\t"):
        mark = "semicolons" if ";" in names[0] else "tabs"
        raise CalibrationInputError(path, f"the columns are parted by {mark}, must be commas", line)
    for name in names:
        base = name.replace("[", " ").replace("(", " ").split(" ")[0].strip()
        if name != base and base in COLUMNS and COLUMNS[base].unit:
            what = f"has another unit than the format's: '{base}' is logged in {COLUMNS[base].unit}"
            raise CalibrationInputError(path, what, line, name)
        if names.count(name) > 1:
            raise CalibrationInputError(path, "appears twice: one file holds one axis", line, name)
    for name in (n for n in REQUIRED if n not in names):
        what = f"the column '{name}' is missing; it is logged in {COLUMNS[name].unit}"
        raise CalibrationInputError(path, what, line)


def _check_time(path: Path, t: Array, period: float, first: int) -> None:
    _refuse(path, np.isnan(t), "is empty", first, "t")
    _refuse(path, np.isinf(t), "is infinite", first, "t")
    step = np.diff(t)
    back = step < -limits.BACKWARDS * period
    if back.any():
        a, b = t[np.argmax(back) :][:2]
        _refuse(path, back, f"time goes backwards from {a:g} s to {b:g} s", first + 1, "t")
    if len(step) <= limits.FEWEST_STEPS:
        return
    same = np.abs(step) < limits.SAME_S
    if np.mean(same) > limits.SHARED_TIMES:
        what = "a third of the rows share their time with the row before: two axes in one file?"
        _refuse(path, same, what, first + 1, "t")
    if not 1 / limits.OFF_PERIOD < (apart := float(np.median(step))) / period < limits.OFF_PERIOD:
        what = f"rows are {apart:g} apart, the header says {period:g} s: 't' is logged in s"
        raise CalibrationInputError(path, what, first, "t")


def _check_values(path: Path, raw: dict[str, Array], full: float, first: int) -> None:
    """Refuse infinities, needed columns without a number, and numbers of another unit."""
    for name, values in raw.items():
        _refuse(path, np.isinf(values), "is infinite", first, name)
    position, effort = raw["position"], raw["effort"]
    for name in ("effort", "position"):
        if not np.isfinite(raw[name]).any():
            raise CalibrationInputError(path, "holds no number in any row", first, name)
    _refuse(path, np.abs(position) > limits.LARGEST_COUNT, "is beyond any 29-bit counter", first, "position")
    beyond = np.abs(effort) > limits.OVER_FULL * full
    _refuse(path, beyond, f"is beyond full scale ({full:g})", first, "effort")
    if len(effort) < limits.FEWEST_MOVED:
        return
    if _fractions(position) and np.nanmax(np.abs(position)) < limits.ANGLE_OF_A_TURN:
        what = "holds fractions: it is logged in 29-bit counts, not in an angle"
        raise CalibrationInputError(path, what, first, "position")
    most, moved = float(np.nanmax(np.abs(effort))), float(np.nanmax(position) - np.nanmin(position))
    if _fractions(effort) and most < limits.LEAST_EFFORT and moved > limits.LEAST_TRAVEL:
        must = f"it is logged in 1/{full:g} of the supply, not in V or as a fraction"
        raise CalibrationInputError(path, f"never exceeds {most:.3g}: {must}", first, "effort")


def _fractions(values: Array) -> bool:
    good = values[np.isfinite(values)]
    return bool(np.mean(good != np.round(good)) > 0.5) if len(good) else False


def _refuse(path: Path, bad: Mask, why: str, first: int, name: str) -> None:
    """Raise CalibrationInputError for the first row that is `bad` (n,)."""
    if bad.any():
        raise CalibrationInputError(path, why, first + int(np.argmax(bad)), name)
