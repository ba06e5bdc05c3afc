"""The pacer by a clock of its own, where every sleep lasts what it is asked to last."""

import math

import pytest

from bus.outside import pacer as module
from bus.outside.pacer import Pacer, Punctuality, checked_speed
from bus.time import EventQueue

MS = 1_000_000


class Wall:
    """A machine's clock. It stands still but for sleeping."""

    def __init__(self) -> None:
        self.now_s = 1000.0
        self.slept_s: list[float] = []

    def sleep(self, seconds: float) -> None:
        self.slept_s.append(seconds)
        self.now_s += seconds


@pytest.fixture
def wall(monkeypatch: pytest.MonkeyPatch) -> Wall:
    wall = Wall()
    monkeypatch.setattr(module, "perf_counter", lambda: wall.now_s)
    monkeypatch.setattr(module, "sleep", wall.sleep)
    return wall


def ms(*seconds: float) -> list[float]:
    return [round(each * 1e3, 6) for each in seconds]


@pytest.mark.parametrize("speed", [0.01, 1.0, 2.0, 1000.0])
def test_a_slice_is_a_millisecond_of_the_wall_and_run_when_its_middle_is_due(
    wall: Wall, speed: float
) -> None:
    queue = EventQueue()
    slices: list[int] = []
    pacer = Pacer(queue, speed)
    pacer.run(round(3.5 * MS * speed), lambda: slices.append(queue.now_ns))
    assert slices == [round(k * MS * speed) for k in range(4)]
    assert queue.now_ns == round(3.5 * MS * speed)
    assert ms(*wall.slept_s) == [0.5, 1.0, 1.0, 0.75]  # the last slice is a half
    assert (pacer.lateness_s, pacer.slips, pacer.slipped_s) == (0.0, 0, 0.0)


def test_a_time_that_has_been_reached_is_no_slice(wall: Wall) -> None:
    queue = EventQueue()
    queue.run_until(5 * MS)
    Pacer(queue).run(5 * MS, lambda: pytest.fail("asked"))
    assert wall.slept_s == []


def test_the_schedule_begins_with_the_run(wall: Wall) -> None:
    queue = EventQueue()
    pacer = Pacer(queue)
    queue.run_until(7 * MS)
    wall.now_s = 1234.0
    pacer.run(8 * MS)
    assert wall.now_s == pytest.approx(1234.0005)
    assert pacer.due_s(7 * MS) == 1234.0
    assert pacer.due_s(1_007 * MS) == pytest.approx(1235.0)


def test_what_is_late_is_made_up_for_and_told(wall: Wall) -> None:
    """10 ms are lost in the second slice: nobody sleeps until they are made good."""
    queue = EventQueue()
    queue.at(2 * MS, lambda _: setattr(wall, "now_s", wall.now_s + 0.010))
    told: list[float] = []
    pacer = Pacer(queue)
    pacer.run(20 * MS, lambda: told.append(pacer.lateness_s))
    assert ms(*told[:4]) == [0.0, 0.0, 9.5, 8.5]
    assert ms(*wall.slept_s[:2]) == [0.5, 1.0]
    assert wall.now_s == pytest.approx(1000.0 + 0.0195)
    assert (pacer.slips, pacer.lateness_s) == (0, 0.0)


@pytest.mark.parametrize(("lost_s", "slips"), [(0.25, 0), (0.251, 1)])
def test_a_quarter_of_a_second_is_given_up(wall: Wall, lost_s: float, slips: int) -> None:
    queue = EventQueue()
    queue.at(1 * MS, lambda _: setattr(wall, "now_s", wall.now_s + lost_s))
    pacer = Pacer(queue)
    pacer.run(2 * MS)
    assert pacer.slips == slips
    assert pacer.slipped_s == pytest.approx(slips * (lost_s - 0.0005))  # it was half a slice early before
    assert len(wall.slept_s) == 1 + slips


def test_every_slip_counts(wall: Wall) -> None:
    queue = EventQueue()
    for k in (1, 5):
        queue.at(k * MS, lambda _: setattr(wall, "now_s", wall.now_s + 0.4))
    pacer = Pacer(queue)
    pacer.run(9 * MS)
    assert pacer.slips == 2
    assert pacer.slipped_s == pytest.approx(2 * 0.3995)


def test_a_pause_is_slept_in_slices_and_asked_about(wall: Wall) -> None:
    queue = EventQueue()
    pacer = Pacer(queue)
    pacer.paused = True
    times: list[float] = []

    def each() -> None:
        times.append(wall.now_s)
        pacer.paused = len(times) < 4

    pacer.run(2 * MS, each)
    assert ms(*wall.slept_s) == [1.0, 1.0, 1.0, 0.5, 1.0]
    assert not pacer.paused


def test_a_pause_that_is_none_leaves_the_schedule(wall: Wall) -> None:
    pacer = Pacer(EventQueue())
    due_s = pacer.due_s(0)
    wall.now_s += 5.0
    pacer.paused = False
    assert pacer.due_s(0) == due_s
    pacer.paused = True
    assert (pacer.paused, pacer.due_s(0)) == (True, wall.now_s)


