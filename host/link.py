"""The PC's end of the USB link: HID reports in and out, nothing decoded before somebody asks."""

from collections.abc import Callable
from struct import Struct
from typing import Final

from bus.protocol import HEARTBEAT_KIND, SUMMARY_KIND
from bus.protocol.report import REPORT_BYTES, SLOTS, pack_report

_NOT_MEASUREMENT: Final = 0x80
_slots: Final = Struct("8s" * SLOTS).unpack


class HidLink:
    """Keeps the last eight bytes of every device and kind, hands replies on, and sends commands.

    send: `(t_ns, report)` brings a 64-byte OUT report to the gateway. A measurement frame costs a dictionary
    entry.
    """

    def __init__(self, send: Callable[[int, bytes], None]) -> None:
        self.measurements: dict[int, bytes] = {}
        self.measured_ns: dict[int, int] = {}
        self.summaries: dict[int, bytes] = {}
        self.heartbeats: dict[int, bytes] = {}
        self.heard_ns: dict[int, int] = {}
        """Arrival of the last heartbeat per device."""
        self.reports = 0
        self.bad_reports = 0
        self.on_reply: Callable[[int, bytes], None] | None = None
        self._send = send
        self._outgoing: list[bytes] = []

    def receive(self, t_ns: int, report: bytes) -> None:
        """Take an IN report; a report of the wrong length or with an unknown kind is counted and dropped."""
        if len(report) != REPORT_BYTES:
            self.bad_reports += 1
            return
        self.reports += 1
        measurements, measured_ns = self.measurements, self.measured_ns
        for data in _slots(report):
            device = data[0]
            if not device:
                continue
            if device < _NOT_MEASUREMENT:
                measurements[device] = data
                measured_ns[device] = t_ns
            else:
                self._other(t_ns, device & 0x7F, data)

    def _other(self, t_ns: int, device: int, data: bytes) -> None:
        kind = data[1]
        plain = bytes((device,)) + data[1:]
        if kind == SUMMARY_KIND:
            self.summaries[device] = plain
        elif kind == HEARTBEAT_KIND:
            self.heartbeats[device] = plain
            self.heard_ns[device] = t_ns
        elif kind < _NOT_MEASUREMENT:
            if self.on_reply is not None:
                self.on_reply(t_ns, plain)
        else:
            self.bad_reports += 1

    def queue(self, command: bytes) -> None:
        """Put an 8-byte command into the next OUT report."""
        self._outgoing.append(command)

    def flush(self, t_ns: int) -> None:
        """Send what is queued, eight commands to a report."""
        while self._outgoing:
            now, self._outgoing = self._outgoing[:SLOTS], self._outgoing[SLOTS:]
            self._send(t_ns, pack_report(now))
