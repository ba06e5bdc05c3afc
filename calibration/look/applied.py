"""A named effect of a column is applied. The late column is shifted, a coupling's gap is taken out, and the
whole analysis is made once more on the corrected logs."""

from dataclasses import replace
from math import prod

import numpy as np
from numpy.typing import NDArray

from calibration.arrays import Array
from calibration.balances.context import direction_of
from calibration.balances.frame import fill
from calibration.balances.kinematic import APART_ARCSEC
from calibration.balances.noise import column_noise
from calibration.balances.thresholds import FEWEST_FOR_A_CUBIC
from calibration.decide.delays import SOUND, TERM
from calibration.decide.heldout import declared_residual
from calibration.decide.residual import MOST_LEFT, part_left
from calibration.decide.selection import Refusal
from calibration.finding import Finding
from calibration.inputs.run import Run
from calibration.look.axis_result import AxisResult
from calibration.names.channel_delay import COLUMNS
from calibration.names.channel_delay import NAME as DELAY
from calibration.names.inplant import value
from calibration.names.play import NAME as GAP
from calibration.statistics.tails import rms
from plant.units import ARCSEC

UNDONE = (DELAY.name, GAP.name)  # faults of a column that can be undone
#: columns of a log by their number in a plant file
LATE = {1: ("position",), 2: ("velocity",), 3: ("current_a", "current_b"), 4: ("motor_a", "motor_b")}
# of the product of all channels' held-out errors, that an applied effect must leave less than. ASSUMPTION
FALLS = 0.99
# times a channel's error, that it may leave of one at most: rows are left out where a gap stood, and what the
# others leave is another sample of the same. ASSUMPTION
AT_MOST = 1.15

# of the reading's noise per row, rms: two rows differ by so much once in 1e8, so it has moved. arithmetic
MOVED = 8.0
# within which it must move so far on either side of a row: one row of the analysis grid. ASSUMPTION
WAIT_ROWS = 3


def corrected_runs(result: AxisResult, f: Finding) -> list[Run]:
    """The logs without the fault that `f` names; the given ones are left alone."""
    if f.name == GAP.name:
        return _without_gap(result, f.parameters["gap"].value)
    names = LATE[int(value(f, "column", COLUMNS["current"]))]  # none where volts alone have shown it
    delay = f.parameters["delay"].value
    out = []
    for run in result.frame.runs:
        moved = {n: _earlier(run.columns["t"], run.columns[n], delay) for n in names if n in run.columns}
        out.append(replace(run, columns={**run.columns, **moved}))
    return out


def _earlier(t: Array, x: Array, delay: float) -> Array:
    """x(t + delay): cubic between rows, nothing beyond the log's ends."""
    from scipy.interpolate import CubicSpline

    good = np.isfinite(x)
    if good.sum() < FEWEST_FOR_A_CUBIC:
        return x
    at = t + delay
    y = CubicSpline(t[good], x[good])(at)
    return np.where(good & (at >= t[good][0]) & (at <= t[good][-1]), y, np.nan)


def _without_gap(result: AxisResult, gap: float) -> list[Run]:
    """Positions less half the gap (arcsec) on the side on which the coupling drives the encoder. While it
    may cross the gap the encoder does not see the axis: the motors carry it on, the rows are `unseen`."""
    frame, half = result.frame, gap / 2 * ARCSEC
    reading = fill(frame.columns["position"], frame.run)[0]
    side = driven_side(reading, frame.run, column_noise(frame)["position"])
    place = axis_by_motors(result)
    assert place is not None
    axis = carried_on(reading + side * half, place, frame.run)
    out = []
    for k, run in enumerate(frame.runs):
        here = np.flatnonzero(frame.run == k)
        rows = here[np.isfinite(frame.clock[here])]
        unseen = np.isnan(side[rows]).astype(float)
        position = run.columns["position"] + (axis - reading)[rows]
        out.append(replace(run, columns={**run.columns, "position": position, "unseen": unseen}))
    return out


def driven_side(reading: Array, run: NDArray[np.int64], noise: float) -> Array:
    """1 where the coupling drives `reading` (n,) forwards, -1 backwards, NaN where it may be in its gap.

    A reading behind a gap moves only while a flank drives it, so its last direction says which one. This
    holds even where motors leave their teeth in open loop. `noise` is the reading's own per row, in its unit.
    """
    least = MOVED * noise
    side = direction_of(reading, run, least)
    step = np.abs(reading[WAIT_ROWS:] - reading[:-WAIT_ROWS])
    moved = (step > least) & (side[WAIT_ROWS:] == side[:-WAIT_ROWS]) & (run[WAIT_ROWS:] == run[:-WAIT_ROWS])
    before = np.concatenate([np.zeros(WAIT_ROWS, dtype=bool), moved])
    after = np.concatenate([moved, np.zeros(WAIT_ROWS, dtype=bool)])
    return np.where(before & after, side, np.nan)


