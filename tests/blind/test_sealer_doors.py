"""The sealer imports no room, and no room imports the sealer."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
ROOMS = {"boards", "bus", "plant", "calibration", "host", "scenarios"}


def imported(path: Path) -> set[str]:
    """Full names of the modules a file imports, wherever in the file."""
    out: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            out |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            assert node.level == 0, f"{path}: relative import"
            out |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return out


def test_the_sealer_knows_no_room() -> None:
    files = sorted((ROOT / "tests" / "blind" / "sealer").glob("*.py"))
    assert len(files) > 10
    for path in files:
        for name in imported(path):
            assert name.split(".")[0] not in ROOMS, f"{path.name} imports {name}"
            if name.startswith("tests."):
                assert name.startswith("tests.blind.sealer"), f"{path.name} imports {name}"


@pytest.mark.parametrize("family", ["drives", "world"])
def test_the_families_of_tables_know_no_room(family: str) -> None:
    """What seals knows the sealer's compiler only. The command line, which nothing here imports, hands whole
    cases to the campaigns' executor (tests/blind/family.py); the finder is called by its command."""
    files = sorted((ROOT / "tests" / "blind" / family).glob("*.py"))
    assert len(files) > 8
    for path in files:
        rooms = {name for name in imported(path) if name.split(".")[0] in ROOMS}
        assert not rooms, f"{path.name} imports {rooms}"
        assert f"tests.blind.{family}.__main__" not in imported(path)


def test_no_room_knows_the_tests() -> None:
    for room in sorted(ROOMS):
        for path in (ROOT / room).rglob("*.py"):
            assert not {name for name in imported(path) if name.split(".")[0] == "tests"}, path
