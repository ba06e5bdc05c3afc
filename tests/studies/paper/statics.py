"""What can be said about a point of the space without running it: arithmetic on steady states."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from scenarios.studies.paper.published import TABLE_2
from scenarios.studies.paper.runs import STEP_TO
from scenarios.studies.paper.scales import ARCSEC, GEAR_RATIO

SUPPLY_V = 24.0
COUNTER = 0.10
FASTEST = 10800.0 * ARCSEC
DROP_V = 0.7
SLOWEST_OPEN = 100.0 * ARCSEC


def motor_damping(found: Mapping[str, Any]) -> Any:
    """Return (K N)^2 / R, N m s/rad at the axis: how steeply the leading motor's torque falls with speed."""
    return (found["torque_constant"] * GEAR_RATIO) ** 2 / found["resistance"]


def stribeck_slope(rate: float, exponent: Any, drop: float, stribeck_rate: float) -> Any:
    """Return how steeply sliding friction falls at `rate`, N m s/rad (positive where it falls)."""
    x = (rate / stribeck_rate) ** exponent
    return drop * exponent / rate * x * np.exp(-x)


def shortfalls(found: Mapping[str, Any], scale: float = 1.0, diode: bool = False) -> dict[str, Any]:
    """Return by how much each necessary condition fails, as a share; 0 where it holds. Numbers or arrays.

    scale: of Tc and Ts against Table 2 in N m (1 as printed, 1/2.774 when read as N mm at the motor).
    diode: whether the lagging motor brakes through its freewheel diode.
    """
    torque_per_volt = found["torque_constant"] * GEAR_RATIO / found["resistance"]
    low, high = TABLE_2["low"], TABLE_2["high"]
    drag = low["coulomb"] * scale + low["viscous"] * FASTEST
    back = found["torque_constant"] * GEAR_RATIO * FASTEST
    if diode:  # both motors' back-EMF, the lagging one's duty, less its diode's drop
        needed = drag / torque_per_volt + 2.0 * back + COUNTER * SUPPLY_V - DROP_V
    else:
        needed = (drag / torque_per_volt + back) / (1.0 - COUNTER)
    stall = high["stiction"] * scale / torque_per_volt / (1.0 - COUNTER)
    inductance = found["electrical_time"] * found["resistance"]
    return {
        "reaches 3 deg/s at 24 V": np.maximum(0.0, needed / (0.98 * SUPPLY_V) - 1.0),
        "breaks away at high preload": np.maximum(0.0, stall / (0.9 * SUPPLY_V) - 1.0),
        "inductance of 2 to 20 mH (hardware.md 1.2)": np.maximum(0.0, 2e-3 / inductance - 1.0)
        + np.maximum(0.0, inductance / 20e-3 - 1.0),
    }


def low_speed_margin(found: Mapping[str, Any], scale: float = 1.0) -> Any:
    """Return the damping at 100 arcsec/s over what a steady open-loop speed there needs: row E6 wants 1 or
    more."""
    low = TABLE_2["low"]
    slope = stribeck_slope(
        SLOWEST_OPEN, found["exponent"], (low["stiction"] - low["coulomb"]) * scale, low["stribeck_rate"]
    )
    return (motor_damping(found) + low["viscous"]) / slope


def linear_effort(found: Mapping[str, Any], scale: float = 1.0) -> Any:
    """Return the effort of equation (6) at 600 arcsec/s over that of the declared friction; row E9
    wants 1.2 at most.

    Equation (6) takes all of the stiction as lasting; Stribeck friction has fallen by then.
    """
    low, rate = TABLE_2["low"], STEP_TO * ARCSEC
    linear = low["viscous"] * rate + motor_damping(found) * rate
    fall = np.exp(-((rate / low["stribeck_rate"]) ** found["exponent"]))
    sliding = (low["coulomb"] + (low["stiction"] - low["coulomb"]) * fall) * scale
    return (low["stiction"] * scale + linear) / (sliding + linear)


def shortfalls_of(points: Mapping[str, Any], scale: float = 1.0, diode: bool = False) -> Any:
    """Return the sum of all shortfalls."""
    return sum(shortfalls(points, scale, diode).values())
