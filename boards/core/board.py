"""What all boards have in common: processor, crystal, CAN service, parameters, heartbeat, health."""

from collections import deque
from collections.abc import Callable, Iterable, Mapping
from typing import Final

from mypy_extensions import mypyc_attr

from boards.core.commands import Answer, Handler, Parameter, ParameterTable, answer, commands
from boards.core.interrupts import InterruptController, Source
from boards.core.place import Place
from boards.silicon.can import FULL_MASK, CanController
from bus.can import Frame
from bus.protocol import (
    COMMAND_BASE,
    FRAME_BYTES,
    HEARTBEAT_BASE,
    REPLY_BASE,
    Health,
    Opcode,
    Result,
    State,
    pack_heartbeat,
    pack_reply,
)

CAN_LINE: Final = "can"
"""Name of the CAN interrupt in every board's table."""
BOOT_NS: Final = 300_000_000
"""Power-up timer and self test, ASSUMPTION. Longer than any board's slowest timer."""
WARNING_NS: Final = 10_000_000_000
"""How long the health bits FOREIGN and RANGE stand after the last cause. ASSUMPTION: long enough to be asked
for, and one bad frame does not keep a telescope from being powered for the rest of the night."""
_LONG_AGO: Final = -WARNING_NS
INBOX: Final = 8
"""Commands the firmware keeps until it serves them, ASSUMPTION (the chip itself holds two)."""


