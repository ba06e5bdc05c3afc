import pytest
from hypothesis import given
from hypothesis import strategies as st

from boards.core.widths import INT32_TOP, INT64_TOP, saturate
from tests.boards.checked import Checked


@given(st.integers())
def test_saturation_stops_at_both_ends(value: int) -> None:
    assert saturate(value, INT32_TOP) == min(max(value, -INT32_TOP), INT32_TOP)


def test_checked_integers_see_an_overflow() -> None:
    with pytest.raises(OverflowError, match="needs 65 bits"):
        Checked(1 << 62) * 2
    with pytest.raises(OverflowError):
        3 * (Checked(1 << 62) - 1) + 7
    assert Checked(1 << 62) + ((1 << 62) - 1) == (1 << 63) - 1


def test_tops_are_those_of_32_and_64_bits() -> None:
    assert (INT32_TOP, INT64_TOP) == (0x7FFF_FFFF, 0x7FFF_FFFF_FFFF_FFFF)
    assert [saturate(value, 5) for value in (-6, -5, 0, 5, 6)] == [-5, -5, 0, 5, 5]
