"""docs/reference/api.md: classes and functions for users, from the source's signatures and docstrings.

The source is parsed, not imported: compiled functions do not tell their parameters.
"""

import ast
from collections.abc import Iterator
from pathlib import Path

from docs.generate.public import PUBLIC
from docs.generate.text import MADE, prose

ROOT = Path(__file__).parents[2]
_HEAD = """# Python interfaces

{made}
These are the classes and functions that a program of yours imports. [From Python](../guides/from-python.md)
has whole programs, which the tests run. Times are integer nanoseconds since the start; a callback gets the
time.
"""
Function = ast.FunctionDef | ast.AsyncFunctionDef
_OWN = ("self", "cls")


def _parameters(function: Function) -> str:
    """Parameters with types and defaults, without `self`."""
    said = ast.unparse(function.args)
    for own in _OWN:
        said = said.removeprefix(f"{own}, ").removeprefix(own)
    return said.removeprefix("/, ")


def _signature(function: Function, name: str | None = None) -> str:
    returns = f" -> {ast.unparse(function.returns)}" if function.returns and name is None else ""
    return f"{name or function.name}({_parameters(function)}){returns}"


def _decorated(node: Function | ast.ClassDef, name: str) -> bool:
    return any(name in ast.unparse(each) for each in node.decorator_list)


def _comment(body: list[ast.stmt], place: int) -> str:
    """Docstring of the field before `place`."""
    after = body[place] if place < len(body) else None
    if isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant):
        return prose(str(after.value.value))
    return ""


def _members(node: ast.ClassDef) -> Iterator[str]:
    """One line for each public field, property and method of a class."""
    for place, each in enumerate(node.body, 1):
        if isinstance(each, ast.AnnAssign) and isinstance(each.target, ast.Name):
            kind = ast.unparse(each.annotation)
            if not each.target.id.startswith("_") and "ClassVar" not in kind:
                default = f" = {ast.unparse(each.value)}" if each.value else ""
                yield _line(f"{each.target.id}: {kind}{default}", _comment(node.body, place))
        if isinstance(each, Function) and not each.name.startswith("_") and not _decorated(each, ".setter"):
            text = prose(ast.get_docstring(each) or "")
            if _decorated(each, "property"):
                returns = ast.unparse(each.returns) if each.returns else "object"
                yield _line(f"{each.name}: {returns}", text)
            else:
                yield _line(_signature(each), text)


def _line(code: str, text: str) -> str:
    return f"- `{code}`" + (f"  \n  {' '.join(text.split())}" if text else "") + "\n"


def _entry(module: str, name: str) -> Iterator[str]:
    """One class or function."""
    tree = ast.parse((ROOT / (module.replace(".", "/") + ".py")).read_text(encoding="utf-8"))
    kinds = (ast.ClassDef, *Function.__args__)
    node = next(each for each in tree.body if isinstance(each, kinds) and each.name == name)
    shown = f"def {_signature(node)}" if isinstance(node, Function) else _class(node)
    yield f"\n### {name}\n\n```python\nfrom {module} import {name}\n\n{shown}\n```\n"
    if text := ast.get_docstring(node):
        yield f"\n{prose(text)}\n"
    if isinstance(node, ast.ClassDef) and (members := list(_members(node))):
        yield "\n" + "".join(members)


def _class(node: ast.ClassDef) -> str:
    inside = {each.name: each for each in node.body if isinstance(each, Function)}
    bases = [ast.unparse(each) for each in node.bases]
    return (
        f"class {_signature(inside['__init__'], node.name)}"
        if "__init__" in inside
        else (f"class {node.name}" + (f"({', '.join(bases)})" if bases else ""))
    )


def page() -> str:
    """The whole page, Markdown."""
    parts = [_HEAD.format(made=MADE.format(source="docstrings; `docs/generate/public.py` says of what"))]
    for title, (text, entries) in PUBLIC.items():
        parts.append(f"\n## {title}\n\n{text}\n")
        for entry in entries:
            parts += _entry(*entry.split(":"))
    return "".join(parts)
