"""Rows of a log that repeat the row before, and rows that are missing."""

from __future__ import annotations

import numpy as np

from calibration.inputs.declaration import Rig
from calibration.inputs.record import Record, Repair, quantum

STILL = ("time", "temperature", "supply", "reference")  # slow, or computed: they do not come with the frame
OFF_BEAT, REGULAR = 0.15, 0.99  # of a period either way; of the rows that must keep it
PLACES = 10  # at which rows are missing: fewer are gaps, which are told as such
LOST = 0.001  # of the rows


def lost_rows(record: Record) -> None:
    """Note single rows that are missing here and there from a clock that is regular otherwise."""
    steps = np.diff(record.columns["t"]) / record.period_s
    whole = np.round(steps)
    regular = np.abs(steps - whole) < OFF_BEAT
    if len(steps) < 200 or regular.mean() < REGULAR:
        return
    at = regular & (whole >= 2)
    rows = int((whole[at] - 1).sum())
    if at.sum() >= PLACES and rows > LOST * record.rows:
        note = f"{rows} rows are missing in {int(at.sum())} places"
        record.repairs.append(Repair("lost", "all", rows, float(rows), note))


def repeated_rows(record: Record, rig: Rig) -> None:
    """Rows in which every moving column repeats the row before while the motion goes on: a frame was lost."""
    present = [c for c in rig.columns if c in record.columns and c not in STILL]
    if len(present) < 2 or record.rows < 200:
        return
    same = np.ones(record.rows - 1, dtype=bool)
    for c in present:
        same &= np.diff(record.columns[c]) == 0
    x = record.columns["position"]
    usual = float(np.nanmedian(np.abs(np.diff(x))))
    step = quantum(x[np.isfinite(x)]) or 0.0
    if usual == 0 or usual < 4 * step or not same.any():  # a coarse column repeats itself anyway
        return
    quick = np.abs(np.nan_to_num(x[2:] - x[:-2])) > usual  # over two rows it moved
    lost = np.concatenate([[False], same[:-1] & quick, [False]])
    if not 3 <= lost.sum() <= 0.2 * record.rows:
        return
    for c in present:
        record.columns[c] = np.where(lost, np.nan, record.columns[c])
    note = f"{int(lost.sum())} rows repeat the row before while the drive moves: left out"
    record.repairs.append(Repair("repeat", "all", int(lost.sum()), float(lost.sum()), note))
