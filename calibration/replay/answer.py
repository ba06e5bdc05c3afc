"""From the axis pipeline's result to the corrected plant file and the closed loop run again with it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from calibration.candidates.axis_torque import start_clock
from calibration.corrected.curves import curve_of
from calibration.corrected.making import Facts
from calibration.decide.parameters import parameters_of
from calibration.decide.verdict import Verdict
from calibration.finding import Finding
from calibration.plantfile import calibrate_model, declared_model, write_plant
from calibration.replay.before import before_numbers, with_declared_lines
from calibration.replay.held import Replay, replay
from calibration.twomotors.result import AxisResult
from plant.gears import RATIO
from plant.model import PlantModel, with_effects


def correct_and_replay(
    result: AxisResult,
    verdict: Verdict,
    out: Path,
    base: Path | None,
    run_again: bool,
    tell: Callable[[str], None],
) -> tuple[Replay, list[str]]:
    """Write the corrected plant to `out`, run the held-out loop again; remarks on what the file lacks."""
    run = result.frame.runs[0]
    axis = run.header["axis"]
    model, keep = declared_model(run.header, base)
    if not keep:
        model = with_effects(model, axis, ())
    t = result.selections.get("T")
    unsure = verdict.not_identifiable
    add_curves(result, verdict.effects)
    corrected, remarks = write_plant(
        out,
        with_declared_lines(model, axis, result, t.after if t else None),
        axis,
        verdict.calibrated,
        verdict.effects,
        facts_of(result, verdict, model, run.name),
        unsure,
    )
    if not run_again:
        return Replay(), remarks
    tell("running the closed loop again")
    numbers = before_numbers(result, verdict.calibrated, verdict.effects)
    declared, _ = calibrate_model(
        with_declared_lines(model, axis, result, t.before if t else None), axis, numbers, run.name, unsure
    )
    per_ampere = result.torque.drive.per_ampere if result.torque is not None else 0.0
    e = result.selections.get("E")
    mean = result.declared.ripple is not None
    mean |= e is not None and "current_ripple" in [name for name, _ in e.problem.base_labels]
    return replay(result.frame, result.held, axis, declared, corrected, per_ampere, mean), remarks


def add_curves(result: AxisResult, effects: list[Finding]) -> None:
    """Give every `unknown` of the torque channel that is a function of its domain its curve, in place."""
    t, torque = result.selections.get("T"), result.torque
    if t is None or torque is None:
        return
    starts = [r.header.get("start_utc", "") for r in result.frame.runs]
    clock = start_clock(starts, result.frame.t, result.frame.run)[torque.motion.pick]
    for f in effects:
        if f.name != "unknown" or f.channel != "T":
            continue
        for k, chosen in enumerate(t.chosen):
            if (chosen.candidate.name, chosen.candidate.domain) == (f.name, f.domain):
                f.curve = curve_of(t, k, torque.context, clock)
                break


def facts_of(result: AxisResult, verdict: Verdict, model: PlantModel, name: str) -> Facts:
    """What the plant file's terms need beside the findings."""
    axis = result.frame.runs[0].header["axis"]
    part = getattr(model.axes, axis)
    theta = result.motion.theta[result.motion.pick]
    sense = part.motor.switch_resistance.si + part.motor.sense_resistance.si
    loop = verdict.calibrated.get("resistance")
    resistance = loop.value if loop is not None else part.motor.resistance.si + sense
    return Facts(
        name,
        axis,
        float(theta.mean()),
        float(np.ptp(theta)),
        float(np.ptp(result.frame.t[result.motion.pick])) or 1.0,
        0.5 * part.gear.backlash.si * RATIO,
        resistance,
        max(resistance - sense, 0.1),
        result.torque.drive.per_ampere if result.torque is not None else 140.0,
        result.frame.scale["adc_A_per_count"],
        result.frame.scale["supply_V"],
        model.environment.warming.si,
        twists(result),
    )


def twists(result: AxisResult) -> dict[tuple[str, int], tuple[float, float]]:
    """Gear lines of the encoder channel that both trains show: (stage, harmonic) -> (arcsec, phase)."""
    k_channel = result.selections.get("K")
    out: dict[tuple[str, int], tuple[float, float]] = {}
    for k, chosen in enumerate(k_channel.chosen if k_channel is not None else []):
        c = chosen.candidate
        if c.name not in ("gear_eccentricity", "gear_mesh") or c.stage is None or k_channel is None:
            continue
        half = len(c.columns) // 2
        if np.any(c.columns[:half]) and np.any(c.columns[half:]):
            p = parameters_of(k_channel, k)
            out[(c.stage, c.harmonic or 1)] = (p["amplitude"].value, p["phase"].value)
    return out
