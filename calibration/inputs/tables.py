"""Any drive's table, read through its rig file into records."""

from __future__ import annotations

import itertools
from datetime import datetime
from pathlib import Path

import numpy as np

from calibration.errors import CalibrationInputError
from calibration.inputs.declaration import Rig
from calibration.inputs.matlab import read_matlab
from calibration.inputs.record import Record, signal_of
from calibration.inputs.repair import repair
from calibration.inputs.stamps import steady_stamps
from calibration.inputs.text import read_text
from calibration.readers.run import Array


def read_table(path: Path, rig: Rig) -> list[Record]:
    """The file's runs: one, or one per cell of a .mat file."""
    wanted: list[str | int] = [c.column for c in rig.columns.values()]
    if "column" in rig.runs:
        wanted.append(rig.runs["column"])
    if path.suffix.lower() == ".mat":
        found = read_matlab(path, [str(c) for c in wanted])
    else:
        found = [read_text(path, wanted, rig.names, rig.delimiter)]
    many = len(found) > 1
    return [
        _record(path, rig, raw, f"{path.stem}{{{k}}}" if many else path.stem)
        for k, raw in enumerate(found, 1)
    ]


def _record(path: Path, rig: Rig, raw: dict[str, Array], name: str) -> Record:
    columns: dict[str, Array] = {}
    wraps: dict[str, int] = {}
    for channel, where in rig.columns.items():
        values = np.array(raw[str(where.column)], dtype=float)
        label = str(where.column)
        if not np.isfinite(values).any():
            raise CalibrationInputError(path, "holds no number in any row", None, label)
        if np.isinf(values).any():
            row = int(np.argmax(np.isinf(values))) + 1
            raise CalibrationInputError(path, f"is infinite in data row {row}", None, label)
        if where.wrap:
            values, wraps[channel] = _unwrapped(values, where.wrap)
        columns["t" if channel == "time" else channel] = values * where.scale + where.offset
    if "time" not in rig.columns:
        columns["t"] = np.asarray(
            np.arange(len(next(iter(columns.values())))) * (rig.sample_period_s or 1.0), dtype=np.float64
        )
    clock = str(rig.columns["time"].column) if "time" in rig.columns else "time"
    first = _check_clock(path, columns["t"], clock)
    columns["t"] = columns["t"] - first
    for channel, where in rig.columns.items():  # a column that is late by delay_s tells of earlier times
        if where.delay_s and channel != "time":
            columns[channel] = np.interp(columns["t"] + where.delay_s, columns["t"], columns[channel])
    if "column" in rig.runs:
        columns["run"] = raw[str(rig.runs["column"])]
    record = Record(name, path, name, columns, raw, {"rig": rig.name})
    record.period_s = float(np.median(np.diff(columns["t"]))) if record.rows > 1 else 1.0
    record.start_s = _start(path, rig, first)
    record.signals = {
        c: signal_of(c, str(w.column), w.unit, columns["t" if c == "time" else c], wraps.get(c, 0))
        for c, w in rig.columns.items()
    }
    repair(record, rig)
    if "time" in rig.columns:
        steady_stamps(record)
    return record


def _unwrapped(values: Array, length: float) -> tuple[Array, int]:
    good = np.isfinite(values)
    out = values.copy()
    out[good] = np.unwrap(values[good], period=length)
    turns = np.round((out[good] - values[good]) / length)
    return out, int(np.count_nonzero(np.diff(turns)))


def _check_clock(path: Path, t: Array, name: str) -> float:
    """The first time stamp of a clock that goes forward."""
    if not np.isfinite(t).all():
        raise CalibrationInputError(
            path, f"is empty in data row {int(np.argmax(~np.isfinite(t))) + 1}", None, name
        )
    if len(t) > 1 and not np.median(np.diff(t)) > 0:
        raise CalibrationInputError(path, "does not advance", None, name)
    if (np.diff(t) < 0).any():
        k = int(np.argmax(np.diff(t) < 0))
        raise CalibrationInputError(path, f"time goes backwards from {t[k]:g} to {t[k + 1]:g}", k + 2, name)
    return float(t[0])


def _start(path: Path, rig: Rig, first: float) -> float | None:
    """When the file began, on the clock of all files; None where only their order is known."""
    source = rig.wall_time.get("from")
    if source == "time":
        return first
    if source == "name":
        form = rig.wall_time["format"]
        try:
            return datetime.strptime(path.stem, form).timestamp()
        except ValueError:
            raise CalibrationInputError(
                path, f"its name does not read as wall_time.format '{form}'"
            ) from None
    return None


def set_starts(records: list[Record], rig: Rig) -> str:
    """Fill every start in: from the clocks, or end to end in the order given; says which."""
    if not rig.wall_time and len(records) > 1:
        firsts = [r.raw[str(rig.columns["time"].column)][0] for r in records] if "time" in rig.columns else []
        scale = rig.columns["time"].scale if firsts else 1.0
        spans = sorted((f * scale, f * scale + r.duration_s) for f, r in zip(firsts, records, strict=False))
        if firsts and all(b[0] > a[1] for a, b in itertools.pairwise(spans)):
            for f, r in zip(firsts, records, strict=True):
                r.start_s = float(f * scale)
    if all(r.start_s is not None for r in records):
        first = min(float(r.start_s or 0.0) for r in records)
        for r in records:
            r.start_s = float(r.start_s or 0.0) - first
        return "the files' own clock"
    at = 0.0
    for r in records:
        r.start_s = at
        at += r.duration_s + r.period_s + float(rig.wall_time.get("gap_s", 0.0))
    return "the order of the files, end to end"
