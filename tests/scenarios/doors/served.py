"""A served network without boards, and clients that only write down: for doors by themselves."""

from types import SimpleNamespace
from typing import Any

from bus.can import Frame


class StubClient:
    """says: pieces that it has sent and nobody has read; heard: what it was sent."""

    def __init__(self, peer: str = "127.0.0.1", *says: bytes) -> None:
        self.peer, self.says = peer, list(says)
        self.heard: list[bytes] = []
        self.gone = False

    def receive(self) -> bytes:
        return self.says.pop(0) if self.says else b""

    def send(self, data: bytes) -> None:
        self.heard.append(data)

    deliver = send


class StubClients:
    """Those of a door: new ones at first, then all."""

    def __init__(self) -> None:
        self.new: list[StubClient] = []
        self.all: list[StubClient] = []
        self.came = 0
        self.waited: list[float] = []

    def accept(self) -> list[StubClient]:
        found, self.new = self.new, []
        self.all += found
        self.came += len(found)
        return found

    def sweep(self) -> None:
        self.all = [each for each in self.all if not each.gone]

    def wait(self, timeout_s: float) -> None:
        self.waited.append(timeout_s)

    def close(self) -> None:
        self.all = []


class StubServed:
    """Time that goes on by `run_until` alone; frames: (time, node, frame) of what entered."""

    def __init__(self) -> None:
        self.now_ns = 0
        self.commands: list[list[str]] = []
        self.frames: list[tuple[int, int, Frame]] = []
        self.nodes: list[int] = []
        self.taps: list[Any] = []
        self.ending = False
        self.steps: Any = None
        self.snapshot: Any = None
        self.pacer = SimpleNamespace(speed=1.0, paused=False, lateness_s=0.004, slips=2)
        self.punctual = SimpleNamespace(
            ticks=0, on_time=0.75, worst_s=0.009, late=[(5.0, 0.002)], counting=True,
            quantile_s=lambda share: share / 1000.0,
        )  # fmt: skip
        self.entry = SimpleNamespace(count=0, running=False)
        wire = SimpleNamespace(load=0.25, frames=7, tap=self.taps.append)
        boards = {"FOCUS": SimpleNamespace(on=True), "DISPLAY": SimpleNamespace(on=False)}
        self.network = SimpleNamespace(wire=wire, boards=boards)
        kinds = [SimpleNamespace(name="hang"), SimpleNamespace(name="reset")]
        running = [SimpleNamespace(number=3, name="hang")]
        self.faults = SimpleNamespace(running=running, kinds=lambda: kinds)

    def command(self, words: list[str]) -> str:
        self.commands.append(words)
        return " ".join(words)

    def stop(self) -> None:
        self.ending = True

    def node(self, index: int) -> None:
        self.nodes.append(index)

    def frame(self, index: int, frame: Frame) -> None:
        self.frames.append((self.now_ns, index, frame))

    def run_until(self, t_ns: int) -> None:
        self.now_ns = t_ns


def stub_served() -> Any:
    """A new one."""
    return StubServed()


def stub(**names: Any) -> Any:
    """Anything that has these names."""
    return SimpleNamespace(**names)
