"""The axis pipeline: from logs of one telescope axis to findings, channel by channel."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from pathlib import Path

import numpy as np

from calibration.candidates import amplifier, axis_torque
from calibration.candidates import electrical as electrical_candidates
from calibration.candidates import kinematic as kinematic_candidates
from calibration.candidates.context import Context
from calibration.channels.clock import clock_findings, repair_wraps
from calibration.channels.command import command_candidates, command_problem, pulses
from calibration.channels.electrical import electrical_problem
from calibration.channels.frame import Frame, build_frame, fill
from calibration.channels.kinematic import (
    Kinematic,
    kinematic_problem,
    roller_problem,
)
from calibration.channels.motion import Motion, motion_of
from calibration.channels.problem import Problem
from calibration.channels.sampling import mean_currents, undo_sampling
from calibration.channels.torque import WIDTH, Transmission
from calibration.channels.windup import wind_up
from calibration.decide.broadband import pick_up, unexplained_volts
from calibration.decide.delays import delay_findings
from calibration.decide.holdout import choose_held_out
from calibration.decide.merge import merge
from calibration.decide.select import fitted, select
from calibration.decide.sizes import largest_amplitude
from calibration.decide.tolerance import compliance_change
from calibration.declaredplant import declared_numbers
from calibration.finding import Finding, middle
from calibration.inputs.declaration import Rig
from calibration.inputs.telescope import telescope
from calibration.readers.drive import ARCSEC
from calibration.readers.run import Array, Run
from calibration.statistics.regression import gls
from calibration.twomotors.applied import (
    before_of,
    corrected_runs,
    judged,
    keep_untouched,
    to_apply,
    too_little,
    without,
)
from calibration.twomotors.floors import sensor_floors
from calibration.twomotors.result import AxisResult
from calibration.twomotors.torque import torque_channel

FINE_MARGIN = (
    0.002  # of the mean square of the 5 ms velocity: one count of it is ten times the interpolation error
)
# times what the rounding of the effort leaves of its change, before a law of its own is looked for: below, a
# law that fits better is how small numbers round (the plant's own logs: 1.0; a wrong gain: 1.9 and more)
LEAST_LAW = 1.2
SURE_CONSTANT = 0.1  # standard error of the torque constant, of itself, beyond which the declared one is used
PULSES = 8.0  # a quarter of the regular spikes: 32 of them
# steps of the effort: a line on the command below the effort's own step is a beat of quantised columns
LEAST_COMMAND = 0.8


def analyse(
    runs: list[Run],
    hold_out: list[str],
    seed: int = 0,
    tell: Callable[[str], None] = lambda s: None,
    plant: Path | None = None,
    rig: Rig | None = None,
) -> AxisResult:
    """Run every channel the logs have; a fault of a column that is found is undone, and all is run again.
    `rig` declares the drive, the telescope's own axis without it; `plant` a plant file it is held against."""
    wraps = [w for w in (repair_wraps(r) for r in runs) if w is not None]
    rig = rig or telescope(runs[0].header["axis"])
    result = _look(runs, rig, hold_out, seed, tell, plant)
    result.findings = [*wraps[:1], *result.findings]
    fault = to_apply(merge(deepcopy(result.findings), result.frame.train))
    if fault is None:
        return result
    refusal = too_little(result, fault)
    if refusal is not None:
        return without(result, fault, refusal)
    tell(f"once more without the {fault.name.replace('_', ' ')}")
    again = _look(corrected_runs(result, fault), rig, hold_out, seed, tell, plant)
    before = before_of(result, again, fault)
    refusal = judged(before, again, fault)
    if refusal is not None:
        return without(result, fault, refusal)
    again.before = before
    if fault.name == "play":  # the motors see the crossings that the corrected encoder leaves out
        again.selections["K"] = result.selections["K"]
        before["K"] = result.selections["K"].held.before
    keep_untouched(result, again)
    fault.share = max(1 - (again.selections[k].held.after / b) ** 2 for k, b in before.items() if b > 0)
    stamps = [f for f in result.findings if f.domain == "clock" and f.name != fault.name]
    rest = [f for f in again.findings if f.name != fault.name and f.domain != "clock"]
    again.findings = [fault, *stamps, *rest]
    return again


