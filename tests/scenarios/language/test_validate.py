"""What a schema's error becomes: one line with the field, what was found, and what would be right."""

from pathlib import Path
from typing import Any

import pytest

from scenarios.language.document import Document, ScenarioError
from scenarios.language.validate import check

INTEGER: dict[str, Any] = {"type": "integer", "minimum": 1, "maximum": 9}
CHOICE = {
    "type": "object",
    "properties": {"name": {"type": "string"}, "go": {}, "halt": {}},
    "additionalProperties": False,
    "oneOf": [{"required": ["go"]}, {"required": ["halt"]}],
}
FORMS = {"oneOf": [{"title": "a name", "type": "string"}, {"type": "null"}, {"enum": [3.5]}]}
BLOCKS: dict[str, Any] = {
    "oneOf": [
        {"type": "string"},
        {"type": "object", "properties": {"a": INTEGER}, "additionalProperties": False},
    ]
}
LISTS: dict[str, Any] = {
    "oneOf": [{"type": "array", "items": INTEGER}, {"type": "object", "required": ["a"]}]
}
TIME = {"type": ["string", "number"], "x-quantity": "time"}
SHARE = {"type": ["string", "number"], "x-quantity": "fraction", "x-range": [0, 0.5]}


def told(data: object, rule: dict[str, Any], lines: dict[Any, int] | None = None) -> list[str]:
    """Lines that a value gives under a rule, without the file's name."""
    document = Document(Path("f.yaml"), data, {(): 1} if lines is None else lines)
    try:
        check(document, rule)
    except ScenarioError as error:
        return [each.removeprefix("f.yaml:") for each in (str(error), *getattr(error, "__notes__", ()))]
    return []


@pytest.mark.parametrize(("value", "said"), [
    (1, None), (9, None), (0, "0 is out of range; it must be at least 1"),
    (10, "10 is out of range; it must be at most 9"),
    (1.5, "expected a whole number, found 1.5"), (True, "expected a whole number, found true"),
    (None, "expected a whole number, found nothing"), ("x", "expected a whole number, found 'x'"),
    ({"a": 1}, "expected a whole number, found a block of fields"),
    ([1, 2], "expected a whole number, found a list of 2"),
    ("1e3", "expected a whole number, found the text '1e3': a number with an exponent has a point and a "
            "sign, as 1.0e+3"),
    ("-1.5e-3", "expected a whole number, found the text '-1.5e-3': a number with an exponent has a point "
                "and a sign, as 1.0e+3"),
    ("1e3 s", "expected a whole number, found '1e3 s'"),
])  # fmt: skip
def test_a_number_out_of_its_bounds_or_none(value: object, said: str | None) -> None:
    assert told(value, INTEGER) == ([] if said is None else [f"1: the file: {said}"])


@pytest.mark.parametrize(("value", "rule", "said"), [
    (3, {"type": ["string", "null"]}, "expected text or nothing, found 3"),
    (3, {"type": "array"}, "expected a list, found 3"),
    (3, {"type": "boolean"}, "expected true or false, found 3"),
    (3, {"type": "object"}, "expected a block of fields, found 3"),
    ("x", {"type": "number"}, "expected a number, found 'x'"),
    (0, {"exclusiveMinimum": 0}, "0 is out of range; it must be more than 0"),
    ([1, 2, 3], {"maxItems": 2}, "3 entries; at most 2"),
    ("lift", {"enum": ["left", "right"]}, "'lift' is not known; did you mean 'left'?"),
    ({}, {"required": ["name"]}, "field 'name' is missing"),
    ("b", {"const": "a"}, "'a' was expected"),
    ("b", {"pattern": "^a"}, "'b' does not match '^a'"),
    ({}, {"x-needs": ["a", "b"]}, "needs a a or an b"),
    ("3 parsec", TIME, "'3 parsec': unit 'parsec' does not fit; use one of ns, us, µs, ms, s, min, h"),
    ([3], TIME, "[3] is not a value with a unit such as '10 s'"),
    ({"x": 1}, {"propertyNames": {"pattern": "^[0-9]+$"}}, "'x' is not a parameter's number "
     "(see the protocol page)"),
])  # fmt: skip
def test_each_kind_of_mistake(value: object, rule: dict[str, Any], said: str) -> None:
    assert told(value, rule) == [f"1: the file: {said}"]


