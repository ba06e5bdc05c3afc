"""What each run commands, by the words of the paper and arithmetic on its numbers."""

import numpy as np
import pytest

from scenarios.studies.paper import runs
from scenarios.studies.paper.measures import Log
from scenarios.studies.paper.runs import (
    MOTOR_TURN_ARCSEC,
    break_away,
    high_speed,
    last_half_turns,
    low_speed,
    map_pair,
    map_run,
    map_settle,
    opened_pair,
    opened_run,
    run_down,
    tracking,
)
from tests.studies.paper.commanded import Command, Commanded
from tests.studies.paper.synthetic import log_of

HALF_TURN = 360 * 3600 / (113 / 27 * 123 / 21 * 250 / 17) / 2  # arcsec of the axis: 1797.6


def span(log: Log) -> tuple[float, int]:
    return round(float(log.t_s[0]), 6), log.t_s.size


def test_speeds_are_those_of_the_paper() -> None:
    assert runs.TRACKING == 15 and runs.LOW == 100 and runs.STEP_TO == 600
    assert runs.HIGH == (600, 700, 800, 900, 1000) and runs.OPENED == (600, 1000)
    assert runs.SLOW_SLEW == (3600, 2 * 3600, 3 * 3600)
    assert pytest.approx(2 * HALF_TURN) == MOTOR_TURN_ARCSEC
    slowest, fastest = min(runs.MAP_SPEEDS), max(runs.MAP_SPEEDS)
    assert slowest < 15 and fastest == 7200
    assert sorted(set(runs.MAP_SPEEDS)) == list(runs.MAP_SPEEDS)
    assert not any(speed % 5 for speed in runs.MAP_SPEEDS)  # round numbers, as an operator sets them
    assert map_settle(slowest) > map_settle(fastest)


def test_tracking_discards_25_s_of_start_up_and_keeps_a_minute() -> None:
    bench = Commanded()
    assert span(tracking(bench)) == (25.0, 6000)
    assert span(tracking(Commanded(), 10.0, 4.0)) == (4.0, 1000)
    assert bench.commands == [("closed", 15.0, 85.0)]


def test_the_loop_is_opened_at_the_effort_that_had_held_the_speed() -> None:
    bench = Commanded()
    closed, opened = high_speed(bench, 604.0, 12.0, 4.0)
    assert bench.commands == [("closed", 604.0, 16.0), ("open", 60, 16.0)]
    assert span(closed) == (4.0, 1200) and span(opened) == (20.0, 1200)


def looked(least: float) -> tuple[list[float], list[Command], list[Log]]:
    """Efforts tried, all commands, and logs that ran, on axes that move from an effort on."""
    made: list[Commanded] = []

    def bench() -> Commanded:
        made.append(Commanded(lambda effort: 9.0 * effort if effort >= least else 0.0))
        return made[-1]

    closed, running = low_speed(bench)
    assert span(closed) == (12.0, 6000) and made[0].commands == [("closed", 100.0, 72.0)]
    trials = [each.commands for each in made[1:]]
    assert all(before == ("closed", 140.0, 4.0) for before, _ in trials)
    assert all(after[2] == 72.0 for _, after in trials)
    assert all(span(log) == (16.0, 6000) for log in running)
    return [after[1] for _, after in trials], made[0].commands, running


def test_the_lowest_speed_is_looked_for_downwards_until_the_axis_stays_put() -> None:
    tried, _, running = looked(8.0)
    assert tried == [10, 9, 8, 7]
    assert [float(log.effort[0]) for log in running] == [10, 9, 8]


def test_the_lowest_speed_is_looked_for_upwards_until_the_axis_moves() -> None:
    tried, _, running = looked(12.0)
    assert tried == [10, 11, 12]
    assert [float(log.effort[0]) for log in running] == [12]


def test_the_search_ends_where_it_finds_nothing() -> None:
    assert looked(0.5)[0] == [10, 9, 8, 7, 6, 5, 4, 3, 2, 1]  # no effort is none at all
    assert looked(1000.0)[0] == list(range(10, 20))


