"""A declared board by itself on a wire: its pins are numbers, and what it drives is noted."""

from collections.abc import Callable
from typing import Generic, TypeVar

from boards.core import Place
from boards.core.declared import DeclaredBoard
from bus.can import Frame, Wire
from bus.protocol import COMMAND_BASE, Result, pack_command, unpack_reply
from bus.protocol.nodes import FrameCodec, arguments_of, messages_of
from bus.time import EventQueue, Oscillator

MS = 1_000_000
SECOND = 1000 * MS
B = TypeVar("B", bound=DeclaredBoard)


class Alone(Generic[B]):
    """driven: (pin, time in ns, what is written). pins: what each reads now."""

    def __init__(self, kind: type[B], number: int, **pins: float) -> None:
        self.pins = pins
        self.driven: list[tuple[object, ...]] = []
        self.frames: list[tuple[int, Frame]] = []
        self.wire = Wire(EventQueue())
        self.queue = self.wire.queue
        name = next(name for name, each in kind.KIND.nodes.items() if each == number)
        place = Place(
            name=name, device_type=number, queue=self.queue, wire=self.wire, oscillator=Oscillator(0.0, 0)
        )
        self.board = kind(place, {pin.name: self._pin(pin.name) for pin in kind.PINS})
        self.partner = self.wire.attach("partner")
        self.partner.on_receive = lambda t_ns, frame: self.frames.append((t_ns, frame))
        (self.codec,) = (
            FrameCodec(each) for each in messages_of(kind.KIND) if each.frame_id == 0x200 + number
        )
        self.board.begin()
        self.run(0.002)  # a frame is through some 300 us after its tick

    def _pin(self, name: str) -> Callable[..., float]:
        def pin(t_ns: int, *written: object) -> float:
            if written:
                self.driven.append((name, t_ns, *written))
            return self.pins.get(name, 0.0)

        return pin

    def run(self, seconds: float) -> None:
        self.queue.run_until(self.queue.now_ns + round(seconds * SECOND))

    def said(self) -> dict[str, float]:
        """The last of its own frames."""
        return self.codec.unpack(self.told()[-1][1].data)

    def told(self) -> list[tuple[int, Frame]]:
        """Its own frames and when they were through."""
        return [(t_ns, frame) for t_ns, frame in self.frames if frame.identifier == self.codec.identifier]

    def hears(self, identifier: int, data: bytes) -> None:
        """A frame of somebody else, now."""
        assert self.partner.send(Frame(identifier, data), self.queue.now_ns)
        self.run(0.0005)

    def command(self, name: str, *arguments: int) -> Result:
        """The board's reply to an opcode of its kind."""
        number = self.board.device_type
        opcode = next(each for each in arguments_of(self.board.KIND) if each.name == name)
        self.hears(COMMAND_BASE + number, pack_command(number, opcode, *arguments))
        self.run(0.005)
        replies = [frame for _, frame in self.frames if frame.identifier == 0x100 + number]
        return Result(unpack_reply(replies[-1].data).result)

    def writes(self) -> list[tuple[object, ...]]:
        """What was driven since this was last asked, without the times."""
        found = [(pin, *written) for pin, _, *written in self.driven]
        self.driven.clear()
        return found
