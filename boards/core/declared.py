"""A board made from its declaration: a class with its kind, interrupt table, pins and one routine.

Identifiers, parameters, commands and their bounds, frames and their periods, heartbeat and RS232 packets
follow from the kind's DBC (`bus/protocol/nodes/`). Wiring and schema from the pins
(`scenarios/lab/nodes.py`).
"""

import sys
from collections.abc import Callable, Mapping
from math import isfinite
from typing import Any, ClassVar, NamedTuple

from mypy_extensions import mypyc_attr

from boards.core.board import Board
from boards.core.commands import Answer, Command, Handler, Parameter
from boards.core.interrupts import Source
from boards.core.packets import PacketLine
from boards.core.periodic import PeriodicBoard
from boards.core.place import Place
from boards.silicon.can import FULL_MASK
from boards.silicon.uart import Uart
from bus.protocol import COMMAND_BASE, SUMMARY_BASE
from bus.protocol.nodes import FrameCodec, Kind, arguments_of, messages_of

_SECOND_NS = 1_000_000_000


class BoardError(ValueError):
    """A declared board's own code fails; one line with board, file and simulated time."""


class Pin(NamedTuple):
    """One pin.

    source: the plant's method it is wired to, such as `ra.auxiliary`, or `part.` and a method of the board's
    PART. `{side}` stands for ra or dec, by the board's name. Without a source a scenario sets the pin.
    default: what it reads before, in `unit`.
    """

    name: str
    source: str = ""
    default: float = 0.0
    unit: str = ""


class Cell:
    """A parameter's value in the board's memory."""

    def __init__(self, value: int) -> None:
        self.value = value

    def get(self) -> int:
        """Read it."""
        return self.value

    def set(self, value: int) -> None:
        """Write it."""
        self.value = value


def board_error(board: type, name: str, t_ns: int, error: BaseException, what: str = "") -> BoardError:
    """What is said of an error in the code of `board`, of which `name` is one; an interruption goes on.

    what: said instead of the error.
    """
    if isinstance(error, KeyboardInterrupt):
        raise error
    file = getattr(sys.modules.get(board.__module__), "__file__", board.__module__)
    try:
        text = " ".join(str(error).split())
    except Exception:  # its text is the author's, too
        text = ""
    reason = what or f"{type(error).__name__}: {text}".rstrip(": ")
    return BoardError(f"{file}: board {name} fails at {t_ns * 1e-9:.6g} s: {reason}")


def _unusable(values: Any) -> str:
    """Why no frame can be made of what `measure` returned; "" when that is not to blame."""
    if not isinstance(values, Mapping):
        return f"measure returned {type(values).__name__}, expected a mapping of signals"
    for name, value in values.items():
        if not isinstance(value, (int, float)):
            return f"measure returned {name} as {type(value).__name__}, expected a number"
        try:
            usable = isfinite(value)
        except OverflowError:
            usable = False
        if not usable:
            return f"measure returned {name} that is no finite number"
    return ""


@mypyc_attr(allow_interpreted_subclasses=True)
class DeclaredBoard(PeriodicBoard):
    """Subclasses name KIND, TABLE, PINS and write `measure(t_ns)`.

    For an opcode X of their own they write `x(t_ns, arguments as on the wire)`; it returns an Answer, or None
    for OK. PART is the class of what the pins with the source `part` drive and read. Each board makes one,
    without arguments.
    """

    KIND: ClassVar[Kind]
    FCY_HZ: ClassVar[int] = 10_000_000
    TABLE: ClassVar[tuple[Source, ...]]
    PINS: ClassVar[tuple[Pin, ...]] = ()
    PART: ClassVar[type | None] = None

    def __init__(self, place: Place, pins: Mapping[str, Callable[..., float]]) -> None:
        device_type = place.device_type
        messages = [each for each in messages_of(self.KIND) if each.frame_id & 0x7F == device_type]
        own = [each for each in messages if 0x200 <= each.frame_id < 0x400]
        self.codecs = sorted((FrameCodec(each) for each in own), key=lambda codec: codec.period_ns)
        tick_ns = self.codecs[0].period_ns
        if _SECOND_NS % tick_ns or any(codec.period_ns % tick_ns for codec in self.codecs):
            raise ValueError(f"{self.KIND.dbc}: periods must be multiples of the shortest, which divides 1 s")
        super().__init__(place, self.FCY_HZ, self.TABLE, tick_ns)
        self._signals = {signal.name for message in own for signal in message.signals}
        self.pins = dict(pins)
        self.packets = PacketLine(place, self.clip)
        self.uart = self.packets.uart
        self.values = {row.name: Cell(row.default) for row in self.KIND.parameters}
        self.set_parameters(
            Parameter(row.number, row.name, row.low, row.high, cell.get, cell.set)
            for row, cell in zip(self.KIND.parameters, self.values.values(), strict=True)
        )
        own_commands: dict[int, Handler] = {
            int(opcode): Command(
                opcode, getattr(self, opcode.name.lower()), [(each.low, each.high) for each in arguments]
            )
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
        self.packets.clear()
        for row in self.KIND.parameters:
            self.values[row.name].value = row.default

    def _serve(self, t_ns: int) -> None:
        try:  # a command's method is the author's, and so is its answer
            super()._serve(t_ns)
        except BaseException as error:
            raise board_error(type(self), self.name, t_ns, error) from None

    def routine(self, t_ns: int) -> None:
        """Timer interrupt, every shortest period."""
        end = self.enter(t_ns)
        if not end:
            return
        ticks = self.ticks
        for identifier, data in self._frames(t_ns):
            self.transmit(identifier, data, end)
            if identifier < SUMMARY_BASE:
                self.packets.take(t_ns, end, data[1:])
        if not (ticks - 1) % self._heartbeat_ticks:
            self.heartbeat(end)

    def heartbeat(self, t_ns: int) -> None:
        """As any board's; raises BoardError where `state` says nothing that one can hold."""
        try:
            super().heartbeat(t_ns)
        except BaseException as error:
            raise board_error(type(self), self.name, t_ns, error, f"state cannot be sent: {error}") from None

    def _ping(self, t_ns: int) -> Answer:
        try:
            return super()._ping(t_ns)
        except BaseException as error:
            raise board_error(type(self), self.name, t_ns, error, f"health cannot be sent: {error}") from None

    def _frames(self, t_ns: int) -> list[tuple[int, bytes]]:
        """Identifiers and data of what is due now; raises BoardError."""
        passed_ns = self.ticks * self.period_ns
        values: Any = {}
        try:
            values = self.measure(t_ns)
            if unknown := values.keys() - self._signals:
                raise LookupError(f"measure returned {min(map(str, unknown))}, which no frame has")
            return [
                (codec.identifier, codec.pack(values, self.clip))
                for codec in self.codecs
                if not passed_ns % codec.period_ns
            ]
        except BaseException as error:
            raise board_error(type(self), self.name, t_ns, error, _unusable(values)) from None


def uart_of(board: Board) -> Uart | None:
    """A board's RS232 transmitter, if it has one."""
    found = getattr(board, "uart", None)
    return found if isinstance(found, Uart) else None
