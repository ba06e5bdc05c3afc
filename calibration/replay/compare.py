"""How far a replayed run is from the measured one: rms per channel on the rows that may be compared."""

import numpy as np

from calibration.arrays import Array, Mask
from calibration.balances.filters import since
from calibration.balances.frame import JUMP, Frame
from calibration.balances.noise import row_to_row
from calibration.replay import thresholds as limits
from calibration.replay.trace import Trace
from plant.units import ARCSEC

UNITS = {"torque": "N m", "velocity": "arcsec/s", "position": "arcsec"}


def comparable(frame: Frame, rows: Mask) -> Mask:
    """Rows of the run `rows` that are settled: SETTLE_S away from start, gaps and jumps of the command."""
    there = np.isfinite(frame.clock[rows])
    wanted = frame.columns["setpoint"][rows]
    jump = np.zeros(len(there), dtype=bool)
    jump[0] = True
    jump[1:] |= np.abs(np.diff(np.nan_to_num(wanted))) > limits.SETPOINT_STEP
    jump[1:] |= there[1:] & ~there[:-1]
    if not np.isfinite(wanted).any():
        jump[1:] |= np.abs(np.diff(np.nan_to_num(frame.columns["effort"][rows]))) > JUMP
    settled = since(jump) > round(limits.SETTLE_S / frame.period_s)
    settled[:-2] &= ~(jump[1:-1] | jump[2:])
    return np.asarray(settled & there)


def breaking(position: Array, period_s: float, stribeck: float) -> Mask:
    """Rows within BREAKAWAY_S of a passage of the measured speed (position: arcsec) through `stribeck`."""
    good = np.isfinite(position)
    x = np.interp(np.arange(len(position)), np.flatnonzero(good), position[good]) * ARCSEC
    half = max(round(limits.SPEED_S / period_s / 2), 1)
    padded = np.pad(x, half, mode="reflect", reflect_type="odd")  # at the speed of the first and last rows
    speed = np.abs(padded[2 * half :] - padded[: -2 * half]) / (2 * half * period_s)
    passage = np.zeros(len(x))
    passage[1:] = (speed[1:] > stribeck) != (speed[:-1] > stribeck)
    reach = round(limits.BREAKAWAY_S / period_s)
    return np.asarray(np.convolve(passage, np.ones(2 * reach + 1), "same")[: len(x)] > 0)


def residual(channel: str, log: Trace, model: Trace, use: Mask) -> Array:
    """Model less log on `use`; positions less their mean in every stretch between two transients."""
    e = getattr(model, channel) - getattr(log, channel)
    if channel == "position":
        stretch = np.cumsum(~use)
        for k in np.unique(stretch[use]):
            at = use & (stretch == k) & np.isfinite(e)
            if at.any():  # a stretch may have no finite row
                e[at] -= e[at].mean()
    return np.asarray(e[use & np.isfinite(e)])


def errors(pairs: list[tuple[Trace, Trace, Mask]]) -> dict[str, tuple[float, float]]:
    """Per channel (units: UNITS) the rms of replay less log over the runs, each (log, replay, rows), and what
    noise and quantisation of both leave."""
    out = {}
    for channel in UNITS:
        e = np.concatenate([residual(channel, log, model, use) for log, model, use in pairs])
        if len(e) < limits.FEWEST_COMPARED:
            continue
        both = [(row_to_row(getattr(x, channel), use), int(use.sum())) for a, b, use in pairs for x in (a, b)]
        weight = sum(n for _, n in both) / 2
        floor = float(np.sqrt(sum(s * s * n for s, n in both if np.isfinite(s)) / max(weight, 1)))
        out[channel] = float(np.sqrt(np.mean(e**2))), floor
    return out
