"""The firmware core common to all boards."""

from boards.core.board import Board
from boards.core.commands import answer
from boards.core.interrupts import InterruptController, Line, Source
from boards.core.packets import PacketLine
from boards.core.parameters import Parameter, ParameterTable
from boards.core.periodic import PeriodicBoard
from boards.core.place import Place
from boards.core.results import NOT_ALLOWED, OK, OUT_OF_RANGE, Answer
from boards.core.timer import Timer

__all__ = [
    "NOT_ALLOWED",
    "OK",
    "OUT_OF_RANGE",
    "Answer",
    "Board",
    "InterruptController",
    "Line",
    "PacketLine",
    "Parameter",
    "ParameterTable",
    "PeriodicBoard",
    "Place",
    "Source",
    "Timer",
    "answer",
]
