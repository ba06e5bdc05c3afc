"""The firmware core common to all boards."""

from boards.core.board import Board
from boards.core.commands import NOT_ALLOWED, OK, OUT_OF_RANGE, Answer, Parameter, ParameterTable, answer
from boards.core.interrupts import InterruptController, Line, Source
from boards.core.packets import PacketLine
from boards.core.periodic import PeriodicBoard, Timer
from boards.core.place import Place

__all__ = [
    "NOT_ALLOWED", "OK", "OUT_OF_RANGE", "Answer", "Board", "InterruptController", "Line", "PacketLine",
    "Parameter", "ParameterTable", "PeriodicBoard", "Place", "Source", "Timer", "answer",
]  # fmt: skip
