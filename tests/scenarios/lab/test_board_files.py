"""Files with a user's board: which rows cannot be, and the one line that is said of a file."""

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from boards.core import Source
from boards.core.declared import DeclaredBoard, Pin
from bus.protocol.nodes import KindError
from bus.protocol.nodes.kind import ParameterRow
from scenarios.lab import nodes
from scenarios.lab.nodes import board_files, firmware_file, load_board


def unfit(**changed: Any) -> str:
    parts = {"FCY_HZ": 1000, "TABLE": (source(999, 999),), "KIND": SimpleNamespace(parameters=()), "PINS": ()}
    board: Any = SimpleNamespace(**(parts | changed))
    return nodes._unfit(board)


def source(latency: Any, cost: Any) -> Source:
    return Source("can", priority=1, latency_cycles=latency, cost_cycles=cost)


def rows(*given_rows: tuple[Any, Any, Any, Any]) -> Any:
    return SimpleNamespace(
        parameters=[ParameterRow(n, "gain", low, high, default) for n, low, high, default in given_rows]
    )


def test_a_board_s_rows_are_fit_at_their_bounds() -> None:
    least, most = -(2**31), 2**31 - 1
    assert unfit() == "" and unfit(TABLE=(source(0, 0),)) == ""
    assert unfit(KIND=rows((1, least, most, least), (255, 5, 5, 5))) == ""
    assert unfit(PINS=(Pin("a"), Pin("b"))) == ""


@pytest.mark.parametrize("table", [(1000, 5), (5, 1000), (-1, 5)])
def test_a_routine_takes_less_than_a_second(table: tuple[int, int]) -> None:
    assert unfit(TABLE=(source(*table),)).endswith(": it takes rows of Source, whole cycles below FCY_HZ")
    assert unfit(TABLE=("can",)) == "TABLE: can: it takes rows of Source, whole cycles below FCY_HZ"


@pytest.mark.parametrize(
    "row", [(1, 0, 10, 11), (1, 5, 10, 4), (1, 0, 2**31, 5), (1, -(2**31) - 1, 3, 0), (1, 0.5, 1, 1)]
)
def test_a_default_lies_between_32_bit_bounds(row: tuple[Any, Any, Any, Any]) -> None:
    said = "KIND: parameter gain: low, high and, between them, the default are 32-bit numbers"
    assert unfit(KIND=rows(row)) == said


@pytest.mark.parametrize("numbers", [(0,), (256,), (1.0,), (7, 7)])
def test_a_parameter_s_number_is_its_own(numbers: tuple[Any, ...]) -> None:
    assert unfit(KIND=rows(*((each, 0, 1, 0) for each in numbers))) == (
        "KIND: parameter gain: its number is 1 to 255, and no other's"
    )


@pytest.mark.parametrize("pins", [(Pin("a", default=float("inf")),), (Pin("a"), Pin("a"))])
def test_a_pin_s_name_is_its_own_and_its_default_finite(pins: tuple[Pin, ...]) -> None:
    assert unfit(PINS=pins) == "PINS: a: its default is a finite number, its name no other's"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", ": holds 0 classes derived from DeclaredBoard, expected one"),
        ("class A(DeclaredBoard): pass\nclass B(DeclaredBoard): pass",
         ": holds 2 classes derived from DeclaredBoard, expected one"),
        ("class A(DeclaredBoard): pass", ": A has no KIND and no TABLE"),
        ("class A(DeclaredBoard):\n    KIND = 3", ": A has no TABLE"),
        ("class A(DeclaredBoard):\n    KIND, TABLE = 3, ()",
         ": A.KIND cannot be used: 'int' object has no attribute 'name'"),
        ("raise KeyError('x')", ": cannot be imported: KeyError: 'x'"),
        ("raise SystemExit(3)", ": cannot be imported: SystemExit: 3"),
    ],
)  # fmt: skip
def test_a_file_that_is_no_board_is_said_in_one_line(text: str, said: str, tmp_path: Path) -> None:
    file = tmp_path / "own.py"
    file.write_text(f"from boards.core.declared import DeclaredBoard\n{text}\n")
    before = set(sys.modules)
    with pytest.raises(KindError) as caught:
        load_board(file)
    assert str(caught.value) == f"{file}{said}"
    for name in set(sys.modules) - before:
        assert name.startswith(nodes.MODULE) and "imported" not in said
        del sys.modules[name]


def test_a_file_that_is_not_there_is_no_python_file(tmp_path: Path) -> None:
    for name in ("none.py", "none.txt"):
        with pytest.raises(KindError, match=rf"{name}: no such Python file$"):
            load_board(tmp_path / name)


def test_files_are_found_beside_the_scenario_or_come_along(tmp_path: Path) -> None:
    own = tmp_path / "axis.c"
    own.write_text("")
    assert firmware_file(tmp_path, "axis.c") == own.resolve()
    assert firmware_file(tmp_path, "none.c") == tmp_path / "none.c"
    scenario: Any = SimpleNamespace(file=tmp_path / "s.yaml", network={"boards": ["a.py", "b.py"]})
    assert board_files(scenario) == [tmp_path / "a.py", tmp_path / "b.py"]
    assert board_files(SimpleNamespace(file=tmp_path, network={})) == []  # type: ignore[arg-type]
    assert issubclass(nodes.BOARDS[0], DeclaredBoard)
