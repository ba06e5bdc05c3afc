"""The bus page's view of real boards: what reaches the host's own link, and what the heartbeats say."""

from collections import Counter, deque
from concurrent.futures import Future

from bus.can.length import frame_bits
from bus.can.wire import MAX_BITRATE
from bus.protocol import Device, unpack_heartbeat
from bus.protocol.nodes import DEVICES
from bus.protocol.report import ReportError, unpack_report
from host.client import SILENCE_NS, Client
from host.console.views import KEPT, BusState, FaultKind, Node

_LOAD_NS = 1_000_000_000
"""The load is that of the last second."""
_PASSIVE = 128
"""Error counter from which ISO 11898-1 has a node passive. Bus off cannot be heard."""


class HeardBus:
    """A `BusView`. client: whose heartbeats are looked at; it ticks elsewhere, and what is read here is
    replaced as a whole.

    The load is a lower bound: the gateway does not pass on what the host itself commands, nor broken frames.
    A host at a real bus has no faults to make.
    """

    def __init__(self, client: Client) -> None:
        self.boards: tuple[str, ...] = ()
        self.kinds: list[FaultKind] = []
        self._client = client
        self._frames: deque[tuple[int, int, bytes]] = deque(maxlen=KEPT)
        self._second_ns = 0
        self._bits: Counter[int] = Counter()
        self._loads: dict[int, float] = {}

    def take(self, t_ns: int, report: bytes) -> None:
        """A report of the gateway, on the ticking thread."""
        if t_ns - self._second_ns >= _LOAD_NS:
            share = 1e9 / MAX_BITRATE / (t_ns - self._second_ns)
            self._loads = {number: bits * share for number, bits in self._bits.items()}
            self._second_ns, self._bits = t_ns, Counter()
        try:
            frames = unpack_report(report)
        except ReportError:
            return  # the link counts it
        for frame in frames:
            self._bits[frame.data[0]] += frame_bits(frame)
            self._frames.append((t_ns, frame.identifier, frame.data))

    def look(self) -> BusState:
        """Boards that should live; silent ones are shown as off. Nobody tells the host of their REC.

        The load is of the last whole second, errors are of the cable only: no host hears error frames through
        the gateway.
        """
        names = {int(device): device.name for device in (*DEVICES, *self._client.devices)}
        return BusState(
            nodes=[self._node(device) for device in self._client.devices],
            load=sum(self._loads.values()),
            errors={"bad reports": self._client.link.bad_reports},
            running=[],
            frames=[
                (t_ns, names.get(data[0], f"{data[0]:#04x}"), identifier, data)
                for t_ns, identifier, data in tuple(self._frames)
            ],
        )

    def wish(self, _command: str) -> Future[str]:
        """Refused."""
        future: Future[str] = Future()
        future.set_exception(ValueError("this is no emulated bus: nothing can be broken from here"))
        return future

    def _node(self, device: Device) -> Node:
        heard_ns, data = self._client.link.heard_ns.get(device), self._client.link.heartbeats.get(device)
        if heard_ns is None or data is None or self._client.now_ns - heard_ns > SILENCE_NS:
            return Node(device.name, False, "silent", 0, 0)
        tec, load = unpack_heartbeat(data).tec, self._loads.get(int(device), 0.0)
        return Node(device.name, True, "passive" if tec >= _PASSIVE else "active", tec, 0, load)
