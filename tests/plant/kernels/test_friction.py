"""LuGre friction: passive, bounded, exact over any step, and the published reference behaviour.

The reference set (sigma0 = 1e5, sigma1 = sqrt(1e5), sigma2 = 0.4, Tc = 1, Ts = 1.5, vs = 1e-3, unit mass) is
that of Canudas de Wit et al. 1995 (hardware.md 1.1).
"""

from math import exp, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from plant.kernels import layout as at
from plant.kernels.friction import relax, steady, stribeck, torque
from plant.units import ARCSEC
from tests.plant.bench import lugre

g_of, torque_of, relaxed, steady_of = (f.py_func for f in (stribeck, torque, relax, steady))  # type: ignore[attr-defined]
REFERENCE = lugre(1e5, sqrt(1e5), 0.4, 1.0, 1.5, 1e-3)
# paper Table 2 low preload, sigma0 of design.md; sigma1 at the passivity bound sigma2 Tc / (Ts - Tc)
TELESCOPE = lugre(5.9e6, 6700 * 229 / (621 - 229), 6700.0, 229.0, 621.0, 4e-4)


@pytest.fixture(autouse=True)
def _python_kernels(monkeypatch: pytest.MonkeyPatch) -> None:
    """Run the formulas as Python, so that a failure shows its numbers."""
    import plant.kernels.friction as kernel

    monkeypatch.setattr(kernel, "damping", kernel.damping.py_func)
    monkeypatch.setattr(kernel, "stribeck", kernel.stribeck.py_func)


rates = st.lists(st.floats(-0.05, 0.05), min_size=1, max_size=60)


@given(rates, st.floats(1e-6, 2e-3), st.sampled_from([0.5, 1.0, 2.0]))
@settings(max_examples=60, deadline=None)
def test_P5_lugre_is_passive(speeds: list[float], dt: float, exponent: float) -> None:
    """Whatever the motion, friction gives back no more than the bristle holds: sigma0 z^2 / 2.

    Work is integrated finely between the updates, where the exact solution for constant rate is known.
    """
    f = TELESCOPE.copy()
    f[6] = exponent
    z = 0.0
    work = 0.0
    fine = 50
    for speed in speeds:
        g = g_of(speed, f, 0)
        for _ in range(fine):
            middle = relaxed(z, speed, g, 0.5 * dt / fine)
            work += torque_of(speed, middle, g, f, 0) * speed * dt / fine
            z = relaxed(z, speed, g, dt / fine)
        assert work >= -1e-9 * (1.0 + abs(work))


@given(rates, st.floats(1e-6, 1.0))
@settings(max_examples=100, deadline=None)
def test_P5_bristle_stays_within_break_away(speeds: list[float], dt: float) -> None:
    z = 0.0
    for speed in speeds:
        z = relaxed(z, speed, g_of(speed, TELESCOPE, 0), dt)
        assert abs(z) <= 621.0 / 5.9e6 * (1 + 1e-12)


@given(st.floats(-0.05, 0.05), st.floats(-1e-4, 1e-4), st.floats(1e-6, 0.1), st.integers(1, 7))
@settings(deadline=None)
def test_P5_update_is_exact_so_it_composes(speed: float, z: float, dt: float, parts: int) -> None:
    g = g_of(speed, TELESCOPE, 0)
    in_parts = z
    for _ in range(parts):
        in_parts = relaxed(in_parts, speed, g, dt / parts)
    assert in_parts == pytest.approx(relaxed(z, speed, g, dt), rel=1e-9, abs=1e-18)


def test_P5_steady_torque_is_equation_5_and_sigma2() -> None:
    for speed in (7e-5, 4e-4, 5e-3, -2e-3):
        expected = 229 + (621 - 229) * exp(-((abs(speed) / 4e-4) ** 2)) + 6700 * abs(speed)
        assert steady_of(speed, TELESCOPE, 0) == pytest.approx(np.copysign(expected, speed))


def test_P5_torque_at_15_arcsec_per_s_is_the_computed_one() -> None:
    """hardware.md 1.1: 608.7, 556.3, 485.4 N m for delta 2, 1, 0.5 at low preload."""
    rate = 15 * ARCSEC
    for exponent, expected in ((2.0, 608.7), (1.0, 556.3), (0.5, 485.4)):
        f = TELESCOPE.copy()
        f[6] = exponent
        assert steady_of(rate, f, 0) == pytest.approx(expected, abs=0.1)


