"""The encoders of an axis with two motors: the motors' and the roller's against the axis'."""

from __future__ import annotations

import numpy as np

from calibration.candidates import kinematic as kinematic_candidates
from calibration.candidates.context import Context
from calibration.channels.frame import Frame, fill
from calibration.channels.kinematic import Kinematic, kinematic_problem, roller_problem
from calibration.channels.motion import Motion, motion_of
from calibration.channels.problem import Problem
from calibration.decide.broadband import pick_up
from calibration.decide.select import select
from calibration.decide.tolerance import compliance_change
from calibration.readers.drive import ARCSEC
from calibration.readers.run import Array
from calibration.statistics.regression import gls
from calibration.twomotors.result import AxisResult

# of the mean square of the 5 ms velocity: one count of it is ten times the interpolation error
FINE_MARGIN = 0.002


def encoder_channels(result: AxisResult, per_ampere: float, rng: np.random.Generator) -> None:
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


def full_rate(result: AxisResult, rng: np.random.Generator) -> None:
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


def lags_of(p: Problem) -> Array:
    """What the roller channel's base makes of acceleration and jerk, s and s2."""
    return gls(p.y, p.base, p.train, p.ar_order, p.block).beta[:2]


def place_by_motors(k: Kinematic, m: Motion) -> Array:
    """Where the axis is (n_analysis,) arcsec by its motors, less the wind-up that the base takes up."""
    p = k.problem
    fit = gls(p.y, p.base, p.train, p.ar_order, p.block)
    off = (p.y - p.base[:, 0] * fit.beta[0]).reshape(2, -1).mean(axis=0)
    return np.asarray(m.theta[m.pick] / ARCSEC + off)


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
