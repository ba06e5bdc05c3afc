"""Formulas over columns, for calibration: the same numbers as the equations in the effect files."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import interp1d

from plant.effects import signals as sig
from plant.effects.unknown import COUNT, DOMAIN, FIRST, KIND, KNOTS, PERIOD, formula
from plant.evaluate import evaluate, evaluate_function, signals, values_over
from plant.kernels.layout import ROW, ROW_MEMORY
from plant.parts import EffectModel, Number
from plant.rows import KINDS, values, vector
from plant.units import ARCSEC


def with_friction(rate: np.ndarray) -> np.ndarray:
    """Return signal vectors with the low-preload friction of Table 2 and delta 2."""
    n = len(rate)
    columns = {
        sig.TIME: np.arange(n) * 0.01, sig.RATE: rate, sig.SIGMA0: np.full(n, 5.9e6), sig.SIGMA2: np.full(n,
        6700.0),
        sig.COULOMB: np.full(n, 229.0), sig.STICTION: np.full(n, 621.0), sig.STRIBECK_RATE: np.full(n, 4e-4),
        sig.STRIBECK_EXPONENT: np.full(n, 2.0),
    }  # fmt: skip
    return signals(n, columns)


def test_gear_eccentricity_is_a_sine_at_its_order() -> None:
    angle = np.linspace(0.0, 0.2, 500)
    y = evaluate(
        "gear_eccentricity", signals(500, {sig.ANGLE: angle}),
        {"amplitude": 20.0, "kinematic": 1e-5, "phase": 0.3, "order": 720.977},
    )  # fmt: skip
    assert np.allclose(y, 20.0 * np.sin(720.977 * angle + 0.3))


def test_second_term_of_gear_eccentricity_is_its_kinematic_error() -> None:
    angle = np.linspace(0.0, 0.2, 500)
    given_ = {"amplitude": 20.0, "kinematic": 1e-5, "phase": 0.3, "order": 86.1}
    y = evaluate("gear_eccentricity", signals(500, {sig.ANGLE: angle}), given_, term=1)
    assert np.allclose(y, 1e-5 * np.sin(86.1 * angle + 0.3))


def test_friction_effects_give_the_change_of_the_steady_torque() -> None:
    """A tenth more Coulomb friction brakes by 22.9 N m where the Stribeck bump has died out; viscous by
    rate.
    """
    rate = np.array([0.01, -0.01, 0.03])
    assert np.allclose(evaluate("coulomb_change", with_friction(rate), {"factor": 1.1}), [-22.9, 22.9, -22.9])
    viscous = evaluate("viscous_change", with_friction(rate), {"factor": 2.0})
    assert np.allclose(viscous, -6700.0 * rate)
    asymmetric = evaluate(
        "friction_asymmetry", with_friction(rate), {"coulomb_asymmetry": 0.1, "viscous_asymmetry": 0.0}
    )
    assert np.allclose(asymmetric, [-22.9, -22.9, -22.9])


def test_warm_up_follows_its_time_constant_in_motion() -> None:
    rate = np.full(2001, 0.01)
    y = evaluate("friction_warmup", with_friction(rate), {"depth": -0.5, "time_constant": 10.0})
    declared = 229.0 + 67.0
    t = np.arange(2001) * 0.01
    assert np.allclose(y, -declared * 0.5 * np.exp(-t / 10.0), rtol=1e-6)


def test_diode_braking_uses_constants_of_the_plant() -> None:
    rows = signals(2, {sig.MOTOR_RATE: np.array([5.0, -5.0]), sig.MOTOR: np.zeros(2)})
    y = evaluate(
        "diode_braking", rows,
        {"share": 1.0, "drop": 0.0, "torque_constant": 0.4, "resistance": 2.0, "ratio": 360.0},
    )  # fmt: skip
    assert np.allclose(y, [0.0, 0.4 * 0.4 * 5.0 / 2.0 * 360.0])


def unknown(x: np.ndarray, knots: list[tuple[float, float]], kind: float, period: float = 0.0) -> np.ndarray:
    """Evaluate an unknown function of the axis angle."""
    p = np.zeros(ROW - ROW_MEMORY)
    place = sig.MEMORY
    p[place + DOMAIN], p[place + KIND] = sig.ANGLE, kind
    p[place + PERIOD], p[place + COUNT] = period, len(knots)
    for k, (at, value) in enumerate(knots):
        p[place + FIRST + k], p[place + FIRST + KNOTS + k] = at, value
    y = np.zeros(len(x))
    values_over(KINDS[formula], signals(len(x), {sig.ANGLE: x}), p, y)
    return y


knot_lists = st.lists(
    st.tuples(st.integers(0, 1000), st.floats(-50, 50)),
    min_size=2,
    max_size=32,
    unique_by=lambda pair: pair[0],
)


@given(knot_lists)
@settings(max_examples=40, deadline=None)
def test_unknown_linear_is_linear_interpolation(pairs: list[tuple[int, float]]) -> None:
    knots = sorted((k * 1e-3, y) for k, y in pairs)
    xs, ys = zip(*knots, strict=True)
    x = np.linspace(xs[0], xs[-1], 77)
    assert np.allclose(unknown(x, knots, 1.0), interp1d(xs, ys)(x), atol=1e-9)


@given(knot_lists)
@settings(max_examples=40, deadline=None)
def test_unknown_cubic_passes_its_knots_and_is_flat_outside(pairs: list[tuple[int, float]]) -> None:
    knots = sorted((k * 1e-3, y) for k, y in pairs)
    xs, ys = (np.array(column) for column in zip(*knots, strict=True))
    assert np.allclose(unknown(xs, knots, 3.0), ys, atol=1e-9)
    assert np.allclose(unknown(np.array([xs[0] - 1, xs[-1] + 1]), knots, 3.0), [ys[0], ys[-1]])


def test_unknown_cubic_reproduces_a_parabola_and_wraps_with_its_period() -> None:
    knots = [(k * 0.1, (k * 0.1) ** 2) for k in range(11)]
    x = np.linspace(0.1, 0.9, 50)
    assert np.allclose(unknown(x, knots, 3.0), x**2, atol=1e-12)
    assert np.allclose(unknown(x + 3.0, knots, 3.0, 1.0), x**2, atol=1e-9)


def test_parameters_become_si_numbers_behind_the_order() -> None:
    from plant.effects import REGISTRY

    given_ = {"amplitude": Number(2.0, "arcsec", "t")}
    effect = REGISTRY["encoder_eccentricity"]
    numbers = vector(effect, values(EffectModel("encoder_eccentricity", "roller", 1, given_)))
    assert numbers == [24.5, pytest.approx(2.0 * ARCSEC), 0.0, 0.0, 0.0]


def test_play_is_the_play_operator() -> None:
    """A reading behind a gap of 10 arcsec stands still for 10 arcsec at each reversal."""
    steps = np.concatenate([np.full(40, 1.0), np.full(40, -1.0), np.full(5, 1.0), np.full(60, -1.0)]) * ARCSEC
    n = len(steps)
    rows = signals(n, {sig.TIME: np.arange(n) * 0.01, sig.RATE: steps / 0.01})
    reading = np.cumsum(steps) + evaluate("play", rows, {"gap": 10.0 * ARCSEC, "encoder": 2.0})
    moved = np.diff(reading)
    assert np.allclose(moved[10:39], ARCSEC)  # taken along
    assert np.allclose(moved[39:49], 0.0, atol=1e-18)  # the gap closes
    assert np.allclose(moved[49:79], -ARCSEC)
    assert np.allclose(moved[79:84], 0.0, atol=1e-18)  # less than the gap back, and forth again
    assert np.allclose(moved[84:89], 0.0, atol=1e-18)
    assert np.allclose(moved[89:], -ARCSEC)


def test_memory_begins_at_the_first_row() -> None:
    """A winding is cold there, whatever time the rows begin at; then it warms by its own time."""
    t_s = np.array([100.0, 130.0, 160.0])
    rows = signals(3, {sig.TIME: t_s, sig.CURRENT: np.full(3, 2.0)})
    y = evaluate("winding_heating", rows, {"thermal_resistance": 1.5, "time_constant": 60.0, "winding": 2.0})
    warmth = 1.5 * 2.0**2 * 2.0 * (1 - np.exp(-(t_s - 100.0) / 60.0))
    assert y == pytest.approx(2.0 * 0.00393 * warmth)


def test_without_a_seed_it_is_nought() -> None:
    rows = signals(4, {sig.TIME: np.arange(4) * 0.01})
    numbers = {"mean": 0.0, "deviation": 5.0, "correlation_time": 0.5}
    with np.errstate(over="ignore"):
        given: tuple[dict[str, float], ...] = ({}, {"seed": 0.0}, {"seed": 1.0})
        none, nought, one = (evaluate("wind_torque", rows, numbers | more) for more in given)
    assert np.array_equal(none, nought) and not np.array_equal(none, one)


def test_a_function_over_a_period_returns() -> None:
    knots, heights = np.array([0.0, 1.0, 3.0]), np.array([0.0, 2.0, 0.0])
    u = np.array([0.0, 1.0, 2.5])
    assert evaluate_function(knots, heights, u + 6.0, 3.0) == pytest.approx(
        evaluate_function(knots, heights, u, 3.0)
    )
    assert evaluate_function(knots, heights, np.array([4.0]), 3.0) == pytest.approx([2.0])
    assert evaluate_function(knots, heights, np.array([4.0])) == pytest.approx([0.0])  # flat beyond
