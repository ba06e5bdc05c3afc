"""Gains of a loop whose effort is made of them: exact where it is one loop, none where it is none."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from calibration.balances.frame import Frame
from calibration.balances.thresholds import AT_LIMIT
from calibration.replay.gains import Gains, identify
from tests.calibration.replay.frames import ARCSEC, PERIOD_S, frame

LAG = 25  # rows: a quarter of a second
WINDOW_S, COUNT = 0.005, 0.0115 * ARCSEC
RNG = np.random.default_rng(2)
SPEED = 400.0 * ARCSEC


def loop(*runs: int, kp: float = 3.0, ki: float = 0.5, roller: float = 0.0, change: float = 0.0) -> Frame:
    """Effort = kp e + ki (sum of the set points - way) in counts, and 700 steps of friction."""
    n = sum(runs)
    position = SPEED * PERIOD_S * np.arange(n) + 3 * COUNT * RNG.standard_normal(n)
    velocity = SPEED + 5 * COUNT / WINDOW_S * RNG.standard_normal(n)
    setpoint = SPEED + np.where(np.arange(n) >= 400, change, 0.0)
    e = (setpoint - velocity) * WINDOW_S / COUNT
    way = (np.cumsum(setpoint) * PERIOD_S - (1 + roller) * position) / COUNT
    effort = (700.0 + kp * e + ki * way) / 3000.0
    return frame(*runs, setpoint=setpoint, velocity=velocity, position=position, effort=effort)


def found(f: Frame, rows: np.ndarray | None = None) -> Gains | None:
    return identify(f, np.ones(len(f.t), dtype=bool) if rows is None else rows)


@pytest.mark.parametrize(
    ("kp", "ki", "roller"), [(3.0, 0.5, 0.0), (99.0, 0.5, 0.0), (0.5, 99.0, 0.0), (3.0, 0.5, 1e-3)]
)
def test_gains_are_those_the_effort_is_made_of(kp: float, ki: float, roller: float) -> None:
    f = loop(800, kp=kp, ki=ki, roller=roller)
    f.columns["effort"] -= np.nanmean(f.columns["effort"]) - 0.1  # the loop is at no limit
    small = np.abs(f.columns["effort"]).max() / (0.5 * AT_LIMIT)
    f.columns["effort"] /= max(small, 1.0)
    f.scale["effort_full_scale"] *= max(small, 1.0)
    got = found(f)
    assert got is not None and [got.kp, got.ki] == pytest.approx([kp, ki], rel=1e-6)


@pytest.mark.parametrize(("kp", "ki"), [(-3.0, 0.5), (3.0, -0.5)])
def test_gains_of_no_stable_loop_are_none(kp: float, ki: float) -> None:
    assert found(loop(800, kp=kp, ki=ki)) is None


def test_five_hundred_rows_with_one_behind_them_tell() -> None:
    assert found(loop(500 + LAG)) is not None and found(loop(499 + LAG)) is None
    two = loop(400, 1000)
    assert found(two, two.run == 0) is None and found(two, two.run == 1) is not None
    both = loop(250 + LAG, 250 + LAG)
    assert found(both) is not None  # over the edge of a run nothing is compared
    assert found(loop(250 + LAG, 249 + LAG)) is None


def without(name: str, at: Any, value: float, rows: int = 500 + LAG + 60) -> Gains | None:
    f = loop(rows)
    f.columns[name][at] = value
    return found(f)


def test_rows_at_a_limit_at_rest_or_without_a_number_and_those_behind_them_are_left_out() -> None:
    for name, value in (("effort", 1.0), ("effort", -1.0), ("position", np.nan), ("velocity", np.nan)):
        wide = slice(100, 107)  # too many to be bridged
        got = without(name, wide, value)
        assert got is not None and got.kp == pytest.approx(3.0), (name, value)
        assert without(name, wide, value, 500 + LAG + 7) is None, (name, value)
    assert without("effort", slice(100, 200), 0.0) is None
    rested = without("effort", slice(100, 120), 0.0)
    assert rested is not None


def test_rows_of_another_mode_or_a_new_set_point_are_left_out() -> None:
    f = loop(1000)
    f.columns["effort"][300:500] += 0.2
    got = found(f)
    assert got is not None and [got.kp, got.ki] == pytest.approx([3.0, 0.5], rel=1e-3)
    for change, told in ((0.6, 400 + 600 - 25), (0.4, 1000)):  # of a count: less is the same set point
        f = loop(1000, change=change * COUNT / WINDOW_S)
        f.columns["effort"][400:] += 0.001 * np.sign(change)
        got = found(f, np.arange(1000) < told)
        assert got is not None and got.kp == pytest.approx(3.0, rel=1e-3)


def test_without_a_set_point_or_a_velocity_there_is_no_loop() -> None:
    f = loop(800)
    for name in ("setpoint", "velocity"):
        assert found(replace(f, columns=f.columns | {name: np.full(800, np.nan)})) is None
