"""A named effect of a column is applied: the late column is shifted, a coupling's gap is taken out, and the
whole analysis is made once more on the corrected logs."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calibration.channels.coupling import carried_on, driven_side
from calibration.channels.frame import fill
from calibration.channels.noise import column_noise
from calibration.decide.delays import ELECTRICAL_S, WINDOW_DELAY_S
from calibration.decide.heldout import predict_residual
from calibration.decide.judge import Refusal
from calibration.decide.select import Selection
from calibration.finding import Finding
from calibration.readers.drive import ARCSEC
from calibration.readers.run import Array, Run
from calibration.statistics.regression import gls
from calibration.twomotors.result import AxisResult

#: columns of a log by what a finding calls them
LATE = {
    "position": ("position",),
    "tachometers": ("motor_a", "motor_b"),
    "velocity": ("velocity",),
    "current": ("current_a", "current_b"),
    "current or effort": ("current_a", "current_b"),
}
#: label of the nuisance of a channel that takes up a delay, and what it is in a sound log, s
NOMINAL = {"K": "tachometer_delay", "S": "velocity_delay", "T": "current_delay", "E": "electrical_lag"}
FALLS = 0.99  # of the held-out error of a channel, that an applied effect must leave less than
RISES = 1.05  # of another channel's, that it may leave at most
MUCH, AT_MOST = 0.5, 1.15  # where one channel's falls below half, what another's may rise to (ASSUMPTION)
APPLIED = ("channel_delay", "play")
# of the mean square above the encoders' floor: a gap that leaves more than it takes is not what is there. The
# emulator's own log at low preload, whose teeth part, has 16 % that look like a gap of the coupling
MOST_LEFT = 0.5


def to_apply(findings: Sequence[Finding]) -> Finding | None:
    """The first finding that is a fault of a column and can be undone."""
    return next((f for f in findings if f.name in APPLIED), None)


def corrected_runs(result: AxisResult, f: Finding) -> list[Run]:
    """The logs without the fault that `f` names; the given ones are left alone."""
    if f.name == "play":
        return _without_gap(result, f.parameters["gap"].value)
    word = re.match(r"the (.+) column is late", f.note)
    names = LATE.get(word.group(1) if word else "", ())
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
    if good.sum() < 4:
        return x
    at = t + delay
    y = CubicSpline(t[good], x[good])(at)
    return np.where(good & (at >= t[good][0]) & (at <= t[good][-1]), y, np.nan)


def _without_gap(result: AxisResult, gap: float) -> list[Run]:
    """Positions less half the gap (arcsec) on the side on which the coupling drives the encoder. While it
    may cross the gap the encoder does not see the axis: the motors carry it on, the rows are `unseen`."""
    frame, half = result.frame, gap / 2 * ARCSEC
    reading = fill(frame.columns["position"], frame.run)[0]
    side = driven_side(reading, frame.run, column_noise(frame).position)
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


def axis_by_motors(result: AxisResult) -> Array | None:
    """Angle of the axis (n,) rad by both motors' encoders less their trains' wind-up, an offset per run;
    None without them."""
    frame, k = result.frame, result.kinematic
    if k is None or "K" not in result.selections:
        return None
    compliance = float(result.selections["K"].after.beta[0])  # arcsec / arcsec per N m, see the K base
    ratio = frame.scale["gear_ratio"]
    both = []
    for key, sign in (("a", 1.0), ("b", -1.0)):
        spin = fill(frame.columns[f"motor_{key}"], frame.run)[0]
        current = fill(frame.columns[f"current_{key}"], frame.run)[0]
        turned = np.cumsum(spin) * frame.period_s / ratio
        both.append(turned - compliance * sign * k.per_ampere * current)
    return np.asarray(np.mean(both, axis=0))


def without_nuisance(s: Selection, key: str) -> Array:
    """Held-out residual (rows of test) of a channel's declared model when its delay is held at a sound log's:
    what the log leaves before a late column is shifted."""
    p = s.problem
    at = [label for label, _ in p.base_labels].index(NOMINAL[key])
    value = float(s.before.beta[at])
    sound = {"S": (-WINDOW_DELAY_S,) * 2, "E": ELECTRICAL_S}.get(key, (0.0, 0.0))
    held = float(np.clip(value, *sound))
    free = [k for k in range(p.base.shape[1]) if k != at]
    y = p.y - p.base[:, at] * held
    fit = gls(y, p.base[:, free], p.train, p.ar_order, p.block)
    part = replace(p, y=y, base=p.base[:, free])
    return predict_residual(part, part.base, fit.beta, p.test)


def before_of(result: AxisResult, again: AxisResult, f: Finding) -> dict[str, float]:
    """Per channel, the held-out error of the declared model on the logs as they are, on the rows that the
    corrected logs have, too."""
    out = {}
    for key in "TEKS":
        if key not in result.selections or key not in again.selections:
            continue
        s, p = result.selections[key], result.selections[key].problem
        both = again.selections[key].problem.test
        if not np.isfinite(s.held.before) or len(both) != len(p.test):
            continue
        late = f.name == "channel_delay" and key in NOMINAL
        e = without_nuisance(s, key) if late else predict_residual(p, p.base, s.before.beta, p.test)
        e = e[both[p.test]]
        if len(e):
            out[key] = float(np.sqrt(np.mean(e**2)))
    return out


def keep_untouched(first: AxisResult, again: AxisResult) -> None:
    """Channels without any effect that the correction does not help are left as they were: other rows to fit
    on are no gain and no loss of the effect's. In place."""
    for key, before in list(again.before.items()):
        was, now = first.selections[key], again.selections[key]
        if not was.chosen and not now.chosen and now.held.before >= before:
            again.selections[key] = was
            again.before[key] = was.held.before


def too_little(result: AxisResult, f: Finding) -> Refusal | None:
    """Why a gap is not applied at all: it leaves most of what the encoders show above their floor."""
    s, floor = result.selections.get("K"), result.floors.get("K")
    if f.name != "play" or s is None or floor is None or not np.isfinite(s.held.after):
        return None
    left = (s.held.after**2 - floor**2) / max(s.held.before**2 - floor**2, floor**2)
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
    falls = [k for k, a in after.items() if a < FALLS * before[k]]
    rises = [k for k, a in after.items() if a > max(RISES * before[k], again.floors.get(k, 0.0))]
    # rows are left out where a gap stood: what the others leave is another sample of the same
    much = min((a / before[k] for k, a in after.items() if before[k] > 0), default=1.0) < MUCH
    if falls and not [k for k in rises if not much or after[k] > AT_MOST * before[k]]:
        return None
    said = ", ".join(f"{k} {before[k]:.3g} to {a:.3g}" for k, a in after.items())
    return Refusal(f.name, f"applied, the held-out error does not fall: {said}")
