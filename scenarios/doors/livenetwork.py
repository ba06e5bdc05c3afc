"""A served network, everything a door may touch, and its fence: what enters is stamped and recorded."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from bus.can.candump import line, parsed
from bus.can.frame import Frame, check
from bus.outside.node import OutsideNode
from bus.outside.pacer import Pacer, Punctuality
from bus.time import EventQueue
from plant.model import PlantModel
from scenarios.doors.lines import Lines
from scenarios.doors.usb import Usb
from scenarios.lab.wiring import wired
from scenarios.language.model import Scenario

if TYPE_CHECKING:
    from scenarios.doors.recording import Recording
    from scenarios.doors.snapshots import Standing
    from scenarios.doors.steps import Steps


class Entry:
    """Kinds of input by name and what each does. The same entries at the same times give the same trace.

    That holds because entries are made between slices only, when all events up to the present have happened.
    """

    def __init__(self, queue: EventQueue, journal: Recording | None = None) -> None:
        self.count = 0
        self._queue = queue
        self._journal = journal
        self._apply: dict[str, Callable[[bytes], None]] = {}
        self.running = False

    def register(self, kind: str, apply: Callable[[bytes], None]) -> None:
        """Let `kind` enter: `apply(data)` puts it into the network, at the present. One registration each."""
        if kind in self._apply:
            raise RuntimeError(f"{kind} is registered twice")
        self._apply[kind] = apply

    def enter(self, kind: str, data: bytes) -> None:
        """Something comes in, now."""
        if self.running:
            raise RuntimeError(f"{kind} would enter in the middle of a slice")
        if self._journal is not None:
            self._journal.write(self._queue.now_ns, kind, data)
        self.count += 1
        self._apply[kind](data)

    def kinds(self) -> list[str]:
        """What may enter, in the order it was registered."""
        return list(self._apply)


def frame_text(frame: Frame) -> str:
    """A frame as candump writes it: `211#1101000000000000`."""
    return line(0, frame).rpartition(" ")[2]


def frame_of(text: str) -> Frame:
    """The frame of such a text; raises ValueError."""
    found = parsed(f"(0.000000) can0 {text}")
    if found is None:
        raise ValueError("a frame is ID#DATA, such as 011#1105")
    check(found[1])
    return found[1]


USAGE = {
    "power": "power BOARD on|off",
    "fault": "fault list | kinds | start NAME ARGUMENT=VALUE ... | clear NUMBER",
}


def _argument(word: str) -> tuple[str, str]:
    name, _, value = word.partition("=")
    if not (name and value):
        raise ValueError(f"{word!r}: arguments are written name=value")
    return name, value if name in ("node", "nodes", "sensor") else value.replace("_", " ")


class LiveNetwork:
    """Network, pace and ways in. Nothing in here knows a particular door.

    entry: where things enter. usb: the gateway's USB cable, for host programs in this process too. lines: the
    five RS232 lines. pacer: speed and pause, both changeable at any time. `stop()` ends the serving.
    nodes: of the doors to CAN, by their kinds of entry. snapshot: takes one of this session under a name and
    says where; None: it takes none. begun: a network to go on with, instead of a new one.
    steps: when clients step time; None: it is paced.
    """

    def __init__(
        self,
        scenario: Scenario,
        model: PlantModel,
        speed: float = 1.0,
        journal: Recording | None = None,
        begun: Standing | None = None,
    ) -> None:
        self.scenario = scenario
        self.model = model
        self.network, self.faults = wired(scenario, model) if begun is None else (begun.network, begun.faults)
        self.entry = Entry(self.network.queue, journal)
        cable = None if begun is None else begun.usb
        self.usb = cable or Usb(self.network.queue, self.network.hid)
        self.usb.enter_by(self.entry)
        self.nodes: dict[str, OutsideNode] = {} if begun is None else begun.nodes
        self.snapshot: Callable[[str], str] | None = None
        self.lines = Lines(self.network.uarts)
        self.pacer = Pacer(self.network.queue, speed)
        self.punctual = Punctuality(self.pacer)
        self.ending = False
        self.steps: Steps | None = None
        self.entry.register("command", self._carry_out)
        self.entry.register("debug", self._debug)

    @property
    def now_ns(self) -> int:
        """Simulated time."""
        return self.network.queue.now_ns

    def node(self, index: int) -> OutsideNode:
        """The node on the wire for the door to CAN of this number, from 0 on, whose frames may enter now."""
        kind = f"can{index}"
        if kind not in self.nodes:
            name = f"outside {index}" if index else "outside"
            self.nodes[kind] = OutsideNode(self.network.queue, self.network.wire, name)
        node = self.nodes[kind]
        self.entry.register(kind, lambda data: node.arrive(frame_of(data.decode())))
        return node

    def frame(self, index: int, frame: Frame) -> None:
        """A frame for the wire, by the node of this number."""
        self.entry.enter(f"can{index}", frame_text(frame).encode())

    def stop(self) -> None:
        """End the serving with the next slice."""
        self.ending = True

    def switch(self, board: str, on: bool) -> None:
        """Switch the supply of a board, by name; raises ValueError for one there is not."""
        self.network.board(board)
        self.entry.enter("command", f"power {board} {'on' if on else 'off'}".encode())

    def _carry_out(self, data: bytes) -> None:
        match data.decode().split(" ", 3):
            case ["power", name, state]:
                board = self.network.board(name)
                (board.power_on if state == "on" else board.power_off)(self.now_ns)
            case ["fault", "start", name, arguments]:
                self.faults.start(name, **json.loads(arguments))
            case ["fault", "clear", number]:
                self.faults.clear(int(number))
            case _:
                raise ValueError("no such command")

    def debug(self, board: str, data: bytes) -> None:
        """Bytes for a board's debug port."""
        self.entry.enter("debug", board.encode() + b" " + data)

    def _debug(self, data: bytes) -> None:
        name, _, text = data.partition(b" ")
        self.network.debug[name.decode()].write(self.now_ns, text)

    def start_fault(self, name: str, **arguments: Any) -> int:
        """Start a fault now (`scenarios.lab.faults`); returns its number. Raises ValueError."""
        values = self.faults.check(name, arguments)
        self.entry.enter("command", f"fault start {name} {json.dumps(values)}".encode())
        return self.faults.running[-1].number

    def clear_fault(self, number: int) -> None:
        """End a fault now; raises ValueError when it is not on."""
        if all(each.number != number for each in self.faults.running):
            self.faults.clear(number)  # says what is on
        self.entry.enter("command", f"fault clear {number}".encode())

    def command(self, words: Sequence[str]) -> str:
        """Carry out `power BOARD on|off`, `fault start NAME ARGUMENT=VALUE ...` or `fault clear NUMBER`; its
        answer. A value has no blank, or `_` for one. Raises ValueError with one line."""
        match words:
            case ["power", board, "on" | "off" as state]:
                self.switch(board, state == "on")
                return f"{board} {state}"
            case ["fault", "start", name, *pairs]:
                return f"fault {self.start_fault(name, **dict(map(_argument, pairs)))} is on"
            case ["fault", "clear", number] if number.isdecimal():
                self.clear_fault(int(number))
                return f"fault {number} cleared"
        raise ValueError(USAGE.get(words[0], f"no command {words[0]!r}"))

    def run_until(self, t_ns: int) -> None:
        """Let simulated time go on to `t_ns`, as fast as it goes."""
        self.network.queue.run_until(t_ns)
