"""Every parameter of a report is the plant's, or the page on reports says which property of a log it is."""

import ast
import importlib
from collections.abc import Iterator
from pathlib import Path

import pytest

from calibration.finding import UNKNOWN
from calibration.names import NAMES
from plant.effects import REGISTRY
from tests.calibration.reported import knows, listed

ROOM = Path(__file__).parents[3] / "calibration"
MAKERS = {"candidate", "grid", "steps", "tried", "over", "line"}
SIZES = {"Parameter", "normal", "deviation", "middle", "middle_of"}
#: files of no name, and whose findings they make
MADE = {
    "decide/broadband.py": (UNKNOWN, "wind_torque"),
    "decide/delays.py": ("channel_delay",),
    "decide/withdraw.py": ("play",),
    "decide/residual.py": (UNKNOWN,),
    "balances/effortchange.py": (UNKNOWN,),
    "look/controllerlaw.py": (UNKNOWN, "command_disturbance"),
    "names/columns.py": ("log_wrap", "sample_loss", "clock_jitter"),
    "names/unknown_bits.py": (UNKNOWN,),
    "names/unknown_shapes.py": (UNKNOWN,),
    "names/lines.py": ("bearing_pass",),
}


def words(node: ast.AST, module: object) -> Iterator[str]:
    """The text that a label is, or a constant of the module; of a text made of parts none."""
    found = node.value if isinstance(node, ast.Constant) else None
    if isinstance(node, ast.Name):
        found = getattr(module, node.id, None)
    if isinstance(found, str):
        yield found


def printed(path: Path) -> Iterator[str]:
    """Parameters that a file's text gives to candidates and findings."""
    at = ".".join(path.relative_to(ROOM.parent).with_suffix("").parts)
    module = importlib.import_module(at)
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        maker = getattr(node.func, "id", getattr(node.func, "attr", "")) if isinstance(node, ast.Call) else ""
        if isinstance(node, ast.Call) and maker in MAKERS:
            for size in node.args[2:]:
                yield from words(size.elts[0] if isinstance(size, ast.Tuple) else size, module)
        called = node.arg if isinstance(node, ast.keyword) else ""
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            called = node.targets[0].id
        if called in ("at", "fixed", "parameters") and isinstance(
            value := getattr(node, "value", None), ast.Dict
        ):
            for key in value.keys:
                yield from words(key, module) if key is not None else ()
        if called in ("along", "size") and isinstance(value := getattr(node, "value", None), ast.Tuple):
            yield from words(value.elts[0], module)
        if isinstance(node, ast.Dict):
            for key, made in zip(node.keys, node.values, strict=True):
                name = getattr(made.func, "id", "") if isinstance(made, ast.Call) else ""
                yield from words(key, module) if name in SIZES and key is not None else ()


def known(name: str, parameter: str) -> bool:
    """Whether a report of this name may print it, or no report prints it."""
    return knows(name, parameter) or parameter in NAMES[name].nuisances


def test_every_parameter_in_the_text_is_known() -> None:
    strange, count = [], 0
    for path in sorted(ROOM.rglob("*.py")):
        at = path.relative_to(ROOM).as_posix()
        mine = MADE.get(at, (path.stem,) if at.startswith("names/") and path.stem in NAMES else ())
        for parameter in printed(path) if mine else ():
            count += 1
            if not any(known(name, parameter) for name in mine):
                strange.append(f"{at}: {parameter}")
    assert not strange, strange
    assert count > 70  # else the text is written otherwise, and nothing was asked


@pytest.mark.parametrize("name", NAMES)
def test_what_the_page_lists_is_not_the_plants(name: str) -> None:
    own = {p.name for p in REGISTRY[name].parameters}
    assert not own & listed()[name]
