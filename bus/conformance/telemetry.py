"""What boards say unasked: identifier, length, device type, contents, times."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import can

from bus.conformance.boards import Board
from bus.conformance.link import Link
from bus.conformance.result import CheckResult, doubted, judged, told
from bus.conformance.timing import Row, check_course, check_timing, queueing_s

if TYPE_CHECKING:
    from cantools.database import Database

_INTERVALS = 2
"""Fewer intervals than this say nothing about a period."""


def check_telemetry(link: Link, dbc: "Database", boards: Sequence[Board]) -> Iterator[CheckResult]:
    """Listen once, then judge each periodic frame of `boards` in the DBC, and each that is not in it."""
    heard: dict[int, list[can.Message]] = defaultdict(list)
    odd: set[str] = set()
    seconds = link.settings.listen_s / link.settings.speed
    lost = link.lost
    for message in link.listen(seconds):
        if message.is_extended_id or message.is_remote_frame:
            odd.add(f"{'remote' if message.is_remote_frame else 'extended'} {message.arbitration_id:#05x}")
        else:
            heard[message.arbitration_id].append(message)
    lost = link.lost - lost
    link.known = set(heard)
    known = {message.frame_id for message in dbc.messages}
    for board in boards:
        shift = board.device - board.model
        for documented in dbc.messages:
            if documented.name.rpartition("_")[0] != board.model.name:
                continue
            known.add(documented.frame_id + shift)
            if documented.cycle_time:
                yield from _frame(
                    link, dbc, board, documented, heard.get(documented.frame_id + shift, []), lost
                )
    strange = sorted(odd) + [f"{identifier:#05x}" for identifier in sorted(set(heard) - known)]
    observed = ", ".join(strange) or "none"
    yield doubted("undocumented", "bus", not strange, "no other frames", observed, seconds)


def _frame(
    link: Link, dbc: "Database", board: Board, documented: Any, heard: list[can.Message], lost: int
) -> Iterator[CheckResult]:
    seconds = link.settings.listen_s / link.settings.speed
    identifier = documented.frame_id + board.device - board.model
    subject = f"{board.name}_{documented.name.rpartition('_')[2]}"

    def result(check: str, passed: bool, expected: str, observed: str) -> CheckResult:
        return judged(check, subject, passed, expected, observed, seconds)

    observed = f"{len(heard)} in {seconds:.2f} s"
    yield result("identifier", bool(heard), f"frames with {identifier:#05x}", observed)
    if not heard:
        return
    lengths = {len(message.data) for message in heard}
    yield result(
        "length", lengths == {documented.length}, f"{documented.length} bytes", f"{sorted(lengths)} bytes"
    )
    first = sorted({bytes(message.data[:1]) for message in heard})
    yield result(
        "device type",
        first == [bytes([board.device])],
        f"byte 0 = {board.device:#04x}",
        ", ".join(f"0x{byte.hex()}" if byte else "none" for byte in first),
    )
    speed = link.settings.speed
    rows = [
        Row(message.timestamp * speed, documented.decode(message.data, decode_choices=False))
        for message in heard
        if len(message.data) == documented.length
    ]
    yield result("contents", *_contents(documented, rows))
    yield from check_course(subject, rows, link.settings.stamps_s * speed)
    if len(heard) <= _INTERVALS:
        yield told("period", subject, f"{len(heard)} frames in {seconds:.2f} s say nothing about a period")
        return
    stamps = [message.timestamp for message in heard]
    queueing = queueing_s(dbc.messages, identifier)
    yield from check_timing(link.settings, subject, documented.cycle_time, stamps, queueing, lost)


def _contents(documented: Any, rows: Sequence[Row]) -> tuple[bool, str, str]:
    """Every signal of every frame within the range the DBC gives; byte 0 has a check of its own."""
    expected = "every signal within its range"
    for row in rows:
        for signal in documented.signals:
            value = row.signals[signal.name]
            if signal.name != "Device" and not signal.minimum <= value <= signal.maximum:
                return False, expected, f"{signal.name} = {value}, not {signal.minimum}..{signal.maximum}"
    return True, expected, f"{len(rows)} frames within"
