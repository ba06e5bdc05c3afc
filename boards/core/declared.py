"""A board made from its declaration: a class with its kind, interrupt table, pins and one routine.

Identifiers, parameters, commands and their bounds, frames and their periods, heartbeat and RS232 packets
follow from the kind's DBC (`bus/protocol/nodes/`); wiring and schema from the pins (`scenarios/nodes.py`).
"""

from collections.abc import Callable, Mapping
from typing import ClassVar, NamedTuple

from mypy_extensions import mypyc_attr

from boards.core.board import Board
from boards.core.commands import Handler
from boards.core.interrupts import Source
from boards.core.parameters import Parameter
from boards.core.periodic import PeriodicBoard
from boards.core.results import OK, OUT_OF_RANGE, Answer
from boards.silicon.can import FULL_MASK
from boards.silicon.uart import Uart
from bus.can import Wire
from bus.protocol import COMMAND_BASE, LAYOUTS, SUMMARY_BASE
from bus.protocol.nodes import FrameCodec, Kind, arguments_of, messages_of
from bus.protocol.nodes.command import Argument
from bus.protocol.serial import SAMPLES, STAMP_UNIT_NS, pack_packet
from bus.time import EventQueue, Oscillator

_SECOND_NS = 1_000_000_000


class Pin(NamedTuple):
    """One pin. source: the plant's method it is wired to, such as `ra.auxiliary`, `{side}` being ra or dec by
    the board's name; empty: an input that a scenario sets, `default` otherwise, in `unit`."""

    name: str
    source: str = ""
    default: float = 0.0
    unit: str = ""


class Cell:
    """A parameter's value in the board's memory."""

    __slots__ = ("value",)

    def __init__(self, value: int) -> None:
        self.value = value

    def get(self) -> int:
        """Read it."""
        return self.value

    def set(self, value: int) -> None:
        """Write it."""
        self.value = value


class Command:
    """Checks the arguments of one opcode against the DBC's bounds, then calls the method of its name."""

    __slots__ = ("arguments", "board", "method", "opcode")

    def __init__(
        self, board: "DeclaredBoard", opcode: int, method: str, arguments: tuple[Argument, ...]
    ) -> None:
        self.board, self.opcode, self.method, self.arguments = board, opcode, method, arguments

    def __call__(self, t_ns: int, data: bytes) -> Answer:
        """Serve it; `data` is bytes 2..7."""
        values = LAYOUTS[self.opcode][0].unpack(data)
        if any(
            not each.low <= value <= each.high for each, value in zip(self.arguments, values, strict=True)
        ):
            return OUT_OF_RANGE
        return getattr(self.board, self.method)(t_ns, *values) or OK


@mypyc_attr(allow_interpreted_subclasses=True)
class DeclaredBoard(PeriodicBoard):
    """Subclasses name KIND, TABLE, PINS and write `measure(t_ns)`; for an opcode X of their own a method
    `x(t_ns, arguments as on the wire)` that returns an Answer, or None for OK."""

    KIND: ClassVar[Kind]
    FCY_HZ: ClassVar[int] = 10_000_000
    TABLE: ClassVar[tuple[Source, ...]]
    PINS: ClassVar[tuple[Pin, ...]] = ()

    def __init__(
        self,
        name: str,
        device_type: int,
        queue: EventQueue,
        wire: Wire,
        pins: Mapping[str, Callable[..., float]],
        oscillator: Oscillator,
    ) -> None:
        messages = [each for each in messages_of(self.KIND) if each.frame_id & 0x7F == device_type]
        own = [each for each in messages if 0x200 <= each.frame_id < 0x400]
        self.codecs = sorted((FrameCodec(each) for each in own), key=lambda codec: codec.period_ns)
        tick_ns = self.codecs[0].period_ns
        if _SECOND_NS % tick_ns or any(codec.period_ns % tick_ns for codec in self.codecs):
            raise ValueError(f"{self.KIND.dbc}: periods must be multiples of the shortest, which divides 1 s")
        super().__init__(name, device_type, queue, wire, oscillator, self.FCY_HZ, self.TABLE, tick_ns)
        self.pins = dict(pins)
        self.uart = Uart(queue)
        self.packets = 0
        self.stamp_ns = 0
        self.samples: list[bytes] = []
        self.values = {row.name: Cell(row.default) for row in self.KIND.parameters}
        self.set_parameters(
            Parameter(row.number, row.name, row.low, row.high, cell.get, cell.set)
            for row, cell in zip(self.KIND.parameters, self.values.values(), strict=True)
        )
        own_commands: dict[int, Handler] = {
            int(opcode): Command(self, opcode, opcode.name.lower(), arguments)
            for opcode, arguments in arguments_of(self.KIND).items()
        }
        self.commands = self.common_commands() | own_commands
        self._heartbeat_ticks = _SECOND_NS // tick_ns
        self.reset()

    def measure(self, t_ns: int) -> Mapping[str, float]:
        """The routine's work: read the pins at `t_ns`, return the frames' signals in their units."""
        raise NotImplementedError

    def read(self, pin: str, t_ns: int) -> float:
        """A pin at `t_ns`."""
        return self.pins[pin](t_ns)

    def listen(self, mail: Mapping[int, Callable[[int, bytes], None]]) -> None:
        """Take other boards' frames: identifier -> call(now_ns, data)."""
        self.mail |= mail
        self.can.accept((FULL_MASK, [COMMAND_BASE + self.device_type]), (FULL_MASK, list(mail)))

    def reset(self) -> None:
        """After power-up: parameters as declared."""
        self.samples = []
        for row in self.KIND.parameters:
            self.values[row.name].value = row.default

    def routine(self, t_ns: int) -> None:
        """Timer interrupt, every shortest period."""
        end = self.enter(t_ns)
        if not end:
            return
        ticks = self.ticks
        values = self.measure(t_ns)
        for codec in self.codecs:
            if not ticks * self.period_ns % codec.period_ns:
                data = codec.pack(values, self.clip)
                self.transmit(codec.identifier, data, end)
                if codec.identifier < SUMMARY_BASE:
                    self._sample(t_ns, end, data)
        if not (ticks - 1) % self._heartbeat_ticks:
            self.heartbeat(end)

    def _sample(self, t_ns: int, end_ns: int, data: bytes) -> None:
        """RS232: 25 measurement frames, device type off, make a packet."""
        if not self.samples:
            self.stamp_ns = t_ns
        self.samples.append(data[1:])
        if len(self.samples) == SAMPLES:
            stamp = self.oscillator.local_ns(self.stamp_ns) // STAMP_UNIT_NS
            self.uart.send(end_ns, pack_packet(self.device_type, self.packets, stamp, self.samples))
            self.packets = self.packets + 1 & 0xFF
            self.samples = []


def uart_of(board: Board) -> Uart | None:
    """A board's RS232 transmitter, if it has one."""
    found = getattr(board, "uart", None)
    return found if isinstance(found, Uart) else None
