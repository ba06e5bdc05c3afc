"""Steps of a delay's search on a force that is one sine: what is left of it, in which part, and its error."""

import numpy as np
import pytest

from calibration.names.lateness import _converge, _everywhere, _left, _rate, _step
from calibration.names.scene import Scene
from tests.calibration.names.made import PERIOD_S, drive

ROWS = 1000
T = PERIOD_S * np.arange(ROWS)
WAVE, RATE = np.sin(2 * np.pi * T), 2 * np.pi * np.cos(2 * np.pi * T)  # whole periods in each of five parts
NONE = np.zeros((ROWS, 0))


def force(size: np.ndarray | float = 1.0, held: np.ndarray | None = None) -> Scene:
    """The declared term is `size` (n,) times the sine."""
    return drive(WAVE, base=(size * WAVE)[:, None], held=held)


def late(parts: tuple[float, ...], size: np.ndarray | float = 1.0) -> np.ndarray:
    """4 N of it, late by as many s in each part, to first order."""
    return np.asarray(4.0 * size * (WAVE - np.repeat(parts, ROWS // 5) * RATE))


@pytest.mark.parametrize(("off", "same"), [(0.0, True), (0.0038, True), (0.0040, False)])
def test_a_delay_is_one_that_scatters_by_a_third_over_the_log(off: float, same: bool) -> None:
    """Two parts more, two parts less: the deviation is 0.89 of it, of a delay of 10 ms, against 0.35."""
    y = late((off, -off, off, -off, 0.0))
    assert _everywhere(force(), y, 0.01, NONE) is same
    assert _everywhere(force(), y, -0.01, NONE) is same


@pytest.mark.parametrize(("last", "same"), [(-0.0098, True), (-0.0102, False)])
def test_a_delay_is_late_everywhere_or_early_everywhere(last: float, same: bool) -> None:
    y = late((-0.009, -0.009, -0.009, -0.009, last))
    assert _everywhere(force(), y, 0.01, NONE) is same
    assert _everywhere(force(), late((0.009, 0.009, 0.009, 0.009, -last)), -0.01, NONE) is same


@pytest.mark.parametrize(("part", "same"), [(0.2, True), (0.4, False)])
def test_a_part_in_which_little_moves_says_nothing(part: float, same: bool) -> None:
    """A tenth of the mean weight, which goes with the square: 0.04 of it or 0.16."""
    size = np.repeat([1.0, 1.0, 1.0, 1.0, part], ROWS // 5)
    assert _everywhere(force(size), late((0.0, 0.0, 0.0, 0.0, -0.05), size), 0.01, NONE) is same


def test_what_other_terms_explain_is_no_delay() -> None:
    """In the last part a term has just what a delay would add."""
    other = np.where(np.arange(ROWS) >= 800, RATE, 0.0)[:, None]
    y = late((0.0, 0.0, 0.0, 0.0, -0.05))
    assert not _everywhere(force(), y, 0.01, NONE) and _everywhere(force(), y, 0.01, other)


@pytest.mark.parametrize("delay", [0.004, -0.002])
def test_a_step_is_what_is_left_of_the_delay_with_its_error(delay: float) -> None:
    noise = 0.1 * np.random.default_rng(1).standard_normal(ROWS)
    s = force()
    s.problem.block_s = 0.5  # twenty blocks tell an error to a sixth
    found, error = _step(s, late((delay,) * 5), NONE)
    assert found == pytest.approx(delay, rel=1e-3)  # a difference over two rows is a little less
    _, error = _step(s, late((delay,) * 5) + noise, NONE)
    assert error == pytest.approx(0.1 / np.linalg.norm(4.0 * RATE), rel=0.3)


@pytest.mark.parametrize("delay", [0.1, -0.18])
def test_the_search_ends_where_the_sine_is_in_step(delay: float) -> None:
    def moved(by: float) -> np.ndarray:
        return np.asarray(4.0 * np.sin(2 * np.pi * (T - delay + by)))

    found, error = _converge(force(), moved, NONE)
    assert found == pytest.approx(delay, abs=1e-6) and error < 1e-4


def test_a_rate_is_per_second_and_none_where_a_file_begins() -> None:
    files = np.repeat([0, 1], 50)
    s = drive(WAVE[:100], files=files)
    rate = _rate(s, np.where(files == 0, 3.0, 5.0) * T[:100])
    assert rate[50] == 0.0 and rate[:49] == pytest.approx(3.0) and rate[51:] == pytest.approx(5.0)


@pytest.mark.parametrize(("count", "left"), [(20, 1.0), (21, 3.0)])
def test_what_is_left_is_looked_at_on_rows_that_are_held_out(count: int, left: float) -> None:
    """Fewer than that say too little."""
    held = np.arange(ROWS) < count
    y = np.where(held, 3.0, 1.0) * np.where(np.arange(ROWS) % 2, 1.0, -1.0)
    assert _left(force(held=held), y, NONE) == pytest.approx(left, rel=0.01)
