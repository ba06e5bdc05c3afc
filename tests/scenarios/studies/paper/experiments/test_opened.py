"""Rows of the opened loop on made-up records: peaks without drifts, the staircase, the slow line."""

import numpy as np
import pytest

from scenarios.studies.paper.experiments import opened
from scenarios.studies.paper.measures import Array, Log
from tests.scenarios.studies.paper.bench import StubBench, benches, log_of

TURN = 1_296_000 * 27 * 21 * 17 / 113 / 123 / 250
"""arcsec of the axis in a turn of the motor."""


def swing(seconds: float, hertz: float, size: float) -> Array:
    t = np.arange(round(seconds * 100)) / 100
    return np.asarray(size * np.sin(2 * np.pi * hertz * t))


def test_a_peak_is_that_of_quick_errors_but_for_five_seconds_at_both_ends() -> None:
    rate = 600.0 + swing(60.0, 1.0, 30.0)
    assert opened.fast_peak(rate, 600.0) == pytest.approx(5.0, rel=0.15)  # what is left of the ends
    assert opened.fast_peak(600.0 + swing(400.0, 0.005, 30.0), 600.0) < 0.1
    corner = opened.fast_peak(swing(1000.0, 0.05, 100.0)[: 100 * 1000], 100.0)
    assert corner == pytest.approx(50.0, rel=0.1)  # forth and back: half of it at the corner
    edges = np.zeros(6000)
    edges[:490] = edges[-490:] = 100.0
    edges[200] = edges[-200] = 1e4
    assert opened.fast_peak(edges, 100.0) < opened.fast_peak(np.roll(edges, 3000), 100.0) / 3


def test_E5_is_the_larger_peak_of_two_speeds_and_their_ratio() -> None:
    """Closed 2 % and 3 %, opened 8 % and 6 %, over 70 s after 4 s."""
    asked: list[tuple[str, float, float]] = []

    def answer(loop: str, value: float, seconds: float) -> Log:
        asked.append((loop, value, seconds))
        speed = value if loop == "closed" else value * 10.0
        percent = {
            ("closed", 600.0): 2.0,
            ("closed", 1000.0): 3.0,
            ("open", 600.0): 8.0,
            ("open", 1000.0): 6.0,
        }
        rate = speed * (1.0 + swing(seconds, 2.0, percent[loop, speed] / 100.0))
        rate[:399] = 1e6
        return log_of(rate, seconds, effort=speed / 10.0)

    found = opened.higher_speeds.measure(benches(answer))
    assert asked == [(loop, speed / (10 if loop == "open" else 1), 74.0)
                     for speed in (600.0, 1000.0) for loop in ("closed", "open")]  # fmt: skip
    expected = {"peak 600": 8.0, "peak 1000": 6.0, "closed": 3.0, "ratio": 8.0 / 3.0}
    assert found == {k: pytest.approx(v, rel=0.16) for k, v in expected.items()}
    assert found["ratio"] == pytest.approx(8.0 / 3.0) == found["peak 600"] / found["closed"]


class Slow:
    """Two arcsec/s per step of effort, a slow line of three cycles a motor turn; below 45 steps it stands.

    stuck: an effort at which it stands still, too.
    """

    def __init__(self, stuck: int = 0) -> None:
        self.stuck = stuck
        self.asked: list[tuple[str, float, float]] = []

    def line_hz(self, rate: float) -> float:
        return 3.0 * rate / TURN

    def __call__(self, loop: str, value: float, seconds: float) -> Log:
        self.asked.append((loop, value, seconds))
        if loop == "closed":
            return log_of(100.0 + swing(seconds, self.line_hz(94.0), 1.0), seconds, effort=47.0)
        if value < 45 or value == self.stuck:
            return log_of(0.0, seconds, effort=value)
        rate = 2.0 * value
        return log_of(rate + swing(seconds, self.line_hz(rate), 8.0), seconds, effort=value)


def test_E6_looks_at_the_run_that_is_nearest_to_the_loop_s_speed() -> None:
    """Efforts of 47, 46 and 45 keep it running; 47 is nearest to 100 arcsec/s. One more is run again."""
    axis = Slow()
    found = opened.slowest.measure(benches(axis))
    assert axis.asked[-2:] == [("closed", 140.0, 4.0), ("open", 48.0, 72.0)]
    assert found["line"] == pytest.approx(3.0 * 94.0 / TURN, abs=0.002)
    assert found["mean"] == pytest.approx(94.0, abs=0.5)
    assert found["nearest"] == pytest.approx(abs(found["mean"] - 100.0))
    assert found["lowest"] == pytest.approx(90.0, abs=0.5)
    assert found["amplitude"] == pytest.approx(8.0, rel=0.05)
    assert found["left"] == pytest.approx(1.0 / 8.0, rel=0.1)
    assert found["narrower"] == pytest.approx(8.0 / 94.0 * 100 - 1.0, abs=0.7)
    assert found["order a step up"] == pytest.approx(1.0, abs=0.05)  # the line turns with the motor
    assert found["speed a step up"] == pytest.approx(96.0, abs=0.5)


def test_E6_has_no_order_of_an_axis_that_stands_still_and_no_figures_without_a_run() -> None:
    found = opened.slowest.measure(benches(Slow(stuck=48)))
    assert np.isnan(found["order a step up"]) and found["speed a step up"] == 0.0
    assert opened.slowest.measure(benches(lambda loop, value, seconds: log_of(0.0, seconds, 40.0))) == {}


def test_an_order_is_cycles_per_motor_turn() -> None:
    log = log_of(100.0 + swing(60.0, 0.1, 5.0), 60.0)
    assert opened.order(log) == pytest.approx(0.1 * TURN / 100.0, rel=0.03)
    slow = log_of(0.5 + swing(60.0, 0.1, 5.0), 60.0)
    assert opened.order(slow) == pytest.approx(0.1 * TURN, rel=0.03)
    assert isinstance(benches(lambda *_: log)("low"), StubBench)
