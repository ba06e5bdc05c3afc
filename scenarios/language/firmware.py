"""The two firmwares of the axis boards, as parameters that a host sets."""

from collections.abc import Mapping

from bus.protocol import AxisParameter
from plant.deadzone import bias_steps
from plant.parts import AxisModel, PlantModel

NAMES = ("paper", "fine")
"""paper: everything off. fine: what docs/results/one-arcsecond.md proposes, without compensation."""
BLEND_SHIFT = 11
"""10.2 s: four lines of the absolute encoder at the tracking rate. A roller ratio that is wrong by 1e-4 then
costs 0.015 arcsec."""


def parameters_of(name: str, model: PlantModel, axis: str = "ra") -> Mapping[int, int]:
    """Return the parameters of a firmware on an axis of a plant: its bias follows from the power stage."""
    if name == "paper":
        return {}
    part: AxisModel = getattr(model.axes, axis)
    return {
        AxisParameter.DUTY_FRACTION: 1,
        AxisParameter.RATE_LOCK: 1,
        AxisParameter.POSITION_BLEND: BLEND_SHIFT,
        AxisParameter.COUNTER_BIAS_Q8: bias_steps(model, part.motor) * 256,
    }
