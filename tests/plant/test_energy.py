"""An axis without power cannot gain energy, however rotors, teeth and bristles move."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from plant.gears import RATIO
from plant.kernels import layout as at
from plant.plant import Plant
from plant.units import ARCSEC
from tests.plant.bench import bare

MODEL = bare()


def energy(w: np.ndarray) -> float:
    """Return kinetic energy, that of both trains' springs and that of the bristles, J, at the step's
    middle.
    """
    total = 0.5 * w[at.INERTIA] * w[at.RATE] ** 2
    total += 0.5 * w[at.DECLARED_FRICTION + at.F_SIGMA0] * w[at.BRISTLE] ** 2
    for m in range(2):
        o = at.MOTORS + m * at.MOTOR_SIZE
        total += 0.5 * w[at.ROTOR_INERTIA] * w[o + at.M_RATE] ** 2
        wound = max(0.0, abs(w[o + at.M_ANGLE] / RATIO - w[at.ANGLE]) - w[at.HALF_PLAY])
        total += 0.5 * w[at.GEAR_STIFFNESS] * wound**2
    return float(total)


@given(
    st.floats(-7000, 7000), st.floats(-20, 20), st.floats(-20, 20), st.floats(-600, 600), st.floats(-300, 300)
)
@settings(max_examples=25, deadline=None)
def test_P5_unpowered_axis_loses_energy(
    rate: float, rate_a: float, rate_b: float, twist_a: float, twist_b: float
) -> None:
    """rate, arcsec/s; rotors, rad/s; where the rotors stand in their play, arcsec at the axis."""
    plant = Plant(MODEL, 1)
    w = plant.world[0]
    w[at.RATE] = w[at.RATE_BEFORE] = rate * ARCSEC
    for m, (speed, twist) in enumerate(((rate_a, twist_a), (rate_b, twist_b))):
        o = at.MOTORS + m * at.MOTOR_SIZE
        w[o + at.M_RATE] = w[o + at.M_RATE_BEFORE] = speed
        w[o + at.M_ANGLE] = twist * ARCSEC * RATIO
    start = energy(w)
    # a hundredth of slack: angles and rates of the leapfrog are half a step apart
    for k in range(1, 40):
        plant.advance(k * 25_000_000)
        assert energy(w) <= start * 1.01 + 1e-9
    assert energy(w) < 0.9 * start + 1e-6
