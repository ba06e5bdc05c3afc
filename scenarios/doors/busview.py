"""What the host beside a served network sees of the emulator: its wire for the bus page, sky for cameras."""

from collections import Counter, deque

from bus.can.frame import Frame
from bus.can.length import frame_bits
from host.camera.models import Look
from host.console.views import KEPT, BusState, FaultKind, Node
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.lab.eye import look
from scenarios.lab.faults.kind import Parameter

_LOAD_NS = 1_000_000_000


class EmulatedBus:
    """The wire for a host elsewhere, between slices: `look` is what it shows, `wish` what it may ask for."""

    def __init__(self, served: LiveNetwork) -> None:
        self._served = served
        self._frames: deque[tuple[int, str, int, bytes]] = deque(maxlen=KEPT)
        self._sent: Counter[str] = Counter()
        self._bits: deque[tuple[int, int, dict[str, int]]] = deque([(0, 0, {})])
        """Time and bits on the wire so far, all and by sender, of the last second."""
        served.network.wire.tap(self._tap)

    def _tap(self, t_ns: int, frame: Frame, sender: str) -> None:
        self._frames.append((t_ns, sender, frame.identifier, frame.data))
        self._sent[sender] += frame_bits(frame)

    def look(self) -> BusState:
        """Everything at this moment."""
        wire = self._served.network.wire
        load = self._load()
        return BusState(self._nodes(), load, dict(wire.errors), self._running(), list(self._frames))

    def _load(self) -> float:
        """Share of the last second in which the bus was busy."""
        wire, now_ns = self._served.network.wire, self._served.now_ns
        self._bits.append((now_ns, wire.bits, dict(self._sent)))
        while len(self._bits) > 2 and self._bits[1][0] <= now_ns - _LOAD_NS:
            self._bits.popleft()
        since_ns, before, _ = self._bits[0]
        return (wire.bits - before) * wire.bit_ns / (now_ns - since_ns) if now_ns > since_ns else 0.0

    def _nodes(self) -> list[Node]:
        boards, wire = self._served.network.boards, self._served.network.wire
        (since_ns, _, before), (now_ns, _, sent) = self._bits[0], self._bits[-1]
        share = wire.bit_ns / max(now_ns - since_ns, 1)
        found = []
        for port in wire.ports:
            on = boards[port.name].on if port.name in boards else port.online
            load = (sent.get(port.name, 0) - before.get(port.name, 0)) * share
            found.append(Node(port.name, on, port.state, port.tec, port.rec, load))
        return found

    def fault_kinds(self) -> list[FaultKind]:
        """The table of faults; of arguments that have to be given the names, for a person to complete."""
        found = []
        for k in self._served.faults.kinds():
            needed = (each.name for each in k.parameters if each.default is None or each.name in k.one_of)
            words = " ".join(f"{name}=" for name in needed)
            found.append(FaultKind(k.name, k.level, k.text, words, "; ".join(map(_said, k.parameters))))
        return found

    def _running(self) -> list[tuple[int, str]]:
        found = []
        for each in self._served.faults.running:
            given = " ".join(f"{name}={value}" for name, value in each.arguments.items()) or "no arguments"
            since_s = (self._served.now_ns - each.since_ns) * 1e-9
            found.append((each.number, f"{each.name}, {given} for {since_s:.1f} s"))
        return found

    def wish(self, command: str) -> tuple[str, bool]:
        """Carry out a command of the control plane; its answer, and whether it was refused."""
        try:
            return self._served.command(command.split()), False
        except (ValueError, TypeError) as error:
            return str(error), True


def _said(p: Parameter) -> str:
    """An argument: what it is, its unit, its bounds, what it is when left out."""
    unit = f", {p.unit}" if p.unit not in ("", "1") else ""
    bounds = f", {p.low:g} to {p.high:g}" if None not in (p.low, p.high) else ""
    default = f" ({p.default} when left out)" if p.default not in (None, "") else ""
    return f"{p.name}: {p.text}{unit}{bounds}{default}"


PERIOD_NS = 10_000_000
"""Between two looks: 0.15″ of the sky's turn."""


class Looks:
    """Where the telescope truly looks, for cameras whose shutter is open; kept since they were last taken.

    The plant is asked between two slices, which changes nothing in it.
    """

    def __init__(self, served: LiveNetwork) -> None:
        self._served = served
        self._kept: list[Look] = []
        self._next_ns = 0
        self.wanted = False

    def poll(self, now_ns: int) -> None:
        """Look, when somebody wants it and it is time."""
        if self.wanted and now_ns >= self._next_ns:
            self._next_ns = now_ns + PERIOD_NS
            self._kept.append(look(self._served.network.plant, self._served.scenario, now_ns))

    def taken(self) -> list[Look]:
        """Those since the last call."""
        kept, self._kept = self._kept, []
        return kept
