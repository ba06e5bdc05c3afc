"""The torque channel of an axis: the declared model fitted, looked at, fitted again beside what was found."""

from dataclasses import replace

import numpy as np
from scipy.ndimage import binary_dilation

from calibration.arrays import Mask
from calibration.balances.candidate import Candidate
from calibration.balances.thresholds import FEWEST_MOVING
from calibration.balances.torque import Torque, Transmission, torque_problem
from calibration.decide.broadband import wind
from calibration.decide.drive import cancelling
from calibration.decide.select import select
from calibration.decide.selection import Selection
from calibration.decide.thresholds import FEWEST_BLOCKS, SAME_ORDER_SHARE
from calibration.decide.tolerance import NEEDED, calibrated_numbers, changes, seen_speeds, telling
from calibration.decide.twins import beside_a_stage
from calibration.finding import UNKNOWN, Finding
from calibration.look.axis_result import AxisResult
from calibration.look.scene import scene_of_pair
from calibration.look.volts import DENIED, volts_deny
from calibration.names import NAMES, offered
from calibration.names.adc_offset import NAME as OFFSET
from calibration.statistics.carried import carried
from calibration.statistics.whitening import white_noise
from plant.effects import REGISTRY

CREEP = 1.5e-5  # rad/s, 3 arcsec/s: slower, the torque is the bristles' history. ASSUMPTION
REST_S = 3.0  # of creeping beside a motion: pre-sliding and break-away. ASSUMPTION
LEAST_MOVING = 300  # rows of the analysis grid, 9 s, that slide in training. ASSUMPTION
SURE_IN_WIND = 120.0  # -log10 p of a torque effect that is accepted beside a broadband torque. ASSUMPTION


def torque_channel(result: AxisResult, drive: Transmission) -> None:
    """Fill the result's torque channel; nothing happens when the log has no currents.

    Friction is fitted before anything is known of an effect, which bends it. When something is found it is
    fitted again with that beside it, and the second look stands if it leaves less.
    """
    m = result.motion
    torque = torque_problem(m, drive, result.held, result.declared)
    result.torque = torque
    if torque is None:
        return
    s, whole, moving = _pass(result, torque)
    if s.chosen:
        beside = np.hstack([c.columns for c in s.candidates])
        again = torque_problem(m, drive, result.held, result.declared, beside)
        assert again is not None
        second = _pass(result, again)
        if second[0].fitted_square < s.fitted_square:
            result.torque = torque = again
            s, whole, moving = second
    p = torque.problem
    result.selections["T"] = s
    result.collect(s)
    enough = p.blocks >= FEWEST_BLOCKS
    blowing = wind(s.after.residual, p, white_noise(s.after.residual, p.train)) if enough else None
    if blowing is not None and (blowing.name != UNKNOWN or not s.chosen):
        kept = [x for x in result.findings if x.channel != "T" or beside_wind(x)]
        result.findings = [*kept, blowing]
    # long rests say where the bristles were left, not what they are; and an exponent below 1 has a cusp at
    # rest, which needs slower speeds than the encoder resolves
    if result.declared.stribeck_exponent >= 1.0:
        moving = np.asarray(binary_dilation(moving, iterations=round(REST_S / m.cell_s)))
    everything = replace(p, valid=whole & moving)
    x = everything.design(s.candidates)
    all_rows, blocks = carried(everything.fit(x), x, everything.train, p.block)
    seen = seen_speeds(m.speed[m.rows][everything.train], result.declared)
    used = x[everything.train]
    numbers, calibrated = calibrated_numbers(torque, all_rows, used, result.scale_error, blocks)
    known = set(numbers) >= NEEDED and numbers["coulomb"].value > 0
    if enough and known and len(used) >= FEWEST_BLOCKS * p.block:
        found = changes(numbers, calibrated, result.declared, seen)
        result.findings += telling(found, everything, x, result.declared, torque.friction)
    result.calibrated |= calibrated
    # the effects' columns were made with the friction from before they were known, which a large one has bent
    now = {n: calibrated[n].value for n in ("coulomb", "viscous") if n in calibrated}
    quotients: dict[str, float] = {n: getattr(torque.friction, n) / x for n, x in now.items() if x > 0}
    result.findings = [NAMES[f.name].retold(f, quotients) if f.channel == "T" else f for f in result.findings]


def _pass(result: AxisResult, torque: Torque) -> tuple[Selection, Mask, Mask]:
    """Selection among all torque candidates; rows that may be calibrated on, and those of them that move."""
    m, p = result.motion, torque.problem
    if result.kinematic is not None:
        p.valid &= result.kinematic.engaged
    scene = scene_of_pair(result, torque, p.fit().residual)
    result.views["T"] = scene.view
    if any(f.name == OFFSET.name for f in result.findings):
        p.add(("offset_torque", "N m", np.ones(len(p.y))))
    candidates = [c for c in offered(scene) if not _of_a_gear(c, result.findings)]
    if result.electrical is not None:  # volts have shown it, or have not
        candidates = [c for c in candidates if c.name != OFFSET.name]
    whole = p.valid.copy()
    moving = whole & (np.abs(m.speed[m.rows]) > CREEP)
    if (moving & p.train).sum() > LEAST_MOVING and (moving & p.test).sum() > FEWEST_MOVING:
        p.valid = moving  # the bristles' history is calibrated, but not known to the sensors' noise
    else:
        candidates = []  # nothing but that history: no torque effect can be told from it
    s = select(p, candidates, result.rng)
    if denied := {c.name for c, beta in s.fitted if volts_deny(result, c, float(beta[0]))}:
        fresh = [("T", name, DENIED) for name in sorted(denied)]
        result.refused += [x for x in fresh if x not in result.refused]
        candidates = [c for c in candidates if c.name not in denied]
        s = select(p, candidates, result.rng)
    if pair := cancelling(s):  # again with either, which may have been bent by the other
        keys = [s.candidates[k].key for k in pair]
        without = [select(p, [c for c in candidates if c.key != key], result.rng) for key in keys]
        left = min(range(2), key=lambda k: without[k].held.after)
        gone, stays = (s.candidates[k].say() for k in (pair[left], pair[1 - left]))
        result.refused += [("T", gone, f"cancels against {stays}")]
        s = without[left]
    return beside_a_stage(s, scene), whole, moving


def _of_a_gear(c: Candidate, found: list[Finding]) -> bool:
    """Whether a motor's line has the order of a gear's that the encoders have shown. A motor's torque moves
    no encoder against another, and a pinion's teeth are harmonics of its motor."""
    if not c.order or REGISTRY[c.name].domain != "motor_angle":
        return False
    gears = (f.order for f in found if f.channel == "K" and f.order and REGISTRY[f.name].staged)
    return any(abs(c.order / order - 1.0) < SAME_ORDER_SHARE for order in gears)


def beside_wind(f: Finding) -> bool:
    """Whether a torque effect stands beside a broadband torque, which may be no more than its remainder."""
    periodic = f.name == UNKNOWN and f.domain == "time"  # a wind has no period
    return periodic or f.evidence > SURE_IN_WIND
