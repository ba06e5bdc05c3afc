"""Numbers that decide: none stands bare in a comparison, each named one says its unit, why and whence."""

import ast
import re
from collections.abc import Callable
from pathlib import Path

ROOM = Path(__file__).parents[2] / "calibration"
# counting, a sign, half and twice are no thresholds
PLAIN = {0, 1, -1, 2, -2, 0.5}
# the unit, at the name's end or in the words above
UNITS = (
    "s ms Hz rad rad/s arcsec arcsec/s N m V A K px ohm turn turns order orders count counts row rows column"
    " columns period periods point points piece pieces line lines block blocks file files run runs knots draw"
    " draws step steps place places round rounds fold folds cycles bin bins sine sines harmonic harmonics"
    " candidates function functions value values characters effects pictures surrogates evaluations frames"
    " wraps error errors deviation deviations decades times share fraction z p log10 part of % unit"
)
UNIT = re.compile(rf"_(s|hz|rad|m|nm|v|a|k|px|arcsec)$|\b({'|'.join(UNITS.split())})(?!\w)", re.IGNORECASE)
# the source: seeds, a page, a paper, a definition; or that it is an assumption
SOURCE = re.compile(
    r"ASSUMPTION|\bseeds?\b|\bpaper\b|\.md\b|\b(18|19|20)\d\d\b|definition|lesson \d|datasheet|arithmetic",
    re.IGNORECASE,
)


def number(node: ast.expr) -> float | None:
    """The number that an expression is, its sign included."""
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        found = number(node.operand)
        return None if found is None else -found
    if (
        isinstance(node, ast.Constant)
        and isinstance(node.value, int | float)
        and not isinstance(node.value, bool)
    ):
        return float(node.value)
    return None


def bare(path: Path) -> list[str]:
    """Comparisons with a number that has no name."""
    out = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Compare):
            found = [number(x) for x in (node.left, *node.comparators)]
            if any(x is not None and x not in PLAIN for x in found):
                out.append(f"{path.relative_to(ROOM)}:{node.lineno}: {ast.unparse(node)}")
    return out


def numeric(node: ast.expr) -> bool:
    """Whether a value is a number, or several."""
    if isinstance(node, ast.Tuple | ast.List):
        return bool(node.elts) and all(numeric(x) for x in node.elts)
    if isinstance(node, ast.BinOp):
        return numeric(node.left) and numeric(node.right)
    return number(node) is not None


def constants(path: Path) -> list[tuple[str, int, str]]:
    """Every constant of a module that is a number: name, line, and the words above, beside or below it."""
    text = path.read_text(encoding="utf-8")
    lines, body = text.splitlines(), ast.parse(text).body
    out = []
    for k, node in enumerate(body):
        targets = (
            node.targets
            if isinstance(node, ast.Assign)
            else [node.target]
            if isinstance(node, ast.AnnAssign)
            else []
        )
        names = [
            x
            for t in targets
            for x in (t.elts if isinstance(t, ast.Tuple) else [t])
            if isinstance(x, ast.Name)
        ]
        if not names or getattr(node, "value", None) is None or not numeric(node.value):
            continue
        if not all(n.id.lstrip("_").isupper() or n.id.lstrip("_")[:1].isupper() for n in names):
            continue
        words, at = [], node.lineno - 2
        while at >= 0 and lines[at].startswith("#"):
            words.insert(0, lines[at].lstrip("#: "))
            at -= 1
        words += [x.partition("  # ")[2] for x in lines[node.lineno - 1 : node.end_lineno]]
        after = body[k + 1] if k + 1 < len(body) else None
        if (
            isinstance(after, ast.Expr)
            and isinstance(after.value, ast.Constant)
            and isinstance(after.value.value, str)
        ):
            words.append(after.value.value)
        out.append((" ".join(n.id for n in names), node.lineno, " ".join(words)))
    return out


def silent(path: Path) -> list[str]:
    """Constants that do not say their unit, or not where they are from; several in one line are silent."""
    return [
        f"{path.relative_to(ROOM)}:{line}: {name}"
        for name, line, words in constants(path)
        if " " in name or not UNIT.search(f"{name} {words}") or not SOURCE.search(words)
    ]


def found(look: Callable[[Path], list[str]]) -> str:
    """Everything that `look` finds in the room, one per line."""
    return "\n".join(row for path in sorted(ROOM.rglob("*.py")) for row in look(path))


def test_no_comparison_has_a_bare_number() -> None:
    assert not found(bare)


def test_every_constant_says_unit_and_source() -> None:
    assert not found(silent)


def test_the_median_of_normal_sizes_is_written_once() -> None:
    having = [p for p in ROOM.rglob("*.py") if "1.4826" in p.read_text(encoding="utf-8")]
    assert having == [ROOM / "arrays.py"]