def test_P5_reference_presliding_is_a_spring_of_sigma0() -> None:
    """Small travel is held by the spring sigma0; long slow travel ends at break-away, Ts (1995, figure 2)."""
    for travel, expected in ((1e-7, 1e5 * 1e-7), (1e-3, 1.5)):
        z = 0.0
        rate = travel / 10.0
        g = g_of(rate, REFERENCE, 0)
        for _ in range(1000):
            z = relaxed(z, rate, g, 1e-2)
        assert torque_of(rate, z, g, REFERENCE, 0) == pytest.approx(expected, rel=2e-2)


def test_P5_reference_hysteresis_friction_lags_the_rate() -> None:
    """Friction is higher while the rate rises than while it falls (figure 3)."""
    z = 1.0 / 1e5
    rising: list[tuple[float, float]] = []
    falling: list[tuple[float, float]] = []
    dt = 1e-4
    for k in range(int(2 * np.pi / 10 / dt) * 3):
        speed = 2.5e-3 + 1.5e-3 * np.sin(10 * k * dt)
        g = g_of(speed, REFERENCE, 0)
        z = relaxed(z, speed, g, dt)
        (rising if np.cos(10 * k * dt) > 0 else falling).append((speed, torque_of(speed, z, g, REFERENCE, 0)))
    up, down = (np.array(branch[-5000:]) for branch in (rising, falling))
    up_at = up[np.abs(up[:, 0] - 2e-3) < 5e-5, 1].mean()
    down_at = down[np.abs(down[:, 0] - 2e-3) < 5e-5, 1].mean()
    assert up_at > down_at


def test_P5_update_agrees_with_a_stiff_solver() -> None:
    def speed_at(t: float) -> float:
        return 4e-3 * np.sin(3 * t)

    def slope(t: float, z: list[float]) -> list[float]:
        w = speed_at(t)
        return [w - abs(w) * z[0] / g_of(w, TELESCOPE, 0)]

    reference = solve_ivp(slope, (0, 3), [0.0], method="LSODA", rtol=1e-9, atol=1e-14).y[0, -1]
    z = 0.0
    dt = 5e-4
    for k in range(6000):
        w = speed_at((k + 0.5) * dt)
        z = relaxed(z, w, g_of(w, TELESCOPE, 0), dt)
    assert z == pytest.approx(reference, rel=2e-3)


@pytest.mark.parametrize(("rate", "decay", "sigma1"), [
    (0.5, 0.0, 3.0), (0.5, 1.0, 3.0 * exp(-0.25)), (-2.0, 1.0, 3.0 * exp(-4.0)), (0.5, 0.25, 3.0 * exp(-4.0)),
])  # fmt: skip
def test_P5_torque_by_hand_with_a_decaying_bristle_damping(rate: float, decay: float, sigma1: float) -> None:
    """sigma0 z + sigma1 (w - |w| z / g) + sigma2 w, behind other numbers of an array."""
    w = np.concatenate([[7.0], lugre(10.0, 3.0, 4.0, 1.0, 2.0, 1.0)])
    w[1 + at.F_DECAY] = decay
    expected = 10.0 * 0.1 + sigma1 * (rate - abs(rate) * 0.1 / 0.125) + 4.0 * rate
    assert torque_of(rate, 0.1, 0.125, w, 1) == pytest.approx(expected)


@pytest.mark.parametrize(("exponent", "power"), [(2.0, 9.0), (1.0, 3.0), (0.5, 3.0**0.5), (3.0, 27.0)])
def test_P5_deflection_of_steady_sliding_by_hand(exponent: float, power: float) -> None:
    for before in (1.0, 2.0):  # other numbers of the array
        own = lugre(10.0, 3.0, 4.0, 1.0, 2.0, 0.5, exponent)
        w = np.concatenate([np.full(at.FRICTION_SIZE, before), own])
        for rate in (1.5, -1.5):
            assert g_of(rate, w, at.FRICTION_SIZE) == pytest.approx((1.0 + exp(-power)) / 10.0)


def test_P5_at_rest_a_bristle_stays_and_a_sliding_one_tends_to_its_deflection() -> None:
    assert relaxed(1e-17, 0.0, 0.125, 1.0) == 1e-17 and steady_of(0.0, REFERENCE, 0) == 0.0
    assert relaxed(0.3, 2.0, 0.5, 0.25) == pytest.approx(0.5 - 0.2 * exp(-1.0))
    assert relaxed(0.3, -2.0, 0.5, 0.25) == pytest.approx(-0.5 + 0.8 * exp(-1.0))
