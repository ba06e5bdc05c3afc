"""All checks, in order, on one bus; nothing that was checked is left moving, however they end."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

import can

from bus.conformance.boards import Board, board_of
from bus.conformance.canopen import check_canopen
from bus.conformance.commands import check_answers, check_commands
from bus.conformance.families import FAMILIES, NOTHING, Command
from bus.conformance.flood import check_flood
from bus.conformance.limits import check_limits
from bus.conformance.link import Link
from bus.conformance.misuse import check_misuse, check_states, check_unknown_identifier
from bus.conformance.result import CheckResult, judged
from bus.conformance.settings import Settings
from bus.conformance.telemetry import check_telemetry
from bus.protocol import COMMAND_BASE, Device, Opcode, pack_command
from bus.protocol.nodes import DEVICES, arguments_of, documented, kind_of

if TYPE_CHECKING:
    from cantools.database import Database


_STOP = "_STOP"
"""What an opcode that stops a declared board is called at its end."""
_TIMES = 2
"""Each is sent twice: a frame can be lost."""
_SETTLE_S = 0.05
"""Until the boards have taken the last one, and their answers are through."""


def declared_halt(board: Board) -> tuple[Command, ...]:
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
            for opcode, arguments in FAMILIES.get(board.family, NOTHING).halt or declared_halt(board):
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


def run(
    bus: can.BusABC,
    dbc: "Database | None" = None,
    devices: Sequence[Device | Board] = tuple(Device),
    settings: Settings | None = None,
) -> list[CheckResult]:
    """Check every one of `devices` on `bus` against `dbc` (None: the project's own).

    Never raises for what boards do or fail to do; a bus that breaks raises can.CanError. Nobody else
    should be sending commands meanwhile. With `settings.motion` everything is stopped at the end, however
    it ends.
    """
    settings = settings or Settings()
    boards = [each if isinstance(each, Board) else board_of(each) for each in devices]
    link = Link(bus, settings)
    results = []
    with halted(link, boards):
        for result in _checks(link, dbc or documented([*DEVICES, *(each.model for each in boards)]), boards):
            settings.each(result)
            results.append(result)
    return results


def _checks(link: Link, dbc: "Database", boards: Sequence[Board]) -> Iterator[CheckResult]:
    if link.settings.canopen:
        yield from check_canopen(link, boards)
        return
    yield from check_telemetry(link, dbc, boards)
    for board in boards:
        answers = link.ask(board.device, Opcode.PING) or link.ask(board.device, Opcode.PING)
        if not answers:
            # Once is enough: waiting for the answer to every command of a board that is not there takes
            # minutes.
            none = "; ".join(("none, twice", *filter(None, [answers.instead])))
            yield judged("answers", f"{board.name} PING", False, "a reply", none)
            continue
        yield from check_commands(link, board)
        yield from check_misuse(link, board)
        yield from check_unknown_identifier(link, board)
        yield from check_states(link, board)
        yield from check_limits(link, board)
        yield from check_answers(link, board)
        yield from check_flood(link, board)