def test_another_speed_begins_here_and_now(wall: Wall) -> None:
    queue = EventQueue()
    pacer = Pacer(queue)
    queue.run_until(10 * MS)
    wall.now_s += 5.0
    pacer.speed = 4.0
    assert pacer.speed == 4.0
    assert pacer.due_s(10 * MS) == wall.now_s
    assert pacer.due_s(50 * MS) == pytest.approx(wall.now_s + 0.01)


def test_speeds_at_the_very_limits_are_speeds() -> None:
    assert [checked_speed(each) for each in (0.01, 1000.0)] == [0.01, 1000.0]


def probed(wall: Wall, *late_s: float) -> Punctuality:
    """A probe whose ticks are off by so much, one after the other."""
    queue = EventQueue()
    pacer = Pacer(queue)
    probe = Punctuality(pacer)
    for k, each in enumerate(late_s, 1):
        wall.now_s = pacer.due_s(5 * k * MS) + each
        queue.run_until(5 * k * MS)
    return probe


def test_a_tick_comes_every_five_milliseconds_and_early_is_as_bad_as_late(wall: Wall) -> None:
    probe = probed(wall, 0.0, 0.002, -0.003, 0.0005)
    assert probe.ticks == 4
    assert probe.worst_s == pytest.approx(0.003)
    dues, off = zip(*probe.late, strict=True)
    assert dues == pytest.approx((1000.010, 1000.015))
    assert off == pytest.approx((0.002, 0.003))
    assert probe.on_time == 0.5


def test_a_probe_that_does_not_count_goes_on_ticking(wall: Wall) -> None:
    probe = probed(wall, 0.002)
    queue = probe._pacer.queue
    probe.counting = False
    queue.run_until(20 * MS)
    assert probe.ticks == 1
    probe.counting = True
    queue.run_until(25 * MS)
    assert probe.ticks == 2
    assert queue.next_ns() == 30 * MS


def test_before_the_first_tick_nothing_is_known(wall: Wall) -> None:
    probe = probed(wall)
    assert math.isnan(probe.on_time) and math.isnan(probe.quantile_s(0.5))
    assert probe.text() == "no tick yet"
    assert (probe.ticks, probe.worst_s, len(probe.late)) == (0, 0.0, 0)


def test_a_share_of_the_ticks_stays_below_a_quantile(wall: Wall) -> None:
    """Nine ticks in bins of 10 us: told by the upper end of a bin."""
    probe = probed(wall, *((k + 0.5) * 1e-5 for k in range(8)), 0.0125)
    assert ms(probe.quantile_s(1 / 9), probe.quantile_s(5 / 9), probe.quantile_s(8 / 9)) == [0.01, 0.05, 0.08]
    assert probe.quantile_s(1.0) == pytest.approx(0.0125)  # no more than the worst
    assert probe.on_time == pytest.approx(8 / 9)


@pytest.mark.timeout(30)  # the square of the bins would take ten minutes, and hold up every door
def test_ticks_that_are_late_by_all_sorts_are_told_at_once(wall: Wall) -> None:
    probe = probed(wall)
    probe._bins.update(dict.fromkeys(range(100_000), 1))
    probe.ticks, probe.worst_s = 100_000, 1.0
    assert probe.quantile_s(0.999) == pytest.approx(0.999)
    assert probe.on_time == pytest.approx(0.001)


def test_beyond_a_second_the_worst_is_what_is_told(wall: Wall) -> None:
    probe = probed(wall, 0.5, 1.5, 9.0)
    assert probe.quantile_s(0.3) == pytest.approx(0.5, abs=2e-5)
    assert probe.quantile_s(0.6) == pytest.approx(9.0)
    assert probed(wall, 1.000005, 9.0).quantile_s(0.5) == pytest.approx(9.0)


def test_a_line_says_it_in_numbers(wall: Wall) -> None:
    probe = probed(wall, *[0.0005] * 7, 0.9123)
    assert probe.text() == "87.50% of 8 ticks within 1 ms of due (99.9 % within 912.30 ms, worst 912.3 ms)"


def test_counting_afresh_forgets_all_of_it(wall: Wall) -> None:
    probe = probed(wall, 0.0001, 0.0002, 0.005)
    probe.restart()
    assert (probe.ticks, probe.worst_s, len(probe.late)) == (0, 0.0, 0)
    wall.now_s = probe._pacer.due_s(20 * MS) + 0.004
    probe._pacer.queue.run_until(20 * MS)
    assert (probe.ticks, probe.on_time) == (1, 0.0)
    assert probe.quantile_s(1.0) == pytest.approx(0.004)


def test_the_last_thousand_late_ticks_are_kept(wall: Wall) -> None:
    probe = probed(wall, *[0.002] * 1005)
    assert len(probe.late) == 1000
    assert probe.late[0][0] == pytest.approx(1000.0 + 0.005 * 6)
