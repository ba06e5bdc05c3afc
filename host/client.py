"""The telescope client: sends commands, waits for answers, watches the boards, runs procedures.

It is a participant of the event queue: `tick` is called every 50 ms of simulated time. A procedure is a
generator that yields whenever it has to wait for the next tick; several run side by side.
"""

from collections.abc import Callable, Generator
from dataclasses import dataclass, field
from typing import Any, Final

from bus.protocol import (
    Device,
    Focus,
    Health,
    Heartbeat,
    Motion,
    Opcode,
    Position,
    Reply,
    Result,
    pack_command,
    unpack_focus,
    unpack_heartbeat,
    unpack_motion,
    unpack_position,
    unpack_reply,
)
from host.link import HidLink
from host.logs.journal import Logs

TICK_NS: Final = 50_000_000
"""20 Hz, ASSUMPTION: the paper's consoles refresh at 4 Hz, its threads poll faster."""
REPLY_TIMEOUT_NS: Final = 200_000_000
"""A board answers within milliseconds; 200 ms is four ticks. ASSUMPTION."""
TRIES: Final = 3
SILENCE_NS: Final = 3_500_000_000
"""Three heartbeats missed."""

WATCH_NS: Final = 500_000_000
"""How often heartbeats are looked at; they come once a second."""

_MOVE_NOTHING: Final = (Opcode.PING, Opcode.GET_PARAMETER, Opcode.SET_PARAMETER)
"""Whoever asked for these wants the answer whatever the axes begin meanwhile. A stop overtakes them."""

Procedure = Generator[None, None, Any]


class ClientError(ValueError):
    """A procedure that cannot go on; the message says which device and why."""


class CommandRefused(ClientError):
    """A board answered, but does not do it."""


@dataclass
class _Pending:
    """A command on its way and how often it has been tried."""

    device: Device
    opcode: Opcode
    arguments: tuple[int, ...]
    sent_ns: int = -1
    tries: int = 0
    reply: Reply | None = None
    failed: str = ""
    data: bytes = field(init=False)

    def __post_init__(self) -> None:
        self.data = pack_command(self.device, self.opcode, *self.arguments)

    def text(self) -> str:
        return " ".join([self.opcode.name, *map(str, self.arguments)])


