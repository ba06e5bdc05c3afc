"""Text of any origin, and the numbers of its tables: comment lines, a header row or none, four delimiters."""

import io
import re
from collections.abc import Collection, Mapping
from itertools import pairwise
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from calibration.arrays import Array
from calibration.errors import CalibrationInputError
from calibration.inputs.shapes import is_json, is_stamp, table_of_json, wide, with_seconds

BLANK = " \t\r\f\v"  # characters that a blank line may hold, but for the delimiter
NAME_WORDS = 2  # words of a column's name: itself and its unit. A remark has more. ASSUMPTION
MOST_COLUMNS = 4096  # Ten times the widest table known. ASSUMPTION.
COMMAS = ": decimal commas? write points"
STAMP = ": a stamp? the column time takes 'format: iso'"
_UNIT = re.compile(r"\[.*\]|\(.*\)|-?")  # of a row of units below the names
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|[+-]?inf(inity)?", re.ASCII | re.IGNORECASE)
"""What a field may hold: Python's `float` also takes 1_0 and digits of other scripts."""


def check_file(path: Path) -> None:
    """Raise CalibrationInputError for what is no regular file: a pipe may never begin, a device never end."""
    if path.exists() and not path.is_file():
        what = "Is a directory" if path.is_dir() else "no regular file"
        raise CalibrationInputError(path, f"cannot be read ({what})")


def load_text(path: Path) -> tuple[str, int | None]:
    """The file's text, with or without a byte order mark and with any line ends, and the first line that is
    not UTF-8. Names in a guide log may be in the computer's code page, its numbers are ASCII."""
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise CalibrationInputError(path, f"cannot be read ({error.strerror})") from None
    try:
        text, bad = raw.decode("utf-8-sig"), None
    except UnicodeDecodeError as error:
        text, bad = raw.decode("latin-1"), error.object[: error.start].count(b"\n") + 1
    return text.replace("\r\n", "\n").replace("\r", "\n"), bad


def load_utf8(path: Path) -> str:
    """The file's text; raises CalibrationInputError where it is not UTF-8."""
    text, bad = load_text(path)
    if bad is not None:
        raise CalibrationInputError(path, "is not UTF-8 text", bad)
    return text


def plain(field: str) -> float | None:
    """A field's number, infinite ones too; NaN for an empty one and for nan; None when it is none."""
    if field in ("", "nan", "NaN"):
        return float("nan")
    return float(field) if _NUMBER.fullmatch(field) else None


def split(line: str, mark: str) -> list[str]:
    """Names of a header row, without their quotes."""
    return [name.strip().strip('"') for name in line.split(mark)]


def check_width(path: Path, count: int, line: int) -> None:
    """Refuse more columns than a log has: the reader would need half a minute for a million names."""
    if count > MOST_COLUMNS:
        raise CalibrationInputError(path, f"{count} columns, at most {MOST_COLUMNS}: is it transposed?", line)


Stamps = Mapping[str, tuple[str, str | int]]
"""Formats of the columns that are stamps, and the column ("": none) that holds their clock."""


class Heading(NamedTuple):
    """A table's file, lines, names of its columns, the index of its first row, the delimiter, and the index
    of the header row. That index is `first` where there is none."""

    path: Path
    lines: list[str]
    fields: list[str]
    first: int
    mark: str
    at: int

    def place(self, column: str | int, named: bool = False) -> int:
        """Place of a column, from 0; else CalibrationInputError, of the names if these are `named` anyway."""
        fields = self.fields
        if isinstance(column, int):
            if 0 <= column < len(fields):
                return column
            what = f"there are {len(fields)} columns, counted from 0"
        elif (count := fields.count(column)) == 1:
            return fields.index(column)
        elif count:
            places = ", ".join(str(k) for k, f in enumerate(fields) if f == column)
            what = f"stands more than once (at {places}, from 0): give the place in its stead"
        else:
            named = named or self.first > self.at
            have = ", ".join(fields) if named else f"no header row and {len(fields)} columns, named 0, 1 …"
            what = f"no such column; the file has {have}"
        raise CalibrationInputError(self.path, what, self.at + 1, str(column))

    def read(self, wanted: list[str | int], stamps: Stamps = MappingProxyType({})) -> dict[str, Array]:
        """The wanted columns (by name, or place from 0), keyed by `str(column)`; `stamps` become s."""
        path, mark, line = self.path, self.mark, self.first + 1
        places = [self.place(c) for c in wanted]
        called = {k: c for c, k in zip(wanted, places, strict=True) if isinstance(c, str)}
        labels = [called.get(k, str(k)) for k in range(len(self.fields))]
        rows = self.lines[self.first :]
        for column, k in zip(wanted, places, strict=True):
            if str(column) in stamps:
                form, clock = stamps[str(column)]
                beside = None if clock == "" else self.place(clock)
                rows = with_seconds(path, rows, mark, (k, beside), form, line, labels[k])
        got = read_numbers(path, "\n".join(rows), labels, line, mark, set(places))
        return {str(c): got[k] for c, k in zip(wanted, places, strict=True)}


