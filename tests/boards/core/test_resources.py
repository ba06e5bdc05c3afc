"""Every board of the final network against its chip: RAM of its buffers, time of its routines."""

import shutil
import subprocess
from pathlib import Path

import pytest

from boards.axis.config import TICK_NS
from boards.c.library import Memory
from boards.core.declared import DeclaredBoard
from boards.focus.config import FocusConfig
from plant.model import load
from scenarios.lab.lab import Lab
from scenarios.language.configure import observer
from tests.boards.core.ledger import (
    AXIS,
    CODE_WORDS,
    FOCUS,
    GATEWAY,
    LIBRARY_WORDS,
    MSP430_WORDS,
    PARAMETERS,
    STACK_BYTES,
    WORDS,
    WRITTEN,
    Ledger,
    declared,
)

BY_HAND = {
    "AXIS_RA": 8 * 9 + 8 + 2 * (8 + 24) + 68 * 4 + 128,
    "GATEWAY": 8 * 9 + 8 + 64 * 8 + 64 * 8 + 8 * 64 + 128,
}
"""Bytes of RAM, added by hand."""
ROOT = Path(__file__).parents[3]
COMPILERS = {
    # -O1 needs no licence; small code: every call is one word
    "xc16-gcc": ["-mcpu=30F3011", "-O1", "-msmall-code", "-std=gnu99"],
    "clang": ["--target=msp430", "-Oz", "-fno-inline", "-std=c11"],
}
TABLES = {".word": 1, ".short": 1, ".long": 2}
LAB = Lab("final")
SHIPPED = load("high_preload_bridge")


def ledger(name: str) -> Ledger:
    board = LAB.boards[name]
    return declared(board) if isinstance(board, DeclaredBoard) else WRITTEN[name.split("_")[0]]


@pytest.mark.parametrize("name", LAB.boards)
def test_buffers_and_stack_fit_the_chip(name: str) -> None:
    found = ledger(name)
    assert found.ram <= found.chip.ram
    assert found.ram == BY_HAND.get(name, found.ram)


@pytest.mark.parametrize("name", LAB.boards)
def test_all_routines_at_once_end_within_their_window(name: str) -> None:
    found = ledger(name)
    assert found.busy_ns < found.window_ns


def test_the_page_has_the_figures_of_the_fullest_chips() -> None:
    page = (ROOT / "FIDELITY.md").read_text(encoding="utf-8")
    for found in (AXIS, GATEWAY):
        assert f"{found.ram} of the {found.chip.ram} bytes of a {found.chip.name}" in page


def test_the_axis_boards_figures_are_its_firmwares() -> None:
    """Nine columns of 24 bytes behind a head of eight; the board's own parameters; its own tick."""
    board = LAB.boards["AXIS_RA"]
    assert AXIS.buffers["parts"] == 2 * (8 + 24)
    known = [number for number in range(256) if board.parameters.get(number).result == 0]
    assert len(known) == PARAMETERS
    assert AXIS.window_ns == TICK_NS


def test_the_first_routine_costs_what_the_ledger_says_with_all_options_on() -> None:
    board = Lab().boards["AXIS_RA"]
    for number in range(16, 40, 3):  # orders and cosines of all lines of the compensation
        board.parameters.set(number, 65536)
        board.parameters.set(number + 1, 1)
    options = {12: 1, 13: 1, 40: 1, 41: 1, 42: 15} | observer(SHIPPED, SHIPPED.axes.ra)
    for number, value in options.items():
        assert board.parameters.set(number, value).value == value
    top = AXIS.table[0]
    assert board.cpu.top.own_ns == board.cpu.cycles_ns(top.cost_cycles + AXIS.extra_cycles)


def test_windows_are_those_of_the_timers() -> None:
    names = ("POSITION_RA", "MOTOR_RA_A", "DISPLAY")
    assert [ledger(name).window_ns for name in names] == [LAB.boards[name].period_ns for name in names]  # type: ignore[attr-defined]
    assert FOCUS.window_ns == 1_000_000_000 // FocusConfig().top_rate


def test_the_axis_board_in_c_fits_with_all_of_its_variables() -> None:
    found = Memory(ROOT / "boards/axis/axis.c").row.memory_bytes + STACK_BYTES
    assert AXIS.ram < found <= AXIS.chip.ram
    assert f"in C with all of its variables {found} |" in (ROOT / "FIDELITY.md").read_text(encoding="utf-8")


@pytest.mark.parametrize(("compiler", "most"), [("xc16-gcc", CODE_WORDS), ("clang", MSP430_WORDS)])
def test_the_axis_board_in_c_takes_no_more_words_than_the_ledger_says(compiler: str, most: int) -> None:
    if shutil.which(compiler) is None:
        pytest.skip(f"no {compiler}")
    source = ["-ffreestanding", "-S", "-o", "-", f"-I{ROOT}/boards/c", f"{ROOT}/boards/axis/axis.c"]
    command = [compiler, *COMPILERS[compiler], *source]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    lines = done.stdout.splitlines()
    words = [line.split()[0] for line in lines if line.startswith("\t") and line.strip()]
    code = sum(word[0].isalpha() for word in words)
    tables = sum(TABLES.get(word, 0) for word in words)
    print(f"{code} instructions, {tables} words of tables")
    assert 0.7 * most < code + tables + LIBRARY_WORDS <= most


def test_the_page_says_which_chip_holds_the_code() -> None:
    assert CODE_WORDS <= WORDS
    page = (ROOT / "FIDELITY.md").read_text(encoding="utf-8")
    assert f"at most {CODE_WORDS} of the {WORDS} instructions of a dsPIC30F3011" in page
