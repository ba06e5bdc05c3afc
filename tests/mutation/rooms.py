"""Rooms that are mutated: the share of mutants to be killed, and where the tests that have to notice are."""

from pathlib import Path

AIMS = {
    "bus": 95, "boards": 95, "plant/kernels": 95, "scenarios/run": 95, "calibration/decide": 90,
    "calibration": 85, "host": 85, "plant": 85, "scenarios": 85,
}  # fmt: skip
"""Rooms, the inner ones before those around them, and the share of mutants that is to be killed, per cent."""
BESIDES = {
    "bus": ("tests/boards/chips/mcp2515", "tests/conformance"),
    "calibration/decide": ("tests/calibration",),
    "scenarios": ("tests/doors", "tests/studies"),
    "plant": ("tests/studies/objective/test_observer.py",),
}
"""Tests outside a room's own that judge its modules, too."""
UNCOMPILED = ("plant", "plant/kernels")
"""Rooms whose compiled functions run as Python, or a mutant would have to be compiled first."""


def room_of(path: str) -> str:
    """The first room of AIMS that a module lies in."""
    return next((room for room in AIMS if path.startswith(f"{room}/")), "")


def modules(room: str) -> list[str]:
    """Every module of a room."""
    files = sorted(Path(room).rglob("*.py"), key=str)
    return [str(each) for each in files if each.name != "__init__.py" and room_of(str(each)) == room]


def folder(path: str) -> Path:
    """The nearest folder of tests that mirrors a room's or a module's."""
    found = Path("tests", path.removesuffix(".py"))
    while found != Path("tests") and not any(found.rglob("test_*.py")):
        found = found.parent
    return found


def judging(room: str) -> list[str]:
    """Files of tests that may notice a mutant of the room."""
    places = [folder(room), *map(Path, BESIDES.get(room, ()))]
    return sorted(
        {str(each) for place in places for each in (place.rglob("test_*.py"), [place])[place.is_file()]}
    )


def mirrors(path: str, test: str) -> bool:
    """Whether a file of tests mirrors the module: it has its name or, without such a one, its folder."""
    own = folder(path)
    named = own / f"test_{Path(path).stem}.py"
    return test == str(named) if named.exists() else Path(test).parent == own
