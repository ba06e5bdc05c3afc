"""Coordinates on the wire: rounded, never 60, and read in every form the clients use."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from host.lx200 import angles


@given(st.floats(0, 2 * math.pi))
def test_hours_are_rounded_and_read_back(value: float) -> None:
    text = angles.hours(value)
    assert len(text) == 8
    back = angles.parse(text) * math.pi / 12
    assert abs(math.remainder(back - value, 2 * math.pi)) <= math.radians(7.5001 / 3600)


@given(st.floats(-math.pi / 2, math.pi / 2), st.booleans())
def test_degrees_are_rounded_and_read_back(value: float, precise: bool) -> None:
    back = math.radians(angles.parse(angles.signed(value, precise)))
    assert abs(back - value) <= math.radians((0.5001 if precise else 30.001) / 3600)


def test_what_cutting_would_get_wrong() -> None:
    assert angles.hours(math.radians(15 * (23 + 59 / 60 + 59.6 / 3600))) == "00:00:00"
    assert angles.signed(math.radians(-(9 + 59 / 60 + 59.7 / 3600))) == "-10\xdf00:00"
    assert angles.signed(math.radians(-0.2 / 3600)) == "-00\xdf00:00"
    assert angles.hours(math.radians(15 * 5.5), precise=False) == "05:30.0"
    assert angles.unsigned(math.radians(280.55), precise=False) == "280\xdf33"


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("12:34:56", 12 + 34 / 60 + 56 / 3600), (" 12:34:56", 12 + 34 / 60 + 56 / 3600), ("12:34.5", 12.575),
        ("+12*34:56", 12 + 34 / 60 + 56 / 3600), ("-00*30", -0.5), ("+12\xdf34:56", 12 + 34 / 60 + 56 / 3600),
        ("-12:34:56", -(12 + 34 / 60 + 56 / 3600)), ("-79*27", -79.45), ("280*32", 280 + 32 / 60),
        ("+29*22", 29 + 22 / 60),
    ],
)  # fmt: skip
def test_forms_of_all_clients(text: str, value: float) -> None:
    assert angles.parse(text) == pytest.approx(value)


@pytest.mark.parametrize("text", ["", "12", "12:60:00", "12:30:60", "ab:cd", "1e3*10", "12:34:56:78", "nan"])
def test_what_is_no_angle(text: str) -> None:
    with pytest.raises(ValueError, match=r"."):
        angles.parse(text)
