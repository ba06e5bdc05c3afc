"""Units of an FMU in SI's base units, by the SI brochure (BIPM, 9th edition, tables 2 and 4)."""

import pytest

from plant.fmu.description import exponents


@pytest.mark.parametrize(
    ("unit", "expected"),
    [
        ("N m", {"kg": 1, "m": 2, "s": -2}),
        ("N m2", {"kg": 1, "m": 3, "s": -2}),
        ("V", {"kg": 1, "m": 2, "s": -3, "A": -1}),
        ("W", {"kg": 1, "m": 2, "s": -3}),
        ("ohm", {"kg": 1, "m": 2, "s": -3, "A": -2}),
        ("H", {"kg": 1, "m": 2, "s": -2, "A": -2}),
        ("Hz", {"s": -1}),
        ("kg m2", {"kg": 1, "m": 2}),
        ("N m s/rad", {"kg": 1, "m": 2, "s": -1, "rad": -1}),
        ("rad/(N m)", {"rad": 1, "kg": -1, "m": -2, "s": 2}),
        ("rad/s2", {"rad": 1, "s": -2}),
        ("N m/A", {"kg": 1, "m": 2, "s": -2, "A": -1}),
        ("K/W", {"K": 1, "kg": -1, "m": -2, "s": 3}),
        ("degC", {"K": 1}),
        ("A", {"A": 1}),
        ("s", {"s": 1}),
        ("H/H", {}),
        ("counts/turn", {}),
    ],
)
def test_a_unit_is_what_the_brochure_says(unit: str, expected: dict[str, int]) -> None:
    assert exponents(unit) == expected
