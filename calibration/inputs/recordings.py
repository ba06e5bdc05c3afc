"""Columns out of recordings of other tools: MF4 (asammdf) and MCAP with JSON messages (mcap.dev).

Columns of one rate are taken row by row. A column of another rate shows the last value at or before the row's
time; rows are those of the first column, `time` aside.
"""

import json
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

import numpy as np

from calibration.arrays import Array
from calibration.errors import CalibrationInputError

TIME: Final = "time"
"""The column that every recording has: seconds since its first row."""
Columns = dict[str, tuple[Array, Array]]
"""Name -> times, s, and values."""


def read_mf4(path: Path, wanted: list[str]) -> list[dict[str, Array]]:
    """The wanted channels of an MDF file by their names: one run."""
    from asammdf import MDF
    from asammdf.blocks.mdf_v4 import MDF4

    # its own, of a file that is cut, ends in a traceback on the screen
    MDF4.__del__ = _close  # type: ignore[method-assign]
    try:
        with MDF(path) as file:
            have = sorted(name for name in file.channels_db if name not in ("t", TIME))
            known = (name for name in wanted if name in file.channels_db)
            got = {name: file.get(name, *file.channels_db[name][0]) for name in known}  # of several the first
    except Exception:  # asammdf raises whatever its parts meet in a broken file
        raise CalibrationInputError(path, "is no MDF file that can be read; export it again") from None
    columns = {name: (signal.timestamps, signal.samples) for name, signal in got.items() if name != TIME}
    return [_joined(path, wanted, columns, have)]


def _close(file: Any) -> None:
    with suppress(Exception):
        file.close()


def read_mcap(path: Path, wanted: list[str]) -> list[dict[str, Array]]:
    """The wanted fields, each as `/topic.field` (deeper: `/topic.field.inner`): one run."""
    from mcap.reader import make_reader

    begin_ns: int | None = None  # seconds since 1970 leave a double no more than a quarter of a microsecond
    rows: dict[str, list[tuple[float, float]]] = {name: [] for name in wanted if name != TIME}
    have: set[str] = set()
    try:
        with path.open("rb") as stream:
            reader = make_reader(stream)
            topics = {name for name in rows if name.startswith("/")}
            for _, channel, message in reader.iter_messages():
                names = [name for name in topics if name.startswith(f"{channel.topic}.")]
                if channel.message_encoding != "json" or (not names and channel.topic in have):
                    continue
                have.add(channel.topic)
                begin_ns = message.log_time if begin_ns is None else begin_ns
                content = json.loads(message.data) if names else {}
                for name in names:
                    value = _inside(content, name[len(channel.topic) + 1 :].split("."))
                    if value is not None:
                        rows[name].append(((message.log_time - begin_ns) * 1e-9, value))
    except Exception:  # and what the packers of its chunks raise
        raise CalibrationInputError(path, "is no MCAP file that can be read; record it again") from None
    arrays = {name: np.array(found, dtype=float) for name, found in rows.items() if found}
    columns = {name: (both[:, 0], both[:, 1]) for name, both in arrays.items()}
    return [_joined(path, wanted, columns, sorted(have))]


def _inside(content: Any, words: list[str]) -> float | None:
    for word in words:
        content = content.get(word) if isinstance(content, dict) else None
    return float(content) if isinstance(content, int | float) else None


def _joined(path: Path, wanted: list[str], columns: Columns, have: list[str]) -> dict[str, Array]:
    """One row per sample of the first column; raises CalibrationInputError for a column that is not there."""
    for name in (name for name in wanted if name not in (TIME, *columns)):
        raise CalibrationInputError(path, f"is not in the file, which has {', '.join(have[:20])}", None, name)
    if not columns:
        raise CalibrationInputError(path, "needs a column beside time")
    t = np.asarray(columns[next(name for name in wanted if name != TIME)][0], dtype=float)
    found = {TIME: t - t[0]}
    for name, (times, values) in columns.items():
        try:
            numbers = np.asarray(values, dtype=float)
        except (TypeError, ValueError):
            raise CalibrationInputError(path, "holds no numbers", None, name) from None
        at = np.searchsorted(times, t, side="right") - 1
        held = np.where(at >= 0, numbers[np.maximum(at, 0)], np.nan)
        found[name] = numbers if np.array_equal(times, t) else held
    return {name: found[name] for name in wanted}


RECORDINGS = {".mf4": read_mf4, ".mcap": read_mcap}  # by the ending of a file's name
