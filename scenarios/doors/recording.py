"""`--record DIR`: all logs of a served session, and what entered it, so that it can be run again."""

import json
import struct
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from typing import Any

from bus.can.candump import CandumpWriter
from host.logs.files import LineFile, LogError, write_file
from plant.kernels import layout
from plant.model import dump
from plant.plant import Plant
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.lab.networks import SERIAL
from scenarios.lab.recorder import Recorder
from scenarios.lab.session import log_headers


def state_of(plant: Plant) -> bytes:
    """Every number that the plant's future depends on: all but what is recorded of it."""
    world = plant.world.copy()
    world[:, layout.TRUTH : layout.DELAYS] = 0.0
    world[:, [layout.RECORD_EVERY, layout.RECORDED]] = 0.0
    return world.tobytes() + struct.pack("<d", plant.focus.position(plant.now_ns))


class Rest:
    """From now on: every frame on the bus, and at its end the plant to the last bit."""

    def __init__(self, served: LiveNetwork) -> None:
        self._served = served
        self._log = CandumpWriter(None)
        served.network.wire.tap(self._log.take)

    def digest(self) -> str:
        """Until now: SHA-256 over the log of the bus and the state of the plant."""
        plant = self._served.network.plant
        plant.advance(self._served.now_ns)
        return sha256(self._log.hexdigest().encode() + state_of(plant)).hexdigest()


SESSION, ENTERED, PLANT, SCENARIO = "session.json", "entered.log", "plant.yaml", "scenario.yaml"
BEGUN = "begun.snapshot"


class Recording:
    """Owns the folder: the files of a run (`scenarios.lab.recorder`), and

    entered.log: `t_ns kind hex` for every entry. session.json: what the session was made of, its digest, and
    the digest of the rest from each snapshot on. begun: the snapshot that the session goes on from; a copy
    stays in the folder.
    """

    def __init__(self, folder: Path, begun: Path | None = None) -> None:
        self.folder = folder
        self._recorder: Recorder | None = None
        self._facts: dict[str, Any] = {}
        self._rests: dict[str, Rest] = {}
        try:
            folder.mkdir(parents=True, exist_ok=True)
            if begun is not None:
                (folder / BEGUN).write_bytes(begun.read_bytes())
        except OSError as error:
            raise LogError(f"{folder}: cannot be made: {error.strerror}") from None
        self._begun = begun is not None
        self._entered = LineFile(folder / ENTERED, buffer_bytes=1 << 13)

    def attach(self, served: LiveNetwork) -> None:
        """Record this session, from its very start; its doors are made (not open) by now."""
        scenario, headers = served.scenario, log_headers(served.scenario, served.model)
        self._recorder = recorder = Recorder(self.folder, scenario, served.network.plant, headers)
        served.network.wire.tap(recorder.can.take)
        for device in SERIAL:
            served.network.uarts[device.name].sink = recorder.link(device).receive
        dump(served.model, self.folder / PLANT)
        if scenario.file.is_file():
            (self.folder / SCENARIO).write_bytes(scenario.file.read_bytes())
        self._facts = {
            "scenario": scenario.file.is_file(),
            "seed": scenario.seed,
            "network": scenario.network.get("name", "lab"),
            "kinds": served.entry.kinds(),
            "version": version("schmidt"),
            "begun": self._begun,
            "snapshots": {},
        }
        self._save()

    def mark(self, name: str, served: LiveNetwork) -> None:
        """A snapshot has been taken now: what comes after it gets a digest of its own."""
        self._facts["snapshots"][name] = {"t_ns": served.now_ns, "entries": served.entry.count}
        self._rests[name] = Rest(served)
        self._save()

    def write(self, t_ns: int, kind: str, data: bytes) -> None:
        """One entry."""
        self._entered.write(f"{t_ns} {kind} {data.hex()}\n")

    def flush(self) -> None:
        """Bring what there is to disk."""
        self._entered.flush()
        if self._recorder is not None:
            self._recorder.flush()

    def close(self, end_ns: int) -> str:
        """Close all files; returns the trace digest. Raises LogError when the disk took not all of it."""
        self._entered.close()
        if self._recorder is None:
            return ""
        failures = self._recorder.close()
        if failures:
            raise LogError(failures[0])
        for name, rest in self._rests.items():
            self._facts["snapshots"][name]["rest"] = rest.digest()
        digest = self._recorder.digest()
        self._facts |= {"end_ns": end_ns, "digest": digest}
        self._save()
        return digest

    def _save(self) -> None:
        write_file(self.folder / SESSION, json.dumps(self._facts, indent=1) + "\n")
