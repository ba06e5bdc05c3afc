"""What can be said about a point of the space without running it: arithmetic on steady states.

Currents are averages over a PWM period, continuous ones: inductances of 2 mH and more let no current die that
matters here (test_search.py holds this against the power stage of the plant).
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from scenarios.studies.paper.runs import STEP_TO
from scenarios.studies.paper.scales import ARCSEC, GEAR_RATIO, TABLE_2

SUPPLY_V = 24.0
DROP_V = 0.7
COUNTER = 0.10
SWITCH_OHM = 0.185
"""Switch and sense resistor: in the loop only while the switch is closed."""
LEAST_WINDING_OHM = 0.05
FASTEST = 10800.0 * ARCSEC
SLOWEST_OPEN = 100.0 * ARCSEC
HALVINGS = 40


def winding(found: Mapping[str, Any]) -> Any:
    """Return the resistance in which the current freewheels, ohm."""
    return np.maximum(LEAST_WINDING_OHM, found["resistance"] - SWITCH_OHM)


def current(found: Mapping[str, Any], duty: Any, emf: Any) -> Any:
    """Return the mean current at a duty, A. emf: V, negative where the motor is turned against its pull."""
    driven = duty * (SUPPLY_V + DROP_V) - DROP_V - emf
    return np.maximum(0.0, driven / (winding(found) + duty * SWITCH_OHM))


def torque(found: Mapping[str, Any], duty: Any, rate: float) -> Any:
    """Return what both motors give at the axis, N m. duty: of the leading one. rate: rad/s of the axis."""
    strength = found["torque_constant"] * GEAR_RATIO
    emf = strength * rate
    return strength * (current(found, duty, emf) - current(found, COUNTER * duty, -emf))


def duty_for(found: Mapping[str, Any], wanted: float, rate: float) -> Any:
    """Return the duty at which the drive gives a torque, N m, at a rate, rad/s; 1 where none does."""
    low, high = 0.0 * found["resistance"], 0.0 * found["resistance"] + 1.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        less = torque(found, middle, rate) < wanted
        low, high = np.where(less, middle, low), np.where(less, high, middle)
    return high


def motor_damping(found: Mapping[str, Any]) -> Any:
    """Return (K N)^2 / R, N m s/rad at the axis: how steeply the leading motor's torque falls with speed. At
    the duties of low speeds the current freewheels nearly all the time."""
    return (found["torque_constant"] * GEAR_RATIO) ** 2 / winding(found)


def stribeck_slope(rate: float, exponent: Any, drop: float, stribeck_rate: float) -> Any:
    """Return how steeply sliding friction falls at `rate`, N m s/rad (positive where it falls)."""
    x = (rate / stribeck_rate) ** exponent
    return drop * exponent / rate * x * np.exp(-x)


def shortfalls(found: Mapping[str, Any], scale: float = 1.0) -> dict[str, Any]:
    """Return by how much each necessary condition fails, as a share; 0 where it holds. Numbers or arrays.

    scale: of Tc and Ts against Table 2 in N m (1 as printed, 1/2.774 when read as N mm at the motor).
    """
    low, high = TABLE_2["low"], TABLE_2["high"]
    drag = low["coulomb"] * scale + low["viscous"] * FASTEST
    inductance = found["electrical_time"] * found["resistance"]
    return {
        "reaches 3 deg/s at 24 V": np.maximum(0.0, 1.0 - torque(found, 0.98, FASTEST) / drag),
        "breaks away at high preload": np.maximum(
            0.0, 1.0 - torque(found, 0.9, 0.0) / (high["stiction"] * scale)
        ),
        "inductance of 2 to 20 mH (hardware.md 1.2)": np.maximum(0.0, 2e-3 / inductance - 1.0)
        + np.maximum(0.0, inductance / 20e-3 - 1.0),
    }


def stall_current(found: Mapping[str, Any], scale: float = 1.0) -> Any:
    """Return the leading motor's current per duty as the high preload breaks away, A: row E14 wants 6."""
    duty = duty_for(found, TABLE_2["high"]["stiction"] * scale, 0.0)
    return current(found, duty, 0.0) / duty


def low_speed_margin(found: Mapping[str, Any], scale: float = 1.0) -> Any:
    """Return the damping at 100 arcsec/s over what a steady open-loop speed there needs: row E6 wants 1 or
    more."""
    low = TABLE_2["low"]
    slope = stribeck_slope(
        SLOWEST_OPEN, found["exponent"], (low["stiction"] - low["coulomb"]) * scale, low["stribeck_rate"]
    )
    return (motor_damping(found) + low["viscous"]) / slope


def leap(found: Mapping[str, Any], scale: float = 1.0) -> Any:
    """Return the speed at which a leap of the high preload would settle, arcsec/s: the duty of break-away,
    friction of the high preload; row E2 wants 165 at most, and a leap overshoots it."""
    high = TABLE_2["high"]
    duty = duty_for(found, high["stiction"] * scale, 0.0)
    low, top = 0.0 * duty + 1e-6, 0.0 * duty + FASTEST
    for _ in range(HALVINGS):
        middle = 0.5 * (low + top)
        fall = np.exp(-((middle / high["stribeck_rate"]) ** found["exponent"]))
        friction = (high["coulomb"] + (high["stiction"] - high["coulomb"]) * fall) * scale
        runs = torque(found, duty, middle) > friction + high["viscous"] * middle
        low, top = np.where(runs, middle, low), np.where(runs, top, middle)
    return top / ARCSEC


def linear_effort(found: Mapping[str, Any], scale: float = 1.0) -> Any:
    """Return the effort of equation (6) at 600 arcsec/s over that of the declared friction behind the power
    stage; row E9 wants 0.8 to 1.2.

    Equation (6) takes all of the stiction as lasting, where Stribeck friction has fallen by then. It has no
    diode, and the whole resistance all the time.
    """
    low, rate = TABLE_2["low"], STEP_TO * ARCSEC
    strength = found["torque_constant"] * GEAR_RATIO
    volts = (low["stiction"] * scale + low["viscous"] * rate) * found["resistance"] / strength
    linear = (volts + strength * rate) / (1.0 - COUNTER) / SUPPLY_V
    fall = np.exp(-((rate / low["stribeck_rate"]) ** found["exponent"]))
    sliding = (low["coulomb"] + (low["stiction"] - low["coulomb"]) * fall) * scale
    return linear / duty_for(found, sliding + low["viscous"] * rate, rate)


def shortfalls_of(points: Mapping[str, Any], scale: float = 1.0) -> Any:
    """Return the sum of all shortfalls."""
    return sum(shortfalls(points, scale).values())