@pytest.mark.parametrize(
    ("setpoint", "settle", "least"),
    [(10.0, 10.0, 30.0), (-29.9, 10.0, 30.0), (30.0, 6.0, 30.0), (-2400.0, 6.0, 15.0), (7200.0, 6.0, 6.0)],
)
def test_a_point_of_the_map_is_whole_half_turns_of_the_motor(
    setpoint: float, settle: float, least: float
) -> None:
    """At least 30 s, but no more than 10 degrees, and 6 s."""
    assert map_settle(setpoint) == settle
    bench = Commanded()
    map_run(bench, setpoint)
    ((_, at, seconds),) = bench.commands
    halves = (seconds - settle) * abs(setpoint) / HALF_TURN
    assert at == setpoint and halves == pytest.approx(round(halves), abs=1e-4)
    assert least <= seconds - settle < least + HALF_TURN / abs(setpoint)


def test_there_goes_on_for_as_long_as_back_settles() -> None:
    bench = Commanded()
    there, back = map_pair(bench, 1000.0)
    long = 6.0 + 17 * HALF_TURN / 1000.0  # 30.6 s: 30 s at least
    assert [each[:2] for each in bench.commands] == [
        ("closed", 1000.0),
        ("closed", 1000.0),
        ("closed", -1000.0),
    ]
    assert [each[2] for each in bench.commands] == pytest.approx([long, 6.0, long], abs=1e-5)
    assert there.rate.mean() == pytest.approx(1000.0) and back.rate.mean() == pytest.approx(-1000.0)


def test_an_opened_pair_goes_back_over_the_same_stretch() -> None:
    bench = Commanded()
    opened_pair(bench, 500.0, 40, -41)
    there, settle = [("closed", 500.0, 4.0), ("open", 40, 42.0)], [("open", 40, 16.0)]
    assert bench.commands == [*there, *settle, ("closed", -500.0, 4.0), ("open", -41, 42.0)]
    log = opened_run(Commanded(), 500.0, 40)
    assert log.t_s[-1] == pytest.approx(45.99) and log.t_s[0] >= 16.0
    assert log.t_s.size * 4.0 == pytest.approx(6 * HALF_TURN, abs=4.0)  # 400 arcsec/s: 6.7 of them in 30 s


def test_less_than_half_a_turn_is_kept_as_it_is_and_half_a_turn_is_cut() -> None:
    rate = HALF_TURN  # half a turn a second
    for samples, kept in ((99, 99), (101, 100), (249, 200), (-149, 100)):
        log = log_of(np.full(abs(samples), np.sign(samples) * rate * 1.0001))
        assert last_half_turns(log).t_s.size == kept


@pytest.mark.parametrize("way", [1, -1])
def test_the_effort_rises_step_by_step_until_the_axis_is_gone(way: int) -> None:
    bench = Commanded(lambda effort: 45.9 * np.sign(effort) if abs(effort) < 4 else 46.0 * np.sign(effort))
    log = break_away(bench, way)
    assert bench.commands == [("open", way * effort, 0.2) for effort in (1, 2, 3, 4)]
    assert span(log) == (0.0, 80) and log.effort[-1] == 4 * way
    assert break_away(Commanded(), way, 0.3).t_s.size == 5 * 30  # 50 arcsec/s are more than 46


def test_an_axis_that_never_breaks_away_gets_the_whole_supply() -> None:
    bench = Commanded(lambda _: 0.0)
    assert break_away(bench, 1, 0.0).t_s.size == 0
    assert bench.commands[0][1] == 1 and bench.commands[-1][1] == 3000


@pytest.mark.parametrize(("setpoint", "turns", "later"), [(7200.0, 0.0, 0.0), (-2400.0, 0.25, 0.37)])
def test_a_run_down_is_commanded_a_quarter_turn_later_in_whole_rows(
    setpoint: float, turns: float, later: float
) -> None:
    bench = Commanded()
    assert run_down(bench, setpoint, turns).t_s.size == 150
    assert bench.commands == [("closed", setpoint, 8.0 + later), ("open", 0, 1.5)]
    assert later == pytest.approx(turns * 2 * HALF_TURN / abs(setpoint), abs=0.005)


def test_a_run_down_is_from_2_degrees_a_second_by_itself() -> None:
    bench = Commanded()
    run_down(bench)
    assert bench.commands[0] == ("closed", 7200.0, 8.0)
