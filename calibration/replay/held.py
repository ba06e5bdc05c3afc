"""The held-out runs again, with the re-calibrated declared model and with the corrected plant, compared.

Behind every transient the axis comes to stand at the log's angle. Another controller in the log leaves the
simulated axis at another angle, where periodic torques have another phase. The set point of the transient
takes that offset out; the offset is a figure of its own.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from calibration.arrays import Array, Mask
from calibration.balances.filters import pieces
from calibration.balances.frame import Frame
from calibration.replay.compare import UNITS, breaking, comparable, errors, residual
from calibration.replay.gains import Gains, identify
from calibration.replay.thresholds import CHAOS_SHARE, LEAST_ROWS, NEAR, NUDGES, SETTLE_S, WORSE
from calibration.replay.trace import Loop, Trace, repeats
from plant.model import PlantModel

Compared = tuple[Trace, Trace, Mask]  # log, replay, rows of the run
AGAIN = "closed loop replayed"
IDENTIFIED = "identified from set point, velocity and effort"


@dataclass(frozen=True, kw_only=True)
class Replay:
    """`rows` as in report.json's closed_loop; `reasons` in words; traces of the first run for the plot."""

    rows: Mapping[str, dict[str, Any]] = field(default_factory=dict)
    reasons: Sequence[str] = ()
    run: str = ""
    time: Array = field(default_factory=lambda: np.zeros(0))
    log: Trace | None = None
    before: Trace | None = None
    after: Trace | None = None
    use: Mask = field(default_factory=lambda: np.zeros(0, dtype=bool))


def replay(
    frame: Frame,
    held: Mask,
    declared: PlantModel,
    corrected: PlantModel,
    per_ampere: float,
    mean_currents: bool = False,
) -> Replay:
    """Run the loop again along every run that holds held-out rows, with both models, and compare there.

    `mean_currents`: the log's currents are mean ones already; else training rows tell how they were sampled.
    """
    axis = frame.runs[0].header["axis"]
    gains = identify(frame, ~held) or identify(frame, held)
    loop = Loop(frame=frame, axis=axis, per_ampere=per_ampere, gains=gains)
    shown: dict[str, Any] = {}
    pairs: dict[str, list[Compared]] = {"before": [], "after": []}
    offsets: dict[str, list[float]] = {"before": [], "after": []}
    chaos: list[Mask] = []
    models = {"after": corrected} | ({"before": declared} if declared != corrected else {})
    effects = (each for model in models.values() for each in getattr(model.axes, axis).effects)
    left_out = {each.name for each in effects if not repeats(each)}
    stribeck = getattr(corrected.axes, axis).friction.stribeck_rate.si
    try:
        sampled = not mean_currents and sampled_at_the_edge(loop, held, corrected)
        for k, run in enumerate(frame.runs):
            whole = frame.run == k
            if not (held & whole).any():
                continue
            whole &= np.arange(len(whole)) <= np.flatnonzero(held & whole)[-1]
            use = comparable(frame, whole) & held[whole]
            if use.sum() < LEAST_ROWS:
                continue
            log = loop.measured(whole)
            traces: dict[str, Trace] = {}
            for key, model in models.items():
                trace, moved = drive(loop, model, whole, use)
                traces[key] = as_sampled(trace) if sampled else trace
                offsets[key] += moved.tolist()
            traces.setdefault("before", traces["after"])
            for key, trace in traces.items():
                pairs[key].append((log, trace, use))
            chaos.append(breaking(log.position, frame.period_s, stribeck))
            if not shown:
                time = frame.t[whole] - frame.t[whole][0]
                shown = {"run": run.name, "time": time, "log": log, "use": use & ~chaos[-1], **traces}
    except ValueError as error:
        return Replay(reasons=[f"closed loop not replayed: {error}"])
    if not shown:
        return Replay(reasons=["closed loop not replayed: the held-out rows hold no settled motion"])
    rows, reasons = _judge(pairs, chaos)
    reasons += [*_beside(offsets), *_conditions(gains, left_out, frame)]
    return Replay(rows=rows, reasons=reasons, **shown)


def as_sampled(trace: Trace) -> Trace:
    """The trace with the torque that currents sampled at the PWM's edge give."""
    return replace(trace, torque=trace.torque + trace.ripple) if trace.ripple is not None else trace


def sampled_at_the_edge(loop: Loop, held: Mask, model: PlantModel) -> bool:
    """Whether a run's training rows are nearer to currents sampled at the PWM's edge than to mean ones."""
    for k in range(len(loop.frame.runs)):
        whole = loop.frame.run == k
        use = comparable(loop.frame, whole) & ~held[whole]
        if use.sum() < LEAST_ROWS:
            continue
        log, trace = loop.measured(whole), drive(loop, model, whole, use)[0]
        mean, edge = (np.mean(residual("torque", log, x, use) ** 2) for x in (trace, as_sampled(trace)))
        return bool(edge < mean)
    return False


