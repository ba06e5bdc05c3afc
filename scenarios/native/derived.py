"""Compiled modules whose classes plain code derives from: Python forbids that, so they stay plain, too."""

import ast
from collections.abc import Iterable
from pathlib import Path

from scenarios.native.modules import ROOMS, module_name

_MARK = "mypyc_attr"
"""A class so marked says itself that it may be derived from."""


def derived_from(root: Path, compiled: Iterable[str]) -> dict[str, str]:
    """Of the files to compile those that stay plain, and who derives from them. Both relative to `root`."""
    modules = {module_name(path): path for path in compiled}
    closed = {
        (module, name) for module, path in modules.items() for name in _native_classes(_tree(root / path))
    }
    found: dict[str, str] = {}
    for file in sorted(path for room in _rooms(root) for path in room.rglob("*.py")):
        place = file.relative_to(root).as_posix()
        if place in modules.values():
            continue
        tree = _tree(file)
        origin = {
            alias.asname or alias.name: (node.module, alias.name)
            for node in ast.walk(tree)
            if isinstance(node, ast.ImportFrom) and node.module
            for alias in node.names
        }
        bases = {base.id for node in ast.walk(tree) if isinstance(node, ast.ClassDef) for base in node.bases
                 if isinstance(base, ast.Name)}  # fmt: skip
        for module, name in (origin[base] for base in bases & origin.keys()):
            if (module, name) in closed:
                found[modules[module]] = f"{place} derives from {name}"
    return found


def _rooms(root: Path) -> list[Path]:
    return [root / name for name in ROOMS if (root / name).is_dir()]


def _tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def _native_classes(tree: ast.Module) -> set[str]:
    """Classes that mypyc closes: without a mark, and no tuples, enumerations or errors, which stay open."""
    open_bases = {
        "NamedTuple",
        "IntEnum",
        "IntFlag",
        "Enum",
        "Protocol",
        "Exception",
        "ValueError",
        "RuntimeError",
    }
    return {
        node.name
        for node in tree.body
        if isinstance(node, ast.ClassDef)
        and not any(isinstance(base, ast.Name) and base.id in open_bases for base in node.bases)
        and not any(_MARK in ast.dump(mark) for mark in node.decorator_list)
    }
