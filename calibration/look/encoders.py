"""The encoders of an axis with two motors: the motors' and the roller's against the axis'."""

import numpy as np

from calibration.balances.candidate import Candidate
from calibration.balances.kinematic import kinematic_problem, roller_problem
from calibration.balances.motion import motion_of
from calibration.balances.problem import Problem
from calibration.decide.broadband import pick_up
from calibration.decide.select import select
from calibration.decide.tolerance import changes, train_stiffness
from calibration.look.axis_result import AxisResult
from calibration.look.scene import scene_of_balance
from calibration.names import offered
from calibration.names.command_disturbance import NAME as DISTURBANCE
from calibration.names.pair import Pair

# of the mean square of the 5 ms velocity: one count of it is ten times the interpolation error. arithmetic
FINE_MARGIN = 0.002


def encoder_channels(result: AxisResult, per_ampere: float) -> None:
    """Differences of encoders: motors against the axis, roller against the axis."""
    frame, m, numbers = result.frame, result.motion, result.declared
    k = result.kinematic = kinematic_problem(frame, m, result.held, per_ampere, numbers.lines)
    if k is not None:
        pair = Pair(frame=frame, motion=m, motor=np.repeat([0.0, 1.0], len(m.pick)))
        s = result.selections["K"] = select(k.problem, _candidates(pair, k.problem), result.rng)
        result.collect(s)
        fitted, stiffness = train_stiffness(s, result.scale_error)
        result.findings += changes(fitted, stiffness, numbers, {"moved"})
        result.calibrated |= stiffness
    roller = roller_problem(frame, m, result.held)
    if roller is not None:
        s = select(roller, _candidates(Pair(frame=frame, motion=m), roller), result.rng)
        result.selections["S"] = s
        result.collect(s)


def full_rate(result: AxisResult) -> None:
    """What only the full rate shows: the absolute encoder's interpolation, pick-up on the currents."""
    frame = result.frame
    full = motion_of(frame, 1)
    problem = roller_problem(frame, full, result.held)
    pair = Pair(frame=frame, motion=full)
    if problem is not None and (candidates := _candidates(pair, problem)):
        s = select(problem, candidates, result.rng, margin=FINE_MARGIN)
        if s.chosen:
            result.selections["S1"] = s
            result.collect(s)
    driven = any(f.name == DISTURBANCE.name for f in result.findings)  # its harmonics are no pick-up
    if not driven and (line := pick_up(frame)) is not None:
        result.findings.append(line)


def _candidates(pair: Pair, p: Problem) -> list[Candidate]:
    fit = p.fit()
    return offered(scene_of_balance(pair, p, fit.residual, p.by_name(fit.beta)))
