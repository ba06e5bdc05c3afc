"""All checks, in order, on one bus."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import can

from bus.conformance.boards import Board, board_of
from bus.conformance.canopen import check_canopen
from bus.conformance.commands import check_answers, check_commands
from bus.conformance.flood import check_flood
from bus.conformance.halt import halted
from bus.conformance.limits import check_limits
from bus.conformance.link import Link
from bus.conformance.misuse import check_misuse, check_unknown_identifier
from bus.conformance.result import CheckResult, judged
from bus.conformance.settings import Settings
from bus.conformance.states import check_states
from bus.conformance.telemetry import check_telemetry
from bus.protocol import Device, Opcode
from bus.protocol.nodes import DEVICES, documented

if TYPE_CHECKING:
    from cantools.database import Database


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
