"""Wind on the tube by its speed in the dome's slit."""

from typing import Final

from plant.effects.wind_torque import EFFECT
from plant.parts import EffectModel, Number

AIR_KG_M3: Final = 1.0
"""At 1951 m (paper, section 1: the site of Nainital) and 10 °C: 0.80 of the standard atmosphere's 1.225."""
AREA_ARM_M3: Final = 0.4
"""Drag coefficient times area times arm. ASSUMPTION: 1.0 for a tube, 1.2 m² of it, pressed 0.33 m beside the
axis."""
INTENSITY: Final = 0.2
"""Deviation of the wind's speed over its mean. ASSUMPTION: a slit that faces the wind."""
EDDY_M: Final = 1.0
"""Length of the eddies that come through. ASSUMPTION: the width of the slit, 1 m."""
SPEEDS_M_S: Final = (1.0, 3.0, 10.0)


def wind(speed_m_s: float) -> EffectModel:
    """Mean torque by dynamic pressure; its deviation is that of a square, twice the speed's; eddies drift."""
    mean = AIR_KG_M3 / 2 * speed_m_s**2 * AREA_ARM_M3
    values = {
        "mean": (mean, "N m"),
        "deviation": (2 * INTENSITY * mean, "N m"),
        "correlation_time": (EDDY_M / speed_m_s, "s"),
    }
    source = f"wind of {speed_m_s:g} m/s, scenarios/studies/objective/wind.py"
    numbers = {name: Number(value, unit, source) for name, (value, unit) in values.items()}
    return EffectModel(EFFECT.name, parameters=numbers)