class Client:
    """What the observer's PC does over the USB link.

    link: the HID link. logs: where commands, status and errors go. devices: the boards expected to live.
    """

    def __init__(self, link: HidLink, logs: Logs, devices: tuple[Device, ...] = tuple(Device)) -> None:
        self.link = link
        self.logs = logs
        self.devices = devices
        self.health: dict[Device, Health] = {}
        """What each board answered to its last PING."""
        self.now_ns = 0
        self._watch_ns = 0
        self._waiting: dict[int, list[_Pending]] = {}
        self._silent: set[Device] = set()
        self._states: dict[Device, tuple[int, int]] = {}
        link.on_reply = self._take_reply

    # --- what a procedure calls ---
    def ask(self, device: Device, opcode: Opcode, *arguments: int) -> Generator[None, None, Reply]:
        """Send a command and wait for its reply, with retries; `ClientError` when it is refused or lost."""
        pending = _Pending(device, opcode, arguments)
        queue = self._waiting.setdefault(device, [])
        place = len(queue)
        while opcode == Opcode.STOP and place and queue[place - 1].opcode in _MOVE_NOTHING:
            place -= 1
        queue.insert(place, pending)
        while pending.reply is None and not pending.failed:
            yield
        if pending.failed:
            raise ClientError(f"{device.name}: {pending.text()}: {pending.failed}")
        assert pending.reply is not None
        if pending.reply.result != Result.OK:
            reason = Result(pending.reply.result).name.lower().replace("_", " ")
            raise CommandRefused(f"{device.name}: {pending.text()} was refused: {reason}")
        return pending.reply

    def forget(self, device: Device) -> None:
        """Give up what is waiting for a device and would move it, so that none of it comes after a stop."""
        waiting = self._waiting.get(device, [])
        for pending in waiting:
            if pending.opcode not in _MOVE_NOTHING:
                pending.failed = "given up"
        self._waiting[device] = [pending for pending in waiting if not pending.failed]

    def wait(self, seconds: float) -> Procedure:
        """Do nothing for a while."""
        end_ns = self.now_ns + round(seconds * 1e9)
        while self.now_ns < end_ns:
            yield

    def until(self, what: str, condition: Callable[[], bool], timeout_s: float) -> Procedure:
        """Wait for a condition; raises `ClientError` naming `what` after the time-out."""
        end_ns = self.now_ns + round(timeout_s * 1e9)
        while not condition():
            if self.now_ns >= end_ns:
                raise ClientError(f"{what}: not within {timeout_s:g} s")
            yield

    @property
    def now_s(self) -> float:
        """Time of the tick, s."""
        return self.now_ns * 1e-9

    def latched_s(self, encoder: Device, reading: Position) -> float:
        """When an encoder was read, s, as its frame's age tells."""
        return (self.link.measured_ns[encoder] - reading.age * 4000) * 1e-9

    def motion(self, device: Device) -> Motion | None:
        """Last MOTION of an axis board."""
        data = self.link.measurements.get(device)
        return unpack_motion(data) if data else None

    def position(self, device: Device) -> Position | None:
        """Last POSITION of a position board."""
        data = self.link.measurements.get(device)
        return unpack_position(data) if data else None

    def focus(self) -> Focus | None:
        """Last FOCUS of the focus board."""
        data = self.link.measurements.get(Device.FOCUS)
        return unpack_focus(data) if data else None

    def heartbeat(self, device: Device) -> Heartbeat | None:
        """Last HEARTBEAT of a board."""
        data = self.link.heartbeats.get(device)
        return unpack_heartbeat(data) if data else None

    # --- what the event queue calls ---
    def tick(self, t_ns: int) -> None:
        """Go on: time-outs, retries, heartbeats, then send."""
        self.now_ns = t_ns
        if t_ns >= self._watch_ns:
            self._watch_ns = t_ns + WATCH_NS
            self._watch(t_ns)
        for queue in self._waiting.values():
            if queue:
                self._serve(t_ns, queue)
        self.link.flush(t_ns)

    def _serve(self, t_ns: int, queue: list[_Pending]) -> None:
        """One command per device is on its way; the others wait their turn."""
        pending = queue[0]
        if pending.sent_ns >= 0 and t_ns - pending.sent_ns < REPLY_TIMEOUT_NS:
            return
        if pending.tries >= TRIES:
            pending.failed = f"no answer after {TRIES} tries"
            self.logs.command(t_ns, pending.device.name, pending.text(), "no answer")
            self.logs.error(t_ns, pending.device.name, f"{pending.text()}: {pending.failed}")
            queue.pop(0)
            if queue:
                self._serve(t_ns, queue)
            return
        if pending.tries:
            self.logs.error(
                t_ns, pending.device.name, f"{pending.text()}: no answer, try {pending.tries + 1}"
            )
        pending.tries += 1
        pending.sent_ns = t_ns
        self.link.queue(pending.data)

    def _take_reply(self, t_ns: int, data: bytes) -> None:
        reply = unpack_reply(data)
        queue = self._waiting.get(reply.device, [])
        pending = next((each for each in queue if each.sent_ns >= 0 and each.opcode == reply.opcode), None)
        if pending is None:
            self.logs.status(
                t_ns, f"device {reply.device:#04x}", f"late answer to opcode {reply.opcode:#04x}"
            )
            return
        queue.remove(pending)
        pending.reply = reply
        if reply.opcode == Opcode.PING and reply.result == Result.OK:
            self.health[pending.device] = Health(reply.value)
        result = Result(reply.result).name.lower() if reply.result in _RESULTS else f"result {reply.result}"
        self.logs.command(t_ns, pending.device.name, pending.text(), f"{result} {reply.value}")
        if reply.result:
            self.logs.error(t_ns, pending.device.name, f"{pending.text()}: {result}")

    def _watch(self, t_ns: int) -> None:
        """Heartbeats: silence and changes of state or overruns are logged once."""
        for device in self.devices:
            heard_ns = self.link.heard_ns.get(device, 0)
            if t_ns - heard_ns > SILENCE_NS:
                if device not in self._silent:
                    self._silent.add(device)
                    self.health.pop(device, None)  # whoever comes back may not be what it was
                    self.logs.error(t_ns, device.name, f"silent since {heard_ns / 1e9:.1f} s")
            elif device in self._silent:
                self._silent.discard(device)
                self.logs.status(t_ns, device.name, "is back")
            data = self.link.heartbeats.get(device)
            if data is None:
                continue
            state = (data[2], data[5] | data[6] << 8)
            if self._states.get(device) != state:
                self._states[device] = state
                self.logs.status(t_ns, device.name, f"state {state[0]}, overruns {state[1]}, tec {data[7]}")


_RESULTS: Final = {int(result) for result in Result}
