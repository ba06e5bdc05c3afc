"""MATLAB files in MATLAB's own words: q, log.motor.q, data(:,3), Y{2}(1,:), Y{*}(1,:) for a run per cell."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from calibration.errors import CalibrationInputError
from calibration.readers.run import Array

TOKEN = re.compile(r"\.?([A-Za-z]\w*)|\{(\d+|\*)\}|\(([^()]*)\)")


def read_matlab(path: Path, wanted: list[str]) -> list[dict[str, Array]]:
    """The wanted columns, one dictionary per run (more than one when a name has {*})."""
    from scipy.io import loadmat
    from scipy.io.matlab import MatReadError

    try:
        content = loadmat(path)
    except NotImplementedError:
        raise CalibrationInputError(
            path, "is a MATLAB 7.3 file (HDF5); save it with save(..., '-v7')"
        ) from None
    except (OSError, ValueError, TypeError, MatReadError) as error:
        text = " ".join(str(error).split())
        raise CalibrationInputError(path, f"is not a MATLAB file this tool reads ({text})") from None
    found = {name: _resolve(path, content, name) for name in wanted}
    count = max((len(v) for v in found.values()), default=1)
    for name, values in found.items():
        if len(values) not in (1, count):
            raise CalibrationInputError(path, f"has {len(values)} cells, others {count}", None, name)
    out = []
    for k in range(count):
        run = {name: values[k if len(values) > 1 else 0] for name, values in found.items()}
        lengths = {name: len(v) for name, v in run.items()}
        if len(set(lengths.values())) > 1:
            raise CalibrationInputError(path, f"the variables have different lengths: {lengths}")
        out.append(run)
    return out


def _resolve(path: Path, content: dict[str, Any], name: str) -> list[Array]:
    """The arrays behind one name: a list, because {*} is every cell."""
    at, values = 0, [content]
    while at < len(name):
        token = TOKEN.match(name, at)
        if token is None:
            raise CalibrationInputError(
                path, "is not a name in MATLAB's words, such as q, log.q, x(:,2), Y{2}(1,:)", None, name
            )
        at = token.end()
        field, cell, index = token.groups()
        if field is not None:
            values = [_field(path, v, field, name) for v in values]
        elif cell is not None:
            values = [x for v in values for x in _cells(path, v, cell, name)]
        else:
            values = [_index(path, v, index, name) for v in values]
    return [_numbers(path, v, name) for v in values]


def _field(path: Path, value: Any, field: str, name: str) -> Any:
    if isinstance(value, dict):
        if field not in value:
            have = ", ".join(k for k in value if not k.startswith("__"))
            raise CalibrationInputError(path, f"no such variable; the file has {have}", None, name)
        return value[field]
    names = getattr(getattr(value, "dtype", None), "names", None)
    if not names or field not in names:
        what = f"a struct with {', '.join(names)}" if names else "no struct"
        raise CalibrationInputError(path, f"no field '{field}': it is {what}", None, name)
    if value.size != 1:
        raise CalibrationInputError(path, f"is an array of {value.size} structs: index it", None, name)
    return value.ravel()[0][field]


def _cells(path: Path, value: Any, cell: str, name: str) -> list[Any]:
    if getattr(value, "dtype", None) != np.dtype(object):
        raise CalibrationInputError(path, "{} is for cells; this is no cell array", None, name)
    cells = list(value.ravel(order="F"))
    if cell == "*":
        return cells
    if not 1 <= int(cell) <= len(cells):
        raise CalibrationInputError(path, f"there are {len(cells)} cells, counted from 1", None, name)
    return [cells[int(cell) - 1]]


def _index(path: Path, value: Any, index: str, name: str) -> Any:
    """A row or column, counted from 1, or one element of a struct array."""
    parts = [p.strip() for p in index.split(",")]
    array = np.asarray(value)
    try:
        if len(parts) == 1 and parts[0].isdigit():
            return array.ravel(order="F")[int(parts[0]) - 1 : int(parts[0])]
        if len(parts) == 2 and sorted(p.isdigit() for p in parts) == [False, True] and ":" in parts:
            row = parts[0].isdigit()
            return array[int(parts[0]) - 1, :] if row else array[:, int(parts[1]) - 1]
    except IndexError:
        raise CalibrationInputError(path, f"({index}) is outside of its {array.shape}", None, name) from None
    raise CalibrationInputError(
        path, f"({index}): give one row (2,:), one column (:,2) or one element (2)", None, name
    )


def _numbers(path: Path, value: Any, name: str) -> Array:
    array = np.asarray(value)
    if array.dtype == object or array.dtype.names:
        kind = f"a struct with {', '.join(array.dtype.names)}" if array.dtype.names else "a cell array"
        raise CalibrationInputError(path, f"is {kind}: name the part, such as .q or {{1}}", None, name)
    if array.ndim == 2 and min(array.shape) > 1:
        raise CalibrationInputError(
            path, f"is a matrix of {array.shape[0]} x {array.shape[1]}: name a row or a column", None, name
        )
    try:
        return np.asarray(array, dtype=float).ravel()
    except (TypeError, ValueError):
        raise CalibrationInputError(path, "is not numeric", None, name) from None
