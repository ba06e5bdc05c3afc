"""Inputs of a campaign: from a share to a value, into a scenario, and what is refused."""

import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plant.model import load
from scenarios.campaign.inputs import Input, read
from scenarios.language.document import ScenarioError

BASE: dict[str, Any] = {
    "_folder": ".",
    "plant": "low-preload",
    "steps": [{"wait": {"for": "1 s"}}],
    "seed": 1,
}
FRICTION = "axes.ra.friction.coulomb"
SEED: dict[str, Any] = {"seed": True}


def made(kind: dict[str, Any], **more: Any) -> Input:
    return read({**kind, **more}, "f.yaml:3", BASE)


def said(kind: dict[str, Any], **more: Any) -> str:
    with pytest.raises(ScenarioError) as caught:
        made(kind, **more)
    return str(caught.value)


@pytest.mark.parametrize(("share", "value"), [
    (0.0, 7), (0.249, 7), (0.25, 8), (0.5, 9), (0.999, 10), (1.0, 10)
])  # fmt: skip
def test_a_list_is_drawn_from_evenly(share: float, value: int) -> None:
    assert made(SEED, **{"is": [7, 8, 9, 10]}).draw(share) == value


def test_of_a_list_the_first_twenty_are_looked_at() -> None:
    found = made(SEED, **{"is": list(range(30))})
    assert list(found.values) == list(range(30)) and list(found.ends) == list(range(20))


def test_a_distribution_has_five_levels_and_ends_without_tails() -> None:
    """Middles of equal parts; a thousandth at either end is left out."""
    found = made({"field": "seed"}, **{"is": {"between": [10, 20]}})
    assert found.values == pytest.approx([11, 13, 15, 17, 19])
    assert found.ends == pytest.approx([10.01, 19.99])
    assert found.draw(0.0) == 10.0 and found.draw(1.0) == 20.0
    two = made({"field": "seed"}, **{"is": {"between": [10, 20], "levels": 2}})
    assert two.values == pytest.approx([12.5, 17.5])


@pytest.mark.parametrize(("kind", "whole", "expected"), [
    ({"seed": True}, {}, 13), ({"parameter": {"node": "AXIS_RA", "number": 2}}, {}, 13),
    ({"field": "seed"}, {"whole": True}, 13), ({"field": "seed"}, {}, 12.6),
    ({"field": "seed"}, {"whole": False}, 12.6),
])  # fmt: skip
def test_whole_numbers(kind: dict[str, Any], whole: dict[str, Any], expected: float) -> None:
    value = made(kind, **{"is": {"between": [10, 20], **whole}}).draw(0.26)
    assert value == pytest.approx(expected) and (type(value) is int) is (expected == 13)


@settings(max_examples=10)
@given(st.floats(-100, 100), st.floats(0.01, 50), st.floats(0.01, 0.99))
def test_a_law_of_scipy_is_drawn_through_its_inverse(loc: float, scale: float, share: float) -> None:
    """The exponential one has a closed inverse."""
    law = {"distribution": "expon", "with": {"loc": loc, "scale": scale}}
    value = made({"field": "seed"}, **{"is": law}).draw(share)
    assert value == pytest.approx(loc - scale * math.log1p(-share), abs=1e-9)


