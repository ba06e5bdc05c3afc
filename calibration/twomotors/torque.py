"""The torque channel of an axis: the declared model fitted, looked at, fitted again beside what was found."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from calibration.candidates import axis_lines, axis_torque, axis_unknown, modes, tooth
from calibration.candidates.candidate import Candidate
from calibration.candidates.in_every_run import in_every_run
from calibration.channels.declared import Friction
from calibration.channels.frame import fill
from calibration.channels.level import level_of
from calibration.channels.motion import Motion
from calibration.channels.torque import Torque, Transmission, torque_problem
from calibration.decide.accept import FEWEST_BLOCKS
from calibration.decide.broadband import wind
from calibration.decide.judge import design
from calibration.decide.sameorder import SAME
from calibration.decide.select import Selection, select
from calibration.decide.sizes import white_noise
from calibration.decide.tolerance import seen_speeds, telling, torque_changes
from calibration.finding import Finding, Parameter
from calibration.names import NAMES
from calibration.names.own import own_candidates
from calibration.readers.run import Array
from calibration.statistics.regression import gls
from calibration.statistics.whitening import Mask
from calibration.twomotors.result import AxisResult
from plant.effects.signals import ANGLE, RATE, TIME

CREEP = 1.5e-5  # rad/s, 3 arcsec/s: slower, the torque is the bristles' history
REST_S = 3.0  # of creeping beside a motion: pre-sliding and break-away
LEAST_MOVING = 300  # rows of the analysis grid, 9 s, that slide in training
MOTOR_LINES, GEAR_LINES = ("motor_cogging", "torque_ripple"), ("gear_mesh", "gear_eccentricity")
EXPLAINS = 0.7  # of the held-out mean square: what is left beside such an effect is its remainder
SURE_IN_WIND = 120.0  # -log10 p of a torque effect that is believed beside a broadband torque


def torque_channel(result: AxisResult, drive: Transmission, clock: Array, rng: np.random.Generator) -> None:
    """Fill the result's torque channel; nothing happens when the log has no currents. `clock` (n,) at full
    rate, s.

    Friction is fitted before anything is known of an effect, which bends it. When something is found it is
    fitted again with that beside it, and the second look stands if it leaves less.
    """
    frame, m = result.frame, result.motion
    torque = torque_problem(frame, drive, result.held, result.declared)
    result.torque = torque
    if torque is None:
        return
    s, whole, moving = _pass(result, torque, clock, rng)
    if s.chosen:
        beside = np.hstack([x.candidate.columns for x in s.chosen])
        again = torque_problem(frame, drive, result.held, result.declared, beside)
        assert again is not None
        second = _pass(result, again, clock, rng)
        if left(second[0]) < left(s):
            result.torque = torque = again
            s, whole, moving = second
    p = torque.problem
    result.selections["T"] = s
    result.collect(s)
    enough = p.train.sum() >= FEWEST_BLOCKS * p.block
    blowing = wind(s.after.residual, p, white_noise(s.after.residual, p)) if enough else None
    if blowing is not None and (blowing.name != "unknown" or not s.chosen):
        result.findings = [x for x in result.findings if x.channel != "T" or believed(x)]
        result.findings.append(blowing)
    # long rests say where the bristles were left, not what they are; and an exponent below 1 has a cusp at
    # rest, which needs slower speeds than the encoder resolves
    reach = REST_S / m.period_s if result.declared.stribeck_exponent >= 1.0 else 0.0
    everything = replace(p, valid=whole & near(moving, reach))
    x = design(everything, [k.candidate for k in s.chosen])
    all_rows = gls(p.y, x, everything.train, p.ar_order, p.block)
    seen = seen_speeds(m.rate[m.pick][everything.train], result.declared)
    found, calibrated = torque_changes(
        torque, all_rows, x[everything.train], result.declared, seen, result.scale_error
    )
    found = telling(found, everything, x, result.declared, torque.friction)
    result.findings += found if enough else []
    result.calibrated |= calibrated
    for f in result.findings:
        to_calibrated(f, torque.friction, calibrated)


# sizes that are parts of a friction, and of which: the effect's column was made with the fit's own before the
# effect was known, which a large change has bent
PARTS = {
    ("preload_change", "fraction"): "viscous",
    ("friction_warmup", "amplitude"): "coulomb",
    ("friction_asymmetry", "coulomb_asymmetry"): "coulomb",
    ("friction_asymmetry", "viscous_asymmetry"): "viscous",
}


def to_calibrated(f: Finding, used: Friction, calibrated: dict[str, Parameter]) -> None:
    """Turn sizes that are parts of the friction `used` into parts of the calibrated one."""
    for (name, size), whole in PARTS.items():
        if f.name == name and size in f.parameters and whole in calibrated and calibrated[whole].value > 0:
            f.parameters[size] = f.parameters[size].times(getattr(used, whole) / calibrated[whole].value)


def _pass(
    result: AxisResult, torque: Torque, clock: Array, rng: np.random.Generator
) -> tuple[Selection, Mask, Mask]:
    """Selection among all torque candidates; rows that may be calibrated on, and those of them that move."""
    frame, m = result.frame, result.motion
    p, c, drive = torque.problem, torque.context, torque.drive
    if result.kinematic is not None:
        p.valid &= result.kinematic.engaged
    null = gls(p.y, p.base, p.train, p.ar_order, p.block)
    ia, ib = (fill(frame.columns[f"current_{k}"], frame.run)[0] for k in "ab")
    ta = drive.per_ampere * m.at(drive.left["a"] * ia)
    tb = -drive.per_ampere * m.at(drive.left["b"] * ib)
    effort = m.at(fill(frame.columns["effort"], frame.run)[0])
    f = axis_torque.Friction(
        level_of(m, torque.friction, result.declared.stribeck_exponent, clock, frame.session),
        m.rate[m.pick] * torque.friction.viscous,
        np.where(effort > 0, tb, ta),
        ta,
        tb,
        p.y - null.residual,
        clock[m.pick],
    )
    forced = {x.name for x in result.findings}
    if "adc_offset" in forced:
        p.base = np.column_stack([p.base, np.ones(len(p.y))])
        p.base_labels.append(("offset_torque", "N m"))
    theta = m.theta[m.pick]
    ratio = frame.scale["gear_ratio"]
    motors = axis_lines.Motors(
        {
            "a": (theta + f.torque_a / drive.stiffness) * ratio / (2 * np.pi),
            "b": (theta + f.torque_b / drive.stiffness) * ratio / (2 * np.pi),
        },
        {"a": f.torque_a, "b": f.torque_b},
        m.period_s,
        drive.softness_s2,
    )
    offsets = ("adc_offset",) if result.electrical is not None and "adc_offset" not in forced else ()
    candidates: list[Candidate] = [
        *(x for x in axis_torque.direction_effects(c, f) if x.name not in offsets),
        *axis_torque.angle_effects(c),
        *axis_torque.slow_effects(c, f),
        *in_every_run(f),
        *axis_lines.gear_lines(c, m.period_s),
        *axis_lines.motor_lines(c, motors, null.residual, p.train),
        *modes.structural_modes(m, frame.run),
        *_by_formula(m, clock),
    ]
    candidates += axis_unknown.unknown_torques(c, f, null.residual, p.train, m.period_s)
    candidates += tooth.damaged_teeth(c, null.residual, p.train, m.period_s)
    candidates += axis_lines.free_lines(c, f.level, null.residual, p.train, m.period_s)
    candidates = [c for c in candidates if not _of_a_gear(c, result.findings)]
    whole = p.valid.copy()
    moving = whole & (np.abs(m.rate[m.pick]) > CREEP)
    if (moving & p.train).sum() > LEAST_MOVING and (moving & p.test).sum() > 100:
        p.valid = moving  # the bristles' history is calibrated, but not known to the sensors' noise
    else:
        candidates = []  # nothing but that history: no torque effect can be told from it
    return select(p, candidates, rng), whole, moving


def _of_a_gear(c: Candidate, found: list[Finding]) -> bool:
    """Whether a motor's line has the order of a gear's that the encoders have shown: a motor's torque moves
    no encoder against another, and a pinion's teeth are harmonics of its motor."""
    if c.name not in MOTOR_LINES or not c.order:
        return False
    gears = (f.order for f in found if f.channel == "K" and f.name in GEAR_LINES and f.order)
    return any(abs(c.order / order - 1.0) < SAME for order in gears)


def _by_formula(m: Motion, clock: Array) -> list[Candidate]:
    """Effects that are found by their own formula alone; `clock` (n,) at full rate, s."""
    along = {TIME: clock, ANGLE: m.theta, RATE: m.rate}
    return [
        c for n in NAMES.values() if n.own is not None for c in own_candidates(n.name, n.own, along, m.at)
    ]


def believed(f: Finding) -> bool:
    """Whether a torque effect stands beside a broadband torque, which may be no more than its remainder."""
    periodic = f.name == "unknown" and f.domain == "time"  # a wind has no period
    return periodic or f.evidence > SURE_IN_WIND or f.share > EXPLAINS


def left(s: Selection) -> float:
    """Mean square that a selection leaves on the rows it was fitted to."""
    return float(np.mean(s.after.residual[s.problem.train] ** 2)) if s.problem.train.any() else 0.0


def near(rows: Mask, reach: float) -> Mask:
    """Rows within `reach` rows of one of `rows`."""
    from scipy.ndimage import binary_dilation

    return np.asarray(binary_dilation(rows, iterations=round(reach))) if reach >= 1 else rows
