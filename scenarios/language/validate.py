"""A document against the published schema; errors name file, line, field and the nearest valid word."""

import json
import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

from plant.yamltext import beside, nearest
from scenarios.language.document import Document, Path_, ScenarioError
from scenarios.language.units import BASE, QUANTITIES, UnitError, parse, unit_of

SCHEMA_FILE = Path(__file__).parents[1] / "scenario.schema.json"

Problem = tuple[int, int, str]
"""Line, rank within it, text."""
_TYPES = {
    "object": "a block of fields",
    "array": "a list",
    "string": "text",
    "integer": "a whole number",
    "number": "a number",
    "boolean": "true or false",
    "null": "nothing",
}


@cache
def schema(file: Path = SCHEMA_FILE) -> dict[str, Any]:
    """A published JSON schema, of the scenario language unless another is meant."""
    loaded: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    return loaded


@cache
def _validator() -> Any:
    """The class that knows our quantities and their bounds, and fields of which one is needed.

    Making one takes longer than using it on a file.
    """
    from jsonschema import Draft202012Validator, ValidationError
    from jsonschema.validators import extend

    def quantity(_: object, kind: str, value: object, __: object) -> Iterable[Exception]:
        try:
            parse(value, kind)
        except UnitError as error:
            yield ValidationError(str(error))

    def within(_: object, bounds: list[float], value: object, rule: Mapping[str, str]) -> Iterable[Exception]:
        kind = rule.get("x-quantity") or rule["$ref"].rsplit("/", 1)[1]
        with suppress(UnitError):  # which its own rule reports
            if not bounds[0] <= parse(value, kind) <= bounds[1]:
                word = unit_of(value)
                low, high = (bound / (QUANTITIES[kind].units[word] if word else 1.0) for bound in bounds)
                limits = f"{low:g}..{high:g} {word or BASE[kind]}".removesuffix(" 1")
                yield ValidationError(f"{value} is out of range; {limits}")

    def one_of(_: object, names: list[str], value: object, __: object) -> Iterable[Exception]:
        if isinstance(value, Mapping) and not set(names) & set(value):
            yield ValidationError(f"needs a {' or an '.join(names)}")

    rules = {"x-quantity": quantity, "x-range": within, "x-needs": one_of}
    return extend(Draft202012Validator, rules)  # type: ignore[no-untyped-call]


def check(document: Document, language: dict[str, Any] | None = None) -> None:
    """Raise `ScenarioError` for what the language does not allow: the first mistake by line, others as notes.

    language: a JSON schema; None: that of scenarios.
    """
    validator = _validator()(language or schema())
    errors = validator.iter_errors(_plain(document.data))
    problems = sorted({each for error in errors for each in _describe(document, error)})
    if problems:
        first, *others = (text for _, _, text in problems)
        raise beside(ScenarioError(first), others, str(document.file))


def _problem(document: Document, path: Path_, text: str, rank: int = 1) -> Problem:
    location = document.where(path)
    return int(location.rsplit(":", 1)[1]), rank, f"{location}: {text}"


def _describe(document: Document, error: Any) -> Iterator[Problem]:
    path: Path_ = tuple(error.absolute_path)
    field = ".".join(str(part) for part in path) or "the file"
    kind, expected = error.validator, error.validator_value
    if kind == "type" and "x-quantity" in error.schema:
        return  # which says what is expected, too
    if kind == "additionalProperties":
        known = list(error.schema.get("properties", {}))
        inside = f" in {field}" if error.absolute_path else ""
        for wrong in (key for key in error.instance if key not in known):
            text = f"unknown field {str(wrong)!r}{inside}; {nearest(str(wrong), known)}"
            yield _problem(document, (*path, wrong), text, rank=0)  # it explains the field that is missing
        return
    if kind == "enum":
        text = f"{field}: {error.instance!r} is not known; {nearest(str(error.instance), map(str, expected))}"
    elif kind == "type":
        names = [expected] if isinstance(expected, str) else expected
        wanted = " or ".join(_TYPES[name] for name in names)
        text = f"{field}: expected {wanted}, found {_found(error.instance)}"
    elif kind == "required":
        text = f"{field}: field {error.message.rpartition(' is ')[0]} is missing"
    elif kind == "oneOf" and (inner := _meant(error)) is not None:
        yield from _describe(document, inner)
        return
    elif kind == "oneOf":
        text = _choice(field, error)
        if not text:
            return
    elif kind == "pattern" and "propertyNames" in error.absolute_schema_path:
        text = f"{field}: {error.instance!r} is not a parameter's number (see the protocol page)"
    elif kind == "x-quantity":
        text = f"{field}: {error.message}"
    elif kind in ("minimum", "maximum", "exclusiveMinimum"):
        bound = {"minimum": "at least", "maximum": "at most", "exclusiveMinimum": "more than"}[kind]
        text = f"{field}: {error.instance} is out of range; it must be {bound} {expected}"
    elif kind == "maxItems":
        text = f"{field}: {len(error.instance)} entries; at most {expected}"
    else:
        text = f"{field}: {error.message}"
    yield _problem(document, path, text)


def _meant(error: Any) -> Any:
    """Of a value that is none of several forms: the error in the only form of its type, None: none is."""
    of_type = {id(form) for form in error.validator_value if form.get("type") in ("object", "array")}
    errors = [each for each in error.context if id(error.validator_value[each.schema_path[0]]) in of_type]
    wrong = {each.schema_path[0] for each in errors if each.validator == "type" and not each.path}
    inside = [each for each in errors if each.schema_path[0] not in wrong]
    return inside[0] if len({each.schema_path[0] for each in inside}) == 1 else None


def _choice(field: str, error: Any) -> str:
    """Steps, faults and expectations hold exactly one of several keys."""
    keys = [each["required"][0] for each in error.validator_value if "required" in each]
    if len(keys) == len(error.validator_value) and not isinstance(error.instance, Mapping):
        return ""  # its type is reported already
    if keys and isinstance(error.instance, Mapping):
        given = [key for key in keys if key in error.instance]
        if not given:
            if set(error.instance) - set(error.schema.get("properties", {})):
                return ""  # the unknown field is reported already
            return f"{field}: says nothing to do; use one of {', '.join(keys)}"
        return f"{field}: holds {' and '.join(given)}, but only one is allowed"
    forms = [each.get("title", each.get("type", "?")) for each in error.validator_value]
    return f"{field}: {_found(error.instance)} is neither {' nor '.join(map(str, forms))}"


def _found(value: object) -> str:
    if value is None:
        return "nothing"
    if isinstance(value, Mapping):
        return "a block of fields"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str) and re.fullmatch(r"[-+]?[0-9.]+e[-+]?[0-9]+", value):
        return f"the text {value!r}: a number with an exponent has a point and a sign, as 1.0e+3"
    return f"a list of {len(value)}" if isinstance(value, list) else repr(value)


def _plain(value: object) -> object:
    """Odd keys as text, as JSON has them."""
    if isinstance(value, Mapping):
        return {str(key): _plain(each) for key, each in value.items()}
    return [_plain(each) for each in value] if isinstance(value, list) else value
