"""Wind on the tube: a mean and gusts with von Karman's spectrum.

White noise through three lags has that spectrum within 0.35 dB up to 2 pi tau f = 300. A tube smaller than
its eddies feels the square of the wind's speed. So torque and speed have one spectrum (Davenport 1961).
"""

from math import exp, floor, sqrt
from typing import Final

from plant.compiled import Floats
from plant.effects.base import ASSUMED, Effect, Parameter, Term
from plant.effects.signals import TIME, Hook
from plant.kernels.noise import normal

# of the correlation time, and their shares in the sum: least squares on the logarithm of the spectrum
SLOW: Final = 1.148
MIDDLE: Final = 0.1318
FAST: Final = 0.01076
OF_SLOW: Final = 0.9263
OF_MIDDLE: Final = 0.06194
OF_FAST: Final = 0.00787
PER_S: Final = 1e6  # random numbers are those of a microsecond: steps are longer


def formula(x: Floats, slow: float, middle: float, fast: float, mean: float, deviation: float) -> float:
    """Return the torque, N m at the axis."""
    return mean + deviation * (OF_SLOW * slow + OF_MIDDLE * middle + OF_FAST * fast)


def update(
    x: Floats, dt: float, slow: float, middle: float, fast: float, seed: float, correlation_time: float
) -> tuple[float, float, float]:
    """Three lags of one noise, whose density at low frequency is 4 tau; it is that of seed and time."""
    noise = sqrt(2.0 * correlation_time / dt) * normal(seed, float(floor(x[TIME] * PER_S)))
    slow += (1.0 - exp(-dt / (SLOW * correlation_time))) * (noise - slow)
    middle += (1.0 - exp(-dt / (MIDDLE * correlation_time))) * (noise - middle)
    fast += (1.0 - exp(-dt / (FAST * correlation_time))) * (noise - fast)
    return slow, middle, fast


EFFECT = Effect(
    name="wind_torque",
    catalogue_row=31,
    channel="T",
    domain="time",
    equation="T = mean + deviation n(t), n of density 4 tau (1 + 70.8 tau^2 f^2)^(-5/6)",
    parameters=(
        Parameter("mean", "N m", -200.0, 200.0, 10.0, ASSUMED),
        Parameter("deviation", "N m", 0.0, 200.0, 10.0, ASSUMED),
        Parameter("correlation_time", "s", 0.05, 100.0, 2.0, ASSUMED),
    ),
    source="von Karman, Proc. Nat. Acad. Sci. 34 (1948)",
    terms=(Term(Hook.AXIS_TORQUE, formula, update, memory=("slow", "middle", "fast")),),
)
