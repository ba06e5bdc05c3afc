"""More than a board is used to: commands in quick succession, and, asked for, a bus that is full of them."""

from collections.abc import Iterator

from bus.conformance.boards import Board
from bus.conformance.commands import asked
from bus.conformance.link import Link
from bus.conformance.result import CheckResult, doubted, judged, told
from bus.protocol import COMMAND_BASE, Health, Opcode, Result, pack_command

_COMMANDS = 64
_PACE_S = 0.0005
"""A command and its answer take half of that at 1 Mbit/s. The other half is left to the boards' own frames,
which come after commands in arbitration."""
_OPEN = 2
"""Commands on their way at a time: as many as a CAN controller of these boards has receive buffers. A door
between tester and boards may hand over what has gathered in one piece; back to back is `--flood`."""
_LOST = 3
"""Waits in vain after which the rest is not sent."""


def check_flood(link: Link, board: Board) -> Iterator[CheckResult]:
    """Every command of a quick succession is answered once; a full bus does no lasting harm."""
    start = link.now()
    answers = _stream(link, board)
    yield judged(
        "flooding", board.name, answers == _COMMANDS,
        f"{_COMMANDS} answers, {_PACE_S * 1e3} ms apart or as they come",
        f"{answers}", link.now() - start,
    )  # fmt: skip
    if link.settings.flood:
        yield from _full(link, board)
    ping = pack_command(board.device, Opcode.PING)
    yield asked(link, board, "still there", f"{board.name}, flooded", ping, (Result.OK,))


def _stream(link: Link, board: Board) -> int:
    """Answers to a stream of PINGs that takes half of the bus, or as much as the board keeps up with."""
    ping = pack_command(board.device, Opcode.PING)
    answers = waiting = lost = 0
    for _ in range(_COMMANDS):
        end = link.now() + _PACE_S
        link.send(COMMAND_BASE + board.device, ping)
        waiting += 1
        while (left := end - link.now()) > 0:
            if link.reply(board.device, left) is not None:
                answers, waiting = answers + 1, waiting - 1
        while waiting >= _OPEN:
            if link.reply(board.device, link.settings.reply_s) is not None:
                answers, waiting = answers + 1, waiting - 1
            else:
                lost, waiting = lost + 1, 0
        if lost >= _LOST:
            break
    rest_s = link.settings.reply_s if waiting > 0 else 3 * link.settings.quiet_s
    while link.reply(board.device, rest_s) is not None:
        answers += 1
    return answers


def _full(link: Link, board: Board) -> Iterator[CheckResult]:
    """Commands back to back: answers have less priority, so most cannot leave; the board has to say so."""
    ping = pack_command(board.device, Opcode.PING)
    start = link.now()
    for _ in range(_COMMANDS):
        link.send(COMMAND_BASE + board.device, ping)
    answers = 0
    while link.reply(board.device, 3 * link.settings.quiet_s) is not None:
        answers += 1
    took = link.now() - start
    yield judged(
        "full bus", board.name, answers <= _COMMANDS, f"at most {_COMMANDS} answers", f"{answers}", took
    )
    if answers >= _COMMANDS:
        yield told("full bus", board.name, "nothing was lost")
        return
    reply = link.first(board.device, Opcode.PING)
    owns_up = reply is not None and bool(reply.value & Health.DROPPED)
    observed = "no reply" if reply is None else f"health {reply.value:#x}"
    expected = f"health bit {Health.DROPPED:#x}, as {_COMMANDS - answers} answers were lost"
    yield doubted("full bus", f"{board.name}, loss owned up to", owns_up, expected, observed, took)
