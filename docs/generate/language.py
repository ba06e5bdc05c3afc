"""What is published from the tables of faults and expectations.

The schema's part on each, the tables of docs/reference/faults.md, and that of expectations in scenarios.md.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from docs.generate import faults
from scenarios.language.validate import SCHEMA_FILE
from scenarios.run.evaluate import KINDS, STATISTICS, Kind

REFERENCE = Path(__file__).parents[1] / "reference"
_HEAD = "| expectation | of | limit in | further fields |\n|---|---|---|---|\n"
_WINDOW: dict[str, Any] = {
    "during": {
        "type": "string",
        "description": "Name of the step whose time counts (default: every step the expectation is about)",
    },
    "settle": {"$ref": "#/$defs/time", "description": "Leave out this much at the start of the window"},
    "statistic": {"enum": list(STATISTICS), "description": "Default peak"},
}


def _words(words: Mapping[str, str], quote: str = "") -> str:
    """`sky (the angle between them, default), ra, dec`."""
    default = next(iter(words))
    said = {word: [text] * bool(text) + ["default"] * (word == default) for word, text in words.items()}
    return ", ".join(
        f"{quote}{word}{quote}" + (f" ({', '.join(texts)})" if texts else "") for word, texts in said.items()
    )


def _object(kind: Kind) -> dict[str, Any]:
    rule = {"$ref": f"#/$defs/{kind.limit}"} if kind.limit else {"type": "number"}
    fields = {name: {"enum": list(words), "description": _words(words)} for name, words in kind.words.items()}
    limits = {
        "at_most": rule | {"description": "Upper limit"},
        "at_least": rule | {"description": "Lower limit"},
    }
    return {
        "type": "object",
        "properties": (_WINDOW if kind.steps else {}) | fields | limits,
        "additionalProperties": False,
        "description": kind.text,
        "oneOf": [{"required": [limit]} for limit in limits],
    }


def definition() -> dict[str, Any]:
    """`$defs.expectation` of the schema."""
    return {
        "type": "object",
        "properties": {"name": {"type": "string"}} | {name: _object(kind) for name, kind in KINDS.items()},
        "additionalProperties": False,
        "oneOf": [{"required": [name]} for name in KINDS],
    }


def _row(name: str, kind: Kind) -> str:
    steps = f", in {' and '.join(f'`{step}`' for step in kind.steps)} steps" if kind.steps else ""
    fields = "; ".join(f"`{field}`: {_words(words, '`')}" for field, words in kind.words.items())
    return f"| `{name}` | {kind.text}{steps} | {kind.limit or 'number'} | {fields} |\n".replace("|  |", "| |")


def language() -> dict[str, Any]:
    """The schema of scenarios as it should be."""
    found: dict[str, Any] = json.loads(SCHEMA_FILE.read_text(encoding="utf-8"))
    found["$defs"] |= {"fault": faults.definition(), "expectation": definition()}
    return found


def schema() -> str:
    """The text of the schema."""
    return json.dumps(language(), indent=1, ensure_ascii=False) + "\n"


def faults_page() -> str:
    """The page of faults: what stands before its tables is written by hand."""
    tables = faults.tables()
    written = (REFERENCE / "faults.md").read_text(encoding="utf-8")
    return written.partition(tables[: tables.index("\n") + 1])[0] + tables


def scenarios_page() -> str:
    """The page of the language: all but the table of expectations is written by hand."""
    before, _, rest = (REFERENCE / "scenarios.md").read_text(encoding="utf-8").partition(_HEAD)
    rows = "".join(_row(name, kind) for name, kind in KINDS.items())
    return before + _HEAD + rows + "\n" + rest.partition("\n\n")[2]