def _look(
    runs: list[Run],
    rig: Rig,
    hold_out: list[str],
    seed: int,
    tell: Callable[[str], None],
    plant: Path | None,
) -> AxisResult:
    """Every channel of repaired logs."""
    rng = np.random.default_rng(seed)
    frame = build_frame(runs, rig)
    held, held_names = choose_held_out(frame, hold_out)
    stamps = clock_findings(frame)  # takes repeated rows out: they are no motion
    m = motion_of(frame, WIDTH)
    numbers = declared_numbers(runs, plant, rig)
    result = AxisResult(numbers, frame, m, held, None, None, None, held_out=held_names)
    result.findings += stamps
    clock = axis_torque.start_clock([r.header.get("start_utc", "") for r in runs], frame.t, frame.run)
    tell("electrical channel")
    per_ampere, left = _electrical(result, clock, rng)
    tell("encoder channels")
    _encoders(result, per_ampere, rng)
    _fine(result, rng)
    _command(result, rng)
    tell("torque channel")
    drive = transmission(result, per_ampere, left)
    torque_channel(result, drive, clock, rng)
    result.floors = sensor_floors(result, drive)
    result.findings += delay_findings(result.selections, numbers)
    if "E" in result.selections and not result.findings:  # any effect shakes the volts, too
        turns = np.tile(m.theta[m.pick] * frame.scale["gear_ratio"] / (2 * np.pi), 2)
        left_over = result.selections["E"]
        strange = unexplained_volts(left_over.after.residual, left_over.problem, turns)
        result.findings += [strange] if strange is not None else []
    return result


def _electrical(result: AxisResult, clock: Array, rng: np.random.Generator) -> tuple[float, dict[str, Array]]:
    """Volts: their findings; N m at the axis per A, and what each motor has left of its torque constant."""
    frame, m, numbers = result.frame, result.motion, result.declared
    if numbers.ripple is not None and frame.get("current_a") is not None:
        undo_sampling(frame, numbers.ripple)
    softness = wind_up(frame, m, result.held, numbers)
    e = result.electrical = electrical_problem(frame, m, result.held, numbers, softness)
    per_ampere = (e.constant if e is not None else numbers.torque_constant) * frame.scale["gear_ratio"]
    left = electrical_candidates.weakened([], clock)
    if e is not None and e.problem.train.sum() > 200:
        turns = m.theta[m.pick] * frame.scale["gear_ratio"] / (2 * np.pi)
        p = e.problem
        null = gls(p.y, p.base, p.train, p.ar_order, p.block)
        s = select(
            p,
            electrical_candidates.electrical_effects(e, clock[m.pick])
            + electrical_candidates.brush_effects(e, {"a": turns, "b": turns})
            + amplifier.disturbances(e, m, frame, null.residual),
            rng,
        )
        result.selections["E"] = s
        mean_currents(frame, p, s.after.beta)
        constant, spread = float(s.after.beta[1]), float(np.sqrt(s.after.covariance[1, 1]))
        whole = 1.0
        if spread > SURE_CONSTANT * abs(constant):  # one speed: it is not apart from the resistance
            constant = numbers.torque_constant
        else:
            result.scale_error, whole = spread / abs(constant), e.constant / constant
        per_ampere = constant * frame.scale["gear_ratio"]
        left = electrical_candidates.weakened(fitted(s), clock, whole)
        result.collect(s)
        result.findings = [electrical_candidates.from_whole(f, whole) for f in result.findings]
        cold = float(s.after.beta[0])
        result.findings = [electrical_candidates.from_cold(f, e.resistance / cold) for f in result.findings]
        result.findings = [electrical_candidates.followed(f) for f in result.findings]
    return per_ampere, left


def _encoders(result: AxisResult, per_ampere: float, rng: np.random.Generator) -> None:
    """Differences of encoders: motors against the axis, roller against the axis."""
    frame, m, numbers = result.frame, result.motion, result.declared
    result.kinematic = kinematic_problem(frame, m, result.held, per_ampere, numbers.lines)
    context = _kinematic_context(frame, m)
    if result.kinematic is not None:
        p = result.kinematic.problem
        stacked = _stack(context)
        candidates = kinematic_candidates.motor_encoder_effects(stacked, m.period_s, result.kinematic.motor)
        candidates += kinematic_candidates.play(stacked, place_by_motors(result.kinematic, m))
        s = select(p, candidates, rng)
        result.selections["K"] = s
        result.collect(s)
        found, stiffness = compliance_change(s, numbers, result.scale_error)
        result.findings += found
        result.calibrated |= stiffness
    roller = roller_problem(frame, m, result.held)
    if roller is not None:
        s = select(
            roller,
            kinematic_candidates.roller_effects(context, m)
            + kinematic_candidates.subdivision(context, m, lags_of(roller), frame.rig.encoder_periods),
            rng,
        )
        result.selections["S"] = s
        result.collect(s)


