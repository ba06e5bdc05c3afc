"""Nothing stands in the source that nothing else there uses."""

import ast
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
ROOMS = ("bus", "boards", "plant", "calibration", "host", "scenarios")
PAGES = "\n".join(
    (ROOT / name).read_text(encoding="utf-8")
    for name in ("README.md", "FIDELITY.md", "setup.py", "pyproject.toml", "Makefile")
) + "\n".join(
    p.read_text(encoding="utf-8")
    for f in ("guides", "concepts", "reference", "results")
    for p in ROOT.glob(f"docs/{f}/*.md")
    if p.name != "api.md"  # names what there is
)
TABLES = "\n".join(p.read_text(encoding="utf-8") for p in (ROOT / "scenarios").glob("[dlr]*/**/*.yaml"))
"""Of doors, lab and runs: they name classes and functions."""
LOADED_BY_FOLDER = ("plant.effects.", "calibration.names.", "boards.", "scenarios.studies.paper.experiments.")
"""Found where they stand (plant/effects/__init__.py, calibration/names, a board's package, paper's rows)."""


def files() -> Iterator[Path]:
    for room in ROOMS:
        yield from sorted((ROOT / room).rglob("*.py"))


def defined(tree: ast.Module) -> Iterator[str]:
    """Public functions, classes and constants of a module; members of a table of registers are its own."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            yield node.name
        targets = node.targets if isinstance(node, ast.Assign) else []
        targets = [node.target] if isinstance(node, ast.AnnAssign) else targets
        yield from (t.id for t in targets if isinstance(t, ast.Name))


def test_everything_that_is_defined_is_used() -> None:
    """By name, in another place of the source than where it is defined, or on a page."""
    used = Counter(re.findall(r"\b[A-Za-z_]\w*\b", TABLES))
    places: dict[str, list[str]] = {}
    for path in files():
        if "library" in path.parts:
            continue
        text = path.read_text(encoding="utf-8")
        used.update(re.findall(r"\b[A-Za-z_]\w*\b", text))
        for name in set(defined(ast.parse(text))):
            places.setdefault(name, []).append(path.relative_to(ROOT).as_posix())
    lost = {
        name: where
        for name, where in places.items()
        if used[name] <= len(where)
        and not re.search(rf"\b{name}\b", PAGES)
        and not name.startswith(("pytest_", "__"))
        and not any("registers" in place for place in where)
    }
    assert not lost


def modules() -> dict[str, Path]:
    out = {}
    for path in files():
        parts = path.relative_to(ROOT).with_suffix("").parts
        if "library" not in parts:
            out[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return out


def imported(path: Path) -> Iterator[str]:
    """Modules that a file imports or names in a string, and the packages they lie in."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names = [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            names = re.findall(rf"\b(?:{'|'.join(ROOMS)})(?:\.\w+)+", node.value)
        for name in names:
            parts = name.split(".")
            yield from (".".join(parts[: k + 1]) for k in range(len(parts)))


def test_every_module_is_reached_from_a_command() -> None:
    known = modules()
    named = {n.replace("/", ".").removesuffix(".py") for n in re.findall(r"[a-z_]+(?:[./]\w+)+", PAGES)}
    seen: set[str] = set()
    todo = named & set(known)
    doors = re.findall(r"\b([a-z_0-9]+)\.[A-Z]\w+", TABLES)
    todo |= {f"scenarios.doors.{name}" for name in doors} & set(known)
    todo |= {n for n in known if n.startswith(LOADED_BY_FOLDER) or n.endswith("__main__")}
    while todo:
        name = todo.pop()
        seen.add(name)
        todo |= {n for n in imported(known[name]) if n in known} - seen
    empty = {n for n, path in known.items() if len(path.read_text(encoding="utf-8").splitlines()) < 2}
    assert not sorted(set(known) - seen - empty)
