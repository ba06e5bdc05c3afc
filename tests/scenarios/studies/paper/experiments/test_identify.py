"""The identified model against closed formulas, and the steps that are commanded for it."""

import numpy as np
import pytest

from scenarios.studies.paper.experiments import identify
from scenarios.studies.paper.experiments.identify import FirstOrder, SecondOrder, averaged_step, first_order
from scenarios.studies.paper.measures import Array, Log
from scenarios.studies.paper.scales import COUNT_RATE
from tests.scenarios.studies.paper.bench import StubBench, log_of, near

T: Array = np.asarray(np.arange(100) * 0.01, dtype=np.float64)
HALF_TURN = 360 * 3600 * 27 * 21 * 17 / 113 / 123 / 250 / 2


def test_a_response_with_little_damping_is_the_textbook_s() -> None:
    """1 - exp(-z w t) (cos(p t) + z w / p sin(p t)), p = w sqrt(1 - z^2), after the dead time."""
    z, w, late = 0.4, 20.0, 0.03
    p, t = w * np.sqrt(1.0 - z * z), np.maximum(0.0, T - late)
    expected = 2.0 * (1.0 - np.exp(-z * w * t) * (np.cos(p * t) + z * w / p * np.sin(p * t)))
    assert SecondOrder(2.0, w, z, late).response(T) == pytest.approx(expected)


def test_a_response_with_much_damping_has_two_lags() -> None:
    """Poles at -5 and -20 1/s: w = 10 rad/s, z = 1.25."""
    expected = 1.0 - (20.0 * np.exp(-5.0 * T) - 5.0 * np.exp(-20.0 * T)) / 15.0
    assert SecondOrder(1.0, 10.0, 1.25, 0.0).response(T) == pytest.approx(expected)


def test_a_response_of_equal_poles_is_their_limit() -> None:
    expected = 1.0 - (1.0 + 10.0 * T) * np.exp(-10.0 * T)
    assert SecondOrder(1.0, 10.0, 1.0, 0.0).response(T) == pytest.approx(expected, abs=1e-4)


@pytest.mark.parametrize(
    ("gain", "frequency", "damping", "dead_s"), [(0.3, 12.0, 0.4, 0.004), (2.0, 40.0, 2.0, 0.02)]
)
def test_samples_give_the_model_back(gain: float, frequency: float, damping: float, dead_s: float) -> None:
    truth = SecondOrder(gain, frequency, damping, dead_s)
    found = identify.second_order(T, truth.response(T))
    assert found.response(T) == pytest.approx(truth.response(T), abs=2e-3 * gain)


@pytest.mark.parametrize(("lag_s", "dead_s"), [(0.1, 0.02), (0.04, 0.005)])
def test_a_first_order_of_a_first_order_is_itself(lag_s: float, dead_s: float) -> None:
    """Of two lags, one a hundredth of the other: the slower one, and the dead time with the quick one."""
    quick = lag_s / 100.0
    w = 1.0 / np.sqrt(lag_s * quick)
    found = first_order(SecondOrder(1.9, w, (lag_s + quick) * w / 2.0, dead_s))
    assert found.gain == pytest.approx(1.9, rel=1e-3)
    assert found.lag_s == pytest.approx(lag_s, rel=0.01)
    assert found.dead_s == pytest.approx(dead_s + quick, abs=0.05 * quick)


def test_the_fit_knows_when_rows_are_taken_and_how_long_an_effort_is_held() -> None:
    """The first row is 2.5 ms old on average; the loop holds an effort for 5 ms, 2.5 ms of dead time."""
    t = T + 0.0025
    response = 1.5 * (1.0 - np.exp(-np.maximum(0.0, t - 0.012) / 0.08))
    found = identify.fit(response)
    assert found.gain == pytest.approx(1.5, rel=0.01)
    assert found.lag_s == pytest.approx(0.08, rel=0.06)
    assert found.dead_s + found.lag_s == pytest.approx(0.012 + 0.0025 + 0.08, abs=0.0025)


class Steps:
    """An axis of two counts per step of effort less an offset, at once or after a delay of rows. The first
    row of a new effort still shows the old one, as a log does."""

    def __init__(self, effort: float, slow: int = 0) -> None:
        self.effort, self.slow, self.before = effort, slow, effort
        self.bench = StubBench(self.answer)

    def counts(self, effort: float) -> float:
        return 2.0 * effort - 20.0

    def answer(self, loop: str, value: float, seconds: float) -> Log:
        new = self.effort if loop == "closed" else value
        rows = np.arange(int(seconds * 100 + 1e-6))
        shown = np.where(rows < 1, self.before, new)
        counts = np.where(rows < 1 + self.slow, self.counts(self.before), self.counts(new))
        if loop == "closed":
            shown = np.where(rows < 300, 1e3, new)  # the start-up, discarded
        self.before = new
        return log_of(counts * COUNT_RATE, rows.size / 100, shown)


def test_steps_go_up_and_down_by_multiples_of_ten() -> None:
    """About 0.15 of the effort, and of 140.4 that is two times ten; no less than ten of a small one."""
    for effort, low, high in ((140.4, 140, 160), (30.0, 30, 40)):
        axis = Steps(effort)
        response = averaged_step(lambda axis=axis: axis.bench)  # type: ignore[misc]
        assert response == pytest.approx(np.full(100, 2.0))
        assert axis.bench.asked[:2] == [("closed", 600.0, 6.0), ("open", low, 6.0)]
        assert [value for _, value, _ in axis.bench.asked[2:]] == [high, low] * 10


def test_a_response_begins_where_the_effort_shows() -> None:
    response = averaged_step(lambda: Steps(140.0, slow=3).bench)
    assert response.tolist() == pytest.approx([0.0] * 3 + [2.0] * 97)


def test_steps_lie_11_twentieths_of_half_a_turn_apart() -> None:
    """Each way ten phases of the motor's half turn; a step up comes half a row after whole rows."""
    axis = Steps(140.0)
    averaged_step(lambda: axis.bench)
    apart = HALF_TURN * 1.1 / 2.0
    place = 0.0
    for k, (_, effort, seconds) in enumerate(axis.bench.asked[2:], 1):
        place += axis.counts(effort) * COUNT_RATE * seconds
        assert place == pytest.approx(k * apart, abs=axis.counts(160.0) * COUNT_RATE * 0.05)
        assert (
            seconds * 100 % 1 == pytest.approx(0.0 if k % 2 else 0.5, abs=1e-6) or seconds * 100 % 1 > 0.999
        )
        assert seconds >= 1.3


def test_a_quick_axis_still_has_rows_for_response_and_baseline() -> None:
    axis = Steps(900.0)
    averaged_step(lambda: axis.bench)
    assert min(seconds for _, _, seconds in axis.bench.asked[2:]) == pytest.approx(1.3)


def test_a_log_without_its_step_is_an_error() -> None:
    bench = StubBench(lambda loop, value, seconds: log_of(600.0, seconds, 50.0))
    with pytest.raises(ValueError, match=r"^the log does not show the step to an effort of 60$"):
        averaged_step(lambda: bench)


def test_an_axis_that_no_effort_keeps_going_has_no_steps() -> None:
    bench = StubBench(lambda loop, value, seconds: log_of(600.0, seconds, 0.0))
    with pytest.raises(ValueError, match=r"^no effort keeps the speed"):
        averaged_step(lambda: bench)


def test_identify_fits_what_the_steps_gave(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(identify, "fit", lambda response: FirstOrder(float(response[-1]), 1.0, 2.0))
    assert identify.identify(lambda: Steps(140.0).bench) == FirstOrder(near(2.0), 1.0, 2.0)
