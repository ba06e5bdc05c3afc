"""A run in a file, and on from it: `schmidt run --snapshot-at T`, `schmidt run --from FILE`.

The host's programme is made of generators, which nothing can take apart: it lives again by hearing the same.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from bus.protocol import Device
from scenarios.lab.session import Session
from scenarios.lab.snapshot.code import nothing
from scenarios.lab.snapshot.file import check_place, read, write
from scenarios.lab.snapshot.freeze import SnapshotError, restore, take

Heard = list[tuple[str, tuple[Any, ...]]]
"""(what, arguments), in order: "usb", "tick", "truth", "chain", SEEN, or the name of a board on RS232."""
SEEN = "seen"


def listeners(session: Session) -> dict[str, Callable[..., None]]:
    """Who hears what comes out of a network."""
    calls: dict[str, Callable[..., None]] = {
        "usb": session.link.receive,
        "truth": session.recorder.take_truth,
        "chain": session.chain_says,
    }
    return calls | {link.device.name: link.receive for link in session.serial}


@dataclass
class Progress:
    """How far the runner is: time, bits on the bus, when it ends (ns), load per piece."""

    t_ns: int
    bits: int
    end_ns: int
    bus: list[tuple[float, float, int]] = field(default_factory=list)


@dataclass
class Order:
    """Take a snapshot of a run at a time, into a file."""

    at_ns: int
    file: Path
    heard: Heard = field(default_factory=list)
    ears: dict[str, Callable[..., None]] = field(default_factory=dict)
    """Between the network and who listens."""
    done: bool = False

    def begin(self, session: Session, begun: dict[str, Any] | None = None) -> None:
        """From the start (or from a snapshot of it): what the host hears is kept."""
        if Device.GATEWAY.name not in session.network.boards:
            raise SnapshotError("snapshots of a run need a network with a gateway")
        check_place(self.file)
        if self.at_ns < (now_ns := session.network.queue.now_ns):
            raise SnapshotError(
                f"a snapshot at {self.at_ns * 1e-9:g} s: the run is at {now_ns * 1e-9:g} s already"
            )
        if begun is not None:
            self.heard, session.rows = begun["heard"], begun["rows"]
        ears = self.ears = {kind: self._ear(kind, call) for kind, call in listeners(session).items()}
        network = session.network
        network.hid.to_host, session.plant._sink = ears["usb"], ears["truth"]
        for link in session.serial:
            network.uarts[link.device.name].sink = ears[link.device.name]
        if network.chain is not None:
            network.chain.told = ears["chain"]
        session.ticked, session.eye.told = self._ear("tick", nothing), self._ear(SEEN, nothing)

    def _ear(self, kind: str, call: Callable[..., None]) -> Callable[..., None]:
        def hear(*arguments: Any) -> None:
            self.heard.append((kind, arguments))
            call(*arguments)

        return hear

    def due(self, until_ns: int) -> bool:
        """Whether its time lies before `until_ns`."""
        return not self.done and self.at_ns <= until_ns

    def take(self, session: Session, progress: Progress) -> None:
        """Now; raises LogError when the file cannot be written, SnapshotError."""
        self.done = True
        session.flush_traces()
        session.recorder.can.flush()
        outside: dict[str, Any] = {**self.ears, **_outside(session)}
        whole = {
            "scenario": session.scenario,
            "model": session.plant.model,
            "progress": progress,
            "heard": self.heard,
            "can": (session.recorder.folder / "can.log").read_bytes(),
            "rows": session.rows,
            "network": take((session.network, session.faults), outside),
        }
        write(whole, self.file)


def _outside(session: Session) -> dict[str, Any]:
    return {"session": session, "can": session.recorder.can, "recorder": session.recorder}


def begun(file: Path) -> dict[str, Any]:
    """A run in a file; raises SnapshotError, also for a served session."""
    whole = read(file)
    if whole.get("kind") == "served":
        raise SnapshotError(f"{file}: a served session has no programme to go on with: schmidt serve --from")
    return whole


def resume(whole: dict[str, Any], folder: Path) -> Session:
    """A session in a new folder as it was, its files written again up to then."""
    session = Session(whole["scenario"], whole["model"], folder)
    session.link._send = nothing  # what the host says while it lives again has been said
    calls = listeners(session) | {"tick": session.work}
    session.eye.replay(arguments for kind, arguments in whole["heard"] if kind == SEEN)
    for kind, arguments in whole["heard"]:
        if kind != SEEN:
            calls[kind](*arguments)
    session.begin_traces(whole["rows"])
    session.recorder.can.resume(whole["can"])
    network, session.faults = restore(whole["network"], {**listeners(session), **_outside(session)})
    session.adopt(network)
    return session
