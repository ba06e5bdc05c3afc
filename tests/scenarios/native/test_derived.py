"""Python forbids that plain code derives from a compiled class, unless that says it may be: none does."""

import ast
from collections.abc import Iterator
from pathlib import Path

from scenarios.native.modules import PLAIN, ROOMS, ROOT, selected

# bases of classes that mypyc leaves open
OPEN = {"NamedTuple", "IntEnum", "IntFlag", "Enum", "Protocol", "Exception", "ValueError", "RuntimeError"}


def classes(path: Path) -> Iterator[ast.ClassDef]:
    return (n for n in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(n, ast.ClassDef))


def bases(one: ast.ClassDef) -> set[str]:
    return {base.id for base in one.bases if isinstance(base, ast.Name)}


def module(path: str) -> str:
    return path.removesuffix(".py").removesuffix("/__init__").replace("/", ".")


def test_no_plain_class_derives_from_a_closed_one() -> None:
    compiled = selected()
    closed = {
        (module(path), one.name)
        for path in compiled
        for one in classes(ROOT / path)
        if not bases(one) & OPEN and not any("mypyc_attr" in ast.dump(d) for d in one.decorator_list)
    }
    assert closed
    plain = {p.relative_to(ROOT).as_posix() for room in ROOMS for p in (ROOT / room).rglob("*.py")}
    found = []
    for path in sorted(plain - set(compiled)):
        tree = ast.parse((ROOT / path).read_text("utf-8"))
        imported = {
            a.asname or a.name: (n.module, a.name)
            for n in ast.walk(tree)
            if isinstance(n, ast.ImportFrom)
            for a in n.names
        }
        for one in classes(ROOT / path):
            found += [f"{path}: {b}" for b in bases(one) if imported.get(b) in closed]
    assert not found


def test_what_stays_plain_is_there() -> None:
    assert [path for path in PLAIN if not (ROOT / path).exists()] == []
