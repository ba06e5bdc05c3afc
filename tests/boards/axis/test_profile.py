from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from boards.axis.profile import UNIT_SHIFT, UNITS_PER_STEP, Profile

COUNTS_PER_TURN, STEPS_PER_TURN = 112_896_000, 1 << 29
A = 16 << UNIT_SHIFT
TOP = 3136 << UNIT_SHIFT


def test_the_unit_is_exact_for_both_encoders() -> None:
    assert STEPS_PER_TURN * UNITS_PER_STEP == COUNTS_PER_TURN << UNIT_SHIFT


def run(profile: Profile, limit: int = 20_000) -> list[int]:
    speeds = [profile.speed]
    while profile.remaining or profile.speed:
        profile.step()
        speeds.append(profile.speed)
        assert len(speeds) < limit
    return speeds


@settings(deadline=None)
@given(st.integers(-2_000_000, 2_000_000), st.integers(-3136, 3136), st.integers(-7, 7))
def test_B1_a_move_ends_at_its_target_within_the_acceleration(steps: int, speed: int, rate: int) -> None:
    profile = Profile(A)
    profile.top = TOP
    profile.rate = rate << UNIT_SHIFT
    profile.take_over(0, speed << UNIT_SHIFT)
    profile.aim(steps * UNITS_PER_STEP)
    speeds = run(profile)
    changes = [abs(after - before) for before, after in pairwise(speeds)]
    assert max(changes, default=0) <= A
    assert profile.remaining == 0
    assert max(map(abs, speeds)) <= max(TOP, abs((speed - rate) << UNIT_SHIFT))


def test_B1_braking_takes_the_time_physics_says() -> None:
    profile = Profile(A)
    profile.top = TOP
    distance = 200_000 << UNIT_SHIFT
    profile.aim(distance)
    ticks = len(run(profile)) - 1
    # up and down without reaching the top: 2 sqrt(d / a)
    assert abs(ticks - 2 * (distance / A) ** 0.5) <= 2


@pytest.mark.parametrize("sign", [1, -1])
def test_B1_from_top_speed_it_brakes_in_time_and_no_sooner(sign: int) -> None:
    """d / top + top / a ticks, 3136 counts in 16 a tick are 196 of them.

    The law holds for speeds of whole a; between them it is up to a / 8 short: 2 counts, 0.023 arcsec.
    """
    for more in range(0, 3136, 151):
        profile = Profile(A)
        profile.top = TOP
        profile.aim(sign * (700_000 + more) << UNIT_SHIFT)
        ticks = 0
        while profile.remaining or profile.speed:
            before = profile.speed
            profile.step()
            ticks += 1
            assert abs(profile.speed - before) <= A and sign * profile.remaining >= -A // 8
        assert ticks == pytest.approx((700_000 + more) / 3136 + 196, abs=2)


def test_a_profile_begins_at_rest_at_nothing() -> None:
    profile = Profile(A)
    assert profile.step() == 0
    profile.aim(1000)
    assert (profile.target, profile.remaining) == (1000, 1000)


def test_taking_over_is_continuous() -> None:
    profile = Profile(A)
    profile.top = TOP
    profile.take_over(1000, 50 << UNIT_SHIFT)
    assert profile.target - profile.remaining == 1000
    assert abs(profile.step() - (50 << UNIT_SHIFT)) <= A


def test_taking_over_aims_where_braking_ends_either_way() -> None:
    """v² / 2a beyond where it is, the way it goes: 50² / 32 counts; to a rate, from the speed above it."""
    for speed, rate, way in ((50, 0, 78.1), (-50, 0, -78.1), (50, 20, 28.1), (-50, 20, -153.1)):
        profile = Profile(A)
        profile.rate = rate << UNIT_SHIFT
        profile.take_over(1000 << UNIT_SHIFT, speed << UNIT_SHIFT)
        assert abs(profile.target / (1 << UNIT_SHIFT) - 1000 - way) < 0.1
