"""The wire of a served network as the bus page of the consoles shows it."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from typing import Any

from bus.can.frame import Frame
from host.console.views import FaultKind, Node, SeenFrame
from scenarios.doors.served import Served
from scenarios.faults import FaultError, Kind, Parameter, Running

KEPT = 200
"""Frames that a page may ask for."""


class EmulatedBus:
    """The wire as the bus page shows it. `poll` does what the page asked for, between two slices."""

    def __init__(self, served: Served) -> None:
        self._served = served
        self._frames: deque[tuple[int, Frame, str]] = deque(maxlen=KEPT)
        self._wanted: deque[Callable[[], None]] = deque()
        self._on: list[Running] = []
        served.network.wire.tap(self._tap)

    def _tap(self, t_ns: int, frame: Frame, sender: str) -> None:
        self._frames.append((t_ns, frame, sender))

    def nodes(self) -> list[Node]:
        """Boards and whoever else is attached."""
        boards = self._served.network.boards
        found = []
        for port in self._served.network.wire.ports:
            on = boards[port.name].on if port.name in boards else port.online
            found.append(Node(port.name, on, port.state, port.tec, port.rec))
        return found

    def load(self) -> float:
        """Busy share so far."""
        return self._served.network.wire.load

    def errors(self) -> dict[str, int]:
        """By cause."""
        return dict(self._served.network.wire.errors)

    def frames(self, most: int) -> list[SeenFrame]:
        """The last ones, decoded by the DBC."""
        return [_seen(*each) for each in list(self._frames)[-most:]]

    def faults(self) -> tuple[str, ...]:
        """Every board's supply can be cut."""
        return tuple(self._served.network.boards)

    def fault_kinds(self) -> list[FaultKind]:
        """The table of faults."""
        return [
            FaultKind(
                kind.name, kind.level, kind.text, _template(kind), "; ".join(map(_said, kind.parameters))
            )
            for kind in self._served.faults.kinds()
        ]

    def running(self) -> list[tuple[int, str]]:
        """What is on, by number."""
        now_ns = self._served.now_ns
        return [
            (
                each.number,
                f"{each.name}, {_arguments(each.arguments)} for {(now_ns - each.since_ns) * 1e-9:.1f} s",
            )
            for each in self._on
        ]

    def start_fault(self, name: str, arguments: str) -> Future[str]:
        """Asked for by a page; done by `poll`."""
        return self._later(lambda: f"fault {self._served.start_fault(name, **_pairs(arguments))} is on")

    def clear_fault(self, number: int) -> Future[str]:
        """Asked for by a page; done by `poll`."""

        def clear() -> str:
            self._served.clear_fault(number)
            return f"fault {number} is cleared"

        return self._later(clear)

    def _later(self, act: Callable[[], str]) -> Future[str]:
        future: Future[str] = Future()

        def done() -> None:
            try:
                future.set_result(act())
            except ValueError as error:
                future.set_exception(error)

        self._wanted.append(done)
        return future

    def switch(self, board: str, on: bool) -> None:
        """Asked for by a page; done by `poll`."""
        self._wanted.append(lambda: self._served.switch(board, on))

    def poll(self) -> None:
        """On the ticking thread."""
        self._on = self._served.faults.running
        while self._wanted:
            self._wanted.popleft()()


def _seen(t_ns: int, frame: Frame, sender: str) -> SeenFrame:
    from bus.protocol.database import database

    try:
        said = database().decode_message(frame.identifier, frame.data)
        text = _words(said) if isinstance(said, dict) else ""
    except Exception:  # whatever anybody put on the bus is shown as it is
        text = "not in the protocol"
    return SeenFrame(t_ns * 1e-9, sender, frame.identifier, frame.data, text)


def _words(said: dict[str, Any]) -> str:
    """Signals of a frame; its device is the sender's column already."""
    return ", ".join(f"{name} {value}" for name, value in said.items() if name != "Device")


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
