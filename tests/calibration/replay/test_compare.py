"""Rows of a replayed run that are compared, and how far it is off, by hand."""

from typing import Any

import numpy as np
import pytest

from calibration.replay.compare import breaking, comparable, errors, residual
from calibration.replay.trace import Trace
from tests.calibration.replay.frames import ARCSEC, PERIOD_S, frame

NAN = float("nan")
WHOLE = np.ones(400, dtype=bool)


def rows(*stretches: tuple[int, int]) -> list[int]:
    return [k for a, b in stretches for k in range(a, b)]


def settled(**columns: Any) -> list[int]:
    return np.flatnonzero(comparable(frame(400, **columns), WHOLE)).tolist()


def step(at: int, size: float) -> np.ndarray:
    return np.where(np.arange(400) >= at, size, 0.0)


def test_a_second_behind_the_start_and_a_jump_and_two_rows_before_it_are_left_out() -> None:
    assert settled() == rows((101, 400))
    assert settled(setpoint=step(200, 10.1 * ARCSEC)) == rows((101, 198), (301, 400))
    assert settled(setpoint=step(200, -10.1 * ARCSEC)) == rows((101, 198), (301, 400))
    assert settled(setpoint=step(200, 9.9 * ARCSEC)) == rows((101, 400))
    assert settled(effort=step(200, 0.5)) == rows((101, 400))  # a closed loop is led by its set point


def test_an_open_loop_is_led_by_its_effort() -> None:
    open_loop = np.full(400, NAN)
    assert settled(setpoint=open_loop, effort=step(200, 0.021)) == rows((101, 198), (301, 400))
    assert settled(setpoint=open_loop, effort=step(200, 0.019)) == rows((101, 400))


def test_a_gap_is_a_start() -> None:
    gap = frame(400, missing=(200, 201), setpoint=np.full(400, 0.5))
    found = np.flatnonzero(comparable(gap, WHOLE)).tolist()
    assert found == rows((101, 198), (303, 400))


def test_only_the_runs_own_rows_count() -> None:
    two = frame(150, 250)
    assert np.flatnonzero(comparable(two, two.run == 1)).tolist() == rows((101, 250))


def test_a_break_away_is_a_passage_through_the_stribeck_speed() -> None:
    """At rest until row 500, then 20 arcsec a row; the speed is taken over ten rows."""
    x = 20.0 * np.maximum(np.arange(1000) - 500.0, 0.0)
    quick = 20.0 * ARCSEC / PERIOD_S
    for way in (1.0, -1.0):
        # of ten rows, six have moved at row 501
        near = breaking(way * x + 7.0, PERIOD_S, 0.55 * quick)
        assert np.flatnonzero(near).tolist() == rows((401, 602))
    holes = x.copy()
    holes[[100, 503, 700]] = NAN
    assert np.flatnonzero(breaking(holes, PERIOD_S, 0.55 * quick)).tolist() == rows((401, 602))
    assert not breaking(x, PERIOD_S, 1.01 * quick).any()
    assert np.flatnonzero(breaking(x[:520], PERIOD_S, 0.55 * quick)).tolist()[:1] == [401]
    assert len(breaking(x[:520], PERIOD_S, 0.55 * quick)) == 520


def trace(**columns: list[float]) -> Trace:
    n = len(next(iter(columns.values())))
    given = {name: np.zeros(n) for name in ("torque", "velocity", "position")}
    return Trace(**given | {name: np.array(x) for name, x in columns.items()})


def test_positions_are_compared_about_their_mean_between_transients() -> None:
    log = trace(position=[0.0, 0.0, 0.0, 0.0, 0.0, NAN, 0.0])
    model = trace(position=[1.0, 3.0, 9.0, 5.0, 6.0, 0.0, 10.0])
    use = np.array([True, True, False, True, True, True, True])
    assert residual("position", log, model, use).tolist() == [-1.0, 1.0, -2.0, -1.0, 3.0]
    nothing = trace(position=[NAN, NAN, 0.0, 1.0, 1.0, 1.0, 1.0])
    assert residual("position", nothing, model, use).tolist() == [-0.25, 0.75, -5.25, 4.75]
    speeds = trace(velocity=[1.0, 2.0, NAN]), trace(velocity=[4.0, 1.0, 7.0])
    assert residual("velocity", *speeds, np.array([True, True, True])).tolist() == [3.0, -1.0]


def test_an_error_has_the_floor_of_both_traces_noise() -> None:
    """Up and down by a, the fourth difference is 16 a; of white noise it has sqrt(70) times its size."""
    up = np.resize([1.0, -1.0], 60)
    log, model = trace(torque=list(0.5 * up)), trace(torque=list(2.0 * up + 1.0))
    use = np.ones(60, dtype=bool)
    found = errors([(log, model, use)])
    noise = [16 / np.sqrt(70) * size for size in (0.5, 2.0)]
    off, floor = found["torque"]
    assert off == pytest.approx(np.sqrt(1.5**2 + 1.0)) and floor == pytest.approx(np.hypot(*noise))
    assert found["velocity"] == found["position"] == (0.0, 0.0)
    quiet = trace(torque=list(np.ones(120))), trace(torque=list(np.zeros(120))), np.ones(120, dtype=bool)
    off, floor = errors([(log, model, use), quiet])["torque"]
    assert off == pytest.approx(np.sqrt((60 * 3.25 + 120) / 180))
    assert floor == pytest.approx(np.hypot(*noise) * np.sqrt(60 / 180))
    assert errors([(log, model, np.arange(60) < 49)]) == {}
    assert set(errors([(log, model, np.arange(60) < 50)])) == {"torque", "velocity", "position"}
