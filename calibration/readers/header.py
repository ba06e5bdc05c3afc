"""The `# key: value` header of an axis log: required keys, scale overrides, and their errors."""

from __future__ import annotations

import difflib
from pathlib import Path

from calibration.errors import CalibrationInputError
from calibration.readers.drive import DECLARABLE, SCALES

REQUIRED = ("format", "axis", "sample_period_s", "session", "loop", "start_utc")
FORMAT = "axis-log 1"


def parse_header(path: Path, lines: list[str]) -> tuple[dict[str, str], int]:
    """Return the header and the index of the first line that is not part of it; errors name the line."""
    header: dict[str, str] = {}
    at: dict[str, int] = {}
    for index, text in enumerate(lines):
        if not text.startswith("#"):
            break
        key, colon, value = text[1:].partition(":")
        key, value = key.strip(), value.strip()
        if not colon:
            continue
        if key in ("axis", "format") and header.get(key, value) != value:
            raise CalibrationInputError(
                path,
                f"'{key}' is given twice ('{header[key]}', '{value}'): one file holds one axis",
                index + 1,
            )
        header[key], at[key] = value, index + 1
    else:
        index = len(lines)
    _check(path, header, at)
    return header, index


def _check(path: Path, header: dict[str, str], at: dict[str, int]) -> None:
    for key in REQUIRED:
        if key not in header:
            near = difflib.get_close_matches(key, header, n=1)
            hint = f"; did you mean '{near[0]}' (line {at[near[0]]})?" if near else f"; add '# {key}: ...'"
            raise CalibrationInputError(path, f"the header lacks '{key}'{hint}", 1)
    for key, allowed in (("format", (FORMAT,)), ("axis", ("ra", "dec")), ("loop", ("closed", "open"))):
        if header[key] not in allowed:
            raise CalibrationInputError(
                path, f"'{key}' is '{header[key]}', must be {' or '.join(allowed)}", at[key]
            )
    if header.get("preload", "low") not in ("low", "high"):
        raise CalibrationInputError(
            path, f"'preload' is '{header['preload']}', must be low or high", at["preload"]
        )
    for key in (*SCALES, *DECLARABLE):
        if key in header:
            number(path, header, key, at[key])


def number(path: Path, header: dict[str, str], key: str, line: int | None = None) -> float:
    """The header's value of a scale, or the declared one; a value that is no positive number is an error."""
    if key not in header:
        return SCALES[key][0]
    what = SCALES[key][1] if key in SCALES else DECLARABLE[key]
    try:
        value = float(header[key])
    except ValueError:
        raise CalibrationInputError(
            path, f"'{key}' is '{header[key]}', must be a plain number ({what})", line
        ) from None
    if not (value > 0 or (key == "counter_torque" and value == 0)) or value > 1e12:
        raise CalibrationInputError(path, f"'{key}' is {value}, must be positive ({what})", line)
    return value
