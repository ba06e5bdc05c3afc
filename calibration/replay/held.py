"""The held-out runs again, with the re-calibrated declared model and with the corrected plant, compared."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from calibration.candidates.axis_torque import start_clock
from calibration.channels.frame import Frame
from calibration.readers.run import Array
from calibration.replay.compare import UNITS, breaking, comparable, errors, residual
from calibration.replay.gains import Gains, identify
from calibration.replay.trace import Trace, drive_again, measured, model_for_run
from calibration.statistics.whitening import Mask
from plant.model import PlantModel

LEAST_ROWS = 100  # comparable rows, 1 s
WORSE = 1.25  # of the error before: the loop's own noise is another draw in every replay
NEAR = 1.2  # of the floor: a channel this near to it has nothing to gain
SHARE = 0.02  # of the rows near a break-away, from which on it is worth a line

Rows = dict[str, dict[str, Any]]


@dataclass
class Replay:
    """`rows` as in report.json's closed_loop; `reasons` in words; traces of the first run for the plot."""

    rows: Rows = field(default_factory=dict)
    reasons: list[str] = field(default_factory=list)
    run: str = ""
    time: Array = field(default_factory=lambda: np.zeros(0))
    log: Trace | None = None
    before: Trace | None = None
    after: Trace | None = None
    use: Mask = field(default_factory=lambda: np.zeros(0, dtype=bool))


def replay(
    frame: Frame,
    held: Mask,
    axis: str,
    declared: PlantModel,
    corrected: PlantModel,
    per_ampere: float,
    mean_currents: bool = False,
) -> Replay:
    """Run the loop again along every run that holds held-out rows, with both models, and compare there.

    `mean_currents`: the log's currents are mean ones already; else training rows tell how they were sampled.
    """
    gains = identify(frame, ~held) or identify(frame, held)
    clock = start_clock([r.header.get("start_utc", "") for r in frame.runs], frame.t, frame.run)
    out = Replay()
    pairs: dict[str, list[tuple[Trace, Trace, Mask]]] = {"before": [], "after": []}
    chaos: list[Mask] = []
    left_out: set[str] = set()
    same = declared == corrected
    sampled = not mean_currents and sampled_at_the_edge(frame, held, axis, corrected, gains, per_ampere)
    for k, run in enumerate(frame.runs):
        whole = frame.run == k
        if not (held & whole).any():
            continue
        whole &= np.arange(len(whole)) <= np.flatnonzero(held & whole)[-1]
        use = comparable(frame, whole) & held[whole]
        if use.sum() < LEAST_ROWS:
            continue
        start = float(clock[whole][0])
        log = measured(frame, whole, per_ampere)
        traces: dict[str, Trace] = {}
        for key, model in (("before", declared), ("after", corrected)):
            if key == "after" and same:
                traces[key] = traces["before"]
                continue
            try:
                prepared, left = model_for_run(
                    model, axis, run.scales, gains, start, frame.columns["temperature"][whole]
                )
                traces[key] = drive_again(prepared, axis, frame, whole, per_ampere, start)
                if sampled:
                    traces[key] = as_sampled(traces[key])
            except ValueError as error:
                return Replay(reasons=[f"closed loop not run again: {error}"])
            left_out |= set(left)
        for key, trace in traces.items():
            pairs[key].append((log, trace, use))
        chaos.append(breaking(log.position, frame.period_s, _stribeck(corrected, axis)))
        if out.log is None:
            out.run, out.time = run.name, frame.t[whole] - frame.t[whole][0]
            out.log, out.before, out.after = log, traces["before"], traces["after"]
            out.use = use & ~chaos[-1]
    if out.log is None:
        return Replay(reasons=["closed loop not run again: the held-out rows hold no settled motion"])
    _judge(out, pairs, chaos)
    _say(out, gains, left_out, frame)
    return out


def as_sampled(trace: Trace) -> Trace:
    """The trace with the torque that currents sampled at the PWM's edge give."""
    return replace(trace, torque=trace.torque + trace.ripple) if trace.ripple is not None else trace


def sampled_at_the_edge(
    frame: Frame, held: Mask, axis: str, model: PlantModel, gains: Gains | None, per_ampere: float
) -> bool:
    """Whether a run's training rows are nearer to currents sampled at the PWM's edge than to mean ones."""
    for k, run in enumerate(frame.runs):
        whole = frame.run == k
        use = comparable(frame, whole) & ~held[whole]
        if use.sum() < LEAST_ROWS:
            continue
        try:
            prepared, _ = model_for_run(model, axis, run.scales, gains, 0.0)
            trace = drive_again(prepared, axis, frame, whole, per_ampere)
        except ValueError:
            return False
        log = measured(frame, whole, per_ampere)
        mean, edge = (np.mean(residual("torque", log, x, use) ** 2) for x in (trace, as_sampled(trace)))
        return bool(edge < mean)
    return False


def _judge(out: Replay, pairs: dict[str, list[tuple[Trace, Trace, Mask]]], chaos: list[Mask]) -> None:
    """Fill the rows and say what is worse, and what the rows near a break-away would add."""
    settled = {
        key: [(a, b, use & ~c) for (a, b, use), c in zip(runs, chaos, strict=True)]
        for key, runs in pairs.items()
    }
    all_rows, rows = (sum(int(use.sum()) for _, _, use in x["after"]) for x in (pairs, settled))
    if rows < LEAST_ROWS:
        settled, rows = pairs, all_rows
        out.reasons.append("closed loop run again: the whole of the held-out rows is sticking and slipping")
    before, after = errors(settled["before"]), errors(settled["after"])
    for channel in before.rms:
        out.rows[channel] = {
            "unit": UNITS[channel],
            "before": before.rms[channel],
            "after": after.rms[channel],
            "floor": after.floor[channel],
        }
    for channel, r in out.rows.items():
        if r["after"] > WORSE * r["before"] and r["after"] > NEAR * r["floor"]:
            out.reasons.append(
                f"closed loop run again: the corrected plant is WORSE than the declared one in {channel}: "
                f"{r['before']:.3g} before, {r['after']:.3g} {r['unit']} after"
            )
    if all_rows - rows > SHARE * all_rows:
        first, last = errors(pairs["before"]).rms, errors(pairs["after"]).rms
        told = ", ".join(f"{c} {first[c]:.3g} before, {last[c]:.3g} {UNITS[c]} after" for c in last)
        out.reasons.append(
            f"closed loop run again: {100 * (1 - rows / all_rows):.0f} % of the settled rows are within a "
            f"second of a passage through the Stribeck speed and left out: the moment of breaking away "
            f"cannot be repeated; with them {told}"
        )


def _say(out: Replay, gains: Gains | None, left_out: set[str], frame: Frame) -> None:
    if gains is None:
        if not np.isfinite(frame.columns["setpoint"]).any():
            out.reasons.append("closed loop run again: the log is open loop, its effort was replayed")
        else:
            out.reasons.append(
                "closed loop run again: the log does not tell the gains, the plant file's were used"
            )
    else:
        out.reasons.append(
            f"closed loop run again with gains {gains.source}: Kp {gains.kp:.4g}, Ki {gains.ki:.4g}"
        )
    for name in sorted(left_out):
        out.reasons.append(
            f"closed loop run again without {name}: its trace or phase is a new one in every run"
        )


def _stribeck(model: PlantModel, axis: str) -> float:
    rate: float = getattr(model.axes, axis).friction.stribeck_rate.si
    return rate