@pytest.mark.parametrize(("kind", "more", "text"), [
    (SEED, {}, "seed needs `is` or `times`: a list of values or a distribution"),
    (SEED, {"is": [1], "times": [1]}, "seed needs `is` or `times`: a list of values or a distribution"),
    (SEED, {"times": [1]}, "a seed has no value to multiply; use `is`"),
    ({"plant": FRICTION}, {"times": [True]}, "plant: `times` is a list of numbers"),
    ({"plant": FRICTION}, {"times": [1, "2"]}, "plant: `times` is a list of numbers"),
    (SEED, {"is": {"between": [2, 2]}}, "between 2 and 2 there is nothing"),
    (SEED, {"is": {"between": [3, 2]}}, "between 3 and 2 there is nothing"),
    (SEED, {"is": {"levels": 3}}, "`between` or `distribution` is missing"),
    (SEED, {"is": {"distribution": "nurm"}},
     "no distribution of scipy.stats is called 'nurm'; did you mean 'norm'?"),
    (SEED, {"is": {"distribution": "norm", "with": {"width": 1}}}, "norm: takes loc, scale"),
    (SEED, {"is": {"distribution": "gamma", "with": {"b": 1}}}, "gamma: takes loc, scale and a"),
    (SEED, {"is": {"distribution": "norm", "with": {"scale": -1}}}, "norm: its parameters are out of range"),
    ({"field": "steps.1.wait"}, {"is": [1]}, "the scenario has no field 'steps.1.wait'"),
    ({"field": "steps.x"}, {"is": [1]}, "the scenario has no field 'steps.x'"),
    ({"field": "name.x"}, {"is": [1]}, "the scenario has no field 'name.x'"),
])  # fmt: skip
def test_an_input_that_cannot_be_is_refused(kind: dict[str, Any], more: dict[str, Any], text: str) -> None:
    assert said(kind, **more) == f"f.yaml:3: {text}"


def test_a_value_that_is_no_number_is_refused() -> None:
    found = made({"field": "seed"}, **{"is": {"distribution": "norm"}})
    with pytest.raises(ScenarioError, match="field: the distribution gives inf, which is no number"):
        found.draw(1.0)


@pytest.mark.parametrize(("kind", "value", "place", "put"), [
    ({"seed": True}, 5.0, "seed", {"seed": 5}),
    ({"parameter": {"node": "AXIS_RA", "number": 2}}, 7, "AXIS_RA parameter 2",
     {"network": {"nodes": {"AXIS_RA": {"parameters": {"2": 7}}}}}),
    ({"start": "hour_angle"}, 12, "start, hour angle", {"start": {"hour_angle": "12.0 deg"}}),
    ({"fault": True}, {"a": {}}, "fault", {"faults": [{"a": {}}]}), ({"fault": True}, "none", "fault", {}),
    ({"field": "steps.0.wait.for"}, "2 s", "steps.0.wait.for", {"steps": [{"wait": {"for": "2 s"}}]}),
    ({"field": "seed"}, 3, "seed", {"seed": 3}),
    ({"plant": FRICTION}, 3, FRICTION, {"plant": {"file": "low-preload", "overrides": {FRICTION: 3.0}}}),
])  # fmt: skip
def test_a_value_goes_to_its_place(kind: dict[str, Any], value: Any, place: str, put: dict[str, Any]) -> None:
    found = made(kind, **{"is": [value]})
    document = {**BASE, "steps": [{"wait": {"for": "1 s"}}]}
    found.put(document, value)
    assert (found.name, found.place) == (place, place) and document == {**BASE, **put}
    assert made(kind, name="mine", **{"is": [value]}).name == "mine"


def test_a_factor_multiplies_what_the_plant_has() -> None:
    stated = load("low_preload").axes.ra.inertia.value
    base = {**BASE, "plant": {"file": "low-preload", "overrides": {FRICTION: 8.0, "axes.ra.inertia": stated}}}
    found = read({"plant": FRICTION, "times": [1.5]}, "f.yaml:3", base)
    document = dict(base)
    found.put(document, 1.5)
    overrides = {FRICTION: 12.0, "axes.ra.inertia": stated}
    assert document["plant"] == {"file": "low-preload", "overrides": overrides}


@pytest.mark.parametrize(("kind", "value", "text"), [
    ({"seed": True}, 1.5, "seed: expected a whole number, found 1.5"),
    ({"seed": True}, math.inf, "seed: expected a whole number, found inf"),
    ({"start": "hour_angle"}, "x", "start.hour_angle: expected a number, found 'x'"),
])  # fmt: skip
def test_a_value_of_another_kind_is_refused(kind: dict[str, Any], value: Any, text: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        made(kind, **{"is": [value]}).put({}, value)
    assert str(caught.value) == f"f.yaml:3: {text}"


@pytest.mark.parametrize(("values", "ranks"), [
    ([1, 2.5], True), ([True, 1], False), (["1", 2], False), (["none"], False)
])  # fmt: skip
def test_numbers_can_be_ranked(values: list[Any], ranks: bool) -> None:
    assert made({"field": "seed"}, **{"is": values}).numeric is ranks
