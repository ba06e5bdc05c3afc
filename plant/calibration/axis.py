"""The axis pipeline: from logs of one telescope axis to findings, channel by channel."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from plant.calibration.candidates import axis_lines, axis_torque, axis_unknown, modes, tooth
from plant.calibration.candidates import electrical as electrical_candidates
from plant.calibration.candidates import kinematic as kinematic_candidates
from plant.calibration.candidates.candidate import Candidate
from plant.calibration.candidates.context import Context
from plant.calibration.channels.clock import clock_findings, repair_wraps
from plant.calibration.channels.command import command_candidates, command_problem, pulses
from plant.calibration.channels.electrical import (
    Electrical,
    electrical_problem,
    mean_currents,
    undo_sampling,
)
from plant.calibration.channels.frame import Frame, build_frame, fill
from plant.calibration.channels.kinematic import (
    Kinematic,
    kinematic_problem,
    roller_problem,
)
from plant.calibration.channels.motion import Motion, motion_of
from plant.calibration.channels.torque import WIDTH, Torque, torque_problem
from plant.calibration.decide.broadband import pick_up, wind
from plant.calibration.decide.delays import delay_findings
from plant.calibration.decide.finding import Finding, Parameter
from plant.calibration.decide.holdout import choose_held_out
from plant.calibration.decide.parameters import finding_of
from plant.calibration.decide.select import FEWEST_BLOCKS, Selection, design, select
from plant.calibration.decide.sizes import largest_amplitude, white_noise
from plant.calibration.decide.tolerance import compliance_change, seen_speeds, telling, torque_changes
from plant.calibration.declaredplant import Declared, declared_numbers
from plant.calibration.readers.run import Array, Run
from plant.calibration.statistics.regression import gls
from plant.calibration.statistics.whitening import Mask

CREEP = 1.5e-5  # rad/s, 3 arcsec/s: slower, the torque is the bristles' history
REST_S = 3.0  # of creeping beside a motion: pre-sliding and break-away
LEAST_MOVING = 300  # rows of the analysis grid, 9 s, that slide in training
FINE_MARGIN = (
    0.002  # of the mean square of the 5 ms velocity: one count of it is ten times the interpolation error
)
LEAST_COMMAND = (
    0.8  # 1/3000: a line on the command below the effort's own step is a beat of quantised columns
)
SURE_CONSTANT = 0.1  # standard error of the torque constant, of itself, beyond which the declared one is used
SURE_IN_WIND = 120.0  # -log10 p of a torque effect that is believed beside a broadband torque


@dataclass
class AxisResult:
    """Everything the axis pipeline found, for the decision and the report."""

    declared: Declared
    frame: Frame
    motion: Motion
    held: Mask
    electrical: Electrical | None
    kinematic: Kinematic | None
    torque: Torque | None
    selections: dict[str, Selection] = field(default_factory=dict)
    findings: list[Finding] = field(default_factory=list)
    held_out: list[str] = field(default_factory=list)
    calibrated: dict[str, Parameter] = field(default_factory=dict)


def analyse(
    runs: list[Run],
    hold_out: list[str],
    seed: int = 0,
    tell: Callable[[str], None] = lambda s: None,
    plant: Path | None = None,
) -> AxisResult:
    """Run every channel the logs have."""
    rng = np.random.default_rng(seed)
    wraps = [w for w in (repair_wraps(r) for r in runs) if w is not None]
    frame = build_frame(runs)
    held, held_names = choose_held_out(frame, hold_out)
    m = motion_of(frame, WIDTH)
    numbers = declared_numbers(runs, plant)
    result = AxisResult(numbers, frame, m, held, None, None, None, held_out=held_names)
    result.findings += wraps[:1] + clock_findings(frame)
    clock = axis_torque.start_clock([r.header.get("start_utc", "") for r in runs], frame.t, frame.run)[m.pick]
    tell("electrical channel")
    if numbers.ripple is not None and frame.get("current_a") is not None:
        undo_sampling(frame, numbers.ripple)
    e = result.electrical = electrical_problem(frame, m, held, numbers)
    per_ampere = (e.constant if e is not None else numbers.torque_constant) * frame.scale["gear_ratio"]
    if e is not None and e.problem.train.sum() > 200:
        turns = m.theta[m.pick] * frame.scale["gear_ratio"] / (2 * np.pi)
        s = select(
            e.problem,
            electrical_candidates.electrical_effects(e, clock)
            + electrical_candidates.brush_effects(e, {"a": turns, "b": turns}),
            rng,
        )
        result.selections["E"] = s
        mean_currents(frame, e, s.after.beta)
        constant, spread = float(s.after.beta[1]), float(np.sqrt(s.after.covariance[1, 1]))
        if spread > SURE_CONSTANT * abs(constant):  # one speed: it is not apart from the resistance
            constant = numbers.torque_constant
        per_ampere = constant * frame.scale["gear_ratio"]
        _collect(result, s)
    tell("encoder channels")
    result.kinematic = kinematic_problem(frame, m, held, per_ampere, numbers.lines)
    context = _kinematic_context(frame, m)
    if result.kinematic is not None:
        p = result.kinematic.problem
        stacked = _stack(context)
        s = select(
            p, kinematic_candidates.motor_encoder_effects(stacked, m.period_s, result.kinematic.motor), rng
        )
        result.selections["K"] = s
        _collect(result, s)
        found, stiffness = compliance_change(s, numbers)
        result.findings += found
        result.calibrated |= stiffness
    roller = roller_problem(frame, m, held)
    if roller is not None:
        alpha = m.acceleration[m.pick]
        s = select(
            roller,
            kinematic_candidates.roller_effects(context, alpha, m.period_s)
            + kinematic_candidates.subdivision(context, m.period_s),
            rng,
        )
        result.selections["S"] = s
        _collect(result, s)
    _fine(result, rng)
    command = command_problem(frame, held, numbers.own)
    if command is not None:
        p, setpoint = command
        null = gls(p.y, p.base, p.train, p.ar_order, p.block)
        s = select(p, command_candidates(p, setpoint, null.residual), rng, margin=0.02)
        result.selections["U"] = s
        if not s.chosen or largest_amplitude(s) > LEAST_COMMAND:
            _collect(result, s)
        size, period, score = pulses(p, s.after.residual)
        if score > 8:
            result.findings.append(
                Finding(
                    "unknown",
                    "S",
                    "command",
                    evidence=score,
                    share=0.1,
                    note=f"pulses on the command, every {period:.2f} s",
                    parameters={
                        "size": Parameter(size, "1/3000", 0.5 * size, 1.5 * size),
                        "period": Parameter(period, "s", 0.98 * period, 1.02 * period),
                    },
                )
            )
    tell("torque channel")
    _torque(result, per_ampere, clock, rng)
    result.findings += delay_findings(result.selections, numbers)
    return result


def _fine(result: AxisResult, rng: np.random.Generator) -> None:
    """What only the log's full rate shows: interpolation error of the absolute encoder, pick-up on the
    currents."""
    frame = result.frame
    full = motion_of(frame, 1)
    problem = roller_problem(frame, full, result.held)
    if problem is not None:
        candidates = kinematic_candidates.subdivision(_kinematic_context(frame, full), full.period_s)
        if candidates:
            s = select(problem, candidates, rng, margin=FINE_MARGIN)
            if s.chosen:
                result.selections["S1"] = s
                _collect(result, s)
    line = pick_up(frame)
    if line is not None:
        result.findings.append(line)


def _torque(result: AxisResult, per_ampere: float, clock: Array, rng: np.random.Generator) -> None:
    frame, m = result.frame, result.motion
    torque = result.torque = torque_problem(frame, per_ampere, result.held, result.declared)
    if torque is None:
        return
    p, c = torque.problem, torque.context
    if result.kinematic is not None:
        p.valid &= result.kinematic.engaged
    null = gls(p.y, p.base, p.train, p.ar_order, p.block)
    ia, ib = (fill(frame.columns[f"current_{k}"], frame.run)[0] for k in "ab")
    ta, tb = per_ampere * m.at(ia), -per_ampere * m.at(ib)
    effort = m.at(fill(frame.columns["effort"], frame.run)[0])
    f = axis_torque.Friction(
        m.at(torque.bristle) * torque.friction.coulomb,
        p.base[:, 3],
        m.rate[m.pick] * torque.friction.viscous,
        np.where(effort > 0, tb, ta),
        ta,
        tb,
        p.y - null.residual,
        clock,
    )
    forced = {x.name for x in result.findings}
    if "adc_offset" in forced:
        p.base = np.column_stack([p.base, np.ones(len(p.y))])
        p.base_labels.append(("offset_torque", "N m"))
    stiffness = result.declared.stiffness
    if "K" in result.selections and result.selections["K"].after.beta[0] > 1e-8:
        stiffness = 1.0 / float(result.selections["K"].after.beta[0])
    theta = m.theta[m.pick]
    ratio = frame.scale["gear_ratio"]
    motors = axis_lines.Motors(
        {
            "a": (theta + f.torque_a / stiffness) * ratio / (2 * np.pi),
            "b": (theta + f.torque_b / stiffness) * ratio / (2 * np.pi),
        },
        {"a": f.torque_a, "b": f.torque_b},
        m.period_s,
    )
    offsets = ("adc_offset",) if result.electrical is not None and "adc_offset" not in forced else ()
    candidates: list[Candidate] = [
        *(x for x in axis_torque.direction_effects(c, f) if x.name not in offsets),
        *axis_torque.angle_effects(c),
        *axis_torque.slow_effects(c, f),
        *axis_lines.gear_lines(c, m.period_s),
        *axis_lines.motor_lines(c, motors, null.residual, p.train),
        *modes.structural_modes(c, m.acceleration[m.pick], m.period_s),
    ]
    candidates += axis_unknown.unknown_torques(c, f, null.residual, p.train, m.period_s)
    candidates += tooth.damaged_teeth(c, null.residual, p.train, m.period_s)
    candidates += axis_lines.free_lines(c, null.residual, p.train, m.period_s)
    whole = p.valid.copy()
    moving = whole & (np.abs(m.rate[m.pick]) > CREEP)
    if (moving & p.train).sum() > LEAST_MOVING and (moving & p.test).sum() > 100:
        p.valid = moving  # the bristles' history is calibrated, but not known to the sensors' noise
    else:
        candidates = []  # nothing but that history: no torque effect can be told from it
    s = select(p, candidates, rng)
    result.selections["T"] = s
    _collect(result, s)
    enough = p.train.sum() >= FEWEST_BLOCKS * p.block
    blowing = wind(s.after.residual, p, white_noise(s.after.residual, p)) if enough else None
    if blowing is not None:
        result.findings = [x for x in result.findings if x.channel != "T" or x.evidence > SURE_IN_WIND]
        result.findings.append(blowing)
    # long rests say where the bristles were left, not what they are; and an exponent below 1 has a cusp at
    # rest, which needs slower speeds than the encoder resolves
    reach = REST_S / m.period_s if result.declared.stribeck_exponent >= 1.0 else 0.0
    everything = replace(p, valid=whole & near(moving, reach))
    x = design(everything, [k.candidate for k in s.chosen])
    all_rows = gls(p.y, x, everything.train, p.ar_order, p.block)
    seen = seen_speeds(m.rate[m.pick][everything.train], result.declared)
    found, calibrated = torque_changes(torque, all_rows, x[everything.train], result.declared, seen)
    found = telling(found, everything, x, result.declared, torque.friction)
    result.findings += found
    result.calibrated |= calibrated


def near(rows: Mask, reach: float) -> Mask:
    """Rows within `reach` rows of one of `rows`."""
    from scipy.ndimage import binary_dilation

    return np.asarray(binary_dilation(rows, iterations=round(reach))) if reach >= 1 else rows


def _collect(result: AxisResult, s: Selection) -> None:
    for k in range(len(s.chosen)):
        result.findings.append(finding_of(s, k))


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
    )
