"""A run in a file, and on from it: `schmidt run --snapshot-at T`, `schmidt run --from FILE`."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from bus.protocol import Device
from scenarios.lab.session import Session
from scenarios.lab.snapshot.file import read, write
from scenarios.lab.snapshot.freeze import SnapshotError, restore, take
from scenarios.lab.snapshot.tape import SEEN, Tape, listeners


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
    tape: Tape | None = None
    done: bool = False

    def begin(self, session: Session, begun: dict[str, Any] | None = None) -> None:
        """From the start (or from a snapshot of it): what the host hears is kept."""
        if Device.GATEWAY.name not in session.network.boards:
            raise SnapshotError("snapshots of a run need a network with a gateway")
        self.tape = Tape(session, [] if begun is None else begun["heard"])
        if begun is not None:
            session.rows = begun["rows"]

    def due(self, until_ns: int) -> bool:
        """Whether its time lies before `until_ns`."""
        return not self.done and self.at_ns <= until_ns

    def take(self, session: Session, progress: Progress) -> None:
        """Now; raises LogError when the file cannot be written, SnapshotError."""
        assert self.tape is not None
        self.done = True
        session.flush_traces()
        session.recorder.can.flush()
        outside: dict[str, Any] = {**self.tape.ears, **_outside(session)}
        whole = {
            "scenario": session.scenario,
            "model": session.plant.model,
            "progress": progress,
            "heard": self.tape.heard,
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
    session.link._send = _nobody
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


def _nobody(_t_ns: int, _report: bytes) -> None:
    """What the host says while it lives again has been said."""
