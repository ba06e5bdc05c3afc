"""When frames come: period, jitter, gaps, and how much of them the bus and the tester explain."""

from math import inf
from random import Random
from types import SimpleNamespace

import pytest

from bus.conformance.result import Level
from bus.conformance.settings import Settings
from bus.conformance.timing import check_timing, queueing_s
from tests.conformance.scripted import told

SETTINGS = Settings(stamps_s=60.0)


def period(stamps: list[float], lost: int) -> tuple[Level, str]:
    result = next(check_timing(SETTINGS, "X", 10, stamps, 0.001, lost))
    return result.level, result.observed


def test_frames_that_the_tester_lost_are_not_the_boards() -> None:
    random = Random(1)
    every = [k * 0.01 for k in range(400)]
    heard = [t for t in every if random.random() > 0.3]
    assert period(heard, len(every) - len(heard))[0] is Level.OK
    level, observed = period(heard, 0)  # nothing was lost here: the board left them out
    assert level is Level.ERROR and float(observed.split()[1]) == pytest.approx(10 / 0.7, rel=0.1)


def test_a_wrong_period_is_one_with_and_without_losses() -> None:
    stamps = [k * 0.0125 for k in range(300)]
    assert period(stamps, 0) == (Level.ERROR, "mean 12.500 ms")
    assert period(stamps, 3) == (Level.ERROR, "mean 12.500 ms, 3 frames were lost here")
    every_second = [k * 0.02 for k in range(200)]
    assert period(every_second, 3)[0] is Level.ERROR


def message(frame_id: int, cycle_time: float | None) -> SimpleNamespace:
    return SimpleNamespace(frame_id=frame_id, cycle_time=cycle_time)


FRAME_MS = 0.135
"""Eight bytes with every stuff bit, at 1 Mbit/s."""


@pytest.mark.parametrize(
    ("messages", "frames"),
    [
        ([], 2),
        ([(0x200, 10), (0x201, 10)], 2),
        ([(0x1FF, None), (0x1FE, 0)], 2),
        ([(0x1FF, 10)], 3),
        ([(0x1FF, 10), (0x080, 250), (0x201, 1)], 4),
        ([(0x1FF, 0.4)], 4),  # 2 + 1 take 0.405 ms, in which it comes twice
        ([(0x1FF, 0.405)], 4),  # and just then once more
        ([(0x1FF, 0.41)], 3),
    ],
)
def test_a_frame_waits_for_one_of_less_and_all_of_more_priority(
    messages: list[tuple[int, float | None]], frames: int
) -> None:
    found = queueing_s([message(*each) for each in messages], 0x200)
    assert found * 1e3 == pytest.approx(frames * FRAME_MS)


@pytest.mark.parametrize(("wait_s", "found_s"), [(0.5, 0.5), (1.5, inf)])
def test_a_bus_on_which_a_frame_waits_for_a_second_is_full(wait_s: float, found_s: float) -> None:
    """w = C (2 + w / T) is w = 2 C / (1 - C / T)."""
    period_ms = FRAME_MS / (1 - 2 * FRAME_MS / (wait_s * 1e3))
    assert queueing_s([message(1, period_ms)], 2) == pytest.approx(found_s, rel=0.01)
    assert queueing_s([message(1, 0.1)], 2) == inf


def lines(
    stamps: list[float], period_ms: int = 125, lost: int = 0, queueing: float = 0.25, **settings: float
) -> list[str]:
    """With at most 375.5 ms of jitter where nothing else is said."""
    found = Settings(**{"stamps_s": 0.125} | settings)  # type: ignore[arg-type]
    return told(check_timing(found, "X", period_ms, stamps, queueing, lost))


def test_times_word_by_word() -> None:
    assert lines([8.0, 8.125, 8.25, 8.375]) == [
        "ok period: X: 125 ms ± 2.0% | mean 125.000 ms",
        "ok jitter: X: within 375.500 ms | 0.000 ms",
        "ok gap: X: at most 563.000 ms | 125.000..125.000 ms",
    ]
    assert lines([8.0, 8.125, 8.25, 8.375], 250, speed=2.0, queueing=0.0005, period_tolerance=0.125) == [
        "ok period: X: 250 ms ± 12.5% | mean 250.000 ms",
        "ok jitter: X: within 251.000 ms | 0.000 ms",
        "ok gap: X: at most 626.000 ms | 250.000..250.000 ms",
    ]
    results = check_timing(SETTINGS, "X", 125, [8.0, 8.125, 8.25], 0.0, 0)
    assert [each.duration_s for each in results] == [0.25] * 3


@pytest.mark.parametrize(
    ("gap_s", "level"), [(0.15625, "ok"), (0.09375, "ok"), (0.1563, "error"), (0.0937, "error")]
)
def test_a_mean_period_is_within_its_tolerance(gap_s: float, level: str) -> None:
    stamps = [0.0, gap_s, 2 * gap_s]
    said = f"{level} period: X: 125 ms ± 25.0% | mean {gap_s * 1e3:.3f} ms"
    assert lines(stamps, period_tolerance=0.25)[0] == said


@pytest.mark.parametrize(
    ("stamps", "lost", "mean"),
    [
        ([0.0, 0.125, 0.25, 0.5], 1, "125.000 ms, 1 frames were lost here"),
        ([0.0, 0.125, 0.25, 0.5], 0, "166.667 ms"),
        ([0.0, 0.125, 0.25, 0.275], 2, "91.667 ms, 2 frames were lost here"),  # a short gap is one
        ([0.0, 0.0, 0.0, 0.25], 3, "62.500 ms, 3 frames were lost here"),  # usual: 125 ms, as written
    ],
)
def test_a_gap_holds_periods_where_frames_were_lost(stamps: list[float], lost: int, mean: str) -> None:
    assert lines(stamps, lost=lost)[0].endswith(f"| mean {mean}")


@pytest.mark.parametrize(("queueing_ms", "level"), [(1.501, "ok"), (1.499, "issue")])
def test_jitter_is_off_the_straight_line_through_all(queueing_ms: float, level: str) -> None:
    """1 ms late, early, early and late: no straight line is nearer than an even one."""
    stamps = [0.001, 0.124, 0.249, 0.376]
    said = f"{level} jitter: X: within {queueing_ms + 0.5:.3f} ms | 2.000 ms"
    assert lines(stamps, queueing=queueing_ms / 1e3, stamps_s=0.0)[1] == said


@pytest.mark.parametrize("start_s", [0.0, 0.03125])
def test_jitter_does_not_hang_on_the_first_frames(start_s: float) -> None:
    """Of 0, 175, 225, 375 ms the line is 17.5 + 117.5 k: off by -17.5, 40, -27.5 and 5 ms."""
    stamps = [start_s + each for each in (0.0, 0.175, 0.225, 0.375)]
    assert lines(stamps)[1] == "ok jitter: X: within 375.500 ms | 67.500 ms"


@pytest.mark.parametrize(("end_s", "level"), [(0.375, "ok"), (0.376, "issue")])
def test_a_gap_of_one_and_a_half_periods_is_a_frame_left_out(end_s: float, level: str) -> None:
    said = f"{level} gap: X: at most 250.000 ms | 125.000..{1e3 * end_s - 125:.3f} ms"
    assert lines([0.0, 0.125, end_s], queueing=0.062, stamps_s=0.0)[2] == said


@pytest.mark.parametrize("lost", [0, 1])
def test_an_interface_without_time_stamps_is_told(lost: int) -> None:
    (line,) = lines([0.0] * 5, lost=lost)
    assert line.startswith("error period: X: 125 ms ± 2.0% | mean 0.000 ms")
