from time import perf_counter, sleep

import pytest

from bus.outside.pacer import Pacer, Punctuality, SpeedError
from bus.time import EventQueue


@pytest.mark.parametrize("speed", [1.0, 5.0])
def test_simulated_time_keeps_step_with_the_wall(speed: float) -> None:
    queue = EventQueue()
    start = perf_counter()
    Pacer(queue, speed).run(until_ns=round(0.2 * speed * 1e9))
    assert queue.now_ns == round(0.2 * speed * 1e9)
    assert perf_counter() - start >= 0.199


def test_each_slice_may_stop_it() -> None:
    queue = EventQueue()
    pacer = Pacer(queue)
    pacer.run(each_slice=lambda: queue.now_ns >= 10_000_000)
    assert queue.now_ns == 10_000_000


def test_lateness_is_reported_and_a_long_pause_is_not_made_up_for() -> None:
    queue = EventQueue()
    queue.at(5_000_000, lambda _: sleep(1.1))
    pacer = Pacer(queue)
    start = perf_counter()
    pacer.run(until_ns=20_000_000)
    assert pacer.slips == 1
    assert pacer.slipped_s >= 1.0
    assert perf_counter() - start >= 1.1 + 0.014


@pytest.mark.parametrize("speed", [0.0, -1.0, 1e-9, 1e12, float("nan"), float("inf")])
def test_speeds_that_are_none(speed: float) -> None:
    with pytest.raises(SpeedError, match=r"within 0\.01 to 1000"):
        Pacer(EventQueue(), speed)
    pacer = Pacer(EventQueue())
    with pytest.raises(SpeedError):
        pacer.speed = speed
    assert pacer.speed == 1.0


def test_the_speed_changes_while_it_runs() -> None:
    queue = EventQueue()
    pacer = Pacer(queue)

    def faster(_t_ns: int) -> None:
        pacer.speed = 10.0

    queue.at(50_000_000, faster)
    start = perf_counter()
    pacer.run(until_ns=1_050_000_000)
    assert 0.14 <= perf_counter() - start < 0.9


def test_while_it_is_paused_time_stands_still_and_does_not_catch_up() -> None:
    queue = EventQueue()
    pacer = Pacer(queue)
    slices: list[int] = []
    start = perf_counter()

    def each() -> None:
        slices.append(queue.now_ns)
        pacer.paused = 0.05 < perf_counter() - start < 0.25

    pacer.run(until_ns=100_000_000, each_slice=each)
    assert perf_counter() - start >= 0.1 + 0.19
    assert max(slices.count(t) for t in set(slices)) > 3  # looked at while paused


def test_punctuality_counts_what_is_early_and_late() -> None:
    queue = EventQueue()
    pacer = Pacer(queue)
    probe = Punctuality(pacer)
    queue.at(50_000_000, lambda _: sleep(0.03))
    pacer.run(until_ns=100_000_000)
    assert probe.ticks == 20
    assert probe.worst_s > 0.02
    assert probe.on_time < 1.0
    assert 0.02 < probe.quantile_s(1.0) <= probe.worst_s
    assert "of 20 ticks" in probe.text()
    assert "inf" not in probe.text()
    assert max(late for _, late in probe.late) == probe.worst_s
    assert len(probe.late) == 20 - round(20 * probe.on_time)
    probe.restart()
    assert probe.text() == "no tick yet" and not probe.late


@pytest.mark.parametrize("late_s", [0.0, 0.9e-5, 0.0123, 0.0199999, 0.02, 0.0205, 0.5, 1.0199, 1.03, 77.0])
def test_a_lateness_is_told_to_its_bin(late_s: float, monkeypatch: pytest.MonkeyPatch) -> None:
    queue = EventQueue()
    pacer = Pacer(queue)
    probe = Punctuality(pacer)
    monkeypatch.setattr("bus.outside.pacer.perf_counter", lambda: pacer.due_s(queue.now_ns) + late_s)
    queue.run_until(100_000_000)
    told = probe.quantile_s(0.999)
    assert probe.worst_s == pytest.approx(late_s, abs=1e-9)
    assert late_s - 1e-9 <= told <= late_s + (1e-5 if late_s < 0.02 else 1e-3)
