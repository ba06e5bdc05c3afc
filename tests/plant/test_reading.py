"""What a plant file may say, to the last value that may stand there, and where an error points."""

from dataclasses import fields
from math import pi

import pytest
import yaml

from plant import model
from plant.model import ModelError, load, loads
from plant.parts import Friction, Stops
from plant.reading import Reader
from plant.units import UNITS, factor, to_si


def node(text: str) -> yaml.Node:
    return yaml.compose(text)


def fails(read: str, text: str, *arguments: object) -> str:
    with pytest.raises(ModelError) as caught:
        getattr(Reader("a.yaml"), read)(node(text), "here", *arguments)
    return str(caught.value)


@pytest.mark.parametrize(
    ("unit", "base", "size"),
    [
        ("%", "1", 0.01), ("ppm", "1", 1e-6), ("N mm", "N m", 1e-3), ("N m s2", "kg m2", 1.0),
        ("N mm s2", "kg m2", 1e-3), ("N mm/rad", "N m/rad", 1e-3), ("deg", "rad", pi / 180),
        ("arcsec", "rad", pi / 648_000), ("deg/s", "rad/s", pi / 180), ("arcsec/s", "rad/s", pi / 648_000),
        ("arcsec/s2", "rad/s2", pi / 648_000), ("arcsec/(N m)", "rad/(N m)", pi / 648_000),
        ("arcsec/K", "rad/K", pi / 648_000), ("mV", "V", 1e-3), ("mA", "A", 1e-3), ("mohm", "ohm", 1e-3),
        ("mH", "H", 1e-3), ("V s/rad", "N m/A", 1.0), ("ms", "s", 1e-3), ("us", "s", 1e-6),
        ("kHz", "Hz", 1e3), ("K/h", "K/s", 1 / 3600), ("mm", "m", 1e-3), ("um", "m", 1e-6),
        ("mm/turn", "m/turn", 1e-3),
        ("N mm motor", "N m", 0.360489), ("deg motor", "rad", pi / 180 / 360.489),  # paper: the train's ratio
    ],
)  # fmt: skip
def test_a_unit_has_its_size(unit: str, base: str, size: float) -> None:
    assert factor(unit, base) == pytest.approx(size, rel=1e-5)
    assert to_si(3.0, unit) == pytest.approx(3.0 * size, rel=1e-5)
    assert UNITS[base] == (base, 1.0)


def test_another_quantity_is_no_unit() -> None:
    with pytest.raises(KeyError):
        factor("mV", "A")


NUMBER = "{{value: {}, unit: {}, source: a test}}"


@pytest.mark.parametrize(("value", "unit", "good"), [
    ("2", "V", True), ("9", "V", True), ("9000", "mV", True), ("1.999", "V", False),
    ("9.001", "V", False), ("9001", "mV", False), (".nan", "V", False),
    (".inf", "V", False), ("high", "V", False), ("3", "A", False),
])  # fmt: skip
def test_a_number_lies_within_its_bounds_in_any_unit(value: str, unit: str, good: bool) -> None:
    text = NUMBER.format(value, unit)
    if good:
        number = Reader("a.yaml").number(node(text), "here", "V", 2.0, 9.0)
        assert (number.value, number.unit, number.source) == (float(value), unit, "a test")
    else:
        assert fails("number", text, "V", 2.0, 9.0).startswith("a.yaml, line 1: here")


def test_bits_are_whole_and_a_source_is_said() -> None:
    assert "29.5 bit is no whole number" in fails("number", NUMBER.format(29.5, "bit"), "bit", 1.0, 40.0)
    empty = "{value: 1, unit: V, source: ' '}"
    assert "here.source: is empty" in fails("number", empty, "V", 0.0, 9.0)
    assert "120 V is outside 2 to 9 V" in fails("number", NUMBER.format(120, "V"), "V", 2.0, 9.0)
    assert "12 is outside 2 to 9" in fails("number", NUMBER.format(12, "1"), "1", 2.0, 9.0)


def stops(low: float, high: float) -> str:
    ends = {
        "low": (low, "deg"),
        "high": (high, "deg"),
        "stiffness": (1e6, "N m/rad"),
        "damping": (1e3, "N m s/rad"),
    }
    assert {f.name for f in fields(Stops)} == set(ends)
    rows = (
        f"{name}: {{value: {value}, unit: {unit}, source: a test}}" for name, (value, unit) in ends.items()
    )
    return "{" + ", ".join(rows) + "}"


