"""Sending and waiting on a python-can bus, on whatever clock that bus has."""

from collections.abc import Callable, Iterator
from time import monotonic

import can

from bus.conformance.settings import Settings
from bus.outside.errorframes import kernel_drops
from bus.outside.pythoncan import SchmidtBus
from bus.protocol import COMMAND_BASE, FRAME_BYTES, REPLY_BASE, Opcode, Reply, pack_command, unpack_reply

_ROOM_S = 0.0005
"""Commands come before all else in arbitration: a tester that never pauses starves the boards' own frames
until their transmit buffers are full. Time for some of them after each pair of command and answer."""
_TYPES = 0x80
"""Identifiers from a base on, one for each device type."""
_NUMBERED = (Opcode.GET_PARAMETER, Opcode.SET_PARAMETER)
"""Their answers repeat the number of the parameter."""


class Answers(list[Reply]):
    """Replies to one command. instead: what came in the place of one. parameter: the number each repeats."""

    instead = ""
    parameter: int | None = None


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
        self.took_s: dict[int, list[tuple[float, int]]] = {}
        """Per device type, what its first answers took, seconds on the bus's clock, and to which opcode."""
        self.known: set[int] = set()
        """Identifiers that come unasked."""
        self._instead: list[str] = []
        self._sent_s = 0.0
        self._bus = bus

    @property
    def lost(self) -> int:
        """Frames that this machine has dropped so far, because it was busy."""
        return kernel_drops(self._bus)

    def _heard(self, seconds: float) -> Iterator[can.Message]:
        """What arrives within `seconds`, as it comes, but for error frames."""
        end = self.now() + seconds
        while (left := end - self.now()) > 0:
            message = self._bus.recv(timeout=left)
            if message is not None and not message.is_error_frame:
                yield message

    def listen(self, seconds: float) -> list[can.Message]:
        """Everything that arrives within `seconds`."""
        return list(self._heard(seconds))

    def frame(self, identifier: int, within_s: float) -> can.Message | None:
        """The next data frame with this standard identifier; None when there is none in time."""
        for message in self._heard(within_s):
            standard = not message.is_extended_id and not message.is_remote_frame
            if standard and message.arbitration_id == identifier:
                return message
        return None

    def send(self, identifier: int, data: bytes, *, extended: bool = False, remote: bool = False) -> None:
        """Put one frame on the bus."""
        self._sent_s = self.now()
        self._instead.clear()
        self._bus.send(
            can.Message(
                arbitration_id=identifier,
                data=None if remote else data,
                dlc=len(data),
                is_extended_id=extended,
                is_remote_frame=remote,
            )
        )

    def reply(self, device: int, within_s: float) -> Reply | None:
        """The next answer of `device`; None when there is none in time."""
        for message in self._heard(within_s):
            if message.arbitration_id != REPLY_BASE + device or message.is_extended_id:
                self._stray(message, REPLY_BASE + device)
            elif len(message.data) == FRAME_BYTES and not message.is_remote_frame:
                return unpack_reply(bytes(message.data))
            else:
                self._instead.append(f"answered with {len(message.data)} bytes instead of {FRAME_BYTES}")
        return None

    def _stray(self, message: can.Message, expected: int) -> None:
        """Keep a frame that nobody sends unasked: it may be the answer, elsewhere."""
        identifier = message.arbitration_id
        base = identifier & ~(_TYPES - 1)
        unasked = identifier in self.known or base == COMMAND_BASE  # a bus may hand back the tester's own
        if message.is_extended_id or base == REPLY_BASE or not unasked:
            kind = "extended " if message.is_extended_id else ""
            self._instead.append(f"answered with {kind}{identifier:#05x} instead of {expected:#05x}")

    def _took(self, device: int, opcode: int) -> None:
        self.took_s.setdefault(device, []).append((self.now() - self._sent_s, opcode))

    def replies(self, device: int, opcode: int) -> Answers:
        """Answers of `device` to `opcode`: the first within reply_s, then any within quiet_s."""
        found = Answers()
        end = self.now() + self.settings.reply_s
        while (reply := self.reply(device, end - self.now())) is not None:
            if reply.opcode == opcode:
                if not found:
                    self._took(device, opcode)
                found.append(reply)
                end = self.now() + self.settings.quiet_s
            else:
                self._instead.append(f"answered for opcode {reply.opcode:#04x} instead of {opcode:#04x}")
        found.instead = ", ".join(dict.fromkeys(self._instead))
        return found

    def first(self, device: int, opcode: int, *arguments: int) -> Reply | None:
        """The answer to a command, without waiting for a second one; then the bus is left to others."""
        self.send(COMMAND_BASE + device, pack_command(device, opcode, *arguments))
        end = self.now() + self.settings.reply_s
        while (reply := self.reply(device, end - self.now())) is not None:
            if reply.opcode == opcode:
                self._took(device, opcode)
                self.listen(_ROOM_S)
                return reply
        return None

    def silent(self, device: int) -> bool:
        """Whether `device` says nothing of the kind for quiet_s and a bit."""
        return not any(
            message.arbitration_id == REPLY_BASE + device and not message.is_remote_frame  # may be one's own
            for message in self._heard(3 * self.settings.quiet_s)
        )

    def ask(self, device: int, opcode: int, *arguments: int) -> Answers:
        """Send a command of the protocol and collect its answers."""
        return self.ask_raw(device, pack_command(device, opcode, *arguments))

    def ask_raw(self, device: int, data: bytes) -> Answers:
        """Send any bytes as a command and collect the answers; what has no byte 1 is answered as opcode 0."""
        opcode = data[1] if len(data) > 1 else 0
        self.send(COMMAND_BASE + device, data)
        found = self.replies(device, opcode)
        if len(data) == FRAME_BYTES and data[0] == device and opcode in _NUMBERED:
            found.parameter = data[2]
        return found
