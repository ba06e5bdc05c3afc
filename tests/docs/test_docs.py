"""Links, commands and file names in the documentation are real."""

import re
import shlex
from pathlib import Path

import click
import pytest

from scenarios.cli import cli

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / name for name in ("README.md", "ARCHITECTURE.md", "FIDELITY.md", "CHANGELOG.md")]
PAGES += sorted((ROOT / "docs").glob("*.md"))
COMMAND = re.compile(r"(?<![\w-])schmidt ([a-z]+)\b([^`|\n]*)")
_OUTSIDE = re.compile(r"^[a-z]+:")


def code(page: Path) -> list[str]:
    """Code spans, fenced and indented code of a page."""
    text = page.read_text(encoding="utf-8")
    fenced = re.findall(r"```\w*\n(.*?)```", text, re.DOTALL)
    plain = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    lines = [line for block in fenced for line in block.splitlines()]
    lines += [line for line in plain.splitlines() if line.startswith("    ")]
    return lines + re.findall(r"`([^`\n]+)`", plain)


def anchors(page: Path) -> set[str]:
    """Anchors of the headings, as GitHub makes them."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_relative_links_resolve(page: Path) -> None:
    text = re.sub(r"```.*?```|`[^`\n]+`", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if _OUTSIDE.match(target):
            continue
        name, _, anchor = target.partition("#")
        linked = (page.parent / name).resolve() if name else page
        assert linked.exists(), f"{page.name} links to {target}, which does not exist"
        assert not anchor or anchor in anchors(linked), f"{page.name}: no heading for {target}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_commands_and_their_options_exist(page: Path) -> None:
    for line in code(page):
        for name, rest in COMMAND.findall(line):
            assert name in cli.commands, f"{page.name}: there is no 'schmidt {name}'"
            command = cli.commands[name]
            options = {option for each in command.params for option in (*each.opts, *each.secondary_opts)}
            for option in re.findall(r"(?<![\w-])--[a-z][\w-]*", rest):
                assert option in {*options, "--help"}, f"{page.name}: 'schmidt {name}' has no option {option}"


def test_plain_commands_of_the_readme_are_accepted() -> None:
    """Those without placeholders, parsed by click itself."""
    tried = 0
    for line in code(ROOT / "README.md"):
        for name, rest in COMMAND.findall(line):
            if re.search(r"[\[\]…]|\.\.\.|[A-Z]{3,}", rest):
                continue
            words = shlex.split(rest.split("#")[0])
            assert cli.commands[name].make_context(name, words, resilient_parsing=False) is not None
            tried += 1
    assert tried >= 3


def test_every_command_is_in_the_readme_or_a_page_of_docs() -> None:
    told = {name for page in PAGES for line in code(page) for name, _ in COMMAND.findall(line)}
    assert set(cli.commands) - told <= {"protocol"}, "commands nobody tells a user about"


def test_make_targets_of_the_readme_exist() -> None:
    targets = set(re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
    named = {name for page in PAGES for line in code(page) for name in re.findall(r"^\s*make ([a-z]+)", line)}
    assert {"run", "test"} <= named
    assert named <= targets, f"no such make target: {', '.join(sorted(named - targets))}"


def test_the_readme_names_what_the_command_does() -> None:
    assert isinstance(cli, click.Group)
    for name, command in cli.commands.items():
        assert command.help, f"schmidt {name} has no help"


def test_every_door_of_the_readme_is_an_option_of_serve() -> None:
    """The cells of "attach your host", parsed by click."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    cells = re.findall(r"^\|[^|]+\| `(--[a-z0-9]+ [^`]+)` \|", text, re.MULTILINE)
    for cell in cells:
        assert cli.commands["serve"].make_context("serve", shlex.split(cell)) is not None
    named = {cell.split()[0] for cell in cells}
    assert named == {"--can", "--serial", "--hid", "--lx200", "--alpaca", "--console", "--control"}
