"""B1: wind is noticed by what it leaves between 1 and 8 Hz, and other gains are in force until it is over."""

import cmath
import math

import pytest

from boards.axis.hold import Gusts
from bus.protocol import AxisParameter, Opcode
from bus.protocol.scales import rate_q16
from scenarios.native import compiled
from tests.boards.lab import Lab

ONE = 1 << 16
TICKS_PER_S = 200
WINDOW = 1024
LOUD, QUIET = 0.2, 0.14  # counts a tick


def shake(gusts: Gusts, counts: float, hertz: float, windows: int) -> list[bool]:
    """A sine of the error; what is noticed at the end of each window."""
    heard = []
    for k in range(windows * WINDOW):
        gusts.step(round(counts * ONE * math.sin(2 * math.pi * hertz * k / TICKS_PER_S)))
        if k % WINDOW == WINDOW - 1:
            heard.append(gusts.blowing)
    return heard


def passed(hertz: float) -> float:
    """Mean size of what passes both low-passes of a sine of size 1: their transfer function by hand."""
    z = cmath.exp(-2j * math.pi * hertz / TICKS_PER_S)
    fast = 0.25 / (1 - 0.75 * z)
    return 2 / math.pi * abs(fast * (1 - 1 / 16 / (1 - 15 / 16 * z)))


@pytest.mark.parametrize("hertz", [1.3, 3.0, 7.7])
def test_B1_two_windows_tell_and_two_end_it(hertz: float) -> None:
    edge = LOUD / passed(hertz)
    assert not any(shake(Gusts(), 0.95 * edge, hertz, 5))
    gusts = Gusts()
    assert shake(gusts, 1.05 * edge, hertz, 3) == [False, True, True]
    lower = QUIET / passed(hertz)
    once = Gusts()
    assert shake(once, 1.05 * edge, hertz, 2) + shake(once, 0.0, hertz, 2) == [False, True, True, False]
    assert all(shake(gusts, 1.05 * lower, hertz, 4))  # between both levels nothing turns
    assert shake(gusts, 0.9 * lower, hertz, 3)[1:] == [False, False]


def test_B1_each_window_is_5_12_seconds() -> None:
    gusts, heard = Gusts(), []
    for k in range(2 * WINDOW):
        gusts.step(round(4 * ONE * math.sin(2 * math.pi * 3.0 * k / TICKS_PER_S)))
        heard.append(gusts.blowing)
    assert heard.index(True) == 2 * WINDOW - 1


@pytest.mark.parametrize(("counts", "noticed"), [(8.0, False), (8.9, False), (1000.0, False)])
def test_B1_a_blow_counts_8_counts_at_most(counts: float, noticed: bool) -> None:
    """Ticks apart from each other, so many that at 8 counts they are 0.95 of the level, and 1.07 at 9."""
    each, fast, slow = 0.0, 0.0, 0.0
    for k in range(64):
        fast += ((8.0 if k == 0 else 0.0) - fast) / 4
        slow += (fast - slow) / 16
        each += abs(fast - slow)
    every = round(64 * each / (0.95 * LOUD * 64))
    gusts = Gusts()
    for k in range(3 * WINDOW):
        gusts.step(round(counts * ONE) if k % every == 0 else 0)
    assert gusts.blowing is noticed


def test_B1_what_gears_leave_and_a_start_are_no_wind() -> None:
    assert not any(shake(Gusts(), 1.0, 0.2, 5))  # 2.3 arcsec/s, every 5 s
    gusts = Gusts()
    assert not any(shake(gusts, 8.0, 3.0, 1) + shake(gusts, 0.0, 3.0, 1)) and not any(
        shake(gusts, 8.0, 3.0, 1)
    )


@pytest.mark.skipif(compiled(), reason="a private number of the plain class")
def test_B1_no_window_overflows() -> None:
    gusts = Gusts()
    for k in range(WINDOW - 1):
        gusts.step((1 << 31) - 1 if k // 40 % 2 else -(1 << 31))
    assert 0 < gusts._sum < 1 << 31


@pytest.mark.parametrize("opcode", [Opcode.TRACK_RATE, Opcode.SET_RATE])
def test_B1_the_gains_are_those_of_wind_while_it_blows(opcode: Opcode) -> None:
    lab = Lab()
    lab.run(0.1)
    lab.command(Opcode.POWER, 1)
    lab.command(Opcode.SET_PARAMETER, AxisParameter.RATE_LOCK, 1)
    lab.command(opcode, rate_q16(15.0))
    lab.run(3.0)
    axis = lab.axis
    calm = axis.pi.kp_q12
    assert axis.motion.gusts is not None
    axis.motion.gusts.blowing = True
    lab.run(0.1)
    windy = round(axis.config.kp_gust * 4096), round(axis.config.ki_gust * 4096)
    assert (axis.pi.kp_q12, axis.pi.ki_q12) == windy
    lab.command(Opcode.SET_PARAMETER, AxisParameter.RATE_LOCK, 0)
    lab.run(0.1)
    assert axis.motion.gusts is None and axis.pi.kp_q12 in (calm, axis.motion.kp_q12)
