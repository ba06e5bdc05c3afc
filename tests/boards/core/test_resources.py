"""Every board of the final network against its chip: RAM of its buffers, time of its routines."""

from pathlib import Path

import pytest

from boards.axis.config import TICK_NS
from boards.c.library import Memory
from boards.core.declared import DeclaredBoard
from boards.focus.config import FocusConfig
from bus.protocol.serial import SAMPLES
from scenarios.lab.lab import Lab
from tests.boards.core.ledger import AXIS, FOCUS, GATEWAY, PARAMETERS, STACK_BYTES, WRITTEN, Ledger, declared

EXCESS = {
    "AXIS": 8 * 9 + 8 + 25 * 24 + 2 * 610 + 42 * 4 + 128 - 1024,
    "GATEWAY": 8 * 9 + 8 + 64 * 8 + 64 * 8 + 16 * 64 + 128 - 2048,
}
"""Bytes beyond the chip's RAM: known defects, added by hand, with their reasons in FIDELITY.md (B1, B7)."""
ROOT = Path(__file__).parents[3]
LAB = Lab("final")


def ledger(name: str) -> Ledger:
    board = LAB.boards[name]
    return declared(board) if isinstance(board, DeclaredBoard) else WRITTEN[name.split("_")[0]]


@pytest.mark.parametrize("name", LAB.boards)
def test_buffers_and_stack_fit_the_chip_but_for_the_known_defects(name: str) -> None:
    found = ledger(name)
    assert max(0, found.ram - found.chip.ram) == EXCESS.get(name.split("_")[0], 0)


@pytest.mark.parametrize("name", LAB.boards)
def test_all_routines_at_once_end_within_their_window(name: str) -> None:
    found = ledger(name)
    assert found.busy_ns < found.window_ns


def test_the_defects_are_on_the_page_with_their_figures() -> None:
    page = (ROOT / "FIDELITY.md").read_text(encoding="utf-8")
    for found in (AXIS, GATEWAY):
        assert f"{found.ram} bytes where the {found.chip.name} has {found.chip.ram}" in page


def test_the_axis_boards_figures_are_its_firmwares() -> None:
    """Nine columns of 24 bytes, 25 of them, sync, head and CRC; the board's own parameters; its own tick."""
    board = LAB.boards["AXIS_RA"]
    assert AXIS.buffers["samples"] == SAMPLES * 24
    assert AXIS.buffers["packets"] == 2 * (SAMPLES * 24 + 10)
    known = [number for number in range(256) if board.parameters.get(number).result == 0]
    assert len(known) == PARAMETERS
    assert AXIS.window_ns == TICK_NS


def test_the_first_routine_costs_what_the_ledger_says_with_all_options_on() -> None:
    board = Lab().boards["AXIS_RA"]
    for number in range(16, 24):  # the orders of all lines of the compensation
        board.parameters.set(number, 65536)
    assert board.parameters.set(13, 1).result == 0
    top = AXIS.table[0]
    assert board.cpu.top.own_ns <= board.cpu.cycles_ns(top.cost_cycles + AXIS.extra_cycles)
    assert board.cpu.top.own_ns > board.cpu.cycles_ns(top.cost_cycles)


def test_windows_are_those_of_the_timers() -> None:
    names = ("POSITION_RA", "MOTOR_RA_A", "DISPLAY")
    assert [ledger(name).window_ns for name in names] == [LAB.boards[name].period_ns for name in names]  # type: ignore[attr-defined]
    assert FOCUS.window_ns == 1_000_000_000 // FocusConfig().top_rate


def test_the_axis_board_in_c_does_not_fit_either() -> None:
    """All of its variables, one packet that is filled in place: less than in Python, more than the chip."""
    memory = Memory(ROOT / "boards/axis/axis.c")
    assert memory.row.memory_bytes + STACK_BYTES > AXIS.chip.ram
    assert memory.row.memory_bytes < AXIS.ram
