"""The torque-velocity map on benches that are arithmetic: noise, steady states, closed and opened loop."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenarios.studies.paper.experiments import friction
from scenarios.studies.paper.experiments.friction import Noise
from scenarios.studies.paper.friction_map import FrictionFit, MapPoint
from scenarios.studies.paper.measures import Log
from scenarios.studies.paper.runs import MAP_SPEEDS
from scenarios.studies.paper.scales import ADC_A_PER_COUNT, ARCSEC, GEAR_RATIO, drive
from scenarios.studies.paper.starts import Benches
from tests.scenarios.studies.paper.bench import LOW, StubBench, benches, log_of

FIT = FrictionFit(200.0, 600.0, 4e-4, 1.0, 7000.0)
QUIET = Noise(1, "test", constant_error=0.0)


def counted(log: Log, a: float, b: float) -> Log:
    """The log with these counts of the converter."""
    return replace(log, adc_a=np.full(log.t_s.size, a), adc_b=np.full(log.t_s.size, b))


@settings(max_examples=20)
@given(st.integers(0, 1000), st.floats(0.0, 0.5))
def test_the_torque_constant_is_off_by_no_more_than_its_share(seed: int, share: float) -> None:
    one, twice = Noise(seed, "x", share).constant, Noise(seed, "x", 2.0 * share).constant
    assert abs(one - 1.0) <= share
    assert twice - 1.0 == pytest.approx(2.0 * (one - 1.0))
    assert Noise(seed, "x").constant == Noise(seed, "x", 0.05).constant


def test_its_errors_are_even_between_both_ends() -> None:
    off = np.array([Noise(seed, "x").constant for seed in range(300)]) / 0.05 - 1.0 / 0.05
    assert off.mean() == pytest.approx(0.0, abs=0.1) and off.std() == pytest.approx(3.0**-0.5, abs=0.05)
    sheet = drive(LOW)
    noise = Noise(3, "x")
    assert noise.sheet(sheet) == replace(sheet, torque_constant=sheet.torque_constant * noise.constant)


@pytest.mark.parametrize(("counts", "rms"), [(500.0, np.hypot(5.0, 1.0)), (20.0, np.hypot(0.2, 1.0))])
def test_noise_is_a_hundredth_of_the_reading_beside_a_count(counts: float, rms: float) -> None:
    log = Noise(1, "x").log(counted(log_of(0.0, 200.0), counts, counts))
    for read in (log.adc_a, log.adc_b):
        assert read.mean() == pytest.approx(counts, abs=0.15)
        assert read.std() == pytest.approx(np.hypot(rms, 12**-0.5), rel=0.02)  # rounded, too
        assert not np.any(read % 1.0)
    assert not np.array_equal(log.adc_a, log.adc_b)


def test_the_converter_ends_at_0_and_1023() -> None:
    log = Noise(1, "x").log(counted(log_of(0.0), 0.0, 2000.0))
    assert log.adc_a.min() == 0.0 and set(log.adc_b) == {1023.0}


def point(rate: float, torque: float = 100.0, unrest: float = 0.0) -> MapPoint:
    return MapPoint(rate * ARCSEC, torque, 1.0, unrest)


@pytest.mark.parametrize(
    ("rate", "unrest", "holds"),
    [(100.0, 0.0, True), (104.9, 2.99, True), (95.1, 0.0, True), (105.1, 0.0, False), (94.9, 0.0, False),
     (100.0, 3.0, False), (100.0, 3.1, False)],
)  # fmt: skip
def test_a_steady_state_is_within_5_percent_and_sure_to_3(rate: float, unrest: float, holds: bool) -> None:
    assert friction.steady(100.0, point(rate, 100.0, unrest), (log_of(rate),)) is holds


def test_a_stall_or_a_limit_cycle_is_no_steady_state() -> None:
    fine = log_of(-100.0, 4.0)
    still = log_of(np.where(np.arange(400) < 100, 0.0, -133.0), 4.0)
    leaps = log_of(-np.where(np.arange(400) // 40 % 2, 160.0, 40.0), 4.0)
    assert friction.steady(100.0, point(100.0), (fine, fine))
    for other in (still, leaps):
        assert not friction.steady(100.0, point(100.0), (fine, other))


class Rig:
    """An axis whose torque is 200 N m at any rate: motor A or B has its current. stuck: below which set point
    it stands still; full: above which the converter is at its end."""

    def __init__(self, stuck: float = 0.0, full: float = 1e9) -> None:
        self.stuck, self.full = stuck, full
        self.broken: list[tuple[int, float]] = []
        self.speeds: list[float] = []

    def log(self, speed: float) -> Log:
        amperes = 200.0 / (drive(LOW).torque_constant * GEAR_RATIO)
        log = log_of(0.0 if abs(speed) < self.stuck else speed, 2.0, effort=np.sign(speed) * 3000.0)
        if abs(speed) > self.full:
            return counted(log, 10.0, 1023.0)
        counts = amperes / ADC_A_PER_COUNT
        return counted(log, counts, 0.0) if speed > 0 else counted(log, 0.0, counts)

    def pair(self, _bench: StubBench, speed: float) -> tuple[Log, Log]:
        self.speeds.append(speed)
        return self.log(speed), self.log(-speed)

    def away(self, _bench: StubBench, way: int, step_s: float) -> Log:
        self.broken.append((way, step_s))
        return self.log(way * 10.0 if not self.stuck else way * 2 * self.stuck)


def rigged(monkeypatch: pytest.MonkeyPatch, rig: Rig) -> Benches:
    monkeypatch.setattr(friction, "map_pair", rig.pair)
    monkeypatch.setattr(friction, "break_away", rig.away)
    monkeypatch.setattr(friction, "fit_friction", lambda points: FIT)
    return benches(lambda *_: log_of(0.0))


def test_a_map_has_break_aways_and_every_speed_from_the_fastest(monkeypatch: pytest.MonkeyPatch) -> None:
    rig = Rig()
    points, fit = friction.friction_map(rigged(monkeypatch, rig), "low", QUIET)
    assert rig.broken == [(way, step_s) for step_s in (0.15, 0.2, 0.3) for way in (1, -1)]
    assert rig.speeds == sorted(MAP_SPEEDS, reverse=True)
    assert [each.rate / ARCSEC for each in points[3:]] == pytest.approx(rig.speeds)
    assert [each.torque for each in points] == pytest.approx([200.0] * 26, rel=0.01)
    assert fit is FIT


def test_a_point_at_the_converter_s_end_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    for full, count in ((20.0, 5), (30.0, 6)):  # 10 and 15 arcsec/s are left, or 25, too
        points, fit = friction.friction_map(rigged(monkeypatch, Rig(full=full)), "low", Noise(1, "x", 0.0))
        assert len(points) == count and (fit is None) is (count < 6)


def test_below_the_slowest_speed_the_loop_is_opened(monkeypatch: pytest.MonkeyPatch) -> None:
    begun: list[float] = []

    def opened(_b: Benches, preload: str, _n: Noise, _s: object, begin: tuple[Log, Log]) -> list[MapPoint]:
        begun.extend((float(begin[0].rate.mean()), float(begin[1].rate.mean())))
        return [point(1.0), point(2.0)]

    monkeypatch.setattr(friction, "opened", opened)
    points, _ = friction.friction_map(rigged(monkeypatch, Rig(stuck=50.0)), "high", QUIET)
    assert begun == pytest.approx([60.0, -60.0])
    assert len(points) == 3 + 19 + 2  # break-aways, speeds from 60 arcsec/s on, the opened loop's
    friction.friction_map(rigged(monkeypatch, Rig(stuck=1e5)), "high", QUIET)
    friction.friction_map(rigged(monkeypatch, Rig()), "high", QUIET)
    assert len(begun) == 2  # no loop is opened where none held, or all did


def test_efforts_fall_there_and_back_in_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    """From 40 there and 42 back, at 100 arcsec/s; the axis stands still below 37."""
    pairs: list[tuple[Any, int, int]] = []

    def pair(_bench: StubBench, begin: float, there: int, back: int) -> tuple[Log, Log]:
        pairs.append((begin, there, back))
        rate = 2.0 * min(there, -back) if there >= 37 else 0.0
        return Rig().log(rate) if rate else log_of(0.0), Rig().log(-rate) if rate else log_of(0.0)

    monkeypatch.setattr(friction, "opened_pair", pair)
    begin = log_of(100.0, effort=39.7), log_of(-100.0, effort=-42.2)
    found = list(friction.opened(benches(lambda *_: log_of(0.0)), "low", QUIET, drive(LOW), begin))
    efforts = [(39, -42), (39, -41), (38, -41), (38, -40), (37, -40), (37, -39), (36, -39)]
    assert pairs == [(pytest.approx(100.0), *each) for each in efforts]
    assert [each.rate / ARCSEC for each in found] == pytest.approx([78, 78, 76, 76, 74, 74])
    pairs.clear()
    monkeypatch.setattr(
        friction, "opened_pair", lambda *each: (pair(*each), (Rig().log(9), Rig().log(-9)))[1]
    )
    slow = log_of(100.0, effort=2.0), log_of(-100.0, effort=-3.0)
    assert len(list(friction.opened(benches(lambda *_: log_of(0.0)), "low", QUIET, drive(LOW), slow))) == 3
    far = log_of(100.0, effort=400.0), log_of(-100.0, effort=-300.0)
    assert len(list(friction.opened(benches(lambda *_: log_of(0.0)), "low", QUIET, drive(LOW), far))) == 79
