"""Wind on the tube: the torque by its speed in the dome's slit, and how much of the wind comes in.

Quasi-steady: the force follows the square of the speed, so its deviation is twice the speed's (Davenport
1961); gusts drift through the slit (Taylor 1938). That gusts smaller than the tube act on all of it at once
is the worst case: their force in truth averages out.
"""

from math import cos
from typing import Final

from plant.effects.wind_torque import EFFECT
from plant.parts import EffectModel, Number

AIR_KG_M3: Final = 1.0
"""At 1951 m (paper, section 1: the site of Nainital) and 10 °C: 0.80 of the standard atmosphere's 1.225."""
DRAG: Final = 1.0
"""Drag coefficient. ASSUMPTION: a short cylinder across the wind, below 3e5 of Reynolds' number."""
AREA_M2: Final = 1.2
"""ASSUMPTION: a tube of 0.8 m by 1.5 m."""
ARM_M: Final = 0.33
"""From the axis to where the wind presses. ASSUMPTION: the tube's centre lies beside the polar axis."""
INTENSITY: Final = 0.2
"""Deviation of the wind's speed over its mean. ASSUMPTION: a slit that faces the wind."""
EDDY_M: Final = 1.0
"""Integral length of the gusts. ASSUMPTION: the width of the slit."""
LEE: Final = 0.1
"""Share of the wind that comes round into a slit that looks away. ASSUMPTION: Zago (thesis, EPFL 1995) found
the strongest wind in a slit that faces it, and has no figure for the lee."""
_CALM_M_S: Final = 0.01


def torque(speed_m_s: float) -> tuple[float, float, float]:
    """Mean and deviation, N m at the axis, and correlation time, s, of `wind_torque`."""
    mean = AIR_KG_M3 / 2 * speed_m_s**2 * DRAG * AREA_M2 * ARM_M
    return mean, 2 * INTENSITY * mean, EDDY_M / max(speed_m_s, _CALM_M_S)


def share(away_rad: float, opened: float) -> float:
    """Speed in the slit over the wind's: the slit's width as the wind sees it, and never less than `LEE`.

    away_rad: between the slit's azimuth and where the wind comes from. opened: of the shutter, 0..1.
    """
    return opened * max(LEE, cos(away_rad))


def wind(speed_m_s: float) -> EffectModel:
    """The effect of a wind of this speed in the slit."""
    source = f"wind of {speed_m_s:g} m/s in the slit, plant/wind.py"
    values = zip(EFFECT.parameters, torque(speed_m_s), strict=True)
    numbers = {parameter.name: Number(value, parameter.unit, source) for parameter, value in values}
    return EffectModel(EFFECT.name, parameters=numbers)
