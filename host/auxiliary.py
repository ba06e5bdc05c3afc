"""The auxiliary encoder of an axis (P10) and its combination with the one on the shaft (H5).

Estimator: the mean of both readings weighted by their inverse variances, the best linear unbiased estimate
of two independent readings of one angle. Its variance is 1 / (1/s1² + 1/s2²).

    s1² = (1″)² / 3                                         on the shaft: within ±1″, taken as uniform

    s2² = (15″/10.8)² / 3 + (0.9155″)² / 12 + (rate · t)²   auxiliary: accuracy, step, and time between

The two are latched by clocks of their own, some milliseconds apart. The auxiliary reading is brought to the
moment of the other by the axis' rate. What is left is how well that moment is known, t. At tracking speed it
counts 0.03″; at slew it is some 15″ and the shaft's encoder decides alone. Readings further apart than five
standard deviations of their difference are not combined. One of the two is wrong, which is what the auxiliary
one is for. Both encoders are taken to be aligned to one zero (ASSUMPTION; the plant's are).
"""

import math
from typing import NamedTuple

from bus.protocol.nodes import AUXILIARY
from bus.units import ARCSEC_PER_TURN
from host.link import HidLink
from host.procedures.dome import codecs
from host.sky.mount import STEP_ARCSEC

RATIO = 10.8
"""Turns of the auxiliary encoder per turn of the axis (paper, section 3.2)."""
TURN_ARCSEC = ARCSEC_PER_TURN / RATIO
AUXILIARY_STEP_ARCSEC = TURN_ARCSEC / 2**17
ABSOLUTE_ARCSEC = 1.0 / math.sqrt(3.0)
"""Standard deviation of the on-shaft encoder: an error within ±1″ (RCN 800's system accuracy, hardware.md
1.3), taken as uniform."""
AUXILIARY_ARCSEC = math.hypot(15.0 / RATIO / math.sqrt(3.0), AUXILIARY_STEP_ARCSEC / math.sqrt(12.0))
"""Of the auxiliary one at rest: ±15″ through 1:10.8 (paper, section 3.2), uniform, and its step."""
TIME_S = 0.005 * math.sqrt(2.0 / 12.0)
"""Of the time between two frames' arrivals. Each waits 0 to 5 ms for its USB report (the gateway's 4 ms
and a USB frame), uniform."""
APART = 5.0
"""Standard deviations of the difference beyond which the two do not measure the same. ASSUMPTION."""
BOARDS = {axis: AUXILIARY.device(f"AUXILIARY_{axis.upper()}") for axis in ("ra", "dec")}


class Auxiliary(NamedTuple):
    """A reading brought to the moment of the other's: ″ from the encoder's zero, standard deviation."""

    arcsec: float
    sigma_arcsec: float


class Combined(NamedTuple):
    """Readings of one axis in ″ from the encoder's zero, and the estimate with its standard deviation.

    agree: False when they are too far apart to be combined; the estimate is the on-shaft encoder's then.
    """

    absolute_arcsec: float | None
    auxiliary_arcsec: float | None
    difference_arcsec: float | None
    estimate_arcsec: float | None
    sigma_arcsec: float
    agree: bool = True


def unwrapped(steps: int, near_arcsec: float) -> float:
    """The axis' angle, ″, that shows `steps` (17 bit) on the auxiliary encoder, nearest to another."""
    within = steps * AUXILIARY_STEP_ARCSEC
    return within + round((near_arcsec - within) / TURN_ARCSEC) * TURN_ARCSEC


def auxiliary(
    link: HidLink, axis: str, steps: int | None, latched_s: float, rate_arcsec_s: float
) -> Auxiliary | None:
    """The last ENCODER frame of an axis, carried to `latched_s` of the on-shaft reading `steps`, if any."""
    data = link.measurements.get(BOARDS[axis])
    if data is None or steps is None:
        return None
    values = codecs()[f"AUXILIARY_{axis.upper()}"].unpack(data)
    if values["Alarm"]:
        return None
    later_s = latched_s - (link.measured_ns[BOARDS[axis]] * 1e-9 - values["Age"] * 1e-6)
    moved = rate_arcsec_s * later_s
    near = steps * STEP_ARCSEC - moved
    middle = AUXILIARY_STEP_ARCSEC / 2  # a reading is the step's lower edge
    angle = unwrapped(int(values["Position"]), near) + middle + moved
    return Auxiliary(angle, math.hypot(AUXILIARY_ARCSEC, rate_arcsec_s * TIME_S))


def combine(
    absolute_steps: int | None, auxiliary_arcsec: float | None, sigma_arcsec: float = AUXILIARY_ARCSEC
) -> Combined:
    """Mean weighted by inverse variances; its variance is the inverse of their sum. sigma: auxiliary."""
    absolute = None if absolute_steps is None else absolute_steps * STEP_ARCSEC
    if absolute is None and auxiliary_arcsec is None:
        return Combined(None, None, None, None, math.inf)
    if absolute is None:
        return Combined(None, auxiliary_arcsec, None, auxiliary_arcsec, sigma_arcsec)
    if auxiliary_arcsec is None:
        return Combined(absolute, None, None, absolute, ABSOLUTE_ARCSEC)
    difference = absolute - auxiliary_arcsec
    if abs(difference) > APART * math.hypot(ABSOLUTE_ARCSEC, sigma_arcsec):
        return Combined(absolute, auxiliary_arcsec, difference, absolute, ABSOLUTE_ARCSEC, False)
    weights = (ABSOLUTE_ARCSEC**-2, sigma_arcsec**-2)
    estimate = (weights[0] * absolute + weights[1] * auxiliary_arcsec) / sum(weights)
    return Combined(absolute, auxiliary_arcsec, difference, estimate, sum(weights) ** -0.5)