def test_stops_have_the_low_one_below_the_high_one() -> None:
    assert Reader("a.yaml").stops(node(stops(-10.0, 10.0)), "here").low.value == -10.0
    for low, high in ((10.0, 10.0), (10.0, -10.0)):
        assert "low must lie below high" in fails("stops", stops(low, high))


def unknown(knots: object, **more: object) -> str:
    return yaml.safe_dump(
        {"target": "torque", "domain": "axis_angle", "knots": knots, "source": "a test"} | more
    )


def test_a_function_has_its_defaults() -> None:
    found = Reader("a.yaml").function(node(unknown([[0.0, 1.0], [2.0, 3.0]])), "here")
    assert (found.target, found.domain, found.interpolation) == ("torque", "axis_angle", "cubic")
    assert (found.period, found.motor, found.knots) == (0.0, 0, ((0.0, 1.0), (2.0, 3.0)))
    falling = Reader("a.yaml").function(node(unknown([[0.0, 9.0], [2.0, 3.0]])), "here")
    assert falling.knots == ((0.0, 9.0), (2.0, 3.0))
    more = Reader("a.yaml").function(
        node(unknown([[1, 2]], period=4.5, motor="2", domain="velocity")), "here"
    )
    assert (more.period, more.motor, more.domain) == (4.5, 2, "velocity")


@pytest.mark.parametrize(("kind", "most"), [("linear", 32), ("cubic", 32), ("stop", 12)])
def test_a_function_has_as_many_knots_as_its_row_has_places(kind: str, most: int) -> None:
    knots = [[k + 1.0, 0.0] for k in range(most)]
    assert len(Reader("a.yaml").function(node(unknown(knots, interpolation=kind)), "here").knots) == most
    for wrong in ([*knots, [99.0, 0.0]], [], "none"):
        text = fails("function", unknown(wrong, interpolation=kind))
        assert f"here.knots: expected a list of 1 to {most} pairs [x, y], SI units" in text


@pytest.mark.parametrize(
    ("knots", "more", "words"),
    [
        ([[0, 1], [0, 2]], {}, "here.knots.1: knots must rise in x"),
        ([[0, 1], [1]], {}, "here.knots.1: expected a pair [x, y]"),
        ([[0, 1], 5], {}, "here.knots.1: expected a pair [x, y]"),
        ([[0, "a"]], {}, "here.knots.0: expected a number, not 'a'"),
        ([[0, 1]], {"interpolation": "stop"}, "here.knots.0: the radius of a stop must be above zero"),
        ([[1, 1]], {"interpolation": "stop", "domain": "velocity"}, "a sum of stops follows the axis_angle"),
        ([[1, 1]], {"motor": "3"}, "here.motor: '3' is not known"),
    ],
)
def test_a_wrong_function_is_said_at_its_place(knots: object, more: dict[str, object], words: str) -> None:
    assert words in fails("function", unknown(knots, **more))


def test_a_hundred_effects_may_be_declared() -> None:
    row = "- {name: gravity_imbalance}\n"
    assert len(Reader("a.yaml").effects(node(row * 100), "here")) == 100
    assert "101 effects; at most 100" in fails("effects", row * 101)
    assert Reader("a.yaml").effects(node("~"), "here") == ()


@pytest.mark.parametrize(
    ("harmonic", "good"), [("1", True), ("1000", True), ("0", False), ("1001", False), ("1.5", False)]
)
def test_a_harmonic_is_a_whole_number_up_to_a_thousand(harmonic: str, good: bool) -> None:
    text = f"{{name: gear_mesh, stage: mesh2, harmonic: {harmonic}}}"
    if good:
        assert Reader("a.yaml").effect(node(text), "here").harmonic == int(harmonic)
    else:
        assert "here.harmonic: expected a whole number from 1 to 1000" in fails("effect", text)
    assert Reader("a.yaml").effect(node("{name: gear_mesh, stage: mesh2}"), "here").harmonic == 1


