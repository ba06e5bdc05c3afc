"""The answer for axis logs: verdict, error table, what is not identifiable, controls, pictures,
plant.yaml."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from calibration import compensation
from calibration.answers import calibrated, error_row, gate_rows, refusals, too_short
from calibration.corrected.making import Facts
from calibration.decide.controls import controls
from calibration.decide.merge import merge, traces
from calibration.decide.passive import sound
from calibration.decide.select import Selection
from calibration.decide.thresholds import AXIS_EARNED
from calibration.decide.tolerance import ELECTRICAL_ERROR
from calibration.decide.verdict import Verdict, judge
from calibration.decide.withdraw import withdraw
from calibration.finding import Finding
from calibration.inputs.declaration import Rig
from calibration.plantfile import declared_model, write_plant
from calibration.readers.run import Run
from calibration.replay.answer import correct_and_replay
from calibration.replay.held import Replay
from calibration.report.replayplot import replay_picture
from calibration.statistics.regression import gls
from calibration.twomotors.above import still_missing
from calibration.twomotors.lacks import absent_columns, lacks
from calibration.twomotors.look import analyse
from calibration.twomotors.result import SENSORS, AxisResult
from plant.model import load, with_effects

LEAST_ROWS = 600  # 6 s: fewer rows say nothing about six parameters
LEAST_PRESENT = (
    0.25  # of the rows between first and last stamp; with fewer, nothing is a measured motion any more
)


def axis_answer(
    runs: list[Run],
    hold_out: list[str],
    out: Path,
    plant: Path | None,
    plots: bool,
    tell: Callable[[str], None],
    run_again: bool = True,
    rig: Rig | None = None,
) -> tuple[Verdict, list[dict[str, str]], str]:
    """Run the pipeline and put the answer together; logs that say nothing get that answer and its reason.

    `run_again=False` leaves out the replay of the closed loop. `rig` declares the drive, the telescope's own
    axis without it; a drive whose logs are tables has no plant file that the emulator could run.
    """
    axis = runs[0].header["axis"]
    preload = runs[0].header.get("preload", "low")
    emulated = rig is None or rig.format == "axis-log"
    title = f"{axis.upper()} axis, {preload} preload" if emulated else axis
    reason = too_little(runs)
    if reason:
        v = Verdict("cannot tell", [], reasons=[reason], not_identifiable=["everything: " + reason])
        v.separating = "a log of 80 s and more that moves, at two speeds in both directions, without gaps"
        if emulated:
            model, keep = declared_model(runs[0].header, plant)
            bare = model if keep else with_effects(model, axis, ())
            write_plant(out / "plant.yaml", bare, axis, {}, [], Facts("cannot tell"), [])
        return v, [], title
    result = analyse(runs, hold_out, tell=tell, plant=plant, rig=rig)
    named = merge(result.findings, result.frame.train)
    lost = traces(result.findings, named)
    tried = _controls(result, named)
    effects, withdrawn = withdraw(named, tried)
    effects, against = sound(effects, result.selections)
    withdrawn += against
    doubts = [f"{what} was close, but {why}" for _, what, why in withdrawn]
    verdict, separating = judge(effects, [*lacks(result), *doubts])
    v = Verdict(
        verdict,
        effects,
        held_out=result.held_out,
        separating=separating,
        not_identifiable=not_identifiable(result),
        thresholds=gate_rows(result.selections),
        refused=[*withdrawn, *lost, *result.refused, *refusals(result.selections)],
        controls=tried,
        earned=AXIS_EARNED if emulated else None,
    )
    v.calibrated = dict(result.calibrated)
    if "E" in result.selections:
        v.calibrated |= calibrated(result.selections["E"], ("electrical_lag",), ELECTRICAL_ERROR)
    for key, s in result.selections.items():
        if key in SENSORS and np.isfinite(s.held.before):
            v.error[SENSORS[key]] = error_row(s, result.floors.get(key))
            v.error[SENSORS[key]]["before"] = result.before.get(key, s.held.before)
    _before_within_tolerance(v, result, effects)
    left = still_missing(result, v)
    v.remarks = [x.text for x in left]
    large = [x for x in left if x.effect] if v.verdict == "nothing" else []
    if unnamed := [Finding("unknown", x.channel, x.domain, note=x.text) for x in large if x.domain]:
        v.effects = effects = unnamed
        v.verdict, v.separating = judge(unnamed)
    elif large:
        v.verdict, v.separating = judge([], [f"{x.text}: a column of what may drive it" for x in large])
    again, remarks = Replay(), list[str]()
    if emulated:
        again, remarks = correct_and_replay(result, v, out / "plant.yaml", plant, run_again, tell)
        compensation.write(out / "compensation.yaml", load(out / "plant.yaml"), axis)
    v.closed_loop = again.rows
    short = [x for k, s in result.selections.items() for x in too_short(s, f"channel {k}: ")]
    v.reasons = [*dict.fromkeys(n for r in runs for n in r.notes), *again.reasons, *remarks, *short]
    v.reasons += [*absent_columns(result), *v.remarks]
    pictures = _plots(result, effects) if plots else []
    if plots and again.log is not None:
        pictures.append(replay_picture(again))
    return v, pictures, title


def too_little(runs: list[Run]) -> str:
    """Why these logs cannot say anything; empty when they can."""
    rows = sum(r.rows for r in runs)
    if rows < LEAST_ROWS:
        return f"{rows} rows ({rows * 0.01:.1f} s) are too few to say anything (at least {LEAST_ROWS})"
    span = sum(r.duration_s for r in runs) / runs[0].scales["sample_period_s"]
    if rows < LEAST_PRESENT * span:
        return f"{100 * (1 - rows / span):.0f} % of the samples are missing: what is left is not a motion"
    moved = max(float(np.nanmax(r.columns["position"]) - np.nanmin(r.columns["position"])) for r in runs)
    if moved < 1e-5:
        return "the axis does not move in these logs"
    return ""


def not_identifiable(result: AxisResult) -> list[str]:
    """Parameters this motion cannot tell, from the coverage of the motion and the conditioning; not from
    the fit."""
    out = []
    rate = np.abs(result.motion.rate[result.motion.pick])
    vs = result.declared.stribeck_speed
    moving = rate > 5e-6
    slow, quick = np.mean((rate > 0.05 * vs) & (rate < 0.8 * vs)), np.mean(rate > 2.5 * vs)
    if slow < 0.004 or quick < 0.02:
        out += ["stiction", "stribeck_speed"]
    if not moving.any() or np.quantile(rate[moving], 0.95) < 3 * np.quantile(rate[moving], 0.3):
        out.append("viscous")
    signed = result.motion.rate[result.motion.pick]
    if min(np.mean(signed > 5e-6), np.mean(signed < -5e-6)) < 0.02:
        out.append("friction_asymmetry (one direction only)")
    if np.quantile(np.abs(result.motion.acceleration[result.motion.pick]), 0.99) < 2e-4:
        out.append("inertia")
    turning = result.torque.context.since if result.torque is not None else np.zeros(1)
    if np.mean(np.abs(turning) < 1e-4) < 0.002:
        out.append("sigma_0")
    out.append("sigma_1")
    if result.electrical is None:
        out += ["torque_constant", "resistance"]
    elif result.electrical.constant_error > 0.03 * abs(result.electrical.constant):
        out.append("torque_constant")
    return out


def _before_within_tolerance(v: Verdict, result: AxisResult, effects: list[Finding]) -> None:
    """A declared number that is another one: "before" may only re-calibrate within the tolerance of the
    declared one."""
    from calibration.decide.tolerance import TOLERANCE, held_numbers

    d = result.declared
    changed = {e.name for e in effects}
    t = result.selections.get("T")
    if t is not None and result.torque is not None:
        fixed = held_numbers(changed, t.after.beta, d, result.torque.friction)
        if fixed and "torque" in v.error:
            v.error["torque"]["before"] = _constrained(t, fixed)
    k = result.selections.get("K")
    if k is not None and "shaft_compliance" in changed and "position" in v.error:
        declared = d.stiffness
        value = float(np.clip(k.after.beta[0], 1 / declared / TOLERANCE, TOLERANCE / declared))
        v.error["position"]["before"] = _constrained(k, {0: value})


def _constrained(s: Selection, fixed: dict[int, float]) -> float:
    """Held-out rms with some of the base's coefficients held, the others fitted on training rows."""
    p = s.problem
    from dataclasses import replace

    free = [k for k in range(p.base.shape[1]) if k not in fixed]
    y = p.y - sum(p.base[:, k] * value for k, value in fixed.items())
    fit = gls(y, p.base[:, free], p.train, p.ar_order, p.block)
    part = replace(p, y=y, base=p.base[:, free])
    from calibration.decide.heldout import predict_residual

    return float(np.sqrt(np.mean(predict_residual(part, part.base, fit.beta, p.test) ** 2)))


