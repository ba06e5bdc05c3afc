"""The volts of an axis with two motors: windings, back-EMF, and what the torque channel takes of them."""

from __future__ import annotations

import numpy as np

from calibration.candidates import amplifier
from calibration.candidates import electrical as electrical_candidates
from calibration.channels.electrical import electrical_problem
from calibration.channels.sampling import mean_currents, undo_sampling
from calibration.channels.windup import wind_up
from calibration.decide.select import fitted, select
from calibration.readers.run import Array
from calibration.statistics.regression import gls
from calibration.twomotors.result import AxisResult

SURE_CONSTANT = 0.1  # standard error of the torque constant, of itself, beyond which the declared one is used


def electrical_channel(
    result: AxisResult, clock: Array, rng: np.random.Generator
) -> tuple[float, dict[str, Array]]:
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
        if spread > SURE_CONSTANT * constant:  # one speed, not apart from the resistance; or no motor at all
            constant = numbers.torque_constant
        else:
            result.scale_error, whole = spread / abs(constant), e.constant / constant
        per_ampere = constant * frame.scale["gear_ratio"]
        left = electrical_candidates.weakened(fitted(s), clock, whole)
        doubt = electrical_candidates.reading_error(fitted(s))
        result.scale_error = float(np.hypot(result.scale_error, doubt))
        result.collect(s)
        result.findings = [electrical_candidates.from_whole(f, whole) for f in result.findings]
        cold = float(s.after.beta[0])
        result.findings = [electrical_candidates.from_cold(f, e.resistance / cold) for f in result.findings]
        result.findings = [electrical_candidates.followed(f) for f in result.findings]
    return per_ampere, left
