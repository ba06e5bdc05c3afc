"""Sending and waiting on a python-can bus, on whatever clock that bus has."""

from collections.abc import Callable
from time import monotonic

import can

from bus.conformance.settings import Settings
from bus.protocol import COMMAND_BASE, REPLY_BASE, Reply, pack_command, unpack_reply
from bus.pythoncan import SchmidtBus


def clock_of(bus: can.BusABC) -> Callable[[], float]:
    """Seconds as `bus` counts its timeouts: simulated for an in-process wire, the wall clock otherwise."""
    if isinstance(bus, SchmidtBus):
        queue = bus.wire.queue
        return lambda: queue.now_ns * 1e-9
    return monotonic


class Link:
    """One tester on `bus`."""

    def __init__(self, bus: can.BusABC, settings: Settings) -> None:
        self.settings = settings
        self.now = clock_of(bus)
        self._bus = bus

    def listen(self, seconds: float) -> list[can.Message]:
        """Everything that arrives within `seconds`."""
        heard = []
        end = self.now() + seconds
        while (left := end - self.now()) > 0:
            message = self._bus.recv(timeout=left)
            if message is not None and not message.is_error_frame:
                heard.append(message)
        return heard

    def send(self, identifier: int, data: bytes, *, extended: bool = False, remote: bool = False) -> None:
        """Put one frame on the bus."""
        self._bus.send(
            can.Message(
                arbitration_id=identifier,
                data=None if remote else data,
                dlc=len(data),
                is_extended_id=extended,
                is_remote_frame=remote,
            )
        )

    def replies(self, device: int, opcode: int | None) -> list[Reply]:
        """Answers of `device` to `opcode` (None: to anything): the first within reply_s, then any within
        quiet_s."""
        found: list[Reply] = []
        end = self.now() + self.settings.reply_s
        while (left := end - self.now()) > 0:
            message = self._bus.recv(timeout=left)
            if message is None or message.arbitration_id != REPLY_BASE + device or message.is_extended_id:
                continue
            if len(message.data) != 8:
                continue
            reply = unpack_reply(bytes(message.data))
            if opcode is None or reply.opcode == opcode:
                found.append(reply)
                end = self.now() + self.settings.quiet_s
        return found

    def silent(self, device: int) -> bool:
        """Whether `device` says nothing of the kind for quiet_s and a bit."""
        end = self.now() + 3 * self.settings.quiet_s
        while (left := end - self.now()) > 0:
            message = self._bus.recv(timeout=left)
            if message is not None and message.arbitration_id == REPLY_BASE + device:
                return False
        return True

    def ask(self, device: int, opcode: int, *arguments: int) -> list[Reply]:
        """Send a command of the protocol and collect its answers."""
        return self.ask_raw(device, pack_command(device, opcode, *arguments), opcode)

    def ask_raw(self, device: int, data: bytes, opcode: int | None) -> list[Reply]:
        """Send any bytes as a command to `device` and collect the answers."""
        self.send(COMMAND_BASE + device, data)
        return self.replies(device, opcode)
