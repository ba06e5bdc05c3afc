"""Rows that a log lost or repeats."""

import numpy as np

from calibration.arrays import Mask
from calibration.balances.frame import Frame
from calibration.finding import NORMAL, Parameter, of_columns
from calibration.names.name import Array, Beside, Finding, Name
from calibration.statistics.tails import share_log10

MOVING = 4e-8  # rad per row, 0.8 arcsec/s. ASSUMPTION
QUICK = 4e-7  # rad per row: fast enough that a single row without motion is no chance. ASSUMPTION
LOST = 0.003  # fraction of the rows missing, or repeated, that is worth a word. ASSUMPTION
AROUND = 30  # rows on either side that are looked at for a motion. ASSUMPTION
MOVING_ROWS = 20  # rows of them that move. ASSUMPTION
STANDS = 5  # rows without motion, from which on they are no chance of a slow motion. ASSUMPTION
PACKET = 25  # rows per RS232 packet (log-format.md)


def stamps(frame: Frame) -> Finding | None:
    """Rows that are missing, and rows that repeat others, which are taken out: they are no motion."""
    gaps = frame.gaps
    lost, rows, again = sum(gaps), int(frame.present.sum()), _repeated(frame)
    repeats = int(again.sum())
    if repeats / max(rows, 1) >= LOST:
        for column in frame.columns.values():
            column[again] = np.nan  # a repeated row is a missing one with a wrong stamp
    fraction = lost / (lost + rows)
    if fraction < LOST and repeats / max(rows, 1) < LOST:
        return None
    whole = np.mean([g % PACKET == 0 for g in gaps]) if gaps else 0.0
    value = max(fraction, repeats / max(rows, 1))
    packets = (rows + lost) / PACKET
    half = NORMAL * np.sqrt(value * (1 - value) / max(packets, 1.0))
    share = Parameter(value, "1", max(value - half, 0.0), value + half)
    gone = f"{lost} rows missing in {len(gaps)} gaps ({100 * whole:.0f} % of whole packets)"
    sure, told = share_log10(value * packets, packets, LOST), {"packet_loss" if lost else "repeats": share}
    return of_columns(NAME.name, told, evidence=sure, note=f"{gone}, {repeats} rows repeated")


def _repeated(frame: Frame) -> Mask:
    """Rows (n,) of packets that repeat the packet before them, or frozen rows while moving."""
    p, columns = frame.columns["position"], ("position", "velocity", "effort", "current_a")
    moving = np.abs(np.gradient(np.nan_to_num(p))) > MOVING
    near = np.convolve(moving, np.ones(2 * AROUND + 1), "same") > MOVING_ROWS
    both = (_as_before(frame, PACKET, *columns, "current_b") | _as_before(frame, 1, *columns)) & near
    edges = np.flatnonzero(np.diff(both.astype(int), prepend=0, append=0))
    for start, end in edges.reshape(-1, 2):
        both[start:end] = _goes_on(p, int(start), int(end - start))
    return both


def _as_before(frame: Frame, rows: int, *columns: str) -> Mask:
    """Rows (n,) whose columns are the same as so many rows before."""
    out = np.arange(len(frame.t)) >= rows
    for c in (frame.get(name) for name in columns):
        if c is not None:
            out[rows:] &= c[rows:] == c[:-rows]
    return out


def _goes_on(p: Array, at: int, rows: int) -> bool:
    """Whether the row after `rows` unchanged ones from `at` has moved as if the axis had not come to rest."""
    before, after = p[max(at - 1, 0)], p[min(at + rows, len(p) - 1)]
    usual = np.nanmedian(np.abs(np.diff(p[max(at - 12, 0) : at + 1]))) if at > 1 else 0.0
    least = MOVING if rows >= STANDS else QUICK
    return bool(abs(after - before) > 0.3 * (rows + 1) * usual and usual > least)


NAME = Name(
    name="sample_loss",
    experiment="record at half the rate, or over a shorter cable: a transport loses fewer rows then",
    stamps=stamps,
    repairs=("spike", "repeat", "lost"),
    beside=Beside(consequences={"S": ("wind_torque", "channel_delay", "roller_slip")}),
)
