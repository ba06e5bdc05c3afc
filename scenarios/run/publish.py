"""`python -m scenarios.run.publish [--check]`: what is published from the tables of faults and expectations.

The schema's part on each, the tables of docs/reference/faults.md, and that of expectations in scenarios.md.
"""

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from scenarios.lab.faults import catalogue
from scenarios.language.validate import SCHEMA_FILE
from scenarios.run.evaluate import KINDS, STATISTICS, Kind

DOCS = Path(__file__).parents[2] / "docs"
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


def published() -> dict[Path, str]:
    """File to the text it should have."""
    language = json.loads(SCHEMA_FILE.read_text(encoding="utf-8"))
    language["$defs"] |= {"fault": catalogue.definition(), "expectation": definition()}
    faults, scenarios = (DOCS / "reference" / name for name in ("faults.md", "scenarios.md"))
    tables = catalogue.tables()
    before, _, rest = scenarios.read_text(encoding="utf-8").partition(_HEAD)
    rows = "".join(_row(name, kind) for name, kind in KINDS.items())
    return {
        SCHEMA_FILE: json.dumps(language, indent=1, ensure_ascii=False) + "\n",
        faults: faults.read_text(encoding="utf-8").partition(tables[: tables.index("\n") + 1])[0] + tables,
        scenarios: before + _HEAD + rows + "\n" + rest.partition("\n\n")[2],
    }


def main(arguments: list[str]) -> int:
    """Write what has changed, or with --check say what would."""
    stale = {file: text for file, text in published().items() if file.read_text(encoding="utf-8") != text}
    if "--check" not in arguments:
        for file, text in stale.items():
            file.write_text(text, encoding="utf-8")
    elif stale:
        names = ", ".join(file.name for file in stale)
        print(f"{names}: not as the tables of faults and expectations; run python -m scenarios.run.publish")
    return 1 if stale and "--check" in arguments else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