def _controls(result: AxisResult, effects: list[Finding]) -> list[dict[str, Any]]:
    out = []
    names = {e.name for e in effects}
    theta = result.motion.theta[result.motion.pick] / (2 * np.pi)
    span = float(np.ptp(theta))
    for key, s in result.selections.items():
        if any(c.candidate.name in names for c in s.chosen):
            turns = (
                theta if key in ("T", "S") else np.concatenate([theta, theta]) if key in ("E", "K") else None
            )
            out += [{**c, "channel": key} for c in controls(s, turns, span)]
    return out


def _plots(result: AxisResult, effects: list[Finding]) -> list[dict[str, str]]:
    from calibration.answers import _domain
    from calibration.report import plots as draw

    out = []
    t, torque = result.selections.get("T"), result.torque
    for key, s in result.selections.items():
        for k, chosen in enumerate(s.chosen[:2]):
            c = chosen.candidate
            n = len(s.problem.y)
            theta = np.resize(result.motion.theta[result.motion.pick], n) if key != "U" else s.problem.t
            if c.repeats and key != "U":
                x, label = (theta / (2 * np.pi) * c.repeats) % 1.0, f"phase of order {c.repeats:.5g}, turns"
            elif key == "T" and torque is not None:
                x, label = _domain(c.domain, torque.context, None)
            elif c.domain == "velocity" and key != "U":
                x, label = np.resize(result.motion.rate[result.motion.pick], n) * 206264.8, "rate, arcsec/s"
            elif c.domain == "axis_angle" and key != "U":
                x, label = np.degrees(theta), "axis angle, degrees"
            else:
                x, label = s.problem.t, "time, s"
            out.append(
                {
                    "image": draw.domain_plot(s, x, label, f"{c.say()} in channel {key}", k),
                    "alt": f"Residual over the domain that explains it: {c.say()}, channel {key}",
                }
            )
    if t is not None and torque is not None:
        out.append(
            {
                "image": draw.order_plot(
                    t,
                    torque.context.angle / (2 * np.pi),
                    result.frame.train.orders,
                    "Torque residual over order, gear table dotted",
                    "cycles per axis turn",
                ),
                "alt": "Spectrum over order with the gear table drawn in",
            }
        )
    best = max(
        result.selections.items(),
        key=lambda kv: (len(kv[1].chosen) > 0, kv[1].held.share, kv[0] == "T"),
        default=(None, None),
    )
    if best[1] is not None:
        out.append(
            {
                "image": draw.trace_plot(best[1], f"Held-out trace before and after, channel {best[0]}"),
                "alt": "Held-out residual before and after",
            }
        )
        out.append(
            {
                "image": draw.gate_plot(best[1], f"Gate, channel {best[0]}"),
                "alt": "Largest score of this log against surrogates",
            }
        )
    return out
