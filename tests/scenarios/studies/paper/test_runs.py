"""Which commands each run of the paper gives, and which part of the log it keeps; benches answer by rule."""

from collections.abc import Callable
from dataclasses import replace
from math import ceil

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenarios.studies.paper import runs
from scenarios.studies.paper.measures import Log
from tests.scenarios.studies.paper.bench import StubBench, log_of

TURN = 360 * 3600 * 27 * 21 * 17 / 113 / 123 / 250
"""arcsec of the axis in a turn of the motor: 1 296 000 over the gear's ratio, 360.49."""


def ramp(loop: str, value: float, seconds: float) -> Log:
    """A log whose rate is the time in s, and whose effort is its half."""
    rows = np.arange(round(seconds * 100)) / 100
    return log_of(rows, seconds, rows / 2)


def at_rate(rate: float) -> Callable[[str, float, float], Log]:
    """Answers with one rate, arcsec/s, either way."""
    return lambda loop, value, seconds: log_of(np.copysign(rate, value), seconds, value)


def test_speeds_are_the_papers() -> None:
    assert runs.TRACKING == 15 and runs.LOW == 100 and runs.STEP_TO == 600
    assert runs.HIGH == (600, 700, 800, 900, 1000) and runs.OPENED == (600, 1000)
    assert runs.SLOW_SLEW == (3600, 2 * 3600, 3 * 3600)
    assert pytest.approx(TURN) == runs.MOTOR_TURN_ARCSEC
    assert sorted(runs.MAP_SPEEDS) == list(runs.MAP_SPEEDS) and len(runs.MAP_SPEEDS) == 23
    assert not any(speed % 5 for speed in runs.MAP_SPEEDS)  # round figures
    assert runs.MAP_SPEEDS[0] < runs.TRACKING and runs.MAP_SPEEDS[-1] == 7200


def test_tracking_discards_25_s_of_85() -> None:
    bench = StubBench(ramp)
    log = runs.tracking(bench)
    assert bench.asked == [("closed", 15.0, 85.0)]
    assert log.rate[0] == pytest.approx(25.0) and log.rate.size == 6000
    assert runs.tracking(bench, 3.0, 1.0).rate.size == 300


def test_the_opened_loop_gets_the_mean_effort_of_what_was_kept() -> None:
    """From 2 s to 5 s the effort rises from 1 to 2.5: its mean is 1.75."""
    bench = StubBench(ramp)
    closed, opened = runs.high_speed(bench, 700.0, 3.0, 2.0)
    assert bench.asked == [("closed", 700.0, 5.0), ("open", 2, 5.0)]
    assert closed.rate[0] == opened.rate[0] == pytest.approx(2.0)
    assert closed.rate.size == opened.rate.size == 300


class Axis:
    """Stands still below an effort; the loop needs another one."""

    def __init__(self, least: int, needed: float) -> None:
        self.least, self.needed = least, needed
        self.benches: list[StubBench] = []

    def __call__(self) -> StubBench:
        self.benches.append(StubBench(self.answer))
        return self.benches[-1]

    def answer(self, loop: str, value: float, seconds: float) -> Log:
        effort = value if loop == "open" else self.needed
        rows = np.where(np.arange(round(seconds * 100)) < 1200, 1e3, effort)  # discarded: 12 s
        return log_of(100.0 if effort >= self.least else 0.0, seconds, rows)

    def tried(self) -> list[float]:
        return [bench.asked[-1][1] for bench in self.benches[1:]]


def test_efforts_fall_until_the_axis_stays_put() -> None:
    axis = Axis(least=46, needed=48.2)
    closed, running = runs.low_speed(axis)
    assert axis.benches[0].asked == [("closed", 100.0, 72.0)]
    assert axis.benches[1].asked == [("closed", 140.0, 4.0), ("open", 48, 72.0)]
    assert closed.rate.size == 6000
    assert axis.tried() == [48, 47, 46, 45]
    assert [log.effort[0] for log in running] == [48, 47, 46] and running[0].rate.size == 6000


def test_efforts_rise_until_it_keeps_moving() -> None:
    axis = Axis(least=50, needed=48.0)
    running = runs.low_speed(axis)[1]
    assert axis.tried() == [48, 49, 50] and [log.effort[0] for log in running] == [50]