@mypyc_attr(allow_interpreted_subclasses=True)
class Board:
    """A microcontroller board on the bus.

    Subclasses write `reset()`, the state after power-up, and `start(t_ns)`, which arms the timers. They call
    `heartbeat(t_ns)` once a second. `mail` says what to do with measurement frames: identifier ->
    call(now_ns, data). Such a frame is eight bytes long and begins with the device type its identifier ends
    in; any other is dropped and counted as `foreign`.

    Times called t_ns are true: when pins are read and outputs take effect. What firmware decides by is the
    board's own clock, `clock_ns(t_ns)`, called now_ns: the timer's interrupts counted, and the timer read in
    between.
    """

    def __init__(self, place: Place, fcy_hz: int, table: tuple[Source, ...]) -> None:
        self.name = place.name
        self.device_type = device_type = place.device_type
        self.queue = place.queue
        self.oscillator = place.oscillator
        self.cpu = InterruptController(place.queue, fcy_hz, table)
        self.cpu.lines[CAN_LINE].body = self._serve
        self.mail: dict[int, Callable[[int, bytes], None]] = {COMMAND_BASE + device_type: self._take_command}
        self.inbox: deque[bytes] = deque()
        self.port = place.wire.attach(place.name)
        self.can = CanController(self.port, self._receive)
        self.send = self.can.send
        self.can.accept((FULL_MASK, [COMMAND_BASE + device_type]))
        self.parameters = ParameterTable()
        self.commands: Mapping[int, Handler] = self.common_commands()
        self._command = COMMAND_BASE + device_type
        self._last: dict[int, Frame] = {}
        self._late: bytes | None = None
        self._before: Callable[[int, Frame], None] | None = None
        self.dropped = 0
        self.foreign = 0
        self.clipped = 0
        self._foreign_ns = self._clipped_ns = self._dropped_ns = _LONG_AGO
        self.on = False
        self.boots = 0
        self._boot_ns = _LONG_AGO
        """When the boot in progress ends."""
        self.epoch_ns = 0
        """True time less the board's own; kept by whoever has the timer."""

    def common_commands(self) -> dict[int, Handler]:
        """The commands every board knows."""
        return commands(
            {
                Opcode.PING: self._ping,
                Opcode.GET_PARAMETER: self._get_parameter,
                Opcode.SET_PARAMETER: self._set_parameter,
            }
        )

    def set_parameters(self, rows: Iterable[Parameter]) -> None:
        """Give the board its parameter table."""
        self.parameters = ParameterTable(rows)

    def clock_ns(self, t_ns: int) -> int:
        """The board's own clock at true time `t_ns`, ns since it began to run.

        Within a period the timer is taken to run true: 50 ppm of 5 ms are a quarter of a nanosecond.
        """
        return t_ns - self.epoch_ns

    # --- power ------------------------------------------------------------------------------------
    def power_on(self, t_ns: int) -> None:
        """Supply comes up at `t_ns`: boot, then run."""
        if not self.on and self._boot_ns <= t_ns:  # it may be booting already
            self._boot_ns = t_ns + BOOT_NS
            self.queue.at(self._boot_ns, self._boot)

    def power_off(self, t_ns: int) -> None:
        """Supply fails at `t_ns`: the board falls silent; what it drove goes to its unpowered state."""
        self.port.online = False
        self.hold_in_reset(t_ns)

    def hold_in_reset(self, t_ns: int) -> None:
        """The processor's reset is pulled at `t_ns`; its CAN controller, a chip of its own, goes on."""
        self.on = False
        self._boot_ns = _LONG_AGO
        self.unpowered(t_ns)

    def begin(self, t_ns: int = 0) -> None:
        """Run from `t_ns` on, without a boot: the state a simulation starts in."""
        self._boot_ns = t_ns
        self._boot(t_ns)

    def _boot(self, t_ns: int) -> None:
        if t_ns != self._boot_ns:
            return  # the supply failed again
        self.on = True
        self.boots += 1
        self.port.online = True
        self.epoch_ns = t_ns
        self._foreign_ns = self._clipped_ns = self._dropped_ns = _LONG_AGO
        self.inbox.clear()
        self._last.clear()
        if self._late is not None:
            self._late, self.port.on_sent = None, self._before
        self.reset()
        self.start(t_ns)

    def reset(self) -> None:
        """State after power-up."""

    def start(self, t_ns: int) -> None:
        """Arm the timers."""
        raise NotImplementedError

    def unpowered(self, t_ns: int) -> None:
        """What the outputs do when the supply fails."""

    # --- CAN --------------------------------------------------------------------------------------
    def _receive(self, t_ns: int, frame: Frame) -> None:
        identifier = frame.identifier
        call = self.mail.get(identifier)
        if call is None or frame.extended or not self.on:  # an extended identifier is nobody's here
            return
        data, remote = frame.data, frame.remote
        if len(data) == FRAME_BYTES and data[0] == identifier & 0x7F and not remote:
            call(t_ns - self.epoch_ns, data)
        elif identifier != self._command:
            self.refuse(t_ns)
        elif not remote:
            call(t_ns - self.epoch_ns, data)  # a command that is wrong is answered, not dropped

    def refuse(self, t_ns: int) -> None:
        """Count a frame that is no frame of the peer it claims to come from."""
        self.foreign += 1
        self._foreign_ns = self.clock_ns(t_ns)

    def drop(self) -> None:
        """Count something that found no room."""
        self.dropped += 1
        self._dropped_ns = self.clock_ns(self.queue.now_ns)

    def clip(self) -> None:
        """Count a value that did not fit its field."""
        self.clipped += 1
        self._clipped_ns = self.clock_ns(self.queue.now_ns)

    def take_command(self, data: bytes) -> None:
        """A COMMAND by another way than CAN: the debug port."""
        self._take_command(0, data)

    def _take_command(self, _now_ns: int, data: bytes) -> None:
        if len(self.inbox) >= INBOX:
            self.drop()
            return
        self.inbox.append(data)
        self.cpu.lines[CAN_LINE].request(self.queue.now_ns)

    def _serve(self, t_ns: int) -> None:
        if not self.inbox or not self.on or self._late is not None:
            return
        opcode, reply = answer(self.device_type, self.commands, t_ns, self.inbox.popleft())
        data = pack_reply(self.device_type, opcode, *reply)
        if self.port.free_buffers or self.port.state == "bus_off":
            self.transmit(REPLY_BASE + self.device_type, data, t_ns)
        else:
            self._late, self._before = data, self.port.on_sent
            self.port.on_sent = self._freed
        if self.inbox:
            self.cpu.lines[CAN_LINE].request(t_ns)

    def _freed(self, t_ns: int, frame: Frame) -> None:
        """A transmit buffer is free for the reply that found none; commands wait in the inbox meanwhile, so
        that every one is answered."""
        before = self._before
        self._reply_late(t_ns)
        if before is not None:
            before(t_ns, frame)

    def _reply_late(self, t_ns: int) -> None:
        data = self._late
        if data is None:
            return
        self._late, self.port.on_sent = None, self._before
        self.transmit(REPLY_BASE + self.device_type, data, t_ns)
        if self.inbox:
            self.cpu.lines[CAN_LINE].request(t_ns)

    def transmit(self, identifier: int, data: bytes, ready_ns: int) -> None:
        """Load a frame into a transmit buffer at `ready_ns`; a full controller loses it and is counted."""
        if not self.send(Frame(identifier, data), ready_ns):
            self.drop()

    def refresh(self, identifier: int, data: bytes, ready_ns: int) -> None:
        """Send a frame that makes the one before it old news: if that still waits, this one takes its buffer.

        On a bus full of more important frames the three buffers would else hold old heartbeats, and no
        measurement would find room.
        """
        last = self._last.get(identifier)
        if last is not None:
            self.port.withdraw(last)
        self._last[identifier] = Frame(identifier, data)
        self.transmit(identifier, data, ready_ns)

    def heartbeat(self, t_ns: int) -> None:
        """Send the HEARTBEAT frame, ready at `t_ns`."""
        if self._late is not None and self.port.free_buffers:
            self._reply_late(t_ns)  # buffers that were emptied, as after bus off, tell nobody
        uptime_s = self.clock_ns(t_ns) // 1_000_000_000
        data = pack_heartbeat(self.device_type, self.state(), uptime_s, self.cpu.overruns, self.port.tec)
        self.refresh(HEARTBEAT_BASE + self.device_type, data, t_ns)

    # --- health and parameters --------------------------------------------------------------------
    def state(self) -> State:
        """State byte of the heartbeat."""
        return State.READY

    def health(self) -> Health:
        """Health bits; boards add their own to these."""
        bits = Health(0)
        if self.port.state != "active":
            bits |= Health.BUS
        if self.cpu.overruns:
            bits |= Health.OVERRUN
        now_ns = self.clock_ns(self.queue.now_ns)
        if now_ns - self._dropped_ns < WARNING_NS:
            bits |= Health.DROPPED
        if now_ns - self._foreign_ns < WARNING_NS:
            bits |= Health.FOREIGN
        if now_ns - self._clipped_ns < WARNING_NS:
            bits |= Health.RANGE
        return bits

    def _ping(self, _t_ns: int) -> Answer:
        return Answer(Result.OK, 0, int(self.health()))

    def _get_parameter(self, _t_ns: int, number: int) -> Answer:
        return self.parameters.get(number)

    def _set_parameter(self, _t_ns: int, number: int, value: int) -> Answer:
        return self.parameters.set(number, value)
