"""The period of a frame where the tester itself has lost some of them, and where it has not."""

from random import Random

import pytest

from bus.conformance.result import Level
from bus.conformance.settings import Settings
from bus.conformance.timing import check_timing

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
