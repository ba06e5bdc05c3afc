"""The ramp by its law, v² = v0² + 2 a n, whatever target comes meanwhile; where the index is sought."""

from math import sqrt

import pytest
from hypothesis import given
from hypothesis import strategies as st

from boards.focus.config import FocusConfig
from boards.focus.stepping import Reference, Stepping

TOP = 93
"""Half steps from 100/s to below 400/s at 800/s²: (400² - 100²) / 1600 is 93.75."""


def gap_ns(ramp: int) -> int:
    return round(1e9 / sqrt(100.0**2 + 2 * 800.0 * ramp))


def steps(stepping: Stepping, most: int = 3000) -> list[tuple[int, int]]:
    """Directions and times until it rests."""
    found = []
    while len(found) < most and (step := stepping.next())[0]:
        found.append(step)
    return found


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("far", [1, 2, 3, 40, 187, 188, 189, 300])
def test_P11_the_motor_gains_speed_and_loses_it_again_by_the_ramp(far: int, sign: int) -> None:
    """As fast as steps made, steps to come and the top allow, or one step of the ramp below it."""
    times = [gap_ns(ramp) for ramp in range(TOP + 1)]
    stepping = Stepping(FocusConfig())
    stepping.target = sign * far
    made = steps(stepping)
    assert [direction for direction, _ in made] == [sign] * far
    for k, (_, time) in enumerate(made):
        fastest = min(k + 1, far - 1 - k, TOP)
        assert times.index(time) in (fastest, fastest - (k >= TOP or 2 * k >= far - 2))
    assert (stepping.position, stepping.direction, stepping.moving) == (sign * far, 0, False)


@given(st.lists(st.tuples(st.integers(-800, 800), st.integers(1, 200)), min_size=1, max_size=6))
def test_P11_another_target_turns_the_motor_only_at_its_slowest(orders: list[tuple[int, int]]) -> None:
    times = [gap_ns(ramp) for ramp in range(TOP + 1)]
    stepping, made = Stepping(FocusConfig()), list[tuple[int, int]]()
    for target, most in orders:
        stepping.target = target
        made += steps(stepping, most)
        assert stepping.position == sum(direction for direction, _ in made)
    made += steps(stepping)
    assert stepping.position == orders[-1][0]
    ramp = 0
    for k, (direction, time) in enumerate(made):
        assert not k or direction == made[k - 1][0] or ramp == 0
        assert abs(times.index(time) - ramp) <= 1
        ramp = times.index(time)


@pytest.mark.parametrize("made", [0, 1, 30, 150])
def test_B5_braking_takes_the_steps_of_the_ramp(made: int) -> None:
    stepping = Stepping(FocusConfig())
    stepping.target = -800
    for _ in range(made):
        stepping.next()
    stepping.brake()
    assert len(steps(stepping)) == min(made, TOP)


@pytest.mark.parametrize(("counts", "half_steps"), [(512, 0), (0, -800), (1023, 798), (768, 400), (509, -5)])
def test_P12_the_lvdt_tells_the_place_in_half_steps(counts: int, half_steps: int) -> None:
    """5 mm of 6.25 um either side of the middle, where half of 1024 counts is read (hardware.md 1.3)."""
    assert Reference(FocusConfig()).estimate(counts) == half_steps


@pytest.mark.parametrize(
    ("lvdt", "to"), [(513, 100 - 440), (512, 100 + 440), (0, 100 + 440), (1023, 100 - 440)]
)
def test_P12_a_turn_and_a_tenth_are_searched_towards_the_middle(lvdt: int, to: int) -> None:
    reference = Reference(FocusConfig())
    reference.give_up()
    assert reference.failed and not reference.active
    assert reference.begin(100, lvdt, False) == to
    assert reference.active and not reference.failed


def test_P12_the_index_counts_when_it_rises() -> None:
    """Not where the search begins on it: there it may have been passed by half."""
    reference = Reference(FocusConfig())
    reference.begin(0, 640, True)
    assert [reference.look(640, seen) for seen in (True, False, False, True)] == [None, None, None, 200]
    assert not reference.active
    for lvdt, place in ((128, -600), (384, -200), (896, 600), (767, 200), (769, 600)):
        reference.begin(0, lvdt, False)
        assert reference.look(lvdt, True) == place
