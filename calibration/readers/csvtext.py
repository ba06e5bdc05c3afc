"""Numbers from CSV text, fast when all is well and with line and column when something is not."""

from __future__ import annotations

import io
import re
from pathlib import Path

import numpy as np

from calibration.errors import CalibrationInputError
from calibration.readers.run import Array

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|[+-]?inf(inity)?", re.ASCII | re.IGNORECASE)
"""What a field may hold: Python's `float` also takes 1_0 and digits of other scripts."""


def plain(field: str) -> float | None:
    """A field's number, infinite ones too; NaN for an empty one and for nan; None when it is none."""
    if field in ("", "nan", "NaN"):
        return float("nan")
    return float(field) if _NUMBER.fullmatch(field) else None


def read_numbers(
    path: Path,
    body: str,
    names: list[str],
    first_line: int,
    delimiter: str = ",",
    wanted: set[str] | None = None,
) -> dict[str, Array]:
    """Columns of `body` (no header row) as floats, empty fields as NaN.

    `first_line` is the file's line number of the first row. Text in a column of `wanted` (default: all)
    raises
    CalibrationInputError with line and column; other columns are left out when they are not numbers.
    """
    from pyarrow import ArrowInvalid, csv, float64

    keep = [n for n in names if wanted is None or n in wanted]
    if body.startswith("\ufeff"):  # the reader would pass over it; here it is no beginning of a file
        return _slowly(path, body, names, first_line, delimiter, set(keep))
    try:
        table = csv.read_csv(
            io.BytesIO(body.encode()),
            read_options=csv.ReadOptions(column_names=names, use_threads=False),
            parse_options=csv.ParseOptions(delimiter=delimiter),
            convert_options=csv.ConvertOptions(
                column_types={n: float64() for n in keep},
                include_columns=keep,
                null_values=["", "nan", "NaN"],
                strings_can_be_null=True,
            ),
        )
    except ArrowInvalid:
        return _slowly(path, body, names, first_line, delimiter, set(keep))
    return {n: np.asarray(table[n].to_numpy(), dtype=float) for n in keep}


def _slowly(
    path: Path, body: str, names: list[str], first_line: int, delimiter: str, keep: set[str]
) -> dict[str, Array]:
    """Field by field: finds the line and the column that is wrong."""
    rows = [row.rstrip("\n") for row in io.StringIO(body, newline=None)]  # no other signs end a line
    out = {n: np.full(len(rows), np.nan) for n in names if n in keep}
    count = 0
    for offset, text in enumerate(rows):
        if not text.strip():
            continue
        fields = text.split(delimiter)
        line = first_line + offset
        if len(fields) != len(names):
            if offset == len(rows) - 1:  # a run that was cut off: the last line may be half written
                break
            hint = ""
            if text.startswith("#"):
                hint = ": a second header? one file holds one run"
            elif len(fields) == 2 * len(names) or (len(fields) > len(names) and delimiter == ","):
                hint = ": decimal commas? write points"
            raise CalibrationInputError(
                path, f"{len(fields)} fields, the header row has {len(names)}{hint}", line
            )
        for name, value in zip(names, fields, strict=True):
            value = value.strip()
            if name not in keep:
                continue
            number = plain(value)
            if number is None:
                hint = ": decimal commas? write points" if value.replace(",", "", 1).isdigit() else ""
                raise CalibrationInputError(path, f"'{value}' is not a number{hint}", line, name)
            out[name][count] = number
        count += 1
    return {n: v[:count] for n, v in out.items()}
