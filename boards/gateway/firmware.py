"""Firmware of the gateway, PIC18F4550 at 12 MIPS: a ring of frames towards the PC, commands towards the bus.

Cycles are ASSUMPTIONS. Copying a received frame into the ring costs some 25 us; it changes memory only, so
it is no row of the interrupt table.
"""

from collections import deque
from typing import Final

from boards.core import PeriodicBoard, Place, Source, answer
from boards.silicon.can import FULL_MASK
from boards.silicon.hid import FRAME_NS, HidEndpoint, next_frame_ns
from bus.can import Frame
from bus.protocol import (
    COMMAND_BASE,
    HEARTBEAT_BASE,
    MEASUREMENT_BASE,
    REPLY_BASE,
    SUMMARY_BASE,
    pack_reply,
)
from bus.protocol.report import SLOTS, ReportError, place, slot, unpack_commands

FCY_HZ: Final = 12_000_000

TABLE: Final = (
    Source("second", priority=3, latency_cycles=12, cost_cycles=300),
    Source("can", priority=2, latency_cycles=12, cost_cycles=600, level=True),
    Source("usb", priority=1, latency_cycles=12, cost_cycles=1200, level=True),  # 100 us: unpack a report
)


TICK_NS: Final = 1_000_000_000
HOLD_NS: Final = 4_000_000
"""A frame waits no longer than this for its report to fill. ASSUMPTION: four USB frames."""
RING_SLOTS: Final = 64
"""512 bytes of the PIC's 2 KB. ASSUMPTION."""
REPORTS_MOST: Final = 8
"""Reports from the PC that wait for the firmware; the endpoint NAKs beyond. ASSUMPTION: 512 bytes."""
COMMANDS_MOST: Final = 64
"""Commands that wait for the bus; the endpoint NAKs beyond. ASSUMPTION: 512 bytes of the PIC's 2 KB."""
_BASE_MASK: Final = 0x700
_NEVER: Final = 1 << 61


class GatewayBoard(PeriodicBoard):
    """hid: the USB endpoint. ring: slots waiting for the PC. lost: slots dropped from a full ring."""

    def __init__(self, place: Place) -> None:
        super().__init__(place, FCY_HZ, TABLE, TICK_NS)
        self.hid = HidEndpoint()
        self.hid.from_host = self._take_report
        self.hid.ready = self._ready
        self.hold_ns = HOLD_NS
        self.ring: list[bytes] = []
        self.lost = 0
        self._flush_ns = _NEVER
        self._reports: deque[bytes] = deque()
        self._commands: deque[Frame] = deque()
        self._own_command = COMMAND_BASE + self.device_type
        self.cpu.lines["usb"].body = self._unpack
        self.port.on_sent = self._sent
        bases = [REPLY_BASE, MEASUREMENT_BASE, SUMMARY_BASE, HEARTBEAT_BASE]
        self.can.accept((FULL_MASK, [self._own_command]), (_BASE_MASK, bases))

    def reset(self) -> None:
        """After power-up: nothing to send either way."""
        self.ring.clear()
        self._reports.clear()
        self._commands.clear()
        self._flush_ns = _NEVER

    def routine(self, t_ns: int) -> None:
        """Timer interrupt, every second."""
        end = self.enter(t_ns)
        if end:
            self.heartbeat(end)

    # --- bus to PC
    def _receive(self, t_ns: int, frame: Frame) -> None:
        if frame.extended or frame.remote or not self.on:
            return
        if frame.identifier == self._own_command:
            self._take_command(t_ns, frame.data)
        else:
            try:
                self._put(t_ns, slot(frame))
            except ReportError:
                self.refuse(t_ns)

    def _put(self, t_ns: int, data: bytes) -> None:
        ring = self.ring
        count = len(ring)
        if count >= RING_SLOTS:
            self.lost += 1
            self.drop()
            return
        ring.append(data)
        if not count:
            self._arm(next_frame_ns(t_ns + self.hold_ns))
        elif count == SLOTS - 1:
            self._arm(next_frame_ns(t_ns))

    def _arm(self, t_ns: int) -> None:
        if t_ns < self._flush_ns:
            self._flush_ns = t_ns
            self.queue.at(t_ns, self._flush)

    def _flush(self, t_ns: int) -> None:
        """Start of a USB frame: one report, when one is due."""
        if t_ns != self._flush_ns or not self.on:
            return
        self._flush_ns = _NEVER
        ring = self.ring
        report = place(ring[:SLOTS])
        del ring[:SLOTS]
        if ring:
            self._arm(t_ns + (FRAME_NS if len(ring) >= SLOTS else self.hold_ns))
        if self.hid.to_host is not None:
            self.hid.to_host(t_ns, report)

    def transmit(self, identifier: int, data: bytes, ready_ns: int) -> None:
        """On the bus, and to the PC: a CAN controller does not hear itself."""
        super().transmit(identifier, data, ready_ns)
        self._put(self.queue.now_ns, slot(Frame(identifier, data)))

    # --- PC to bus
    def _ready(self) -> bool:
        """Whether the endpoint takes a report: there is room for it and for the commands before it."""
        return len(self._reports) < REPORTS_MOST and len(self._commands) < COMMANDS_MOST

    def _take_report(self, t_ns: int, report: bytes) -> None:
        if not self.on:
            return
        if len(self._reports) >= REPORTS_MOST:
            self.drop()
            return
        self._reports.append(report)
        self.cpu.lines["usb"].request(t_ns)

    def _unpack(self, t_ns: int) -> None:
        if not self._reports:
            return
        for frame in unpack_commands(self._reports.popleft()):
            if frame.identifier == self._own_command:
                opcode, reply = answer(self.device_type, self.commands, t_ns, frame.data)
                data = pack_reply(self.device_type, opcode, *reply)
                self._put(t_ns, slot(Frame(REPLY_BASE + self.device_type, data)))
            else:
                self._commands.append(frame)
        self._sent(t_ns, None)
        if self._reports:
            self.cpu.lines["usb"].request(t_ns)

    def _sent(self, t_ns: int, _frame: Frame | None) -> None:
        """A transmit buffer may be free: load the next command."""
        commands = self._commands
        while commands and self.send(commands[0], t_ns):
            commands.popleft()
