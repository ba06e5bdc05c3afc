"""A receiver of another bit rate: sample times and resynchronisation by hand (ISO 11898-1, Bosch CAN 2.0).

At 1000 ns a bit the sample point is at 750 ns, and an edge to dominant moves a bit by 125 ns at most.
"""

import pytest

from bus.can.sampling import BitTiming, error_ns, sample

OWN = BitTiming(1000.0)
ALTERNATING = [0, 1] * 12


@pytest.mark.parametrize(("bit_ns", "fits"), [(990.5, True), (1009.5, True), (989.5, False), (1010.5, False)])
def test_one_per_cent_fits(bit_ns: float, fits: bool) -> None:
    assert BitTiming(bit_ns).fits(1000.0) == fits


def test_the_tolerance_itself_fits() -> None:
    assert BitTiming(1250.0, tolerance=0.25).fits(1000.0)
    assert not BitTiming(1251.0, tolerance=0.25).fits(1000.0)


@pytest.mark.parametrize("levels", [[0, 1, 0], [0, 0, 1, 1, 0], [0]])
def test_at_one_rate_every_bit_is_taken_and_sixteen_recessive_ones_behind(levels: list[int]) -> None:
    assert sample(levels, 1000.0, OWN) == levels + [1] * 16


def test_a_sender_just_slow_enough_is_caught_at_the_sample_point() -> None:
    # the first sample, at 750 ns, is still in the start of frame of 751 ns; the next at 1750 ns is behind all
    assert sample([0, 1], 751.0, OWN) == [0] + [1] * 17
    # of 750 ns it is not
    assert sample([0, 1], 750.0, OWN)[0] == 1


def test_a_slow_sender_is_followed_edge_by_edge() -> None:
    """Of 1100 ns a bit: two bits are 200 ns longer, of which an edge takes back 125 ns."""
    assert sample(ALTERNATING[:16], 1100.0, OWN)[:16] == ALTERNATING[:16]
    # without it, the ninth sample, at 8750 ns, is in the eighth bit
    deaf = sample(ALTERNATING[:16], 1100.0, OWN._replace(jump=0.0))
    assert deaf[:8] == ALTERNATING[:8] and deaf[8] == ALTERNATING[7]


def test_a_quick_sender_is_followed_edge_by_edge() -> None:
    """Of 950 ns a bit: two bits are 100 ns shorter, and the edge comes behind the sample point."""
    assert sample(ALTERNATING, 950.0, OWN)[:24] == ALTERNATING
    # without it, the fifth sample, at 4750 ns, is in the sixth bit
    deaf = sample(ALTERNATING, 950.0, OWN._replace(jump=0.0))
    assert deaf[:4] == ALTERNATING[:4] and deaf[4] == ALTERNATING[5]


def test_an_edge_moves_a_bit_by_the_jump_width_and_no_more() -> None:
    # of 1300 ns a bit: the edge at 2600 ns is 600 ns late. The next sample is at 3875 ns, or at 4350 ns.
    assert sample([0, 1, 0, 1], 1300.0, OWN)[:4] == [0, 1, 0, 0]
    assert sample([0, 1, 0, 1], 1300.0, OWN._replace(jump=0.6))[:4] == [0, 1, 0, 1]


def test_only_an_edge_from_recessive_to_dominant_moves_a_bit() -> None:
    """Of 1100 ns a bit: the samples from 1750 to 10750 ns are all within nine recessive bits."""
    assert sample([0, *[1] * 9, 0, 1], 1100.0, OWN)[:12] == [0, *[1] * 10, 0]
    assert sample([0, *[0] * 8, 1, 1], 1100.0, OWN)[:11] == [0] * 10 + [1]


@pytest.mark.parametrize(("levels", "bit_ns", "seen_ns"), [
    ([0] * 6, 1000.0, 6000.0),  # the sixth equal bit is a stuff error
    ([0] * 6, 500.0, 3000.0),
    ([1, 1] + [0] * 6, 1000.0, 8000.0),
])  # fmt: skip
def test_an_error_is_seen_at_the_end_of_its_bit(levels: list[int], bit_ns: float, seen_ns: float) -> None:
    assert error_ns(levels, bit_ns, BitTiming(bit_ns)) == seen_ns


def test_a_frame_that_is_over_before_the_first_sample_is_no_error_while_it_lasts() -> None:
    found = error_ns([0] + [1] * 9, 1000.0, BitTiming(200_000.0))
    assert found is not None and found > 10_000.0