def test_ten_efforts_on_either_side_are_tried_at_most() -> None:
    for least, needed, expected in (
        (0, 48.0, range(48, 38, -1)),
        (99, 48.0, range(48, 58)),
        (0, 3.0, (3, 2, 1)),
    ):
        axis = Axis(least, needed)
        runs.low_speed(axis)
        assert axis.tried() == list(expected)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("speed", "settle_s", "at_least_s"),
    [
        (10.0, 10.0, 30.0),
        (29.0, 10.0, 30.0),
        (30.0, 6.0, 30.0),
        (1000.0, 6.0, 30.0),
        (1800.0, 6.0, 20.0),
        (7200.0, 6.0, 6.0),
    ],
)
def test_a_point_of_the_map_covers_whole_half_turns(
    speed: float, settle_s: float, at_least_s: float, sign: float
) -> None:
    """No less than 30 s, 10 degrees or 6 s."""
    half_s = TURN / speed / 2
    bench = StubBench(ramp)
    log = runs.map_run(bench, sign * speed)
    (loop, value, seconds), *_ = bench.asked
    assert (loop, value) == ("closed", sign * speed)
    assert seconds == pytest.approx(settle_s + half_s * ceil(at_least_s / half_s))
    assert log.rate[0] == pytest.approx(settle_s)


def test_there_and_back_lie_over_one_stretch() -> None:
    bench = StubBench(ramp)
    runs.map_pair(bench, 20.0)
    assert [(value, seconds) for _, value, seconds in bench.asked][1] == (20.0, 10.0)
    assert [value for _, value, _ in bench.asked] == [20.0, 20.0, -20.0]
    opened = StubBench(at_rate(600.0))
    there, back = runs.opened_pair(opened, 500.0, 30, -28)
    assert opened.asked == [
        ("closed", 500.0, 4.0), ("open", 30, 42.0), ("open", 30, 16.0),
        ("closed", -500.0, 4.0), ("open", -28, 42.0),
    ]  # fmt: skip
    assert there.effort[0] == 30 and back.effort[0] == -28


@given(st.floats(70.0, 5000.0), st.sampled_from([1.0, -1.0]))
def test_the_last_whole_half_turns_are_kept(speed: float, sign: float) -> None:
    """Of 30 s, as many as fit, less than a row apart; its end is the log's."""
    log = log_of(sign * speed, 30.0)
    kept = runs.last_half_turns(log)
    half_s = TURN / speed / 2
    whole = int(30.0 / half_s + 1e-9)
    assert kept.t_s[-1] == log.t_s[-1]
    assert kept.t_s.size == pytest.approx(whole * half_s * 100 if whole else 3000, abs=1.0)


def test_of_a_log_without_a_half_turn_all_is_kept() -> None:
    log = log_of(TURN / 2 / 10.1, 10.0)
    assert runs.last_half_turns(log) is log
    assert runs.last_half_turns(log_of(TURN / 2 / 9.9, 10.0)).t_s.size == pytest.approx(990, abs=1)


@pytest.mark.parametrize("way", [1, -1])
def test_the_effort_rises_until_the_axis_is_gone(way: int) -> None:
    """46 arcsec/s are 20.03 counts; the log of every step is kept, that of the last one, too."""
    bench = StubBench(
        lambda loop, effort, seconds: log_of(46.0 if abs(effort) > 3 else 45.9 * way, seconds, effort)
    )
    log = runs.break_away(bench, way)
    assert bench.asked == [("open", way * k, 0.2) for k in (1, 2, 3, 4)]
    assert log.effort.tolist() == [way * k for k in (1, 2, 3, 4) for _ in range(20)]
    assert runs.break_away(bench, way, 0.1).t_s.size == 40
    edge = StubBench(
        lambda loop, effort, seconds: replace(log_of(0.0), counts=np.full(100, 19.0 + abs(effort)))
    )
    runs.break_away(edge, way)
    assert len(edge.asked) == 2  # twenty counts are none too many


def test_an_axis_that_never_moves_gets_all_of_the_supply() -> None:
    bench = StubBench(lambda loop, effort, seconds: log_of(0.0, 0.01))
    runs.break_away(bench, 1)
    assert [asked[1] for asked in bench.asked] == list(range(1, 3001))
    empty = StubBench(lambda loop, effort, seconds: log_of(50.0, 0.01 if effort > 1 else 0.0))
    assert runs.break_away(empty, 1).t_s.size == 1


def test_a_run_down_begins_whole_rows_later() -> None:
    bench = StubBench(ramp)
    assert runs.run_down(bench).t_s.size == 150
    runs.run_down(bench, -2400.0, 0.25)
    later = round(0.25 * TURN / 2400 * 100) / 100
    assert bench.asked == [
        ("closed", 7200.0, 8.0), ("open", 0, 1.5),
        ("closed", -2400.0, pytest.approx(8.0 + later)), ("open", 0, 1.5),
    ]  # fmt: skip