def heading(path: Path, text: str, names: tuple[str, ...] = (), delimiter: str | None = None) -> Heading:
    """Where a table's rows begin, and what its columns are called; JSON as a table."""
    if is_json(text):
        text, delimiter = table_of_json(path, text), "\t"
    lines = _unterminated(text.splitlines())
    rows = [k for k, line in enumerate(lines) if line.strip() and not line.startswith(("#", "%"))]
    if not rows:
        raise CalibrationInputError(path, "has no data rows", len(lines) or None)
    skip = _behind_remarks(lines, rows[0], delimiter)
    mark = delimiter or _mark(lines[skip])
    if mark == " ":  # aligned columns are parted by any number of blanks
        lines = [" ".join(_named(line.split(), len(names))) for line in lines]
    check_width(path, lines[skip].count(mark) + 1, skip + 1)
    fields, first, said = split(lines[skip], mark), skip + 1, list[str]()
    if names or all(f and plain(f) is not None for f in fields):
        said = _commented(lines[:skip], mark, len(fields))
        fields, first = list(names) or said or [str(k) for k in range(len(fields))], skip
    first = next((k for k in range(first, len(lines)) if not _is_blank(lines[k], mark)), len(lines))
    if first == len(lines):
        raise CalibrationInputError(path, "has no data rows", first)
    width = len(lines[first].split(mark))
    if width == len(fields) + 1 and lines[first].rstrip(" ").endswith(mark):  # a writer that ends rows so
        lines[first:] = [_unended(line, mark, width) for line in lines[first:]]
    elif width != len(fields):
        hint = ": every column needs one" if width > len(fields) else ""
        raise CalibrationInputError(path, f"{width} fields, {len(fields)} names{hint}", first + 1)
    return Heading(path, lines, fields, first, mark, skip - 1 if fields == said else skip)


def _unended(line: str, mark: str, width: int) -> str:
    """A row of `width` fields, the last of which is empty, without that one."""
    bare = line.rstrip(" ")
    return bare.removesuffix(mark) if bare.count(mark) == width - 1 else line


def _unterminated(lines: list[str]) -> list[str]:
    """Lines without the `;` that ends every row of commas."""
    rows = [line.rstrip(BLANK) for line in lines if line.strip() and not line.startswith(("#", "%"))]
    if not all("," in row and row.find(";") == len(row) - 1 for row in rows[1:] or rows):
        return lines  # the first may be a header row
    return [line.rstrip(BLANK).removesuffix(";") for line in lines]


def _named(fields: list[str], named: int) -> list[str]:
    """Fields of a row of which the first `named` have names (0: all), without words behind them."""
    return fields[:named] if 0 < named < len(fields) and plain(fields[named]) is None else fields


def _is_blank(line: str, mark: str) -> bool:
    """Whether nothing is in a line; a row of empty fields is a row."""
    return not line.strip(BLANK.replace(mark, ""))


def _mark(line: str) -> str:
    return next((mark for mark in "\t;," if mark in line), " ")


def _behind_remarks(lines: list[str], skip: int, delimiter: str | None) -> int:
    """Index of the header row below lines such as "Operator: N. N.", which have fewer or more fields than the
    rows have; `skip` where no such row is found."""

    def fields(line: str) -> list[str]:
        return line.split() if mark == " " else split(line, mark)

    rows = [k for k in range(skip, len(lines)) if lines[k].strip()]
    # below a remark and a header row; the last of several may be cut off
    row = lines[(rows[2:] or rows[-1:])[-2:][0]]
    mark = delimiter or _mark(row)
    width = len(fields(row))
    if width < 2 or len(fields(lines[skip])) == width or all(plain(f) is None for f in fields(row)):
        return skip
    for k, below in pairwise(rows):
        names = fields(lines[k])
        if len(names) == width:
            words = all(f and plain(f) is None for f in names)
            return k if words and len(fields(lines[below])) == width else skip
    return skip


