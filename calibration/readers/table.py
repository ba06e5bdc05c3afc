"""Any drive's CSV, text or MATLAB file, read through its rig file."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from calibration.errors import CalibrationInputError
from calibration.readers.csvtext import read_numbers
from calibration.readers.rig import Rig
from calibration.readers.run import Array, Run


def read_table(path: Path, rig: Rig) -> Run:
    """Columns named as the rig's channels, in the rig's units; `t` starts at zero."""
    raw = _matlab(path, rig) if path.suffix.lower() == ".mat" else _text(path, rig)
    columns: dict[str, Array] = {}
    for channel, where in rig.columns.items():
        values = raw[str(where.column)]
        if where.wrap:
            good = np.isfinite(values)
            values = values.copy()
            values[good] = np.unwrap(values[good], period=where.wrap)
        columns["t" if channel == "time" else channel] = values * where.scale
    for channel, values in columns.items():
        name = str(rig.columns["time" if channel == "t" else channel].column)
        if not np.isfinite(values).any():
            raise CalibrationInputError(path, "holds no number in any row", None, name)
        if np.isinf(values).any():
            row = int(np.argmax(np.isinf(values))) + 1
            raise CalibrationInputError(path, f"is infinite in data row {row}", None, name)
    t, clock = columns["t"], str(rig.columns["time"].column)
    if not np.isfinite(t).all():
        row = int(np.argmax(~np.isfinite(t))) + 1
        raise CalibrationInputError(
            path, f"is empty in data row {row}", None, str(rig.columns["time"].column)
        )
    if len(t) > 1 and not np.median(np.diff(t)) > 0:
        raise CalibrationInputError(path, "does not advance", None, clock)
    if (np.diff(t) < 0).any():
        k = int(np.argmax(np.diff(t) < 0))
        name = str(rig.columns["time"].column)
        raise CalibrationInputError(path, f"time goes backwards from {t[k]:g} to {t[k + 1]:g}", k + 2, name)
    columns["t"] = t - t[0]
    run_column = rig.runs.get("column")
    if run_column is not None:
        columns["run"] = raw[str(run_column)]
    return Run(path.stem, path, path.stem, columns, raw, {"rig": rig.name})


def _wanted(rig: Rig) -> list[str]:
    names = [str(c.column) for c in rig.columns.values()]
    return names + ([str(rig.runs["column"])] if "column" in rig.runs else [])


def _matlab(path: Path, rig: Rig) -> dict[str, Array]:
    from scipy.io import loadmat
    from scipy.io.matlab import MatReadError

    try:
        content = loadmat(path)
    except (OSError, ValueError, TypeError, NotImplementedError, MatReadError) as error:
        raise CalibrationInputError(path, f"is not a MATLAB file this tool reads ({error})") from None
    out: dict[str, Array] = {}
    for name in _wanted(rig):
        if name not in content:
            have = ", ".join(k for k in content if not k.startswith("__"))
            raise CalibrationInputError(path, f"no such variable; the file has {have}", None, name)
        try:
            out[name] = np.asarray(content[name], dtype=float).ravel()
        except (TypeError, ValueError):
            raise CalibrationInputError(path, "is not numeric", None, name) from None
    lengths = {n: len(v) for n, v in out.items()}
    if len(set(lengths.values())) > 1:
        raise CalibrationInputError(path, f"the variables have different lengths: {lengths}")
    return out


def _text(path: Path, rig: Rig) -> dict[str, Array]:
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise CalibrationInputError(path, f"cannot be read ({error.strerror})") from None
    except UnicodeDecodeError:
        raise CalibrationInputError(path, "is not UTF-8 text; a MATLAB file must end in .mat") from None
    lines = text.splitlines()
    skip = 0
    while skip < len(lines) and (lines[skip].startswith(("#", "%")) or not lines[skip].strip()):
        skip += 1
    if skip >= len(lines):
        raise CalibrationInputError(path, "has no data rows", len(lines))
    delimiter = rig.delimiter or _guess(lines[skip])
    head = [f.strip().strip('"') for f in lines[skip].split(delimiter)]
    if rig.names:
        names, first = list(rig.names), skip
    elif all(_is_number(f) for f in head):
        names, first = [str(k) for k in range(len(head))], skip
    else:
        names, first = head, skip + 1
    if len(names) != len(lines[first].split(delimiter)):
        raise CalibrationInputError(
            path, f"{len(lines[first].split(delimiter))} fields, {len(names)} names", first + 1
        )
    for column in [c.column for c in rig.columns.values()] + [rig.runs.get("column", "")]:
        if isinstance(column, int) and str(column) not in names and 0 <= column < len(names):
            names[column] = str(column)  # by its place, from 0
    for name in _wanted(rig):
        if name not in names:
            have = (
                ", ".join(names) if first > skip else f"no header row and {len(names)} columns, named 0, 1 …"
            )
            raise CalibrationInputError(path, f"no such column; the file has {have}", skip + 1, name)
    return read_numbers(path, "\n".join(lines[first:]), names, first + 1, delimiter, set(_wanted(rig)))


def _guess(line: str) -> str:
    for mark in ("\t", ";", ","):
        if mark in line:
            return mark
    return " "


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
