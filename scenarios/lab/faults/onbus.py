"""Faults of the bus."""

from collections.abc import Mapping
from typing import Any

from bus.can import Flip, Frame
from bus.can.length import frame_bits
from bus.can.partition import Partition
from bus.can.port import BusError
from bus.can.sampling import BitTiming
from bus.can.stuck import StuckDominant
from bus.can.wire import Disturb
from bus.protocol import COMMAND_BASE, MEASUREMENT_BASE, REPLY_BASE
from scenarios.lab.faults.place import Place
from scenarios.lab.layers import Errors, Laid, words

_BUS = "the bus"


class Guest:
    """A node that does not belong on the bus; it leaves when what it has on the bus is through."""

    def __init__(self, place: Place, name: str) -> None:
        self.wire = place.network.wire
        self.queue = place.network.queue
        self.port = self.wire.attach(name)
        self.evidence = place.evidence
        self.port.on_sent, self.port.on_error = self._sent, self._disturbs
        self.leaving = False
        self._loaded: list[Frame] = []

    def load(self, frame: Frame, ready_ns: int) -> None:
        """Into a transmit buffer, if one is free."""
        if not self.leaving and self.port.send(frame, ready_ns):
            self._loaded.append(frame)

    def _sent(self, t_ns: int, frame: Frame) -> None:
        self.evidence.act(t_ns, words(frame))
        self._loaded.remove(frame)
        if self.leaving and not self._loaded:
            self.wire.detach(self.port)
        elif not self.leaving:
            self.sent(t_ns)

    def _disturbs(self, t_ns: int, error: BusError) -> None:
        if error.sending and self._loaded:
            self.evidence.act(t_ns, words(self._loaded[0]))

    def sent(self, t_ns: int) -> None:
        """A frame is through."""

    def clear(self, t_ns: int) -> None:
        """Go: at once, or after the frame that has begun."""
        self.leaving = True
        self._loaded = [frame for frame in self._loaded if not self.port.withdraw(frame)]
        if not self._loaded or self.port.state == "bus_off":
            self.wire.detach(self.port)


class Babbler(Guest):
    """Sends again as soon as it has sent, less the share of the time it leaves to others."""

    def __init__(self, place: Place, given: Mapping[str, Any], t_ns: int) -> None:
        super().__init__(place, "babbler")
        self._frame = Frame(given["identifier"], b"\xff" * 8)
        bits = frame_bits(self._frame)
        self._pause_ns = round(bits * self.wire.bit_ns * (1.0 - given["load"]) / given["load"])
        self.load(self._frame, t_ns)

    def sent(self, t_ns: int) -> None:
        """On with the next."""
        self.load(self._frame, t_ns + self._pause_ns)


class Forger(Guest):
    """Sends one frame again and again, of whatever identifier and data."""

    def __init__(self, place: Place, given: Mapping[str, Any], t_ns: int) -> None:
        super().__init__(place, "forger")
        self.repeat(Frame(given["identifier"], given["data"].to_bytes(8, "big")), given["period"], t_ns)

    def repeat(self, frame: Frame, period_s: float, t_ns: int) -> None:
        """Begin with it."""
        self._frame, self._period_ns = frame, round(period_s * 1e9)
        self.queue.at(t_ns, self._tick)

    def _tick(self, t_ns: int) -> None:
        self.load(self._frame, t_ns)
        self.queue.at(t_ns + self._period_ns, self._tick)

    def clear(self, t_ns: int) -> None:
        """No more of it."""
        self.queue.take_out([self._tick].__contains__)
        super().clear(t_ns)