def _commented(above: list[str], mark: str, count: int) -> list[str]:
    """Names in the last comment above rows of numbers, where it has one for each of `count` columns."""
    remarks = (line for line in reversed(above) if line.startswith(("#", "%")))
    some = ([name.rstrip(",;") for name in split(line.lstrip("#% "), mark)] for line in remarks)
    names = next((row for row in some if not all(_UNIT.fullmatch(name) for name in row)), [])
    words = all(name and plain(name) is None and len(name.split()) <= NAME_WORDS for name in names)
    return names if len(names) == count > 1 and words and len(set(names)) == count else []


class Long(NamedTuple):
    """Columns of a table with a row per reading: a signal's name, stamp and value; `compete` as in `wide`."""

    name: str
    time: str
    value: str
    compete: int


def read_long(
    table: Heading, wanted: list[str | int], long: Long, stamps: Stamps
) -> tuple[dict[str, Array], dict[str, Array]]:
    """The wanted signals of a long table on the stamps of one of them and as logged, as `wide` has it."""
    got = table.read([long.time, long.value], stamps)
    place = table.place(long.name, named=True)
    rows = (row for row in table.lines[table.first :] if row.strip())
    names = [split(row, table.mark)[place] for row in rows][: len(got[long.time])]
    signals = [str(c) for c in wanted if str(c) != long.time]
    found, logged = wide(table.path, names, got[long.time], got[long.value], signals, long.compete)
    return {long.time: found.pop(""), **found}, logged


def read_numbers(
    path: Path, body: str, names: list[str], first_line: int, mark: str = ",", wanted: set[int] | None = None
) -> dict[int, Array]:
    """Columns of `body` (no header row) as floats by their place, empty fields as NaN.

    `first_line` is the file's line number of the first row, `names` are those of all columns in messages.
    Text in a column of `wanted` (places; default: all) raises CalibrationInputError with line and column.
    """
    from pyarrow import ArrowInvalid, csv, float64

    keep = {k: str(k) for k in (range(len(names)) if wanted is None else sorted(wanted))}
    if body.startswith("\ufeff"):  # the reader would pass over it; here it is no beginning of a file
        return _slowly(path, body, names, first_line, mark, keep)
    reading = csv.ReadOptions(column_names=[str(k) for k in range(len(names))], use_threads=False)
    empty: dict[str, Any] = {"null_values": ["", "nan", "NaN"], "strings_can_be_null": True}
    types = dict.fromkeys(keep.values(), float64())
    turned = csv.ConvertOptions(column_types=types, include_columns=list(keep.values()), **empty)
    try:
        table = csv.read_csv(io.BytesIO(body.encode()), reading, csv.ParseOptions(delimiter=mark), turned)
    except ArrowInvalid:
        return _slowly(path, body, names, first_line, mark, keep)
    return {k: np.asarray(table[name].to_numpy(), dtype=float) for k, name in keep.items()}


def _slowly(
    path: Path, body: str, names: list[str], first_line: int, mark: str, keep: Collection[int]
) -> dict[int, Array]:
    """Field by field: finds the line and the column that is wrong."""
    lines = [row.rstrip("\n") for row in io.StringIO(body, newline=None)]  # no other signs end a line
    last, rows = first_line + len(lines) - 1, []
    for line, text in enumerate(lines, first_line):
        if _is_blank(text, mark):
            continue
        fields = text.split(mark)
        if len(fields) != len(names):
            if line == last:  # a run that was cut off: its last line may be half written
                break
            commas = len(fields) == 2 * len(names) or (len(fields) > len(names) and mark == ",")
            hint = ": a second header? one file holds one run" if text.startswith("#") else COMMAS * commas
            what = f"{len(fields)} fields, the header row has {len(names)}{hint}"
            raise CalibrationInputError(path, what, line)
        rows.append([_number(path, fields[k].strip(), line, names[k]) for k in keep])
    return dict(zip(keep, np.array(rows).reshape(-1, len(keep)).T.copy(), strict=True))


def _number(path: Path, value: str, line: int, name: str) -> float:
    number = plain(value)
    if number is None:
        hint = COMMAS if value.replace(",", "", 1).isdigit() else STAMP if is_stamp(value) else ""
        raise CalibrationInputError(path, f"'{value}' is not a number{hint}", line, name)
    return number
