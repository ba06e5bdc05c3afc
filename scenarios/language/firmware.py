"""The two firmwares of the axis boards, as parameters that a host sets."""

from collections.abc import Mapping

from bus.protocol import AxisParameter

COUNTER_BIAS = 36
"""PWM steps, 1.2 % of the supply: the default dead band (1 %, plant/effects/pwm_deadband.py) and a fifth."""
BLEND_SHIFT = 11
"""10.2 s: four lines of the absolute encoder at the tracking rate. A roller ratio that is wrong by 1e-4 then
costs 0.015 arcsec."""

FIRMWARES: Mapping[str, Mapping[int, int]] = {
    "paper": {},
    "fine": {
        AxisParameter.DUTY_FRACTION: 1,
        AxisParameter.RATE_LOCK: 1,
        AxisParameter.POSITION_BLEND: BLEND_SHIFT,
        AxisParameter.COUNTER_BIAS_Q8: COUNTER_BIAS * 256,
    },
}
"""paper: everything off. fine: what docs/results/one-arcsecond.md proposes, without compensation."""
