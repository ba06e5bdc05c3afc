"""Axis log, version 1 (log-format.md): header, CSV, counters unwrapped, counts turned into SI units."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from calibration.errors import CalibrationInputError
from calibration.readers.csvtext import read_numbers
from calibration.readers.drive import ARCSEC, SCALES, WRAPS
from calibration.readers.header import number, parse_header
from calibration.readers.plausible import check_values
from calibration.readers.run import Array, Run
from calibration.readers.stuck import check_stuck

KNOWN = (
    "t",
    "setpoint",
    "effort",
    "position",
    "velocity",
    "adc_a",
    "adc_b",
    "tach_a",
    "tach_b",
    "aux",
    "focus",
    "supply",
    "temperature",
)
_LONGEST_HEADER = 400  # lines, blank ones too
LAST_COUNT = 1022.5  # of the 10-bit converter of the currents, log-format.md: above it may be anything
REQUIRED = ("t", "effort", "position")
#: what each counts column must be in, for the message when a header row names another unit
UNITS = {
    "t": "s",
    "setpoint": "arcsec/s",
    "effort": "1/3000 of supply",
    "position": "29-bit counts",
    "velocity": "counts per 5 ms",
    "adc_a": "counts",
    "adc_b": "counts",
    "tach_a": "counts per 10 ms",
    "tach_b": "counts per 10 ms",
    "aux": "17-bit counts",
    "supply": "V",
    "temperature": "degC",
}


def is_axis_log(text: str) -> bool:
    """True when the text starts like an axis log."""
    return any(line.startswith("#") and "axis-log" in line for line in text[:4000].splitlines())


def read_axis_log(path: Path, text: str | None = None) -> Run:
    """Read one axis log; raises CalibrationInputError naming file, line and column."""
    text = _load(path) if text is None else text
    lines = text.split("\n", _LONGEST_HEADER)
    header, start = parse_header(path, [x.rstrip("\r") for x in lines])
    while start < len(lines) and not lines[start].strip():
        start += 1
    if start >= len(lines):
        raise CalibrationInputError(path, "the log ends after its header: no column row, no data", start)
    if start == _LONGEST_HEADER:
        raise CalibrationInputError(path, f"no column row in the first {start} lines", start + 1)
    names = [n.strip().strip('"') for n in lines[start].rstrip("\r").split(",")]
    if len(names) == 1 and any(mark in names[0] for mark in ";\t"):
        mark = "semicolons" if ";" in names[0] else "tabs"
        raise CalibrationInputError(path, f"the columns are parted by {mark}, must be commas", start + 1)
    _check_names(path, names, start + 1)
    body = text.split("\n", start + 1)[start + 1] if text.count("\n") > start else ""
    if not body.strip():
        raise CalibrationInputError(path, "the log has a column row and no data rows", start + 2)
    raw = read_numbers(path, body, names, start + 2, wanted=set(KNOWN) & set(names))
    scales = {key: number(path, header, key) for key in SCALES}
    scales["adc_end_A"] = LAST_COUNT * scales["adc_A_per_count"]
    raw = _check_time(path, raw, scales["sample_period_s"], start + 2)
    check_values(path, raw, scales, start + 2)
    si = to_si(raw, scales)
    if "aux" in raw and not np.any(raw["aux"]):  # a network without that board logs 0
        del raw["aux"], si["aux"]
    check_stuck(path, raw, si["t"], si["position"], factors(scales), scales["gear_ratio"], start + 2)
    return Run(path.stem, path, header["session"], si, raw, header, scales)


def _load(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise CalibrationInputError(path, f"cannot be read ({error.strerror})") from None
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        raise CalibrationInputError(path, "is not UTF-8 text", line) from None


def _check_names(path: Path, names: list[str], line: int) -> None:
    for name in names:
        base = name.replace("[", " ").replace("(", " ").split(" ")[0].strip()
        if name != base and base in UNITS:
            raise CalibrationInputError(
                path, f"has another unit than the format's: '{base}' is logged in {UNITS[base]}", line, name
            )
    if len(set(names)) != len(names):
        twice = next(n for n in names if names.count(n) > 1)
        raise CalibrationInputError(path, "appears twice: one file holds one axis", line, twice)
    for name in REQUIRED:
        if name not in names:
            raise CalibrationInputError(
                path, f"the column '{name}' is missing; it is logged in {UNITS[name]}", line
            )


def _check_time(path: Path, raw: dict[str, Array], period: float, first: int) -> dict[str, Array]:
    t = raw["t"]
    bad = ~np.isfinite(t)
    if bad.any():
        if np.isnan(t[-1]) and bad.sum() == 1:  # cut off while writing
            raw = {k: v[:-1] for k, v in raw.items()}
            t = raw["t"]
        else:
            k = int(np.argmax(bad))
            what = "is empty" if np.isnan(t[k]) else "is infinite"
            raise CalibrationInputError(path, what, first + k, "t")
    step = np.diff(t)
    if len(step) and step.min() < -0.5 * period:
        k = int(np.argmax(step < -0.5 * period))
        raise CalibrationInputError(
            path, f"time goes backwards from {t[k]:g} s to {t[k + 1]:g} s", first + k + 1, "t"
        )
    if len(step) > 20 and np.mean(np.abs(step) < 1e-9) > 0.3:
        k = int(np.argmax(np.abs(step) < 1e-9))
        raise CalibrationInputError(
            path,
            "a third of the rows share their time with the row before: two axes in one file?",
            first + k + 1,
            "t",
        )
    if len(step) > 20 and not 0.05 < float(np.median(step)) / period < 20:
        raise CalibrationInputError(
            path,
            f"rows are {np.median(step):g} apart, the header says {period:g} s: 't' is logged in s",
            first,
            "t",
        )
    return raw


def unwrap(counts: Array, length: int) -> Array:
    """Unwrap a counter of `length` counts; NaN stay NaN."""
    good = np.isfinite(counts)
    out = counts.copy()
    out[good] = np.unwrap(counts[good], period=length)
    return out


def factors(s: dict[str, float]) -> dict[str, float]:
    """SI units per unit of the log, by column, from the declared or overridden scales."""
    return {
        "t": 1.0,
        "setpoint": ARCSEC,
        "effort": 1 / s["effort_full_scale"],
        "position": s["position_arcsec_per_count"] * ARCSEC,
        "velocity": s["velocity_arcsec_per_count"] * ARCSEC / s["velocity_window_s"],
        "adc_a": s["adc_A_per_count"],
        "adc_b": s["adc_A_per_count"],
        "tach_a": 2 * math.pi / s["tach_counts_per_turn"] / s["tach_window_s"],
        "tach_b": 2 * math.pi / s["tach_counts_per_turn"] / s["tach_window_s"],
        "aux": s["aux_arcsec_per_count"] * ARCSEC,
        "supply": 1.0,
        "temperature": 1.0,
        "focus": 1.0,
    }


def to_si(raw: dict[str, Array], s: dict[str, float]) -> dict[str, Array]:
    """Counts to SI units by the declared or overridden scales."""
    factor = factors(s)
    rename = {"adc_a": "current_a", "adc_b": "current_b", "tach_a": "motor_a", "tach_b": "motor_b"}
    out: dict[str, Array] = {}
    for name, values in raw.items():
        values = unwrap(values, WRAPS[name]) if name in WRAPS else values
        out[rename.get(name, name)] = values * factor[name]
    return out
