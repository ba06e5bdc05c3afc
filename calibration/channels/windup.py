"""How far an ampere winds a train up, from the encoders, before volts and torques need it."""

from __future__ import annotations

import numpy as np

from calibration.channels.frame import Frame
from calibration.channels.kinematic import kinematic_problem
from calibration.channels.motion import Motion
from calibration.declaredplant import Declared
from calibration.statistics.regression import gls
from calibration.statistics.whitening import Mask

KNOWN = 0.05  # standard error, of itself, up to which the measured one is used
SPREAD = 5.0  # factor either way beyond which it is not a train's


def wind_up(frame: Frame, m: Motion, held: Mask, declared: Declared) -> float:
    """rad of the axis per A of its motor; the declared one where the log lacks encoders or does not tell."""
    per_ampere = declared.torque_constant * frame.scale["gear_ratio"]
    as_declared = per_ampere / declared.stiffness
    k = kinematic_problem(frame, m, held, per_ampere, declared.lines)
    if k is None or frame.get("current_a") is None or k.problem.train.sum() < 10 * k.problem.block:
        return as_declared
    p = k.problem
    fit = gls(p.y, p.base, p.train, p.ar_order, p.block)
    found, error = float(fit.beta[0]), float(np.sqrt(fit.covariance[0, 0]))
    likely = 1 / SPREAD < found * declared.stiffness < SPREAD
    return found * per_ampere if likely and error < KNOWN * found else as_declared
