"""A place for faults without a network: a queue that is stepped, boards and ports that write down."""

from types import SimpleNamespace
from typing import Any

import numpy as np

from bus.can import Frame
from scenarios.lab.faults.place import Place
from scenarios.lab.layers import Evidence, Stacks, chained

BIT_NS = 2000  # 500 kbit/s.


class Queue:
    """Keeps what is to be called, by time."""

    def __init__(self) -> None:
        self.now_ns = 0
        self.due: list[tuple[int, Any]] = []

    def at(self, t_ns: int, call: Any) -> None:
        self.due.append((t_ns, call))

    def take_out(self, chosen: Any) -> list[tuple[int, Any]]:
        gone = [each for each in self.due if chosen(each[1])]
        self.due = [each for each in self.due if not chosen(each[1])]
        return gone

    def step(self) -> int:
        """Call the next one."""
        t_ns, call = min(self.due, key=lambda each: each[0])
        self.due.remove((t_ns, call))
        self.now_ns = t_ns
        call(t_ns)
        return t_ns


class StubPort:
    """A node's connection: frames that it was given, and whether there is room for more."""

    def __init__(self, name: str, wire: Any = None, room: int = 3) -> None:
        self.name, self._wire, self.room = name, wire, room
        self.sent: list[tuple[Frame, int]] = []
        self.filters: list[tuple[int, int]] = []
        self.online, self.state, self.timing = True, "active", None
        self.on_sent: Any = None
        self.on_error: Any = None
        self.on_receive: Any = None
        self.begun: list[Frame] = []
        """Frames that are on the bus, so that they cannot be withdrawn."""

    def send(self, frame: Frame, ready_ns: int) -> bool:
        if len(self.sent) >= self.room:
            return False
        self.sent.append((frame, ready_ns))
        return True

    def withdraw(self, frame: Frame) -> bool:
        return frame not in self.begun

    def accept(self, filters: list[tuple[int, int]]) -> None:
        self.filters = filters


class StubWire:
    """Ports that hang on it."""

    bit_ns = BIT_NS
    disturbance: Any = None

    def __init__(self) -> None:
        self.ports: list[StubPort] = []

    def attach(self, name: str) -> StubPort:
        self.ports.append(StubPort(name, self))
        return self.ports[-1]

    def detach(self, port: StubPort) -> None:
        self.ports.remove(port)


def board(name: str, device: int, queue: Queue, wire: StubWire) -> Any:
    """A board that writes down what befalls its supply."""
    calls: list[tuple[str, int]] = []
    made = SimpleNamespace(
        name=name, device_type=device, port=wire.attach(name), queue=queue, on=True, _boot_ns=0, calls=calls,
        period_ns=5_000_000, cpu=SimpleNamespace(lines={"can": SimpleNamespace(latency_ns=700, cost_ns=300)}),
        power_off=lambda t_ns: calls.append(("off", t_ns)), power_on=lambda t_ns: calls.append(("on", t_ns)),
        hold_in_reset=lambda t_ns: calls.append(("reset", t_ns)),
    )  # fmt: skip
    made.oscillator = SimpleNamespace(pull=lambda t_ns, ppm: calls.append((f"pull {ppm:g}", t_ns)))
    made.timer = SimpleNamespace(retime=lambda: calls.append(("retime", 0)))
    return made


def place(*names: str) -> Place:
    """Boards A and B, or of these names, of device types 0x11 and up."""
    queue, wire = Queue(), StubWire()
    boards = {name: board(name, 0x11 + k, queue, wire) for k, name in enumerate(names or ("A", "B"))}
    network: Any = SimpleNamespace(
        queue=queue, wire=wire, boards=boards, layers=Stacks(chained), uarts={}, plant=None
    )
    return Place(network=network, random=np.random.default_rng(1), evidence=Evidence("test"))


def acted(evidence: Evidence) -> tuple[int | None, str]:
    """When a fault acted first, and on what."""
    return evidence.first_ns, evidence.on
