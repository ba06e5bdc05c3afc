"""What a CANopen master may expect of boards (CiA 301): states, heartbeats, objects, aborts, SYNC.

Communication is reset at first, not the boards; nothing moves. Nodes are left OPERATIONAL.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Final

import can

from bus.conformance.boards import Board
from bus.conformance.link import Link
from bus.conformance.result import CheckResult, judged
from bus.protocol import COMMAND_BASE, MEASUREMENT_BASE, REPLY_BASE, SUMMARY_BASE, Opcode, pack_command

_START, _STOP, _RESET = 0x01, 0x02, 0x82
_STATES: Final = {_START: 5, _STOP: 4}
"""NMT commands, and the state a heartbeat says afterwards (table 32, 7.2.8.3.2)."""
_NMT, _SYNC, _HEARTBEAT, _ASK, _ANSWER = 0x000, 0x080, 0x700, 0x600, 0x580
_STATUS: Final = 0x380
"""TPDO4, the documented HEARTBEAT: every board has it (docs/reference/canopen.md)."""
_PDOS: Final = (REPLY_BASE, MEASUREMENT_BASE, SUMMARY_BASE, _STATUS)
_EVENT: Final = 0xFF
_STATUS_KIND: Final = (0x1803, 2)
_SYNCS: Final = 4
_BEFORE_S: Final = 0.1
"""A board that is just starting is through with it. ASSUMPTION."""
_BEATS_S: Final = 3.2
"""Three heartbeats, and a bit."""
_THERE: Final = (
    (0x1000, 0), (0x1001, 0), (0x1003, 0), (0x1005, 0), (0x1008, 0), (0x1010, 1), (0x1011, 1), (0x1014, 0),
    (0x1016, 1), (0x1017, 0), (0x1018, 1), (0x1018, 2), (0x1018, 3), (0x1018, 4), (0x1200, 1), (0x1400, 1),
    (0x1600, 1), (0x1800, 1), (0x1A00, 1),
)  # fmt: skip
_REFUSED: Final = (
    ("no such object", b"\x40\x00\x50\x00", 0x06020000),
    ("no such sub-index", b"\x40\x18\x10\x09", 0x06090011),
    ("read only", b"\x23\x00\x10\x00", 0x06010002),
    ("another length", b"\x23\x17\x10\x00", 0x06070010),
    ("no such specifier", b"\xe0\x00\x10\x00", 0x05040001),
    ("a segment of nothing", b"\x60\x00\x00\x00", 0x05040001),
    ("a value that is none", b"\x2f\x03\x18\x02\xf5", 0x06090030),
    ("mapped while it is valid", b"\x23\x00\x1a\x01\x20\x00\x00\x10", 0x08000022),
    ("not saved by another word", b"\x23\x10\x10\x01\x01", 0x08000020),
)  # fmt: skip
"""What, the request, the abort code (table 22)."""


def check_canopen(link: Link, boards: Sequence[Board]) -> Iterator[CheckResult]:
    """Every board by itself, then all together by NMT."""
    link.listen(_BEFORE_S)
    link.send(_NMT, bytes((_RESET, 0)))
    heard = _heard(link, _BEATS_S)
    for board in boards:
        yield from _heartbeat(link, board, heard[_HEARTBEAT + board.device])
        yield _quiet("pre-operational", board, heard)
        yield from _objects(link, board)
    yield from _states(link, boards)
    yield from _synchronous(link, boards)


def _heard(link: Link, seconds: float) -> dict[int, list[can.Message]]:
    found: dict[int, list[can.Message]] = defaultdict(list)
    for message in link.listen(seconds / link.settings.speed):
        if not message.is_extended_id and not message.is_remote_frame:
            found[message.arbitration_id].append(message)
    return found


def _heartbeat(link: Link, board: Board, heard: list[can.Message]) -> Iterator[CheckResult]:
    said = [bytes(message.data) for message in heard]
    shown = " ".join(each.hex() or "-" for each in said) or "nothing"
    yield judged("boot-up", board.name, said[:1] == [b"\0"], "00 after NMT 82", shown)
    yield judged("state", board.name, set(said[1:]) == {b"\x7f"}, "7f from then on", shown)
    answer = _sdo(link, board.device, b"\x40\x17\x10\x00")
    period_s = int.from_bytes(answer[4:6], "little") / 1e3 if answer[:1] == b"\x4b" else 0.0
    times = [message.timestamp * link.settings.speed for message in heard]
    gaps = [b - a for a, b in pairwise(times[1:])]
    allowed_s = link.settings.period_tolerance * period_s + link.settings.stamps_s * link.settings.speed
    well = bool(gaps) and max(abs(gap - period_s) for gap in gaps) <= allowed_s
    observed = ", ".join(f"{gap:.3f}" for gap in gaps) or "nothing"
    yield judged("heartbeat", board.name, well, f"every {period_s:.3f} s, by 0x1017", observed)


def _sdo(link: Link, node: int, request: bytes) -> bytes:
    """What the server says, no bytes if nothing."""
    link.send(_ASK + node, request.ljust(8, b"\0"))
    message = link.frame(_ANSWER + node, link.settings.reply_s)
    return b"" if message is None else bytes(message.data)


def _objects(link: Link, board: Board) -> Iterator[CheckResult]:
    for index, sub in _THERE:
        request = b"\x40" + index.to_bytes(2, "little") + bytes((sub,))
        answer = _sdo(link, board.device, request)
        well = answer[:1] != b"\x80" and answer[1:4] == request[1:]
        subject = f"{board.name} {index:#06x}:{sub}"
        yield judged(
            "object", subject, well, f"a value of {request[1:].hex(' ')}", answer.hex(" ") or "nothing"
        )
    for what, request, code in _REFUSED:
        answer = _sdo(link, board.device, request)
        found = int.from_bytes(answer[4:], "little") if answer[:1] == b"\x80" else None
        observed = answer.hex(" ") or "nothing" if found is None else f"{found:#010x}"
        yield judged("abort", f"{board.name}, {what}", found == code, f"{code:#010x}", observed)
    link.send(_ASK + board.device, b"\x40\x00\x10")
    short = link.frame(_ANSWER + board.device, 3 * link.settings.quiet_s)
    yield judged("short request", board.name, short is None, "no answer", "none" if short is None else "one")


def _states(link: Link, boards: Sequence[Board]) -> Iterator[CheckResult]:
    for order in (_STOP, _START):
        link.send(_NMT, bytes((order, 0)))
        heard = _heard(link, _BEATS_S / 2)
        for board in boards:
            said = {bytes(message.data) for message in heard[_HEARTBEAT + board.device]}
            shown = " ".join(sorted(each.hex() for each in said)) or "nothing"
            state = bytes((_STATES[order],))
            yield judged("state", f"{board.name}, NMT {order:02x}", said == {state}, state.hex(), shown)
            if order == _STOP:
                yield _quiet("stopped", board, heard)
                continue
            answer = _sdo(link, board.device, b"\x40\x00\x10\x00")
            yield judged("server", board.name, answer[:1] == b"\x43", "43 ...", answer.hex(" ") or "nothing")
            link.send(COMMAND_BASE + board.device, pack_command(board.device, Opcode.PING))
            reply = link.frame(REPLY_BASE + board.device, link.settings.reply_s)
            observed = "none" if reply is None else bytes(reply.data).hex(" ")
            yield judged("operational", board.name, reply is not None, "REPLY to PING", observed)


def _quiet(check: str, board: Board, heard: dict[int, list[can.Message]]) -> CheckResult:
    """Of a state without PDOs."""
    flows = any(heard[base + board.device] for base in _PDOS)
    return judged(check, board.name, not flows, "no PDO", "frames" if flows else "none")


def _synchronous(link: Link, boards: Sequence[Board]) -> Iterator[CheckResult]:
    """TPDO4 at every SYNC, then by event again."""
    for board in boards:
        _write(link, board.device, 1)
    _heard(link, 1.2)  # each has had something to say once
    counts: dict[int, int] = defaultdict(int)
    for _ in range(_SYNCS):
        link.send(_SYNC, b"")
        for identifier, messages in _heard(link, 0.1).items():
            counts[identifier] += len(messages)
    for board in boards:
        found = counts[_STATUS + board.device]
        yield judged("SYNC", board.name, found == _SYNCS, f"{_SYNCS} frames of TPDO4", f"{found}")
        back = _write(link, board.device, _EVENT)
        yield judged("event again", board.name, back[:1] == b"\x60", "60 ...", back.hex(" ") or "nothing")


def _write(link: Link, node: int, kind: int) -> bytes:
    index, sub = _STATUS_KIND
    return _sdo(link, node, b"\x2f" + index.to_bytes(2, "little") + bytes((sub, kind)))
