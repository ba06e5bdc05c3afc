"""Text tables: comment lines, a header row or none, any of four delimiters."""

from __future__ import annotations

from pathlib import Path

from calibration.errors import CalibrationInputError
from calibration.readers.csvtext import read_numbers
from calibration.readers.run import Array


def read_text(
    path: Path,
    wanted: list[str | int],
    names: tuple[str, ...] = (),
    delimiter: str | None = None,
) -> dict[str, Array]:
    """The wanted columns (by name, or place from 0) of a text table, keyed by `str(column)`."""
    lines = _lines(path)
    skip = 0
    while skip < len(lines) and (lines[skip].startswith(("#", "%")) or not lines[skip].strip()):
        skip += 1
    if skip >= len(lines):
        raise CalibrationInputError(path, "has no data rows", len(lines) or None)
    if lines[skip].lstrip()[:1] in "{[" or path.suffix.lower() in (".json", ".jsonl"):
        raise CalibrationInputError(path, "is JSON: write it as a table (CSV), one row per sample", skip + 1)
    mark = delimiter or guess(lines[skip])
    head = [f.strip().strip('"') for f in lines[skip].split(mark)]
    if names:
        fields, first = list(names), skip
    elif all(is_number(f) for f in head):
        fields, first = [str(k) for k in range(len(head))], skip
    else:
        fields, first = head, skip + 1
    if first >= len(lines):
        raise CalibrationInputError(path, "has no data rows", first)
    rows = len(lines[first].split(mark))
    if len(fields) != rows:
        raise CalibrationInputError(path, f"{rows} fields, {len(fields)} names", first + 1)
    where = [_place(path, c, fields, first > skip, skip + 1) for c in wanted]
    keys = [str(k) for k in range(len(fields))]  # read by place: names may stand twice where none is wanted
    for c, k in zip(wanted, where, strict=True):
        keys[k] = str(c) if isinstance(c, str) else keys[k]
    shown = {keys[k] for k in where}
    got = read_numbers(path, "\n".join(lines[first:]), _unique(keys), first + 1, mark, shown)
    return {str(c): got[keys[k]] for c, k in zip(wanted, where, strict=True)}


def _lines(path: Path) -> list[str]:
    try:
        return path.read_text(encoding="utf-8-sig").splitlines()
    except OSError as error:
        raise CalibrationInputError(path, f"cannot be read ({error.strerror})") from None
    except UnicodeDecodeError:
        raise CalibrationInputError(path, "is not UTF-8 text; a MATLAB file must end in .mat") from None


def _unique(keys: list[str]) -> list[str]:
    """Names as they are, a place that is another column's name made different."""
    return [k if keys.index(k) == at else f"{k} at {at}" for at, k in enumerate(keys)]


def _place(path: Path, column: str | int, fields: list[str], header: bool, line: int) -> int:
    if isinstance(column, int):
        if 0 <= column < len(fields):
            return column
        raise CalibrationInputError(
            path, f"there are {len(fields)} columns, counted from 0", line, str(column)
        )
    count = fields.count(column)
    if count == 1:
        return fields.index(column)
    if count > 1:
        places = ", ".join(str(k) for k, f in enumerate(fields) if f == column)
        raise CalibrationInputError(
            path, f"stands more than once (at {places}, from 0): give the place in its stead", line, column
        )
    have = ", ".join(fields) if header else f"no header row and {len(fields)} columns, named 0, 1 …"
    raise CalibrationInputError(path, f"no such column; the file has {have}", line, column)


def guess(line: str) -> str:
    """The delimiter of a row."""
    for mark in ("\t", ";", ","):
        if mark in line:
            return mark
    return " "


def is_number(text: str) -> bool:
    """True for what float() reads."""
    try:
        float(text)
    except ValueError:
        return False
    return True
