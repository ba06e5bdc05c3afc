"""An effect outside the catalogue: lines, cubics and stops through knots, by what is known of them."""

import numpy as np
import pytest

from plant.effects import signals as sig
from plant.effects import unknown
from plant.evaluate import evaluate_function, signals, values_over
from plant.kernels.layout import ROW, ROW_MEMORY
from plant.rows import KINDS

TURN = 2 * np.pi


def over(
    kind: str, knots: list[tuple[float, float]], u: np.ndarray, period: float = 0.0, motor: float = 0.0,
    of: float = 0.0, domain: int = sig.ANGLE,
) -> np.ndarray:  # fmt: skip
    """The function at `u`, in rows in that order; `motor` that it belongs to, `of` the one that asks."""
    p = np.zeros(ROW - ROW_MEMORY)
    at = sig.MEMORY + unknown.FIRST
    p[sig.MEMORY : at] = domain, unknown.KINDS[kind], period, len(knots), motor
    for k, (x, y) in enumerate(knots):
        p[at + k], p[at + unknown.KNOTS + k] = x, y
    y = np.zeros(len(u))
    values_over(KINDS[unknown.formula], signals(len(u), {domain: u, sig.MOTOR: np.full(len(u), of)}), p, y)
    return y


KNOTS = [(0.0, 1.0), (0.5, 3.0), (2.0, -3.0), (2.5, 0.0)]


@pytest.mark.parametrize("domain", [sig.ANGLE, sig.RATE])
def test_lines_join_the_knots_and_end_flat(domain: int) -> None:
    u = np.array([-9.0, 0.0, 0.25, 0.5, 0.75, 1.25, 2.0, 2.25, 2.5, 9.0])
    expected = [1.0, 1.0, 2.0, 3.0, 2.0, 0.0, -3.0, -1.5, 0.0, 0.0]
    assert over("linear", KNOTS, u, domain=domain) == pytest.approx(expected)


def test_a_period_repeats_the_knots_either_way() -> None:
    u = np.array([0.25, 1.25, 2.25])
    for turns in (-2, -1, 1, 3):
        assert over("linear", KNOTS, u + 4.0 * turns, 4.0) == pytest.approx(over("linear", KNOTS, u))
    assert over("linear", KNOTS, np.array([3.0, -1.0]), 4.0) == pytest.approx([0.0, 0.0])  # behind the last


def test_one_knot_is_a_constant() -> None:
    for kind in ("linear", "cubic"):
        assert over(kind, [(1.0, 7.0)], np.array([0.0, 1.0, 2.0])) == pytest.approx([7.0] * 3)


@pytest.mark.parametrize(
    ("motor", "of", "acts"), [(0, 0, 1), (0, 1, 1), (1, 0, 1), (1, 1, 0), (2, 0, 0), (2, 1, 1)]
)
def test_it_acts_on_the_motor_that_it_belongs_to(motor: int, of: int, acts: int) -> None:
    for kind in ("linear", "cubic"):
        (value,) = over(kind, KNOTS, np.array([0.5]), motor=motor, of=of)
        assert value == pytest.approx(3.0 * acts)


def test_a_cubic_of_two_knots_is_a_line() -> None:
    u = np.linspace(-1, 4, 11)
    expected = np.interp(u, [0.0, 3.0], [1.0, 7.0])
    assert over("cubic", [(0.0, 1.0), (3.0, 7.0)], u) == pytest.approx(expected)


def test_inner_slopes_are_those_of_the_parabola_through_three_knots() -> None:
    """Uneven knots on a parabola: between inner ones a cubic of these slopes is the parabola."""

    def parabola(x: np.ndarray) -> np.ndarray:
        return 2.0 - 3.0 * x + 0.7 * x**2

    places = np.array([-1.0, 0.0, 0.4, 1.7, 2.0, 4.0])
    knots = list(zip(places, parabola(places), strict=True))
    u = np.linspace(0.0, 2.0, 21)
    assert over("cubic", knots, u) == pytest.approx(parabola(u))
    assert evaluate_function(places, parabola(places), u) == pytest.approx(parabola(u))


