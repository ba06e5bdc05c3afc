"""Any drive's table, read through its rig file into runs."""

import itertools
from datetime import datetime
from fnmatch import fnmatch
from pathlib import Path

import numpy as np

from calibration.arrays import Array, Mask
from calibration.errors import CalibrationInputError
from calibration.inputs.clock import check_clock, parts_of_clock, parts_of_label
from calibration.inputs.counters import count_wraps, read_signed, unwrap
from calibration.inputs.declaration import Column, Rig
from calibration.inputs.matlab import read_matlab
from calibration.inputs.recordings import RECORDINGS
from calibration.inputs.repair import repair
from calibration.inputs.rows import steady_stamps
from calibration.inputs.run import Repair, Run, signal_of
from calibration.inputs.text import Long, heading, load_utf8, read_long
from calibration.inputs.thresholds import LARGEST_NUMBER

#: files that are no text, by the ending of their name
READERS = {".mat": read_matlab, ".npz": read_matlab, **RECORDINGS}


def read_table(path: Path, rig: Rig, text: str | None = None) -> list[Run]:
    """The file's runs: one, or one per cell of a .mat file, start of its clock, or label.

    `text` is its content if it was read."""
    # of a long table the stamps of what is explained are kept: its noise stays white, its steps are steps
    told = [r.channel for r in rig.responses]
    first = sorted(rig.columns, key=lambda c: (c not in told, c != "position"))
    channels = first if rig.long else list(rig.columns)
    wanted: list[str | int] = [rig.columns[c].column for c in channels if rig.columns[c].column != ""]
    if "column" in rig.runs:
        wanted.append(rig.runs["column"])
    stamp = rig.columns.get("time")
    stamps = {str(stamp.column): (stamp.format, stamp.clock)} if stamp is not None and stamp.format else {}
    logged: dict[str, Array] = {}
    if reader := READERS.get(path.suffix.lower()):
        found = reader(path, [str(c) for c in wanted])
    else:
        table = heading(path, load_utf8(path) if text is None else text, rig.names, rig.delimiter)
        if rig.long and stamp is not None:
            compete = 2 if any(r.is_force for r in rig.responses) else 1  # a force and its position
            long = Long(rig.long["name"], str(stamp.column), rig.long["value"], compete)
            one, logged = read_long(table, wanted, long, stamps)
            found = [one]
        else:
            found = [table.read(wanted, stamps)]
    if "column" in rig.runs:
        label, clock = str(rig.runs["column"]), "" if stamp is None else str(stamp.column)
        found = [part for raw in found for part in parts_of_label(raw, raw[label], raw.get(clock))]
    parts = [(raw, 0) for raw in found]
    if stamp is not None:
        parts = [part for raw in found for part in parts_of_clock(raw, raw[str(stamp.column)])]
    names = [f"{path.stem}{{{k}}}" for k in range(1, len(parts) + 1)] if len(parts) > 1 else [path.stem]
    runs = [_run(path, rig, raw, name, logged) for (raw, _), name in zip(parts, names, strict=True)]
    for run, (_, stray) in zip(runs, parts, strict=True):
        if stray:
            note = f"{stray} rows are left out: stamps that leap back or ahead, or nothing in the row"
            run.repairs.append(Repair("leap", "time", stray, float(stray), note))
    return runs


def _run(path: Path, rig: Rig, raw: dict[str, Array], name: str, logged: dict[str, Array]) -> Run:
    columns: dict[str, Array] = {}
    counted = {
        channel: logged[label] * of_file(path, where, label) * where.scale
        for channel, where in rig.columns.items()
        if (label := str(where.column)) in logged and not (where.steps or where.integrated)
    }
    wraps: dict[str, int] = {}
    rows = len(next(iter(raw.values())))
    for channel, where in sorted(rig.columns.items(), key=lambda item: item[0] != "time"):  # the time first
        label = str(where.column) or channel
        values = np.array(raw[label], dtype=float) if where.column != "" else np.ones(rows)
        if not np.isfinite(values).any():
            raise CalibrationInputError(path, "holds no number in any row", None, label)
        _refuse(path, np.isinf(values), "is infinite", label)
        _refuse(path, np.abs(values) > LARGEST_NUMBER, f"is beyond {LARGEST_NUMBER:g}", label)
        if where.sign_bit is not None:
            values = signed(path, values, where.sign_bit, label)
        if where.wrap:
            counted_up = unwrap(values, where.wrap)
            wraps[channel], values = count_wraps(values, counted_up, where.wrap), counted_up
        values = values * of_file(path, where, label) * where.scale + where.offset
        if where.steps or where.integrated:
            clock_s = columns.get("t", _even(rig, rows))
            values = over_time(where, clock_s - clock_s[0], values)
        columns["t" if channel == "time" else channel] = values
    columns.setdefault("t", _even(rig, rows))
    t = columns["t"]
    clock = str(rig.columns["time"].column) if "time" in rig.columns else "time"
    _refuse(path, ~np.isfinite(t), "is empty", clock)
    check_clock(path, t, clock)
    columns["t"] = t - t[0]
    for channel, where in rig.columns.items():  # a column that is late by delay_s tells of earlier times
        if where.delay_s and channel != "time":
            counted.setdefault(channel, columns[channel])
            columns[channel] = np.interp(columns["t"] + where.delay_s, columns["t"], columns[channel])
    start_s = _start(path, rig, float(t[0]))
    run = Run(name, path, name, columns, raw, {"rig": rig.name}, logged=counted, start_s=start_s)
    run.period_s = float(np.median(np.diff(columns["t"]))) if run.rows > 1 else 1.0
    run.signals = {
        c: signal_of(c, str(w.column), w.unit, columns["t" if c == "time" else c], wraps.get(c, 0))
        for c, w in rig.columns.items()
    }
    return run


