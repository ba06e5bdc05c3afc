"""docs/reference/scenario-fields.md and rig-fields.md: every field of a file, from its JSON schema."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from docs.generate.language import language
from docs.generate.text import MADE, linked, table

_SCENARIO = """# Fields of a scenario

{made}
[The scenario language](scenarios.md) explains them with examples. Faults are on [their own page](faults.md);
units are on [the language's](scenarios.md#values-and-units).
"""
_RIG = """# Fields of a rig file

{made}
[Rig files](rigs.md) explains them, [examples](rig-examples.md) show them.
"""
RIG_SCHEMA = Path(__file__).parents[2] / "calibration" / "inputs" / "rig.schema.json"
ELSEWHERE = {
    "fault": "See [the table of faults](faults.md).",
    "expectation": "See [expectations](scenarios.md#expectations).",
}
"""Definitions that are made on another page."""


def _kind(rule: dict[str, Any]) -> str:
    """What a value is, in a few words."""
    if "$ref" in rule:
        name = rule["$ref"].rpartition("/")[2]
        return f"[{name}](#{name})"
    if "enum" in rule:
        return ", ".join(f"`{word}`" for word in rule["enum"])
    if "oneOf" in rule and "properties" not in rule:
        return " or ".join(
            _kind(each) if "enum" in each else each.get("title") or _kind(each) for each in rule["oneOf"]
        )
    if rule.get("type") == "array":
        return f"list of {_kind(rule.get('items', {}))}"
    return _named(rule) + _bounds(rule)


def _named(rule: dict[str, Any]) -> str:
    kinds = rule.get("type", "any")
    kinds = kinds if isinstance(kinds, list) else [kinds]
    words = {"object": "block", "string": "text", "boolean": "true or false", "integer": "whole number"}
    return " or ".join(words.get(kind, kind) for kind in kinds)


def _bounds(rule: dict[str, Any]) -> str:
    low, high = rule.get("minimum"), rule.get("maximum")
    if low is None and high is None:
        return ""
    return (f" from {low}" if low is not None else "") + (f" to {high}" if high is not None else "")


def _rows(rule: dict[str, Any], path: str = "") -> Iterator[list[str]]:
    """Rows of an object's fields, those of blocks within it after them."""
    for name, each in rule.get("properties", {}).items():
        needed = "required" if name in rule.get("required", ()) else ""
        text = "; ".join(part for part in (needed, linked(each.get("description", ""))) if part)
        yield [f"`{path}{name}`", _kind(each), text]
        inner = each.get("properties", {})
        if len(inner) > 1 and len({str(rule) for rule in inner.values()}) == 1:  # one rule for every board
            yield [f"`{path}{name}.NAME`", _kind(next(iter(inner.values()))), "by name"]
        else:
            yield from _rows(each, f"{path}{name}.")
        items, named = each.get("items", {}), each.get("additionalProperties")
        for other in (*each.get("oneOf", ()), items, *items.get("oneOf", ())):
            yield from _rows(other, f"{path}{name}.")
        if isinstance(named, dict):
            words = ", ".join(f"`{word}`" for word in each.get("propertyNames", {}).get("enum", ()))
            if words:
                yield [f"`{path}{name}.NAME`", _kind(named), f"NAME: {words}"]
            yield from _rows(named, f"{path}{name}.NAME.")


def _definition(name: str, rule: dict[str, Any]) -> str:
    parts = [f"\n## {name}\n"]
    if text := rule.get("description"):
        parts.append(f"\n{text}.\n" if not text.endswith(".") else f"\n{text}\n")
    if examples := rule.get("examples"):
        parts.append("\nFor example " + ", ".join(f"`{each}`" for each in examples) + ".\n")
    rows = list(_rows(rule)) or [row for other in rule.get("oneOf", ()) for row in _rows(other)]
    if rows:
        parts.append(table(["field", "value", "meaning"], rows))
    elif not examples:
        parts.append(f"\nIt is {_kind(rule)}.\n")
    return "".join(parts)


def _page(head: str, rules: dict[str, Any], source: str) -> str:
    top = {name: rule for name, rule in rules.items() if name in ("properties", "required")}
    parts = [head.format(made=MADE.format(source=source)), _definition("the file", top)]
    for name, rule in rules["$defs"].items():
        if name in ELSEWHERE:
            parts.append(f"\n## {name}\n\n{ELSEWHERE[name]}\n")
        elif any(key in rule for key in ("type", "enum", "oneOf")):  # not a condition on other fields
            parts.append(_definition(name, rule))
    return "".join(parts)


def scenario_page() -> str:
    """The page of a scenario's fields, Markdown."""
    return _page(_SCENARIO, language(), "`scenarios/scenario.schema.json`")


def rig_page() -> str:
    """The page of a rig file's fields, Markdown."""
    rules = json.loads(RIG_SCHEMA.read_text(encoding="utf-8"))
    return _page(_RIG, rules, "`calibration/inputs/rig.schema.json`")
