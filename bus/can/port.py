"""One node's connection to a wire: what its CAN controller drives."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Final, Literal, NamedTuple, Protocol

from bus.can.frame import Frame, arbitration_key
from bus.can.length import frame_bits, plain_bits
from bus.can.sampling import BitTiming

if TYPE_CHECKING:
    from bus.can.wire import Wire

TX_BUFFERS: Final = 3
"""Transmit buffers of a controller (MCP2515, DS20001801 section 3)."""

State = Literal["active", "passive", "bus_off"]
Receive = Callable[[int, Frame], None]


Entry = tuple[int, int, int, "Port", Frame, int]
"""An `Offer` as the wire keeps it: a plain tuple costs a third, and every frame needs one."""


class Offer(NamedTuple):
    """A frame in a transmit buffer; sorts as the wire decides: arbitration field, then first come."""

    key: int
    ticket: int
    ready_ns: int
    port: "Port"
    frame: Frame
    bits: int


class BusError(NamedTuple):
    """What a node hears of trouble: an error's kind ("": only counters have changed), and whether it was the
    one that sent."""

    kind: str
    sending: bool = False


class Watcher(Protocol):
    """A controller that wants to know what befalls its node, not only what is sent and received.

    A wire with a watcher on it is decided when it happens: exact, and slower than the planned one.
    """

    def began(self, t_ns: int) -> None:
        """The node's own frame has won the bus; its start of frame was a bit before `t_ns`."""

    def lost(self, t_ns: int) -> None:
        """The node's frame lost arbitration; it stays in its buffer unless the watcher withdraws it."""

    def failed(self, t_ns: int, *, sending: bool) -> None:
        """An error frame ended what the node was sending or receiving; a sent one will be tried again."""

    def counted(self, t_ns: int) -> None:
        """TEC or REC may have changed."""

    def activity(self, t_ns: int) -> None:
        """A frame has started on the wire while the node was asleep."""


class Port:
    """A node on a wire; made by `Wire.attach`.

    Among the buffers of one node the lowest identifier goes first, equal identifiers in the order sent.
    ASSUMPTION: firmware sets the MCP2515's TXP priorities that way. The paper does not say; with all TXP
    equal the chip would take the highest buffer number.
    A node that is off keeps nothing: its buffers are emptied and its error counters start from zero when
    it returns.
    """

    def __init__(self, wire: "Wire", name: str) -> None:
        self.name = name
        self.tec = 0
        self.rec = 0
        self.on_sent: Receive | None = None
        self.on_error: Callable[[int, BusError], None] | None = None
        """Called as `(t_ns, error)` when an error or a change of counters befalls the node."""
        self._wire = wire
        self._online = True
        self._bus_off = False
        self._free = TX_BUFFERS
        self._quiet_ns = 0
        self._filters: tuple[tuple[int, int], ...] | None = None
        self._on_receive: Receive | None = None
        self._routes: dict[int, tuple[Receive, ...]] = {}
        self._watcher: Watcher | None = None
        self._listen_only = False
        self._timing: BitTiming | None = None
        self.asleep = False
        """True: off, but the next frame wakes it: its watcher hears of it."""

    @property
    def state(self) -> State:
        """Error state by ISO 11898-1: passive beyond 127 in either counter, bus off beyond 255 in TEC."""
        if self._bus_off:
            return "bus_off"
        return "passive" if self.tec > 127 or self.rec > 127 else "active"

    @property
    def on_receive(self) -> Receive | None:
        """Called as `(t_ns, frame)` at the end of each good frame of another node that passes the filters."""
        return self._on_receive

    @on_receive.setter
    def on_receive(self, call: Receive | None) -> None:
        self._on_receive = call
        self._wire._forget_routes()

    @property
    def online(self) -> bool:
        """False: the node is off. It neither sends, receives nor acknowledges."""
        return self._online

    @online.setter
    def online(self, on: bool) -> None:
        if on != self._online:
            self._online = on
            self._wire._switched(self)

    @property
    def watcher(self) -> Watcher | None:
        """Who is told of errors, lost arbitrations and counters; None: nobody."""
        return self._watcher

    @watcher.setter
    def watcher(self, watcher: Watcher | None) -> None:
        self._watcher = watcher
        self._wire._trouble.check()

    @property
    def listen_only(self) -> bool:
        """True: the node hears and never drives the bus: no acknowledge, no error flag, no counting."""
        return self._listen_only

    @listen_only.setter
    def listen_only(self, silent: bool) -> None:
        if silent != self._listen_only:
            self._listen_only = silent
            self._wire._trouble.check()

    @property
    def timing(self) -> BitTiming | None:
        """Bit timing of the node's controller; None: the wire's own rate, exactly."""
        return self._timing

    @timing.setter
    def timing(self, timing: BitTiming | None) -> None:
        if timing is not None and timing.fits(self._wire.bit_ns):
            timing = None
        self._timing = timing
        self._wire._trouble.check()

    def withdraw(self, frame: Frame) -> bool:
        """Take a frame that is not on the bus yet out of its buffer; False: it has begun, or is not here."""
        return self._wire._withdraw(self, frame)

    def accept(self, filters: Sequence[tuple[int, int]] | None) -> None:
        """Let through identifiers with `identifier & mask == code & mask` for any (mask, code); None: all."""
        self._filters = None if filters is None else tuple((mask, code & mask) for mask, code in filters)
        self._wire._forget_routes()

    def passes(self, identifier: int) -> bool:
        """Whether a frame with `identifier` gets through the acceptance filters."""
        return self._filters is None or any(identifier & mask == code for mask, code in self._filters)

    @property
    def free_buffers(self) -> int:
        """Transmit buffers that are empty (0 while the node is off)."""
        return self._free

    def send(self, frame: Frame, ready_ns: int) -> bool:
        """Put `frame` into a transmit buffer at `ready_ns` (may be in the future); False: none is free,
        or off.

        Raises FrameError when CAN cannot carry the frame. Whoever gets False decides what to do with the
        frame.
        """
        if not self._free:
            return False
        if frame.extended or frame.remote or len(frame.data) != 8:
            bits, key = frame_bits(frame), arbitration_key(frame)
        else:
            identifier = frame.identifier
            bits, key = plain_bits(identifier, frame.data), identifier << 21
        self._free -= 1
        self._wire._offer(key, ready_ns, self, frame, bits)
        return True
