"""Gear tables and units: tooth counts to periods, periods to orders."""

from math import pi
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from calibration.errors import CalibrationInputError
from calibration.inputs.rigfile import telescope
from calibration.inputs.train import MESH, stages_of, train_of
from calibration.inputs.units import PER_TURN, units_per_turn
from plant.gears import RATIO

PATH = Path("rig.yaml")
TEETH = st.tuples(st.integers(8, 400), st.integers(8, 400))


@settings(max_examples=60, deadline=None)
@given(period=st.floats(0.1, 1e4), pairs=st.lists(TEETH, min_size=1, max_size=5))
def test_a_chain_of_wheels_turns_by_the_product_of_its_teeth(
    period: float, pairs: list[tuple[int, int]]
) -> None:
    items: list[dict[str, Any]] = [{"name": "s0", "period": period}]
    for k, pair in enumerate(pairs, 1):
        items.append({"name": f"s{k}", "of": f"s{k - 1}", "teeth": list(pair)})
    expected = period
    for driver, driven in pairs:
        expected *= driven / driver
    last = stages_of(PATH, items)[-1]
    assert last.period == pytest.approx(expected)
    assert last.period_s is None


def test_a_period_in_seconds_goes_down_the_chain_too() -> None:
    found = stages_of(
        PATH, [{"name": "worm", "period_s": 480.0}, {"name": "gear", "of": "worm", "teeth": [1, 3]}]
    )
    assert (found[1].period, found[1].period_s) == (None, 1440.0)


@pytest.mark.parametrize(
    ("items", "words"),
    [
        ([{"name": "a", "period": 1.0}, {"name": "a", "period": 2.0}], "'a' is given twice"),
        ([{"name": "b", "of": "a", "teeth": [1, 2]}], "'of' must name a stage given before it"),
    ],
)
def test_a_gear_table_that_says_too_much_or_too_little(items: list[dict[str, Any]], words: str) -> None:
    with pytest.raises(CalibrationInputError, match=words):
        stages_of(PATH, items)


@pytest.mark.parametrize("axis", ["ra", "dec"])
def test_the_telescopes_motor_turns_as_often_as_the_plant_says(axis: str) -> None:
    train = train_of(telescope(axis))
    assert train.ratio == pytest.approx(RATIO, rel=1e-9)
    assert train.orders[train.motor] == train.ratio
    assert train.one("axis") is not None
    assert set(train.toothed) <= set(train.shafts)
    assert not {n for n, kind in train.kinds.items() if kind == MESH} & set(train.shafts)
    assert train.one("focuser") is None


@pytest.mark.parametrize("unit", list(PER_TURN))
def test_plurals_capitals_and_words_before_a_unit_do_not_matter(unit: str) -> None:
    for spelled in (unit, unit.upper(), f"{unit}s", f"motor {unit}"):
        assert units_per_turn(spelled) == PER_TURN[unit]


def test_angles_agree_with_each_other_and_lengths_have_no_turn() -> None:
    assert units_per_turn("rad") == pytest.approx(2 * pi)
    assert units_per_turn("arcsec") == 60 * units_per_turn("arcmin") == 3600 * units_per_turn("deg")  # type: ignore[operator]
    assert units_per_turn("mrad") == pytest.approx(1000 * 2 * pi)
    assert [units_per_turn(u) for u in ("mm", "counts", "", "  ")] == [None] * 4
