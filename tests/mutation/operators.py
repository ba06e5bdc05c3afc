"""What a mutant changes: one operator, constant, condition or call of a module's source."""

import ast
import copy
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

_COMPARE: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.In: ast.NotIn, ast.NotIn: ast.In, ast.Is: ast.IsNot, ast.IsNot: ast.Is,
}  # fmt: skip
_BINARY: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.FloorDiv, ast.FloorDiv: ast.Mult, ast.Div: ast.Mult,
    ast.Mod: ast.FloorDiv, ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd, ast.BitXor: ast.BitAnd,
    ast.LShift: ast.RShift, ast.RShift: ast.LShift,
}  # fmt: skip
_SKIPPED_NAMES = {"__slots__", "__all__"}


def _code(tree: ast.AST) -> Iterator[ast.AST]:
    """Nodes that run: no annotations, no docstrings, no `__slots__`, no asserts."""
    for name, value in ast.iter_fields(tree):
        if name in ("annotation", "returns", "decorator_list"):
            continue
        for node in value if isinstance(value, list) else [value]:
            if not isinstance(node, ast.AST) or isinstance(node, ast.Assert):
                continue
            if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
                continue
            targets = node.targets if isinstance(node, ast.Assign) else []
            if any(isinstance(each, ast.Name) and each.id in _SKIPPED_NAMES for each in targets):
                continue
            yield node
            yield from _code(node)


def _changes(node: ast.AST) -> list[str]:
    """Names of what can be done to a node."""
    if isinstance(node, ast.Compare):
        return ["compare"] if type(node.ops[0]) in _COMPARE else []
    if isinstance(node, ast.BinOp | ast.AugAssign):
        text = isinstance(node, ast.BinOp) and isinstance(node.left, ast.Constant | ast.JoinedStr)
        return ["binary"] if type(node.op) in _BINARY and not (text and not _number(node)) else []
    if isinstance(node, ast.BoolOp):
        return ["boolean"]
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        return ["drop not"]
    if isinstance(node, ast.Constant) and isinstance(node.value, int | float):
        return ["constant"]
    if isinstance(node, ast.If | ast.IfExp):
        return ["negate"]
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
        return ["drop call"]
    return []


def _number(node: ast.BinOp) -> bool:
    left = node.left
    return not isinstance(left, ast.Constant) or isinstance(left.value, int | float)


def _apply(node: ast.AST, what: str) -> ast.AST:
    """A changed copy of `node`."""
    node = copy.deepcopy(node)
    if isinstance(node, ast.Compare):
        node.ops[0] = _COMPARE[type(node.ops[0])]()
    elif isinstance(node, ast.BinOp | ast.AugAssign):
        node.op = _BINARY[type(node.op)]()
    elif isinstance(node, ast.BoolOp):
        node.op = ast.Or() if isinstance(node.op, ast.And) else ast.And()
    elif isinstance(node, ast.UnaryOp):
        return node.operand
    elif isinstance(node, ast.Constant):
        node.value = (not node.value) if isinstance(node.value, bool) else node.value + 1  # type: ignore[operator]
    elif isinstance(node, ast.If | ast.IfExp):
        node.test = ast.UnaryOp(ast.Not(), node.test)
    elif isinstance(node, ast.Expr):
        return ast.Pass()
    return node


class _Replace(ast.NodeTransformer):
    def __init__(self, target: ast.AST, new: ast.AST) -> None:
        self.target, self.new = target, new

    def generic_visit(self, node: ast.AST) -> ast.AST:
        return self.new if node is self.target else super().generic_visit(node)


@dataclass
class Mutant:
    """A changed module. number: its place. lines: of the statement; inside: whether in a function's body."""

    source: str
    number: int
    label: str
    lines: range
    inside: bool

    def tree(self) -> ast.Module:
        """The module with the change, lines as they were."""
        tree = ast.parse(self.source)
        node, what = _sites(tree)[self.number]
        new = ast.copy_location(_apply(node, what), node)
        changed: ast.Module = ast.fix_missing_locations(_Replace(node, new).visit(tree))
        return changed


def _places(
    tree: ast.AST, lines: range = range(0), inside: bool = False
) -> Iterator[tuple[ast.AST, range, bool]]:
    """Every node, the lines of its innermost statement (a block's: its head), and whether in a function."""
    for name, value in ast.iter_fields(tree):
        for node in value if isinstance(value, list) else [value]:
            if not isinstance(node, ast.AST):
                continue
            own = lines
            if isinstance(node, ast.stmt):
                last = node.end_lineno or node.lineno
                if isinstance(body := getattr(node, "body", None), list):
                    last = max(node.lineno, body[0].lineno - 1)
                own = range(node.lineno, last + 1)
            within = inside or (name == "body" and isinstance(tree, ast.FunctionDef | ast.Lambda))
            yield node, own, within
            yield from _places(node, own, within)


def _sites(tree: ast.Module) -> list[tuple[ast.AST, str]]:
    return [(node, what) for node in _code(tree) for what in _changes(node)]


def mutants(source: str) -> Iterator[Mutant]:
    """Every mutant of a module."""
    tree = ast.parse(source)
    seen = Counter[str]()
    places = {node: (lines, inside) for node, lines, inside in _places(tree)}
    for number, (node, what) in enumerate(_sites(tree)):
        line = getattr(node, "lineno", 0)
        old, new = (ast.unparse(each).splitlines()[0] for each in (node, _apply(node, what)))
        label = f"{line}: {what}: {old} -> {new}"
        if what == "constant":
            label += f" in: {source.splitlines()[line - 1].strip()}"
        seen[label] += 1
        again = f" ({seen[label]})" if seen[label] > 1 else ""
        yield Mutant(source, number, label + again, *places[node])
