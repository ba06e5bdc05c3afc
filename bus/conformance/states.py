"""Commands in a state that does not allow them: refused, with the right word, whatever their arguments."""

from collections.abc import Iterator

from bus.conformance.boards import Board
from bus.conformance.commands import judge
from bus.conformance.link import Link
from bus.conformance.result import CheckResult
from bus.protocol import Opcode, Result, SpeedClass

_PREPARE: dict[str, tuple[Opcode, tuple[int, ...]]] = {
    "AXIS": (Opcode.POWER, (0,)),
    "FOCUS": (Opcode.FOCUS_FREE, ()),
}
_REFUSED: dict[str, tuple[tuple[Opcode, tuple[int, ...]], ...]] = {
    # Off. Arguments at rest: a board that does not look at its state does not move either.
    "AXIS": (
        (Opcode.SET_RATE, (0,)),
        (Opcode.SET_CLASS, (SpeedClass.FINE, 0)),
        (Opcode.TRACK_RATE, (0,)),
        (Opcode.OPEN_LOOP, (0,)),
        (Opcode.NUDGE, (0,)),
    ),
    # The shaft is free: nothing may be stepped.
    "FOCUS": ((Opcode.FOCUS_STEP, (0,)), (Opcode.FOCUS_REFERENCE, ())),
}
_AFTERWARDS: dict[str, Opcode] = {"FOCUS": Opcode.FOCUS_HOLD}
_LOSES_ORIGIN = {"FOCUS"}
"""Freed, the board no longer knows where it is: only with --motion."""


def check_states(link: Link, board: Board) -> Iterator[CheckResult]:
    """What `board` says to commands it cannot carry out now."""
    if board.family not in _PREPARE or (board.family in _LOSES_ORIGIN and not link.settings.motion):
        return
    opcode, arguments = _PREPARE[board.family]
    link.ask(board.device, opcode, *arguments)
    for each, values in _REFUSED[board.family]:
        start = link.now()
        replies = link.ask(board.device, each, *values)
        subject = f"{board.name} {each.name} after {opcode.name}"
        yield judge("wrong state", subject, replies, board.device, (Result.NOT_ALLOWED,), link.now() - start)
    if board.family in _AFTERWARDS:
        link.ask(board.device, _AFTERWARDS[board.family])