def test_every_part_of_a_file_is_read_where_it_stands() -> None:
    text = model.dumps(load())
    lines = text.splitlines()
    for name in (f.name for f in fields(Friction) if f"{f.name}:" in text):
        line = next(k for k, each in enumerate(lines) if each.strip().startswith(f"{name}:"))
        wrong = [*lines[:line], lines[line].replace(f"{name}:", f"{name}x:"), *lines[line + 1 :]]
        with pytest.raises(
            ModelError, match=rf"line {line + 1}: .*{name}x: unknown field; did you mean '{name}'"
        ):
            loads("\n".join(wrong))


@pytest.mark.parametrize(("value", "good"), [
    (-4.0 - 4e-9, True), (-4.0 - 5e-9, False), (-4.0, True), (2.0 + 4e-9, True), (2.0 + 5e-9, False),
])  # fmt: skip
def test_a_rounding_may_be_beyond_a_bound(value: float, good: bool) -> None:
    """A part in 10^9 of the larger bound, as a number may come from another unit."""
    text = NUMBER.format(repr(value), "V")
    if good:
        assert Reader("a.yaml").number(node(text), "here", "V", -4.0, 2.0).value == value
    else:
        assert "is outside -4 to 2 V" in fails("number", text, "V", -4.0, 2.0)


def test_what_is_no_list_of_effects_is_refused() -> None:
    for text in ("some", "{name: gear_mesh}"):
        assert fails("effects", text) == "a.yaml, line 1: here: expected a list of effects"
    for text in ("''", "null"):
        assert Reader("a.yaml").effects(node(text), "here") == ()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{stage: mesh1}", "here.name: missing"),
        ("[1]", "here: expected a mapping of fields"),
        ("{name: gear_mash}", "here.name: 'gear_mash' is not known; did you mean 'gear_mesh'?"),
        ("{name: gear_mesh}", "here.stage: missing"),
        (
            "{name: gear_mesh, stage: motor}",
            "here.stage: 'motor' is not known; use one of mesh1, mesh2, mesh3",
        ),
        ("{name: wind_torque, stage: motor}", "here.stage: unknown field"),
        ("{name: wind_torque, harmonic: 1}", "here.harmonic: unknown field"),
        ("{name: wind_torque, enabled: maybe}", "here.enabled: 'maybe' is not known; use one of true, false"),
        (
            "{name: wind_torque, parameters: {men: 1}}",
            "here.parameters.men: unknown field; did you mean 'mean'?",
        ),
        ("{name: wind_torque, parameters: {mean: 1}}", "here.parameters.mean: expected a mapping of fields"),
        ("{name: gear_mesh, stage: mesh1, harmonic: x}", "here.harmonic: expected a number, not 'x'"),
        ("{name: unknown}", "here.function: missing"),
        ("{name: unknown, function: {}}", "here.function.target: missing"),
        ("{name: unknown, function: {}, stage: axis}", "here.stage: unknown field"),
    ],
)
def test_a_wrong_effect_is_said_at_its_place(text: str, words: str) -> None:
    assert fails("effect", text).startswith(f"a.yaml, line 1: {words}")


def test_an_effect_is_read_with_all_that_it_has() -> None:
    found = Reader("a.yaml").effect(
        node(
            "{name: gear_mesh, stage: mesh3, harmonic: 4, enabled: false,"
            " parameters: {phase: {value: 90, unit: deg, source: a test}}}"
        ),
        "here",
    )
    assert (found.name, found.stage, found.harmonic, found.enabled) == ("gear_mesh", "mesh3", 4, False)
    assert {word: each.si for word, each in found.parameters.items()} == {"phase": pytest.approx(pi / 2)}
    assert found.function is None
    stageless = Reader("a.yaml").effect(node("{name: wind_torque}"), "here")
    assert (stageless.stage, stageless.harmonic, stageless.enabled) == (None, 1, True)
    shape = "{target: torque, domain: time, knots: [[1, 2]], source: a test}"
    other = Reader("a.yaml").effect(node(f"{{name: unknown, function: {shape}, enabled: false}}"), "here")
    assert other.function is not None and other.function.knots == ((1.0, 2.0),) and not other.enabled


def test_a_turn_has_1296000_arcsec() -> None:
    assert to_si(648_000.0, "arcsec") == pytest.approx(pi, rel=1e-12)
    assert factor("deg", "arcsec") == pytest.approx(3600.0) and factor("arcsec", "deg") == pytest.approx(
        1 / 3600
    )