def lags_of(p: Problem) -> Array:
    """What the roller channel's base makes of acceleration and jerk, s and s2."""
    return gls(p.y, p.base, p.train, p.ar_order, p.block).beta[:2]


def place_by_motors(k: Kinematic, m: Motion) -> Array:
    """Where the axis is (n_analysis,) arcsec by its motors, less the wind-up that the base takes up."""
    p = k.problem
    fit = gls(p.y, p.base, p.train, p.ar_order, p.block)
    off = (p.y - p.base[:, 0] * fit.beta[0]).reshape(2, -1).mean(axis=0)
    return np.asarray(m.theta[m.pick] / ARCSEC + off)


def _command(result: AxisResult, rng: np.random.Generator) -> None:
    """Change of effort against the law of the controller."""
    command = command_problem(result.frame, result.held, result.declared.own)
    if command is None:
        return
    p, setpoint = command
    null = gls(p.y, p.base, p.train, p.ar_order, p.block)
    s = select(p, command_candidates(p, setpoint, null.residual), rng, margin=0.02)
    if s.chosen and s.chosen[0].candidate.name == "unknown" and s.held.before < LEAST_LAW * p.floor:
        s = select(p, [], rng)
    result.selections["U"] = s
    if not s.chosen or s.chosen[0].candidate.kind != "line" or largest_amplitude(s) > LEAST_COMMAND:
        result.collect(s)
    found = pulses(p, s.after.residual)
    if found is not None and found.score > PULSES:
        result.findings.append(
            Finding(
                "unknown",
                "S",
                "command",
                evidence=found.evidence,
                share=found.share,
                note=f"pulses on the command, every {found.period:.2f} s",
                parameters={
                    "size": middle(found.sizes, p.unit),
                    "period": middle(found.gaps, "s"),
                },
            )
        )


def transmission(result: AxisResult, per_ampere: float, left: dict[str, Array]) -> Transmission:
    """From currents to the axis, with the trains' stiffness and the rotors' lag where encoders show them."""
    frame = result.frame
    assert frame.rig.motors is not None
    low, high = (k * frame.scale["gear_ratio"] ** 2 for k in frame.rig.motors.rotor_inertia)  # at the axis
    stiffness, softness = result.declared.stiffness, low / result.declared.stiffness
    if "K" in result.selections:
        beta = result.selections["K"].after.beta
        if beta[0] > 1e-8:
            stiffness = 1.0 / float(beta[0])
        softness = float(np.clip(-beta[1] * ARCSEC, low / stiffness, high / stiffness))
    return Transmission(per_ampere, left, softness, stiffness)


def _fine(result: AxisResult, rng: np.random.Generator) -> None:
    """What only the log's full rate shows: interpolation error of the absolute encoder, pick-up on the
    currents."""
    frame = result.frame
    full = motion_of(frame, 1)
    problem = roller_problem(frame, full, result.held)
    if problem is not None:
        candidates = kinematic_candidates.subdivision(
            _kinematic_context(frame, full), full, lags_of(problem), frame.rig.encoder_periods
        )
        if candidates:
            s = select(problem, candidates, rng, margin=FINE_MARGIN)
            if s.chosen:
                result.selections["S1"] = s
                result.collect(s)
    driven = any(f.name == "command_disturbance" for f in result.findings)  # its harmonics are no pick-up
    line = pick_up(frame) if not driven else None
    if line is not None:
        result.findings.append(line)


def _kinematic_context(frame: Frame, m: Motion) -> Context:
    pick = m.pick
    zero = np.zeros(len(pick))
    temperature = frame.get("temperature")
    return Context(
        frame.t[pick],
        m.theta[pick],
        m.rate[pick],
        np.sign(m.rate[pick]),
        zero,
        frame.run[pick],
        frame.session[pick],
        "arcsec",
        "rad",
        2 * np.pi,
        zero,
        temperature=fill(temperature, frame.run)[0][pick] if temperature is not None else None,
        train=frame.train,
    )


def _stack(c: Context) -> Context:
    def twice(x: Array) -> Array:
        return np.concatenate([x, x])

    return Context(
        twice(c.t),
        twice(c.angle),
        twice(c.speed),
        twice(c.direction),
        twice(c.since),
        np.concatenate([c.run, c.run]),
        np.concatenate([c.session, c.session]),
        c.unit,
        c.angle_unit,
        c.turn,
        twice(c.friction),
        temperature=twice(c.temperature) if c.temperature is not None else None,
        train=c.train,
    )