def test_ends_have_the_slope_of_their_chord() -> None:
    """Hermite's cubic from a slope of 2, the chord's, to one of (2 * 1 - 4 * 1) / 2 at its other end."""
    knots, s = [(0.0, 0.0), (1.0, 2.0), (2.0, -2.0)], 0.25
    end, inner = 2.0, (2.0 - 4.0) / 2
    for place, first, second, low, high in ((s, end, inner, 0.0, 2.0), (1 + s, inner, -4.0, 2.0, -2.0)):
        hermite = (
            low * (2 * s**3 - 3 * s**2 + 1) + first * (s**3 - 2 * s**2 + s)
            + high * (3 * s**2 - 2 * s**3) + second * (s**3 - s**2)
        )  # fmt: skip
        assert over("cubic", knots, np.array([place])) == pytest.approx([hermite])


def test_a_closed_period_is_smooth_across_its_ends() -> None:
    """A wave all round, the last knot as high as the first: both have the slope of their neighbours'
    parabola, (y1 - y-1) / 2h; without a period that of a chord."""
    places = np.linspace(0.0, TURN, 25)
    knots = [(float(x), float(np.sin(x + 1.0))) for x in places]
    knots[-1] = (TURN, knots[0][1])
    u = np.linspace(-0.2, 0.2, 41)
    assert over("cubic", knots, u, TURN) == pytest.approx(np.sin(u + 1.0), abs=3e-4)
    h = places[1]
    slopes = np.diff(over("cubic", knots, np.array([-1e-4, 0.0, 1e-4]), TURN)) / 1e-4
    assert slopes == pytest.approx([(np.sin(1 + h) - np.sin(1 - h)) / (2 * h)] * 2, rel=1e-3)
    (begins,) = np.diff(over("cubic", knots, np.array([0.0, 1e-4]))) / 1e-4
    assert begins == pytest.approx((np.sin(1 + h) - np.sin(1)) / h, rel=1e-3)


def test_stops_follow_and_slip_one_by_one() -> None:
    """Radii 1 and 3, heights 2 and 6: both give twice their travel until each is held at its height."""
    stops = [(1.0, 2.0), (3.0, 6.0)]
    path = np.array([5.0, 5.0, 5.5, 7.0, 11.0, 10.0, 9.0, 4.0, 4.5])
    first = [0.0, 0.0, 0.5, 1.0, 1.0, 0.0, -1.0, -1.0, -0.5]
    second = [0.0, 0.0, 0.5, 2.0, 3.0, 2.0, 1.0, -3.0, -2.5]
    expected = [2 * a + 2 * b for a, b in zip(first, second, strict=True)]
    assert over("stop", stops, path) == pytest.approx(expected)
    assert over("stop", stops, path, motor=1.0, of=1.0) == pytest.approx(np.zeros(9))


def test_a_closed_period_may_begin_anywhere_and_have_three_knots() -> None:
    """By hand: the parabola's slope across the ends is (-1 * 1 + 2 * 2) / (2 + 1) = 1, a chord's is 2."""
    for first in (0.0, 5.0, -0.75):
        knots = [(first, 0.0), (first + 1.0, 2.0), (first + 3.0, 0.0)]
        for turns in (0, -2, 1):
            start = first + 3.0 * turns
            before, at, behind = over("cubic", knots, start + np.array([-1e-4, 0.0, 1e-4]), 3.0)
            assert [(at - before) / 1e-4, (behind - at) / 1e-4] == pytest.approx([1.0, 1.0], abs=1e-3)
            top, middle = over("linear", knots, start + np.array([1.0, 2.0]), 3.0)
            assert (top, middle) == pytest.approx((2.0, 1.0))
        (begins,) = np.diff(over("cubic", knots, first + np.array([0.0, 1e-4]))) / 1e-4
        assert begins == pytest.approx(2.0, abs=1e-3)


def test_a_period_that_is_not_that_of_the_knots_has_chords_at_its_ends() -> None:
    knots = [(0.0, 0.0), (1.0, 2.0), (3.0, 0.0)]
    for period in (2.9, 3.1, 6.0):
        (begins,) = np.diff(over("cubic", knots, np.array([0.0, 1e-4]), period)) / 1e-4
        assert begins == pytest.approx(2.0, abs=1e-3)
    open_ends = [(0.0, 0.0), (1.0, 2.0), (3.0, 0.5)]
    (begins,) = np.diff(over("cubic", open_ends, np.array([0.0, 1e-4]), 3.0)) / 1e-4
    assert begins == pytest.approx(2.0, abs=1e-3)


def test_a_period_may_be_short() -> None:
    u = np.array([0.05, 0.55, 1.05, -0.45])
    assert over("linear", [(0.0, 1.0), (0.1, 3.0)], u, 0.5) == pytest.approx([2.0] * 4)
