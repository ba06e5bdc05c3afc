"""Other files as a table of numbers: JSON, long tables of (name, stamp, value), stamps in words."""

import json
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from calibration.arrays import Array
from calibration.errors import CalibrationInputError
from calibration.inputs import thresholds as limits
from calibration.inputs.run import longest_step

ISO = "iso"  # `format` of a time column whose stamps are ISO 8601; another one is strptime's


def is_json(text: str) -> bool:
    """Whether a text is JSON: lines, a list, or an object of lists."""
    return text.lstrip()[:1] in ("{", "[")


def table_of_json(path: Path, text: str) -> str:
    """The same as a table between tabs, a column for every key; `a.b` for one inside another. The last line
    of a log that was cut off is left out."""
    rows = [dict(_flat(row)) for row in _records(path, text)]
    keys = list(dict.fromkeys(key for row in rows for key in row))
    if not keys:
        raise CalibrationInputError(path, "has no data rows: JSON with an object per row is needed", 1)
    return "\n".join(["\t".join(keys), *("\t".join(row.get(key, "") for key in keys) for row in rows)])


def _records(path: Path, text: str) -> list[Any]:
    try:
        whole = json.loads(text)
    except json.JSONDecodeError:
        return list(_lines(path, text.splitlines()))
    if not isinstance(whole, dict):
        return list(whole)
    lists = {key: v for key, v in whole.items() if isinstance(v, list)}
    only, lengths = 0 < len(lists) == len(whole), {len(v) for v in lists.values()}
    if only and len(lengths) == 1:
        return [dict(zip(lists, row, strict=True)) for row in zip(*lists.values(), strict=True)]
    tables = {key: v for key, v in lists.items() if v and isinstance(v[0], dict | list)}
    if len(tables) == 1:  # the others say something about it
        return [{key: row} for key, rows in tables.items() for row in rows]
    if only:
        raise CalibrationInputError(path, "is JSON whose lists have different lengths", 1)
    return [whole]


def _lines(path: Path, lines: list[str]) -> Iterator[Any]:
    for line, text in enumerate(lines, 1):
        try:
            if text.strip():
                yield json.loads(text)
        except json.JSONDecodeError as error:
            if line < len(lines):
                raise CalibrationInputError(path, f"is not JSON: {error.msg}", line) from None


def _flat(row: Any, key: str = "") -> Iterator[tuple[str, str]]:
    """Keys and fields of one row; lists by place."""
    if isinstance(row, dict | list):
        for k, value in row.items() if isinstance(row, dict) else enumerate(row):
            yield from _flat(value, f"{key}.{k}" if key else str(k))
    elif row is not None:
        yield " ".join(key.split()), " ".join(str(int(row) if isinstance(row, bool) else row).split())


def seconds(word: str, form: str) -> float:
    """s of a stamp, since 1970 where it has a date, in UTC where it says no zone. Raises ValueError."""
    at = datetime.fromisoformat(word) if form == ISO else datetime.strptime(word, form)
    return (at if at.tzinfo else at.replace(tzinfo=UTC)).timestamp()


def is_stamp(word: str) -> bool:
    """Whether a word is an ISO 8601 stamp; a plain number such as 20240501 is one, too."""
    try:
        return bool(np.isfinite(seconds(word, ISO)))
    except ValueError:
        return False


def with_seconds(
    path: Path, rows: list[str], mark: str, places: tuple[int, int | None], form: str, line: int, name: str
) -> list[str]:
    """Rows of a table whose stamps are seconds then. `places` are those of the stamp and, where another
    column holds it, of its clock; `line`, `name` are for messages."""
    out, width = [], rows[0].count(mark)
    place, clock = places
    for k, row in enumerate(rows, line):
        fields = row.split(mark)
        whole = len(fields) == width + 1
        both = [fields[p].strip().strip('"') for p in (place, clock) if p is not None] if whole else []
        if word := " ".join(filter(None, both)):
            try:
                fields[place] = repr(seconds(word, form))
            except ValueError:
                what = f"'{word}' is no stamp of format '{form}'"
                raise CalibrationInputError(path, what, k, name) from None
        out.append(mark.join(fields))
    return out


def wide(
    path: Path, names: list[str], stamps: Array, values: Array, wanted: list[str], compete: int
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Columns of a long table on the stamps of one signal, which are key "", and each as it was logged. NaN
    beyond a signal's own stamps and in its gaps. The one is the first of `wanted` that is logged as often as
    any of the first that `compete`."""
    which = np.array(names)
    known = np.isfinite(stamps) & np.isfinite(values)
    rows = {name: np.flatnonzero((which == name) & known) for name in wanted}
    for name in wanted:
        if len(mine := rows[name]) < limits.FEWEST_VALUES:
            have = ", ".join(dict.fromkeys(names))
            raise CalibrationInputError(path, f"has {len(mine)} rows; the table has {have}", None, name)
    most = max(len(rows[name]) for name in wanted[:compete])
    base = np.sort(stamps[next(mine for mine in rows.values() if len(mine) >= limits.SAME_RATE * most)])
    out = {"": base}
    for name, mine in rows.items():
        mine = mine[np.argsort(stamps[mine], kind="stable")]
        t, x = stamps[mine], values[mine]
        found = np.interp(base, t, x, left=np.nan, right=np.nan)
        step = np.diff(t)
        after = np.clip(np.searchsorted(t, base, side="right"), 1, len(t) - 1) - 1
        inside = (base != t[after]) & (base != t[after + 1])
        found[inside & (step[after] > longest_step(step, float(np.median(step))))] = np.nan
        out[name] = found
    return out, {name: values[mine] for name, mine in rows.items()}
