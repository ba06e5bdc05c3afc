"""What boards make of frames that are wrong, and of commands in a state that does not allow them.

An answer that says so, whatever the arguments, or none where nobody is meant.
"""

import struct
from collections.abc import Iterator

from bus.conformance.boards import Board
from bus.conformance.commands import asked
from bus.conformance.families import FAMILIES, NOTHING, Command
from bus.conformance.link import Link
from bus.conformance.result import CheckResult, judged
from bus.protocol import COMMAND_BASE, REPLY_BASE, Device, Opcode, Result, layout_of, pack_command
from bus.protocol.nodes import arguments_of, kind_of

_UNKNOWN_OPCODES = (0x7E, 0xFE)
_UNKNOWN_PARAMETER = 200
_UNKNOWN_IDENTIFIERS = (0x07F, 0x0FF, 0x6AA, 0x7FE)
"""Nobody has the device types 0x7f and 0x7e; 0x6aa is in no range; 0x07f is below them all."""


def check_misuse(link: Link, board: Board) -> Iterator[CheckResult]:
    """Wrong length, wrong device type, unknown opcode, out of range."""
    name, device = board.name, board.device
    ping = pack_command(device, Opcode.PING)
    other = next(each for each in Device if each != device)
    for length in (0, 1, 2, 7):
        subject = f"{name} PING of {length} bytes"
        yield asked(link, board, "wrong length", subject, ping[:length], (Result.WRONG_LENGTH,))
    data = pack_command(other, Opcode.PING)
    subject = f"{name} PING for {other.name}"
    yield asked(link, board, "wrong device type", subject, data, (Result.WRONG_DEVICE_TYPE,))
    for opcode in _UNKNOWN_OPCODES:
        data = bytes([device, opcode, 0, 0, 0, 0, 0, 0])
        subject = f"{name} opcode {opcode:#04x}"
        yield asked(link, board, "unknown opcode", subject, data, (Result.UNKNOWN_OPCODE,))
    wrong: list[Command] = [
        (Opcode.GET_PARAMETER, (_UNKNOWN_PARAMETER,)),
        (Opcode.SET_PARAMETER, (_UNKNOWN_PARAMETER, 0)),
    ]
    wrong += FAMILIES.get(board.family, NOTHING).out_of_range or declared_misuse(board.model)
    for known, arguments in wrong:
        data = pack_command(device, known, *arguments)
        subject = f"{name} {known.name} {' '.join(map(str, arguments))}"
        yield asked(link, board, "out of range", subject, data, (Result.OUT_OF_RANGE,))


def declared_misuse(device: Device) -> list[Command]:
    """Every parameter, and every argument of an opcode of its own, beyond each limit its bytes can pass."""
    kind = kind_of(device)
    if kind is None:
        return []
    wrong: list[Command] = [
        (Opcode.SET_PARAMETER, (row.number, value))
        for row in kind.parameters
        for value in (row.low - 1, row.high + 1)
    ]
    for opcode, arguments in arguments_of(kind).items():
        highest = tuple(each.high for each in arguments)
        for k, each in enumerate(arguments):
            for value in (each.low - 1, each.high + 1):
                beyond = (*highest[:k], value, *highest[k + 1 :])
                if _fits(opcode, beyond):
                    wrong.append((opcode, beyond))
    return wrong


def _fits(opcode: Opcode, arguments: tuple[int, ...]) -> bool:
    try:
        layout_of(opcode)[0].pack(*arguments)
    except struct.error:
        return False
    return True


def check_unknown_identifier(link: Link, board: Board) -> Iterator[CheckResult]:
    """Frames that are not for `board`, though their data would be: no answer, and it is still there then."""
    command = COMMAND_BASE + board.device
    sends = [(f"identifier {number:#05x}", number, False, False) for number in _UNKNOWN_IDENTIFIERS]
    sends += [
        (f"extended {command:#05x}", command, True, False),
        # the same eleven bits on the wire, then eighteen more
        (f"extended {command << 18:#010x}", command << 18, True, False),
        (f"remote {command:#05x}", command, False, True),
        (f"extended remote {command << 18:#010x}", command << 18, True, True),
        (f"remote {REPLY_BASE + board.device:#05x}", REPLY_BASE + board.device, False, True),
    ]
    ping = pack_command(board.device, Opcode.PING)
    for subject, identifier, extended, remote in sends:
        start = link.now()
        link.send(identifier, ping, extended=extended, remote=remote)
        silent = link.silent(board.device)
        took = link.now() - start
        observed = "no reply" if silent else "a reply"
        check = "remote frame" if remote else "extended frame" if extended else "unknown identifier"
        yield judged(check, f"{board.name}, {subject}", silent, "no reply", observed, took)
    yield asked(link, board, "still there", board.name, ping, (Result.OK,))


_LOSES_ORIGIN = {"FOCUS"}
"""Freed, the board no longer knows where it is: only with --motion."""


def check_states(link: Link, board: Board) -> Iterator[CheckResult]:
    """What `board` says to commands it cannot carry out now."""
    family = FAMILIES.get(board.family, NOTHING)
    if board.family in _LOSES_ORIGIN and not link.settings.motion:
        return
    for opcode, arguments in family.before:
        link.ask(board.device, opcode, *arguments)
    for each, values in family.refused:
        data = pack_command(board.device, each, *values)
        subject = f"{board.name} {each.name} after {family.before[0][0].name}"
        yield asked(link, board, "wrong state", subject, data, (Result.NOT_ALLOWED,))
    for opcode, arguments in family.after:
        link.ask(board.device, opcode, *arguments)
