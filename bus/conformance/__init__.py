"""Protocol conformance checks for any bus python-can can open: emulated, served, or the real one."""

from bus.conformance.boards import Board, BoardError, board_of, parse
from bus.conformance.result import CheckResult, Level, summary
from bus.conformance.run import run
from bus.conformance.settings import Settings

__all__ = ["Board", "BoardError", "CheckResult", "Level", "Settings", "board_of", "parse", "run", "summary"]