@pytest.mark.parametrize("value", [{"a": 1}, {"b": 1}, {"a": 1, "b": 1}, 3])
def test_one_of_the_needed_is_enough(value: object) -> None:
    assert told(value, {"x-needs": ["a", "b"]}) == []


@pytest.mark.parametrize(("value", "said"), [
    ("50 %", None), (0.5, None), (0, None), ("51 %", "51 % is out of range; 0..50 %"),
    (-0.1, "-0.1 is out of range; 0..0.5"), ("x", "'x' is not a number with a unit such as '10 %'"),
])  # fmt: skip
def test_bounds_are_told_in_the_values_own_unit(value: object, said: str | None) -> None:
    assert told(value, SHARE) == ([] if said is None else [f"1: the file: {said}"])


def test_bounds_of_a_named_quantity() -> None:
    rule = {"$defs": {"time": TIME}, "properties": {"for": {"$ref": "#/$defs/time", "x-range": [60, 120]}}}
    assert told({"for": "3 min"}, rule) == ["1: for: 3 min is out of range; 1..2 min"]
    assert told({"for": "1 min"}, rule) == told({"for": "120 s"}, rule) == []


@pytest.mark.parametrize(("value", "said"), [
    ({"go": 1}, []), ({"name": "x", "halt": 1}, []),
    ({}, ["says nothing to do; use one of go, halt"]),
    ({"name": "x"}, ["says nothing to do; use one of go, halt"]),
    ({"go": 1, "halt": 1}, ["holds go and halt, but only one is allowed"]),
    ({"gp": 1}, ["unknown field 'gp'; did you mean 'go'?"]),
    (7, ["expected a block of fields, found 7"]),
])  # fmt: skip
def test_one_thing_to_do(value: object, said: list[str]) -> None:
    head = "" if value == {"gp": 1} else "the file: "
    assert told(value, CHOICE) == [f"1: {head}{each}" for each in said]


@pytest.mark.parametrize(("value", "rule", "said"), [
    (7, FORMS, "the file: 7 is neither a name nor null nor ?"),
    ([7], FORMS, "the file: a list of 1 is neither a name nor null nor ?"),
    ({"go": 1}, FORMS, "the file: a block of fields is neither a name nor null nor ?"),
    ({"a": 0}, BLOCKS, "a: 0 is out of range; it must be at least 1"),
    ({"a": 0, "b": 0}, BLOCKS, "a: 0 is out of range; it must be at least 1"),
    ({"b": 0}, BLOCKS, "unknown field 'b'; use one of a"),
    (7, BLOCKS, "the file: 7 is neither string nor object"),
    ([1, 10], LISTS, "1: 10 is out of range; it must be at most 9"),
    ({}, LISTS, "the file: field 'a' is missing"),
    ("x", LISTS, "the file: 'x' is neither array nor object"),
])  # fmt: skip
def test_one_of_several_forms(value: object, rule: dict[str, Any], said: str) -> None:
    assert told(value, rule) == [f"1: {said}"]


def test_mistakes_go_by_line_and_unknown_fields_before_missing_ones() -> None:
    part = {"properties": {"n": INTEGER}, "additionalProperties": False}
    fields = {"name": {}, "part": part}
    rule = {"required": ["name"], "additionalProperties": False, "properties": fields}
    lines = {(): 2, ("nome",): 2, ("part",): 3, ("part", "n"): 5, ("part", "m"): 4}
    assert told({"nome": 1, "part": {"n": 0, "m": 1}}, rule, lines) == [
        "2: unknown field 'nome'; did you mean 'name'?",
        "2: the file: field 'name' is missing",
        "4: unknown field 'm' in part; use one of n",
        "5: part.n: 0 is out of range; it must be at least 1",
    ]


def test_a_key_that_is_a_number_is_text() -> None:
    assert told({3: [{4: 0}]}, {"properties": {"3": {"items": {"properties": {"4": INTEGER}}}}}) == [
        "1: 3.0.4: 0 is out of range; it must be at least 1"
    ]


def test_without_a_schema_it_is_that_of_scenarios_whatever_the_files_name() -> None:
    with pytest.raises(ScenarioError) as caught:
        check(Document(Path("a:b.yaml"), {"name": "x", "start_utc": "now"}, {(): 4}))
    assert str(caught.value) == "a:b.yaml:4: the file: field 'steps' is missing"
