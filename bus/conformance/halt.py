"""Nothing that was checked is left moving, however the checks end."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress

import can

from bus.conformance.boards import Board
from bus.conformance.link import Link
from bus.protocol import COMMAND_BASE, Opcode, pack_command
from bus.protocol.nodes import arguments_of, kind_of

_HALT: dict[str, tuple[tuple[Opcode, tuple[int, ...]], ...]] = {
    "AXIS": ((Opcode.STOP, ()), (Opcode.POWER, (0,))),
    "FOCUS": ((Opcode.FOCUS_HOLD, ()),),
}
_STOP = "_STOP"
"""What an opcode that stops a declared board is called at its end."""
_TIMES = 2
"""Each is sent twice: a frame can be lost."""
_SETTLE_S = 0.05
"""Until the boards have taken the last one, and their answers are through."""


def declared_halt(board: Board) -> tuple[tuple[Opcode, tuple[int, ...]], ...]:
    """Of a declared board: opcodes without arguments whose name ends in _STOP."""
    kind = kind_of(board.model)
    own = arguments_of(kind) if kind is not None else {}
    return tuple((opcode, ()) for opcode, words in own.items() if not words and opcode.name.endswith(_STOP))


@contextmanager
def halted(link: Link, boards: Sequence[Board]) -> Iterator[None]:
    """Stop everything at the end if motion was asked for: done, failed, or interrupted (Ctrl-C), even twice.

    A bus that is broken by then raises can.CanError, unless something else is on its way already.
    """
    if not link.settings.motion:
        yield
        return
    try:
        yield
    except BaseException:
        with suppress(can.CanError):  # what went wrong first says more
            halt(link, boards)
        raise
    else:
        halt(link, boards)


def halt(link: Link, boards: Sequence[Board]) -> None:
    """STOP, then power off; one interrupt meanwhile does not keep a board from being told."""
    interrupted = False
    broken: can.CanError | None = None
    for _ in range(_TIMES):
        for board in boards:
            for opcode, arguments in _HALT.get(board.family) or declared_halt(board):
                data = pack_command(board.device, opcode, *arguments)
                try:
                    link.send(COMMAND_BASE + board.device, data)
                except KeyboardInterrupt:
                    interrupted = True
                    link.send(COMMAND_BASE + board.device, data)
                except can.CanError as error:
                    broken = error
    if interrupted:
        raise KeyboardInterrupt
    if broken is not None:
        raise broken
    link.listen(_SETTLE_S)
