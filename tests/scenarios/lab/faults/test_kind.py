"""Arguments of a fault: words of the network, quantities, bounds that are allowed themselves, refusals."""

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenarios.lab.faults.kind import Kind, Parameter

KNOWN = {"node": ("AXIS_RA", "DISPLAY"), "axis": ("ra", "dec")}
SHARE = Parameter("load", "of the time", "fraction", low=0.0, high=1.0)
TIME = Parameter("every", "how often", "time", default="", low=0.5)
WHOLE = Parameter("identifier", "of a frame", "identifier", default=7, low=0, high=0x7FF)
FREE = Parameter("factor", "of it", "number", default=2.5)
NODES = Parameter("nodes", "apart", "nodes")


def made(*parameters: Parameter, one_of: tuple[str, ...] = ()) -> Kind:
    return Kind("bus", "noise", "a test", parameters, lambda place, given, t_ns: None, one_of=one_of)  # type: ignore[arg-type,return-value]


def refusal(parameter: Parameter, value: Any) -> str:
    with pytest.raises(ValueError) as caught:
        parameter.read(value, KNOWN)
    return str(caught.value)


def test_a_word_is_one_of_the_network_s() -> None:
    node = Parameter("node", "which", "node")
    assert node.read("DISPLAY", KNOWN) == "DISPLAY"
    assert refusal(node, "DOME") == "node: 'DOME' is not known; use one of AXIS_RA, DISPLAY"


@pytest.mark.parametrize("given", [["DISPLAY", "AXIS_RA"], "DISPLAY,AXIS_RA", ("DISPLAY", "AXIS_RA")])
def test_boards_are_a_list_or_a_text_with_commas(given: Any) -> None:
    assert NODES.read(given, KNOWN) == ["DISPLAY", "AXIS_RA"]


@pytest.mark.parametrize("given", [[], ["DOME"], ["DISPLAY", "DISPLAY"], "DISPLAY,DOME", ""])
def test_boards_are_different_and_of_the_network(given: Any) -> None:
    assert refusal(NODES, given) == "nodes: a list of different boards out of AXIS_RA, DISPLAY"


@pytest.mark.parametrize(
    ("parameter", "given", "value"),
    [(SHARE, "20 %", 0.2), (SHARE, 0, 0.0), (SHARE, 1.0, 1.0), (TIME, "500 ms", 0.5), (TIME, 3, 3.0),
     (WHOLE, "0x7FF", 0x7FF), (WHOLE, 0, 0), (WHOLE, 5.0, 5), (FREE, "1.5", 1.5), (FREE, -1e9, -1e9)],
)  # fmt: skip
def test_numbers_come_in_base_units_and_bounds_are_allowed(
    parameter: Parameter, given: Any, value: float
) -> None:
    found = parameter.read(given, KNOWN)
    assert found == pytest.approx(value)
    assert isinstance(found, int if parameter is WHOLE else float)


@pytest.mark.parametrize(
    ("parameter", "given", "said"),
    [
        (SHARE, 1.1, "load: 1.1 is out of range; 0..1"),
        (SHARE, -0.1, "load: -0.1 is out of range; 0..1"),
        (TIME, "0.4 s", "every: 0.4 s is out of range; at least 0.5 s"),
        (TIME, True, "every: True is no number; at least 0.5 s"),
        (WHOLE, 0x800, "identifier: 2048 is out of range; 0..2047"),
        (WHOLE, 1.5, "identifier: 1.5 is no number; 0..2047"),
        (WHOLE, "ten", "identifier: 'ten' is no number; 0..2047"),
        (WHOLE, float("inf"), "identifier: inf is no number; 0..2047"),
        (FREE, None, "factor: None is no number"),
        (FREE, float("nan"), "factor: nan is no number"),
        (Parameter("a", "b", "angle"), None, "a: None is no number, in arcsec"),
        (Parameter("a", "b", "whole", low=1), None, "a: None is no number; at least 1"),
        (Parameter("a", "b", "number", high=3), 4, "a: 4 is out of range; at most 3"),
    ],
)
def test_a_refusal_says_the_range(parameter: Parameter, given: Any, said: str) -> None:
    assert refusal(parameter, given) == said


def test_a_wrong_unit_is_said_by_the_parser() -> None:
    assert refusal(TIME, "3 deg").startswith("every: '3 deg': unit 'deg' does not fit; use one of ")


@given(st.floats(0.0, 1.0))
def test_whatever_is_within_the_bounds_is_itself(value: float) -> None:
    assert SHARE.read(value, KNOWN) == value


def test_quantities_have_units_and_words_have_none() -> None:
    assert (TIME.quantity, TIME.unit) == ("time", "s")
    assert (FREE.quantity, FREE.unit) == ("", "")
    assert (NODES.default, NODES.low, NODES.high) == (None, None, None)


def test_defaults_fill_in_and_empty_ones_stay_out() -> None:
    kind = made(SHARE, TIME, WHOLE, FREE)
    assert kind.arguments({"load": "50 %"}, KNOWN) == {"load": 0.5, "identifier": 7, "factor": 2.5}
    assert kind.arguments({"load": 1, "every": 2}, KNOWN)["every"] == 2.0
    assert kind.cleared == "nothing" and kind.one_of == ()


@pytest.mark.parametrize(
    ("kind", "given", "said"),
    [
        (made(SHARE, FREE), {"loud": 1}, "noise: unknown argument 'loud'; use load, factor"),
        (made(), {"loud": 1}, "noise: unknown argument 'loud'; use none"),
        (made(SHARE), {}, "noise: load is missing (of the time)"),
        (made(SHARE), {"load": 2}, "noise: load: 2 is out of range; 0..1"),
        (made(TIME, FREE, one_of=("every", "factor")), {}, "noise needs a every or an factor"),
    ],
)
def test_a_fault_s_refusal_begins_with_its_name(kind: Kind, given: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError) as caught:
        kind.arguments(given, KNOWN)
    assert str(caught.value) == said


def test_one_of_several_is_enough() -> None:
    kind = made(TIME, FREE, one_of=("every", "factor"))
    assert kind.arguments({"every": 1.0}, KNOWN) == {"every": 1.0, "factor": 2.5}