def repair_tables(runs: list[Run], rig: Rig) -> None:
    """Repair the columns of all files of a drive in place: a word has its sign in every one of them."""
    read_signed(runs, rig)
    for run in runs:
        repair(run, rig)
        if "time" in rig.columns:
            steady_stamps(run)


def _even(rig: Rig, rows: int) -> Array:
    """Time (rows,) of a file without a time column, s."""
    return np.arange(rows) * np.float64(rig.sample_period_s or 1.0)


def _refuse(path: Path, bad: Mask, why: str, name: str) -> None:
    """Raise CalibrationInputError for the first row that is `bad` (n,)."""
    if bad.any():
        raise CalibrationInputError(path, f"{why} in data row {int(np.argmax(bad)) + 1}", None, name)


def _start(path: Path, rig: Rig, first: float) -> float | None:
    """When the file began, on the clock of all files; None where only their order is known."""
    source = rig.wall_time.get("from")
    if source != "name":
        return first if source == "time" else None
    form = rig.wall_time["format"]
    try:
        return datetime.strptime(path.stem, form).timestamp()
    except ValueError:
        raise CalibrationInputError(path, f"its name does not read as wall_time.format '{form}'") from None


def set_starts(runs: list[Run], rig: Rig) -> str:
    """Fill every start in: from the clocks, or end to end in the order given; says which."""
    starts = [r.start_s for r in runs if r.start_s is not None]
    if not rig.wall_time and len(runs) > 1 and "time" in rig.columns:
        time = rig.columns["time"]
        firsts = [float(r.raw[str(time.column)][0] * time.scale) for r in runs]
        spans = sorted((at, at + r.duration_s) for at, r in zip(firsts, runs, strict=True))
        starts = firsts if all(b[0] > a[1] for a, b in itertools.pairwise(spans)) else []
    if len(starts) == len(runs):
        for at, r in zip(starts, runs, strict=True):
            r.start_s = at - min(starts)
        return "the files' own clock"
    at = 0.0
    for r in runs:
        r.start_s, r.in_order = at, not rig.wall_time
        at += r.duration_s + r.period_s + float(rig.wall_time.get("gap_s", 0.0))
    return "the order of the files, end to end"


def signed(path: Path, words: Array, bit: int, label: str) -> Array:
    """Sign-magnitude words (n,) as numbers: `bit`, from 0, is the sign."""
    if (words < 0).any():
        raise CalibrationInputError(path, "is signed already: leave sign_bit out", None, label)
    negative = np.floor(words / 2.0**bit) % 2 == 1
    return np.where(negative, -1.0, 1.0) * np.where(np.isfinite(words), words % 2.0**bit, np.nan)


def of_file(path: Path, where: Column, label: str) -> float:
    """The number of this file, by its name without the ending; 1 where no file has one."""
    numbers = [x for name, x in (where.files or {"*": 1.0}).items() if fnmatch(path.stem, name)]
    if not numbers:
        raise CalibrationInputError(path, f"'files' has no number for {path.stem}", None, label)
    return numbers[0]


def over_time(where: Column, t: Array, values: Array) -> Array:
    """`values` (n,), rig units, times declared steps, integrated if declared; t s from the first row."""
    if where.steps:
        starts, sizes = np.array(where.steps).T
        values = values * np.where(t < starts[0], 0.0, sizes[np.searchsorted(starts[1:], t, side="right")])
    if where.integrated:
        good = np.isfinite(values)
        rate = np.interp(t, t[good], values[good])
        values = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(t))])
    return values
