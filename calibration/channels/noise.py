"""What the sensors leave in every channel of an axis: each column's own noise, taken through the channel.

A column's noise comes from its differences from row to row, which the motion is too smooth to make, and never
from the residual of a fit. It is at least what rounding to whole counts leaves, a quantum over sqrt(12).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from calibration.channels.frame import Frame
from calibration.channels.motion import Motion
from calibration.channels.torque import Transmission
from calibration.readers.drive import ARCSEC
from calibration.readers.run import Array
from calibration.statistics.regression import solve
from calibration.statistics.whitening import Mask

ROUNDING = 1.0 / np.sqrt(12.0)  # rms of a rounding error, of a quantum
BLOCK = 100  # rows: the median over blocks of a second leaves out transients and lost packets
LEAST_BLOCKS = 3
BOX = np.convolve(np.ones(3), np.ones(3)) / 9.0  # `Motion.at` on the analysis grid of three rows
OWN_COUNT = 0.5  # counts per row: a tachometer that is slower keeps its rounding error from row to row
QUIET_PART = 0.4377  # mean square of the smaller four fifths of normal values, of all: (0.8 - 2 q f(q)) / 0.8
CONDUCTING = 2.0  # counts: a smaller current is cut off at zero


@dataclass(frozen=True)
class Noise:
    """rms per row: position rad, rate of the incremental encoder rad/s, current A by motor; None where a log
    has no such column."""

    position: float
    velocity: float | None
    current: dict[str, float]
    effort: float = 0.0  # what changes from row to row, of full effort


def rough(x: Array, order: int) -> float:
    """rms of white noise in x (n,) from its `order`-th differences: the median over blocks; NaN when too
    short."""
    d = np.diff(x, order) ** 2
    gain = float(np.sum(_binomial(order) ** 2))
    blocks = [float(np.mean(b)) for b in np.split(d, range(BLOCK, len(d), BLOCK)) if np.isfinite(b).all()]
    return float(np.sqrt(np.median(blocks) / gain)) if len(blocks) >= LEAST_BLOCKS else float("nan")


def _binomial(order: int) -> Array:
    out = np.ones(1)
    for _ in range(order):
        out = np.convolve(out, [1.0, -1.0])
    return out


def column_noise(frame: Frame) -> Noise:
    """The noise of every column of a log, from the column alone (currents: beside the logged effort)."""
    count = frame.scale["position_arcsec_per_count"] * ARCSEC
    position = _least(rough(frame.columns["position"], 4), count)
    velocity = None
    if frame.get("velocity") is not None:
        per_count = frame.scale["velocity_arcsec_per_count"] * ARCSEC / frame.scale["velocity_window_s"]
        velocity = _least(rough(frame.columns["velocity"], 2), per_count)
    ampere = frame.scale["adc_A_per_count"]
    current = {
        k: _least(_current_noise(frame, k), ampere) for k in "ab" if frame.get(f"current_{k}") is not None
    }
    effort = rough(frame.columns["effort"], 2)
    return Noise(position, velocity, current, effort if np.isfinite(effort) else 0.0)


def _least(found: float, quantum: float) -> float:
    return float(max(found, quantum * ROUNDING) if np.isfinite(found) else quantum * ROUNDING)


def _current_noise(frame: Frame, key: str) -> float:
    """A current's second differences less what the second differences of the effort make of them: a loop's
    own rounding moves the current for real."""
    i, effort = frame.columns[f"current_{key}"], frame.columns["effort"]
    d, u = np.full(len(i), np.nan), np.full(len(i), np.nan)
    d[2:], u[2:] = np.diff(i, 2), np.diff(np.abs(effort), 2)
    x = np.column_stack([np.roll(u, k) for k in range(3)])
    ok = np.isfinite(d) & np.isfinite(x).all(axis=1) & (i > CONDUCTING * frame.scale["adc_A_per_count"])
    ok[:4] = False
    for side in (effort > 0, effort <= 0):  # a motor's share of the effort hangs on its sign
        rows = ok & side
        if rows.sum() > BLOCK:
            d[rows] -= x[rows] @ solve(x[rows], d[rows])
    parts = [b[np.isfinite(b)] for b in np.split(np.where(ok, d, np.nan), range(BLOCK, len(d), BLOCK))]
    squares = [_quiet(b**2) for b in parts if len(b) > BLOCK // 2]
    return float(np.sqrt(np.median(squares) / 6.0)) if len(squares) >= LEAST_BLOCKS else float("nan")


def _quiet(squares: Array) -> float:
    """Mean square of normal values by their smaller four fifths: what disturbs some rows does not count."""
    return float(np.mean(np.sort(squares)[: round(0.8 * len(squares))])) / QUIET_PART


def torque_floor(n: Noise, drive: Transmission, inertia: float, period_s: float) -> float | None:
    """N m: both currents through the motors, the trains' curvature and the averaging; the position through
    the inertia. `period_s` of the analysis grid (three rows)."""
    if not n.current:
        return None
    second = np.array([1.0, 0, 0, -2.0, 0, 0, 1.0]) / period_s**2
    through = np.pad(BOX, 1) - drive.softness_s2 * second
    currents = drive.per_ampere**2 * float(np.sum(through**2)) * sum(s**2 for s in n.current.values())
    return float(np.sqrt(currents + (inertia * n.position) ** 2 * float(np.sum(second**2))))


def electrical_floor(n: Noise, resistance: float, supply: float, counter: float) -> float | None:
    """V: a current through the resistance (the rate's noise through the constant is a thousandth of it), and
    the effort of the tick between two rows, which is not logged: half of a row's volts are of that tick.
    `counter`: the lagging motor's share of the effort."""
    if not n.current:
        return None
    mean = float(np.mean([s**2 for s in n.current.values()]))
    between = (supply * n.effort) ** 2 / 2 * (1 + counter**2) / 2
    return float(np.sqrt(np.sum(BOX**2) * (resistance**2 * mean + between)))


def encoder_floor(n: Noise, frame: Frame, m: Motion, rows: Mask, drive: Transmission) -> float:
    """arcsec: the tachometers' rounding, averaged where they count quickly enough, the absolute encoder and
    what the currents' noise makes of the trains' wind-up, over the held-out `rows` (n_analysis,)."""
    turn = frame.scale["tach_counts_per_turn"] * frame.scale["gear_ratio"]
    quick = np.abs(m.rate[m.pick][rows]) / (2 * np.pi) * turn * frame.period_s > OWN_COUNT
    averaged = float(np.sum(BOX**2))
    share = float(np.mean(np.where(quick, averaged, 1.0))) if rows.any() else 1.0
    count = 2 * np.pi / turn * ROUNDING
    wind = max(n.current.values(), default=0.0) * drive.per_ampere / drive.stiffness
    return float(np.sqrt(share * count**2 + averaged * (n.position**2 + wind**2)) / ARCSEC)


def roller_floor(n: Noise) -> float | None:
    """arcsec/s: the incremental encoder's counts, averaged."""
    return None if n.velocity is None else float(n.velocity * np.sqrt(np.sum(BOX**2)) / ARCSEC)
