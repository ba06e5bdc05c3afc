"""Pages of results name the command that makes them and its day, and begin with what was missed."""

import re
from importlib.util import find_spec
from pathlib import Path

import pytest

from scenarios.cli import cli

ROOT = Path(__file__).parents[2]
PAGES = sorted((ROOT / "docs" / "results").glob("*.md"))
TARGETS = set(re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
_COMMAND = re.compile(r"(?:`|^    )(schmidt|make|python -m) ([\w.-]+)", re.MULTILINE)


def is_there(program: str, name: str) -> bool:
    if program == "schmidt":
        return name in cli.commands
    return name in TARGETS if program == "make" else find_spec(name) is not None


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_a_page_names_its_command_and_its_day_and_what_was_missed_first(page: Path) -> None:
    head, *sections = page.read_text(encoding="utf-8").split("\n## ")
    commands = _COMMAND.findall(head)
    assert commands and all(is_there(*each) for each in commands), commands
    assert re.search(r"\b20\d\d-\d\d-\d\d\b", head)
    assert sections[0].startswith("Missed\n")
    assert len(sections[0].split("\n")) > 3, "nothing is said to be missed"


def test_readme_quotes_the_page_of_the_measured_drives() -> None:
    page = (ROOT / "docs" / "results" / "measured-drives.md").read_text(encoding="utf-8")
    found = re.search(r"The held-out error falls in (\d+ of \d+), and comes", page)
    assert found and f"falls in {found[1]} answers" in (ROOT / "README.md").read_text(encoding="utf-8")