class Twin(Forger):
    """A second node with a board's identifiers: it measures something else and answers its commands too."""

    def __init__(self, place: Place, given: Mapping[str, Any], t_ns: int) -> None:
        board = place.board(given["node"])
        Guest.__init__(self, place, f"second {board.name}")
        self._device = board.device_type
        line = board.cpu.lines["can"]
        self._answer_ns = line.latency_ns + line.cost_ns
        self.port.accept([(0x7FF, COMMAND_BASE + self._device)])
        self.port.on_receive = self._asked
        wrong = Frame(MEASUREMENT_BASE + self._device, bytes((self._device,)) + b"\x55" * 7)
        self.repeat(wrong, given["period"], t_ns)

    def _asked(self, t_ns: int, frame: Frame) -> None:
        opcode = frame.data[1] if len(frame.data) > 1 else 0
        answer = bytes((self._device, opcode, 0, 0)) + (0x5555).to_bytes(4, "little")
        self.load(Frame(REPLY_BASE + self._device, answer), t_ns + self._answer_ns)


class Cut:
    """The cable between some nodes and the others is broken."""

    def __init__(self, place: Place, given: Mapping[str, Any], t_ns: int) -> None:
        wire = place.network.wire
        if len(given["nodes"]) >= len(place.network.boards):
            raise ValueError("partition: nodes: some boards, not all of them")
        ports = [place.board(name).port for name in given["nodes"]]
        if any(port._wire is not wire for port in ports):
            raise ValueError("partition: nodes: one of them is cut off already")
        self._ports, self._evidence = ports, place.evidence
        self._partition = Partition(wire, ports, t_ns, self._parted)

    def _parted(self, t_ns: int, frame: Frame, _sender: str) -> None:
        if any(port.online for port in self._ports):
            self._evidence.act(t_ns, words(frame))

    def clear(self, t_ns: int) -> None:
        """Joined again."""
        self._partition.heal(t_ns)


class WrongRate:
    """A node's controller is set to another bit rate."""

    def __init__(self, place: Place, given: Mapping[str, Any], _t_ns: int) -> None:
        self._port, self._dials = place.board(given["node"]).port, place.dials
        self._timing = BitTiming(1e9 / given["bitrate"])
        self._dials.add(self._port, "timing", self)
        port = self._port
        self._errors = Errors(place.layers, port, place.evidence, lambda: port.timing is not None)

    def turn(self, _before: BitTiming | None) -> BitTiming:
        """What the port is set to, whatever it was."""
        return self._timing

    def clear(self, t_ns: int) -> None:
        """Set right."""
        self._errors.clear(t_ns)
        self._dials.remove(self._port, "timing", self)


class Dominant:
    """The bus is held dominant."""

    def __init__(self, place: Place, _given: Mapping[str, Any], t_ns: int) -> None:
        self._place, self._evidence = place, place.evidence
        self._first = place.hold(_BUS)
        if self._first:
            place.stuck.append(StuckDominant(place.network.wire, t_ns))
        ports = place.network.wire.ports
        self._errors = [Errors(place.layers, port, place.evidence, lambda: True) for port in ports]

    def clear(self, t_ns: int) -> None:
        """Released."""
        for each in self._errors:
            each.clear(t_ns)
        if self._place.let_go(_BUS):
            if not self._first:  # until now, as the others have long been over
                self._evidence.act(t_ns, _BUS)
            self._place.stuck.pop().release(t_ns)


class BitErrors(Laid):
    """In a share of the frames one bit, any of them, is inverted on the wire."""

    def __init__(self, place: Place, given: Mapping[str, Any], _t_ns: int) -> None:
        self._node, self._probability = given.get("node"), given["probability"]
        self._random, self._evidence = place.random, place.evidence
        super().__init__(place.layers, place.network.wire, "disturbance")

    def __call__(self, t_ns: int, frame: Frame, sender: str) -> Flip | None:
        """Asked by the wire at every start of frame."""
        if (self._node is None or sender == self._node) and self._random.random() < self._probability:
            self._evidence.act(t_ns, words(frame))
            return Flip(int(self._random.integers(frame_bits(frame) - 3)))
        below: Disturb | None = self.below
        return None if below is None else below(t_ns, frame, sender)
