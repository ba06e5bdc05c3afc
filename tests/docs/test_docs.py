"""Links, commands and file names in the documentation are real."""

import re
import shlex
import subprocess
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from scenarios.cli import SECTIONS, cli
from scenarios.doors.table import ON_HOST, ON_NETWORK

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / name for name in ("README.md", "ARCHITECTURE.md", "FIDELITY.md", "CHANGELOG.md")]
GUIDES = sorted((ROOT / "docs" / "guides").glob("*.md"))
FOLDERS = ("concepts", "results", "decisions", "reference", "sources")
PAGES += sorted((ROOT / "docs").glob("*.md")) + GUIDES
PAGES += [page for name in FOLDERS for page in sorted((ROOT / "docs" / name).glob("*.md"))]
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


@pytest.mark.parametrize("page", [ROOT / "README.md", *GUIDES], ids=lambda page: page.name)
def test_plain_commands_of_the_readme_and_the_guides_are_accepted(page: Path) -> None:
    """Those without placeholders, parsed by click itself."""
    for line in code(page):
        for name, rest in COMMAND.findall(line):
            if not rest.strip() or re.search(r"[\[\]…]|\.\.\.|[A-Z]{3,}", rest):
                continue  # the name of a command, or a form of it
            words = shlex.split(rest.split("#")[0])
            assert cli.commands[name].make_context(name, words, resilient_parsing=False) is not None


def test_documents_that_sources_name_are_in_the_repository() -> None:
    """`docs/reference/rigs.md` by its place, `hardware.md` by its name alone."""
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    files = {ROOT / name for name in listed.splitlines()} | {*(ROOT / "docs").rglob("*.md")}
    files = {file for file in files if file.exists()}
    names = {file.name for file in files} | {"FILE.md"}  # a placeholder
    lost = []
    for file in (each for each in files if each.suffix in (".py", ".md", ".yaml", ".json", ".c", ".h")):
        for name in re.findall(r"(?<![\w/.-])(?:[\w.-]+/)*[\w-]+\.md\b", file.read_text(encoding="utf-8")):
            folders = (
                ROOT,
                file.parent,
                ROOT / "docs" / "reference",
            )  # the last: text of a page that is made
            places = {(folder / name).resolve() for folder in folders}
            if not places & files and ("/" in name or name not in names):
                lost.append(f"{file.relative_to(ROOT)}: {name}")
    assert len(files) > 500
    assert not lost, f"no such document: {', '.join(lost)}"


def test_sections_that_sources_name_are_in_the_document() -> None:
    """`hardware.md 2.3, 3.1`: every number is a heading; `trap ii`, `set S1`, `lesson 3`: the page has it."""
    folder = ROOT / "docs" / "sources"
    pages = {page.name: page.read_text(encoding="utf-8") for page in folder.glob("*.md")}
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    files = [ROOT / name for name in listed.splitlines() if name.endswith((".py", ".yaml", ".c"))]
    lost, seen = [], 0
    for file in (each for each in files if each.exists()):
        text = file.read_text(encoding="utf-8")
        for name, numbers in re.findall(r"\b([a-z-]+\.md) (\d\.\d(?:(?:, | and )\d\.\d)*)(?![\d.])", text):
            for number in re.findall(r"\d\.\d", numbers):
                seen += 1
                if not re.search(rf"^#+ {re.escape(number)} ", pages.get(name, ""), re.MULTILINE):
                    lost.append(f"{file.relative_to(ROOT)}: {name} {number}")
        for name, mark in re.findall(
            r"\b(hardware\.md|effects\.md|design\.md)[ \d.]*, ((?:trap|set|lesson) \w+)", text
        ):
            seen += 1
            word, _, which = mark.partition(" ")
            there = rf"^{which}\. " if word == "lesson" else rf"\b{which}\b"
            if not re.search(there, pages[name], re.MULTILINE):
                lost.append(f"{file.relative_to(ROOT)}: {name}, {mark}")
    assert seen > 50
    assert not lost, f"no such section: {', '.join(lost)}"


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


def test_help_shows_every_command_in_a_section_with_an_example_that_is_accepted() -> None:
    text = CliRunner().invoke(cli, ["--help"], terminal_width=100).output
    for title, section in SECTIONS.items():
        assert f"\n{title}:\n" in text
        for command, example in section:
            program, name, *words = shlex.split(example)
            assert (program, name) == ("schmidt", command.name)
            assert command.make_context(name, words) is not None
            assert f"$ {example}" in text
    assert {command.name for section in SECTIONS.values() for command, _ in section} == set(cli.commands)


def test_every_door_of_the_guide_is_an_option_of_serve() -> None:
    """The cells of "attach a host", parsed by click."""
    text = (ROOT / "docs" / "guides" / "attach-a-host.md").read_text(encoding="utf-8")
    cells = re.findall(r"^\|[^|]+\| `(--[a-z0-9]+ [^`]+)` \|", text, re.MULTILINE)
    for cell in cells:
        assert cli.commands["serve"].make_context("serve", shlex.split(cell)) is not None
    named = {cell.split()[0] for cell in cells}
    assert named <= {f"--{kind.name}" for kind in (*ON_NETWORK, *ON_HOST)}
    assert named >= {"--can", "--serial", "--hid", "--lx200", "--alpaca", "--console", "--control"}
