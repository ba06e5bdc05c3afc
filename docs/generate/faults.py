"""Tables of docs/reference/faults.md and the faults of the scenario schema, both from the table of faults."""

from typing import Any

from scenarios.lab.faults.kind import Kind, Parameter
from scenarios.lab.faults.onsensor import unit
from scenarios.lab.faults.place import AXES, SENSORS
from scenarios.lab.faults.table import KINDS

_LEVELS = {
    "bus": "The cable and who is on it.",
    "board": "A board as a whole.",
    "chip": "Single chips, and the lines between them.",
    "sensor": "What lies between the plant and the chip that reads it.",
    "actuator": "The power stages and their supply.",
    "plant": "What the motors turn.",
}
_WORDS: dict[str, dict[str, Any]] = {
    "node": {"$ref": "#/$defs/node"},
    "nodes": {"type": "array", "items": {"$ref": "#/$defs/node"}, "minItems": 1, "uniqueItems": True},
    "sensor": {"enum": list(SENSORS)},
    "axis": {"enum": list(AXES)},
    "motor": {"enum": ["a", "b"]},
}


def _values(each: Parameter) -> str:
    if each.type in ("node", "nodes"):
        return "a board" if each.type == "node" else "a list of boards"
    if each.type in ("axis", "motor"):
        return " ".join(f"`{word}`" for word in _WORDS[each.type]["enum"])
    if each.type == "sensor":
        return "a sensor"
    kind = each.quantity or {"identifier": "a standard identifier", "whole": "a whole number"}.get(
        each.type, "a number"
    )
    unit_text = f" {each.unit}" if each.unit not in ("", "1") else ""
    if each.low is not None and each.high is not None:
        kind += f", {each.low:g} to {each.high:g}{unit_text}"
    return kind


def _argument(each: Parameter) -> str:
    default = "" if each.default in (None, "") else f", default {each.default:g}"
    optional = " optional," if each.default == "" else ""
    return f"`{each.name}`:{optional} {each.text} ({_values(each)}{default})"


def tables() -> str:
    """The page from its first heading of a level on; what stands before is written by hand."""
    lines: list[str] = []
    for level, text in _LEVELS.items():
        lines += [f"## {level.capitalize()}", text, ""]
        lines += ["| fault | arguments | what happens | left when cleared |", "|---|---|---|---|"]
        for kind in KINDS:
            if kind.level == level:
                arguments = ". ".join(_argument(each) for each in kind.parameters) or "none: `{}`"
                lines.append(f"| `{kind.name}` | {arguments} | {kind.text} | {kind.cleared} |")
        lines.append("")
    units: dict[str, list[str]] = {}
    for sensor in SENSORS:
        units.setdefault(unit(sensor) or "a level", []).append(f"`{sensor}`")
    lines += ["## Sensors", "| read in | sensors |", "|---|---|"]
    lines += [f"| {each} | {' '.join(names)} |" for each, names in units.items()]
    return "\n".join(lines) + "\n"


def _property(each: Parameter) -> dict[str, Any]:
    if each.type in _WORDS:
        return {**_WORDS[each.type], "description": each.text}
    if each.quantity:
        within = [each.low, each.high]
        return {"$ref": f"#/$defs/{each.quantity}", "x-range": within, "description": each.text}
    rule: dict[str, Any] = {"type": "integer" if each.type in ("identifier", "whole") else "number"}
    bounds = {"minimum": each.low, "maximum": each.high}
    rule |= {key: bound for key, bound in bounds.items() if bound is not None}
    return {**rule, "description": each.text}


def _object(kind: Kind) -> dict[str, Any]:
    rule: dict[str, Any] = {
        "type": "object",
        "properties": {each.name: _property(each) for each in kind.parameters},
        "additionalProperties": False,
        "description": kind.text,
    }
    required = [each.name for each in kind.parameters if each.default is None]
    if required:
        rule["required"] = required
    if kind.one_of:
        rule |= {"minProperties": 1, "x-needs": list(kind.one_of)}
    return rule


def definition() -> dict[str, Any]:
    """`$defs.fault` of the schema."""
    time = {"$ref": "#/$defs/time"}
    properties: dict[str, Any] = {
        "name": {"type": "string"},
        "at": {**time, "description": "From (default: the start)"},
        "until": {**time, "description": "To (default: the end)"},
        "may_not_act": {
            "type": "boolean",
            "description": "The run does not fail when this fault never acts (default: it does)",
        },
    }
    return {
        "type": "object",
        "properties": properties | {kind.name: _object(kind) for kind in KINDS},
        "additionalProperties": False,
        "oneOf": [{"required": [kind.name]} for kind in KINDS],
    }