def _judge(
    pairs: dict[str, list[Compared]], chaos: list[Mask]
) -> tuple[dict[str, dict[str, Any]], list[str]]:
    """The rows, what is worse, and what the rows near a break-away would add."""
    out: dict[str, dict[str, Any]] = {}
    reasons: list[str] = []
    settled = {
        key: [(a, b, use & ~c) for (a, b, use), c in zip(runs, chaos, strict=True)]
        for key, runs in pairs.items()
    }
    all_rows, rows = (sum(int(use.sum()) for _, _, use in x["after"]) for x in (pairs, settled))
    if rows < LEAST_ROWS:
        settled, rows = pairs, all_rows
        reasons.append(f"{AGAIN}: the whole of the held-out rows is sticking and slipping")
    declared = errors(settled["before"])
    for channel, (after, floor) in errors(settled["after"]).items():
        before, unit = declared[channel][0], UNITS[channel]
        out[channel] = {"unit": unit, "before": before, "after": after, "floor": floor}
        if after > WORSE * before and after > NEAR * floor:
            worse = f"the corrected plant is WORSE than the declared one in {channel}"
            reasons.append(f"{AGAIN}: {worse}: {before:.3g} before, {after:.3g} {unit} after")
    if all_rows - rows > CHAOS_SHARE * all_rows:
        first, last = errors(pairs["before"]), errors(pairs["after"])
        told = ", ".join(f"{c} {first[c][0]:.3g} before, {last[c][0]:.3g} {UNITS[c]} after" for c in last)
        reasons.append(
            f"{AGAIN}: {100 * (1 - rows / all_rows):.0f} % of the settled rows are within a "
            f"second of a passage through the Stribeck speed and left out. The moment of breaking away "
            f"cannot be repeated. With them {told}"
        )
    return out, reasons


def _beside(offsets: dict[str, list[float]]) -> list[str]:
    """How far from the log the axis comes to stand behind the transients of its command."""
    rms = {key: float(np.sqrt(np.mean(np.square(x)))) for key, x in offsets.items() if x}
    if not rms:
        return []
    said = ", ".join(f"{x:.3g} arcsec {key}" for key, x in rms.items())
    moves = f"each of {len(offsets['after'])} transients moves it against the log by {said} (rms)"
    return [f"{AGAIN}: {moves}; the set point of a transient takes that out"]


def _conditions(gains: Gains | None, left_out: set[str], frame: Frame) -> list[str]:
    """With which gains it was run, and without which effects."""
    if gains is not None:
        how = f" with gains {IDENTIFIED}: Kp {gains.kp:.4g}, Ki {gains.ki:.4g}"
    elif np.isfinite(frame.columns["setpoint"]).any():
        how = ": the log does not tell the gains, the plant file's were used"
    else:
        how = ": the log is open loop, its effort was replayed"
    without = (f" without {name}: its trace or phase is a new one in every run" for name in sorted(left_out))
    return [AGAIN + words for words in (how, *without)]


def drive(loop: Loop, model: PlantModel, rows: Mask, use: Mask) -> tuple[Trace, Array]:
    """Run `model` along the run `rows` (mask of the log's rows), of whose rows `use` are compared. The second
    value is how far each of its transients, run as it is, moves the axis against the log, arcsec. Raises
    ValueError where the plant cannot be run."""
    period_s, position = loop.frame.period_s, loop.measured(rows).position
    half = round(SETTLE_S / period_s / 2)
    least = max(LEAST_ROWS, half)
    settled = use & np.isfinite(position)
    parts = [first for first, end in pieces(settled.astype(int)) if settled[first] and end - first >= least]
    nudge = np.zeros(len(position))  # arcsec/s beside the set point, in the first half of what settles
    found: list[tuple[float, Trace, Array]] = []
    for _ in range(1 + NUDGES):
        trace = loop.again(model, rows, nudge)
        beside = trace.position - position
        offsets = np.array([np.mean(beside[first : first + half]) for first in parts])
        found.append((float(np.abs(offsets).max(initial=0.0)), trace, np.diff(offsets, prepend=0.0)))
        for first, moved in zip(parts, found[-1][2], strict=True):
            start = max(first - 2 * half, 0)
            nudge[start : start + half] -= moved / (half * period_s)
    _, best, _ = min(found, key=lambda one: one[0])
    return best, found[0][2]
