"""The wire of a served network, for the bus page of a host's consoles: this is the emulator's side."""

from collections import Counter, deque
from collections.abc import Callable, Mapping
from typing import Any

from bus.can.frame import Frame
from bus.can.length import frame_bits
from host.console.views import KEPT, BusState, FaultKind, Node
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.lab.faults import FaultError, Kind, Parameter

_LOAD_NS = 1_000_000_000
REFUSALS = (ValueError, TypeError)
"""What a wish may be refused by: FaultError, NetworkError, arguments of another kind."""


class EmulatedBus:
    """The wire for a host elsewhere: `look` is what it shows, `wish` what it may ask for; `poll`, between two
    slices, does it."""

    def __init__(self, served: LiveNetwork) -> None:
        self._served = served
        self._frames: deque[tuple[int, str, int, bytes]] = deque(maxlen=KEPT)
        self._sent: Counter[str] = Counter()
        self._bits: deque[tuple[int, int, dict[str, int]]] = deque([(0, 0, {})])
        """Time and bits on the wire so far, all and by sender, of the last second."""
        self._wanted: deque[Callable[[], None]] = deque()
        self._acts: dict[str, Callable[..., str]] = {
            "start_fault": self._start_fault,
            "clear_fault": self._clear_fault,
            "switch": self._switch,
        }
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
        """The table of faults."""
        return [
            FaultKind(
                kind.name, kind.level, kind.text, _template(kind), "; ".join(map(_said, kind.parameters))
            )
            for kind in self._served.faults.kinds()
        ]

    def _running(self) -> list[tuple[int, str]]:
        now_ns = self._served.now_ns
        return [
            (
                each.number,
                f"{each.name}, {_arguments(each.arguments)} for {(now_ns - each.since_ns) * 1e-9:.1f} s",
            )
            for each in self._served.faults.running
        ]

    def wish(self, name: str, arguments: tuple[Any, ...], answer: Callable[[str, bool], None]) -> None:
        """Have `poll` do it and call answer(text, bad)."""

        def act() -> None:
            try:
                text, bad = self._acts[name](*arguments), False
            except REFUSALS as error:
                text, bad = str(error), True
            answer(text, bad)

        self._wanted.append(act)

    def poll(self) -> None:
        """On the ticking thread."""
        while self._wanted:
            self._wanted.popleft()()

    def _start_fault(self, name: str, arguments: str) -> str:
        return f"fault {self._served.start_fault(name, **_pairs(arguments))} is on"

    def _clear_fault(self, number: int) -> str:
        self._served.clear_fault(number)
        return f"fault {number} is cleared"

    def _switch(self, board: str, on: bool) -> str:
        self._served.switch(board, on)
        return f"{board} is switched {'on' if on else 'off'}"


def _template(kind: Kind) -> str:
    """The arguments that have to be given, for a person to complete."""
    needed = [each.name for each in kind.parameters if each.default is None or each.name in kind.one_of]
    return " ".join(f"{name}=" for name in needed)


def _said(parameter: Parameter) -> str:
    """An argument: what it is, its unit, its bounds, what it is when left out."""
    unit = f", {parameter.unit}" if parameter.unit not in ("", "1") else ""
    bounds = (
        f", {parameter.low:g} to {parameter.high:g}" if None not in (parameter.low, parameter.high) else ""
    )
    default = f" ({parameter.default} when left out)" if parameter.default not in (None, "") else ""
    return f"{parameter.name}: {parameter.text}{unit}{bounds}{default}"


def _pairs(text: str) -> dict[str, str]:
    """`name=value` words; a value with a unit is written without a blank, or with `_` for it."""
    found = {}
    for word in text.split():
        name, equals, value = word.partition("=")
        if not (name and equals and value):
            raise FaultError(f"{word!r}: arguments are written name=value")
        found[name] = value.replace("_", " ") if name not in ("node", "nodes", "sensor") else value
    return found


def _arguments(given: Mapping[str, Any]) -> str:
    return " ".join(f"{name}={value}" for name, value in given.items()) or "no arguments"