def carried_on(seen: Array, place: Array, run: NDArray[np.int64]) -> Array:
    """`seen` (n,) rad, gaps filled along `place` from both ends; straight where a motor left its teeth."""
    out = seen.copy()
    for k in np.unique(run):
        rows = np.flatnonzero(run == k)
        known = rows[np.isfinite(seen[rows])]
        if len(known) == 0:
            out[rows] = place[rows]
            continue
        off = seen[known] - place[known]
        out[rows] = place[rows] + np.interp(rows, known, off)
        left = np.abs(np.diff(off)) > APART_ARCSEC * ARCSEC
        for a, b in zip(known[:-1][left], known[1:][left], strict=True):
            out[a : b + 1] = np.linspace(seen[a], seen[b], b - a + 1)
    return out


def axis_by_motors(result: AxisResult) -> Array | None:
    """The axis (n,) rad by both motors' encoders less the wind-up, an offset per run; None without them."""
    frame, k = result.frame, result.kinematic
    if k is None or "K" not in result.selections:
        return None
    fit = result.selections["K"]
    compliance = fit.problem.named(fit.after)["compliance"].value  # rad per N m
    ratio = frame.scale["gear_ratio"]
    both = []
    for key, sign in (("a", 1.0), ("b", -1.0)):
        spin = fill(frame.columns[f"motor_{key}"], frame.run)[0]
        current = fill(frame.columns[f"current_{key}"], frame.run)[0]
        turned = np.cumsum(spin) * frame.period_s / ratio
        both.append(turned - compliance * sign * k.per_ampere * current)
    return np.asarray(np.mean(both, axis=0))


def before_of(result: AxisResult, again: AxisResult, f: Finding) -> dict[str, float]:
    """Per channel, the held-out error of the declared model on the logs as they are, on the rows that the
    corrected logs have, too. Before a late column is shifted its delay is held at a sound log's."""
    out = {}
    for key in "TEKS":
        if key not in result.selections or key not in again.selections:
            continue
        s, p = result.selections[key], result.selections[key].problem
        both = again.selections[key].problem.test
        if not np.isfinite(s.held.before) or len(both) != len(p.test):
            continue
        e = s.bare.residual(p, p.test)
        if f.name == DELAY.name and key in TERM:
            at = p.place(TERM[key])
            held = float(np.clip(s.before.beta[at], *SOUND.get(key, (0.0, 0.0))))
            e = declared_residual(p.holding({at: held}))
        e = e[both[p.test]]
        if len(e):
            out[key] = rms(e)
    return out


def keep_untouched(first: AxisResult, again: AxisResult) -> None:
    """Channels without an effect that the correction does not help stay: other rows are no gain. In place."""
    for key, before in list(again.before.items()):
        was, now = first.selections[key], again.selections[key]
        if not was.chosen and not now.chosen and now.held.before >= before:
            again.selections[key] = was
            again.before[key] = was.held.before


def too_little(result: AxisResult, f: Finding) -> Refusal | None:
    """Why a gap is not applied at all: it leaves most of what the encoders show above their floor."""
    s, floor = result.selections.get("K"), result.floors.get("K")
    if f.name != GAP.name or s is None or floor is None or not np.isfinite(s.held.after):
        return None
    left = part_left(s.held.before, s.held.after, floor)
    # the emulator's own log at low preload, whose teeth part, has 16 % that look like a gap of the coupling
    if left <= MOST_LEFT:
        return None
    return Refusal(f.name, f"leaves {100 * left:.0f} % of what is above the floor between the encoders")


def without(result: AxisResult, f: Finding, why: Refusal) -> AxisResult:
    """The result without the fault that was refused. In place."""
    result.findings = [x for x in result.findings if x.name != f.name]
    result.refused.append((f.channel, why.what, why.why))
    return result


def judged(before: dict[str, float], again: AxisResult, f: Finding) -> Refusal | None:
    """None when the held-out error falls once the effect is applied; else why it was not the effect."""
    after = {k: s.held.before for k, s in again.selections.items() if k in before}
    rises = [k for k, a in after.items() if a > max(AT_MOST * before[k], again.floors.get(k, 0.0))]
    if prod(a / before[k] for k, a in after.items() if before[k] > 0) < FALLS and not rises:
        return None
    said = ", ".join(f"{k} {before[k]:.3g} to {a:.3g}" for k, a in after.items())
    return Refusal(f.name, f"applied, the held-out error does not fall, or one rises: {said}")
