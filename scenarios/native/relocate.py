"""Puts the rooms of a wheel below one package, `schmidt`, so that they collide with nobody's modules.

Used by `setup.py`. In the checkout the rooms are top-level folders, which is how they import each other. A
user may have a `plant.py` or a `bus/` of their own, which an installed `schmidt` must neither take nor
give way to.
"""

import ast
import shutil
from pathlib import Path

from scenarios.native import modules

PACKAGE = "schmidt"
ROOMS = (*modules.ROOMS, "calibration")


class RelocationError(ValueError):
    """An import that has no relocated form."""


def relocate(folder: Path) -> Path:
    """Move the rooms below `folder/schmidt`, which begins as `schmidt.py`, rewrite imports; returns it."""
    package = folder / PACKAGE
    shutil.rmtree(package, ignore_errors=True)
    package.mkdir()
    front = folder / f"{PACKAGE}.py"
    text = rewritten(front.read_text(encoding="utf-8"), front.name)
    (package / "__init__.py").write_text(text, encoding="utf-8")
    front.unlink()
    for room in ROOMS:
        (folder / room).rename(package / room)
        for file in sorted((package / room).rglob("*.py")):
            source = file.read_text(encoding="utf-8")
            file.write_text(rewritten(source, str(file.relative_to(folder))), encoding="utf-8")
    return package


def rewritten(source: str, name: str = "<source>") -> str:
    """`source` with `from plant.model import …` as `from schmidt.plant.model import …`, and `import plant` as
    `import schmidt.plant as plant`. Raises RelocationError for `import plant.model`, which binds `plant`."""
    lines = source.splitlines(keepends=True)
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom) and node.module and not node.level and _ours(node.module):
            _insert(lines, node, "from ")
        elif isinstance(node, ast.Import) and any(_ours(alias.name) for alias in node.names):
            alias = node.names[0]
            if len(node.names) > 1 or ("." in alias.name and not alias.asname):
                raise RelocationError(f"{name}:{node.lineno}: write `from … import …` here")
            _insert(lines, node, "import ", "" if alias.asname else f" as {alias.name}")
    return "".join(lines)


def _ours(module: str) -> bool:
    return module.partition(".")[0] in ROOMS


def _insert(lines: list[str], node: ast.ImportFrom | ast.Import, word: str, behind: str = "") -> None:
    """Put the package's name behind `word` of the statement at `node`, and `behind` at its end."""
    line = lines[node.lineno - 1]
    at = len(line.encode()[: node.col_offset].decode()) + len(word)
    if behind:
        end = len(line.encode()[: node.end_col_offset].decode())
        line = line[:end] + behind + line[end:]
    lines[node.lineno - 1] = f"{line[:at]}{PACKAGE}.{line[at:]}"


def entry_point(target: str) -> str:
    """`scenarios.cli:main` where the wheel has it."""
    return f"{PACKAGE}.{target}" if _ours(target) else target
