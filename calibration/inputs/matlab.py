"""MATLAB files in MATLAB's own words: q, log.motor.q, data(:,3), Y{2}(1,:), Y{*}(1,:) for a run per cell.

NumPy's archives (.npz) are read in the same words.
"""

import re
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from calibration.arrays import Array
from calibration.errors import CalibrationInputError

TOKEN = re.compile(r"\.?([A-Za-z]\w*)|\{(\d+|\*)\}|\(([^()]*)\)")
# one element (2), one row (2,:), one column (:,2)
PLACE = re.compile(r"\s*(?:([1-9]\d*)|([1-9]\d*)\s*,\s*:|:\s*,\s*([1-9]\d*))\s*")


def read_matlab(path: Path, wanted: list[str]) -> list[dict[str, Array]]:
    """The wanted columns, one dictionary per run (more than one when a name has {*})."""
    content = _content(path)
    found: dict[str, list[Array]] = {}
    for name in wanted:
        try:
            found[name] = [_numbers(value) for value in _resolve(content, name)]
        except LookupError as error:
            raise CalibrationInputError(path, str(error), None, name) from None
    count = max((len(v) for v in found.values()), default=1)
    for name, values in found.items():
        if len(values) not in (1, count):
            raise CalibrationInputError(path, f"has {len(values)} cells, others {count}", None, name)
    runs = [{name: v[k % len(v)] for name, v in found.items()} for k in range(count)]
    for lengths in ({name: len(v) for name, v in run.items()} for run in runs):
        if len(set(lengths.values())) > 1:
            raise CalibrationInputError(path, f"the variables have different lengths: {lengths}")
    return runs


def _content(path: Path) -> dict[str, Any]:
    """Variables by their names. Raises CalibrationInputError for what is no such file."""
    from scipy.io import loadmat
    from scipy.io.matlab import MatReadError

    if path.suffix.lower() == ".npz":
        return _arrays(path)
    try:
        return dict(loadmat(path))
    except NotImplementedError:
        raise CalibrationInputError(path, "is MATLAB 7.3 (HDF5); save it with save(..., '-v7')") from None
    except (OSError, ValueError, TypeError, MatReadError):
        raise CalibrationInputError(path, "is not a MATLAB file this tool reads; save it with -v7") from None


def _arrays(path: Path) -> dict[str, Any]:
    """Plain arrays of a NumPy archive; objects are passed over."""
    from zipfile import BadZipFile
    from zlib import error as ZlibError

    found: dict[str, Any] = {}
    try:
        with np.load(path) as archive:
            for name in archive.files:
                with suppress(ValueError):
                    found[name] = archive[name]
    except (OSError, ValueError, TypeError, AttributeError, EOFError, RuntimeError, BadZipFile, ZlibError):
        raise CalibrationInputError(path, "is not a NumPy archive of plain arrays (savez)") from None
    return found


def columns_of(path: Path) -> list[str]:
    """Names of the rows and columns of numbers that a file has most of with one length, in MATLAB's words."""
    found: dict[tuple[int, int], list[str]] = {}
    for name, value in _content(path).items():
        for count, length, words in _vectors(value, name) if not name.startswith("__") else ():
            found.setdefault((count, length), []).append(words)
    return max(found.items(), key=lambda item: (len(item[1]), item[0]), default=((0, 0), []))[1]


def _vectors(value: Any, name: str, count: int = 1) -> Iterator[tuple[int, int, str]]:
    """Cells, rows and name of every row or column of numbers in a variable."""
    array = np.atleast_2d(value)
    if array.dtype.names and array.size == 1:
        for field in array.dtype.names:
            yield from _vectors(array.ravel()[0][field], f"{name}.{field}", count)
    elif array.dtype == object and array.size:
        yield from _vectors(array.ravel()[0], f"{name}{{*}}", array.size)
    elif np.issubdtype(array.dtype, np.number) and array.ndim == 2 and array.size > 1:
        short, rows = min(array.shape), array.shape[0] <= array.shape[1]
        for k in range(1, short + 1) if short > 1 else ():
            yield count, max(array.shape), f"{name}({k},:)" if rows else f"{name}(:,{k})"
        if short == 1:
            yield count, array.size, name


def _resolve(content: dict[str, Any], name: str) -> list[Any]:
    """What is behind one name: a list, because {*} is every cell."""
    if re.fullmatch(f"({TOKEN.pattern})*", name) is None:
        raise LookupError("is not a name in MATLAB's words, such as q, log.q, x(:,2), Y{2}(1,:)")
    values: list[Any] = [content]
    for field, cell, index in TOKEN.findall(name):
        if cell:
            values = [x for v in values for x in _cells(v, cell)]
        else:
            values = [_field(v, field) if field else _index(v, index) for v in values]
    return values


def _field(value: Any, field: str) -> Any:
    """A variable of the file, or a field of a struct."""
    struct = not isinstance(value, dict)
    names = (getattr(getattr(value, "dtype", None), "names", None) or ()) if struct else value
    if field not in names:
        have = ", ".join(k for k in names if not k.startswith("__")) or "none"
        raise LookupError(f"no such {'field' if struct else 'variable'} ('{field}'); there are {have}")
    if struct and value.size != 1:
        raise LookupError(f"is an array of {value.size} structs: index it")
    return value.ravel()[0][field] if struct else value[field]


def _cells(value: Any, cell: str) -> list[Any]:
    if getattr(value, "dtype", None) != np.dtype(object):
        raise LookupError("{} is for cells; this is no cell array")
    cells = list(value.ravel(order="F"))
    if cell != "*" and not 1 <= int(cell) <= len(cells):
        raise LookupError(f"there are {len(cells)} cells, counted from 1")
    return cells if cell == "*" else [cells[int(cell) - 1]]


def _index(value: Any, index: str) -> Any:
    """A row or column, counted from 1, or one element of a struct array."""
    form = PLACE.fullmatch(index)
    if form is None:
        raise LookupError(f"({index}): give one row (2,:), one column (:,2) or one element (2)")
    element, row, column = (int(k or 0) for k in form.groups())
    array = np.asarray(value)
    try:
        if element:
            return array.ravel(order="F")[element - 1 : element]
        return array[row - 1, :] if row else array[:, column - 1]
    except IndexError:
        raise LookupError(f"({index}) is outside of its {array.shape}") from None


def _numbers(value: Any) -> Array:
    array = np.asarray(value)
    if array.dtype == object or array.dtype.names:
        kind = f"a struct with {', '.join(array.dtype.names)}" if array.dtype.names else "a cell array"
        raise LookupError(f"is {kind}: name the part, such as .q or {{1}}")
    if array.ndim == 2 and min(array.shape) > 1:
        raise LookupError(f"is a matrix of {array.shape}: name a row or a column")
    if np.iscomplexobj(array):
        raise LookupError("holds complex numbers")
    try:
        return np.asarray(array, dtype=float).ravel()
    except (TypeError, ValueError):
        raise LookupError("is not numeric") from None
