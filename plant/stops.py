"""Hard stops for a plant file that names none: where its soft limits end, and a little further."""

from collections.abc import Mapping
from dataclasses import replace
from math import radians
from typing import Final

from plant.parts import AxisModel, Number, PlantModel, Stops

BEYOND_RAD: Final = radians(5.0)
"""From a soft limit to the buffer behind it. ASSUMPTION: no source shows the mount's ends. An axis that runs
down from 3 deg/s takes 0.244 s (hardware.md 2.2), so 0.4 deg: half of the 5 are room for a switch."""
_WHY = "ASSUMPTION: a rubber buffer that brings the 1760 kg m2 (paper) from 3 deg/s to rest within 0.2 deg"
STIFFNESS: Final = Number(4e5, "N m/rad", _WHY)
"""J (rate / way)^2 = 1760 * (3 / 0.2)^2, rounded."""
DAMPING: Final = Number(1.6e4, "N m s/rad", "ASSUMPTION: 0.3 of critical, 2 sqrt(k J), as rubber has")


def with_stops(model: PlantModel, soft_rad: Mapping[str, tuple[float, float]]) -> PlantModel:
    """Return the model with hard stops on every axis; those that its file declares stay.

    soft_rad: soft limits (low, high) of each axis, rad on the scale of the absolute encoder.
    """
    axes, source = model.axes, "ASSUMPTION: 5 deg beyond the soft limit"
    for name, (low, high) in soft_rad.items():
        axis: AxisModel = getattr(axes, name)
        if axis.stops is None:
            ends = Number(low - BEYOND_RAD, "rad", source), Number(high + BEYOND_RAD, "rad", source)
            axes = replace(axes, **{name: replace(axis, stops=Stops(*ends, STIFFNESS, DAMPING))})
    return replace(model, axes=axes)
