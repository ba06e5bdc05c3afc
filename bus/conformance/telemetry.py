"""What boards say unasked: identifier, length, device type, contents, period."""

from collections import defaultdict
from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import can

from bus.conformance.link import Link
from bus.conformance.result import CheckResult, Level

if TYPE_CHECKING:
    from cantools.database import Database

_INTERVALS = 2
"""Fewer intervals than this say nothing about a period."""


def check_telemetry(link: Link, dbc: "Database", devices: set[str]) -> Iterator[CheckResult]:
    """Listen once, then judge every periodic frame of `devices` in the DBC, and every frame that is not
    in it."""
    heard: dict[int, list[can.Message]] = defaultdict(list)
    seconds = link.settings.listen_s / link.settings.speed
    for message in link.listen(seconds):
        if not message.is_extended_id and not message.is_remote_frame:
            heard[message.arbitration_id].append(message)
    for documented in dbc.messages:
        if documented.name.rpartition("_")[0] in devices and documented.cycle_time:
            yield from _frame(link, documented, heard.get(documented.frame_id, []), seconds)
    known = {message.frame_id for message in dbc.messages}
    strange = sorted(set(heard) - known)
    observed = ", ".join(f"{identifier:#05x}" for identifier in strange) or "none"
    yield CheckResult(
        "undocumented", "bus", Level.SHOULD, not strange, "no other identifiers", observed, seconds
    )


def _frame(link: Link, documented: Any, heard: list[can.Message], seconds: float) -> Iterator[CheckResult]:
    def result(check: str, passed: bool, expected: str, observed: str) -> CheckResult:
        return CheckResult(check, documented.name, Level.MUST, passed, expected, observed, seconds)

    yield result(
        "identifier",
        bool(heard),
        f"frames with {documented.frame_id:#05x}",
        f"{len(heard)} in {seconds:.2f} s",
    )
    if not heard:
        return
    lengths = {len(message.data) for message in heard}
    yield result(
        "length", lengths == {documented.length}, f"{documented.length} bytes", f"{sorted(lengths)} bytes"
    )
    device = documented.get_signal_by_name("Device").minimum
    first = {message.data[0] if message.data else -1 for message in heard}
    yield result(
        "device type", first == {device}, f"byte 0 = {device:#04x}", ", ".join(f"{b:#04x}" for b in first)
    )
    yield result("contents", *_contents(documented, heard))
    if len(heard) > _INTERVALS:
        yield result("period", *_period(link, documented.cycle_time, heard))


def _contents(documented: Any, heard: list[can.Message]) -> tuple[bool, str, str]:
    """Every signal of every frame within the range the DBC gives."""
    expected = "every signal within its range"
    for message in heard:
        if len(message.data) != documented.length:
            continue
        values = documented.decode(message.data, decode_choices=False)
        for signal in documented.signals:
            value = values[signal.name]
            if not signal.minimum <= value <= signal.maximum:
                return False, expected, f"{signal.name} = {value}, not {signal.minimum}..{signal.maximum}"
    return True, expected, f"{len(heard)} frames within"


def _period(link: Link, period_ms: int, heard: list[can.Message]) -> tuple[bool, str, str]:
    """Mean period within the tolerance; the spread is told, not judged: it is the tester's as much as
    the board's."""
    settings = link.settings
    stamps = [message.timestamp for message in heard]
    gaps = [(b - a) * 1e3 * settings.speed for a, b in pairwise(stamps)]
    mean = sum(gaps) / len(gaps)
    return (
        abs(mean - period_ms) <= settings.period_tolerance * period_ms,
        f"{period_ms} ms ± {settings.period_tolerance:.1%}",
        f"mean {mean:.3f} ms, {min(gaps):.3f}..{max(gaps):.3f} ms",
    )
