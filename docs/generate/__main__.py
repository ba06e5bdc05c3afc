"""`python -m docs.generate [--check]`: write the pages and the schema made from code, or say which differ."""

import sys
from pathlib import Path

from bus.protocol import page as protocol
from bus.protocol.nodes import DEVICES, documented
from docs.generate import api, commands, effects, fields, language, parameters
from scenarios.language.validate import SCHEMA_FILE

REFERENCE = Path(__file__).parents[1] / "reference"
PAGES = {
    "api.md": api.page,
    "commands.md": commands.page,
    "effects.md": effects.page,
    "faults.md": language.faults_page,
    "parameters.md": parameters.page,
    "protocol.md": protocol.page,
    "rig-fields.md": fields.rig_page,
    "scenario-fields.md": fields.scenario_page,
    "scenarios.md": language.scenarios_page,
    str(SCHEMA_FILE): language.schema,
}


def stale() -> dict[Path, str]:
    """File to the text it should have, for those that have another."""
    made = {REFERENCE / name: page() for name, page in PAGES.items()}
    return {
        file: text
        for file, text in made.items()
        if not file.exists() or file.read_text(encoding="utf-8") != text
    }


def main(arguments: list[str]) -> int:
    """Write what has changed, or with --check say what would and return 1."""
    changed = stale()
    if "--check" in arguments:
        for file in changed:
            print(f"{file}: not what the code says; run python -m docs.generate", file=sys.stderr)
        return 1 if changed else 0
    for file, text in changed.items():
        file.write_text(text, encoding="utf-8")
    # versions of cantools differ in the text: tests/bus/protocol/test_nodes.py compares what it says
    dbc: str = documented(DEVICES).as_dbc_string(sort_signals=None)
    protocol.DBC_PATH.write_text(dbc.replace("\r\n", "\n"), encoding="utf-8", newline="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
