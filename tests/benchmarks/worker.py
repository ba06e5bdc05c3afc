"""One way of running the source, asked for one part after another: `python -m tests.benchmarks.worker`.

A line in: `PART SECONDS`. A line out: JSON with the CPU seconds it took and what there was to do. Two such
processes, one plain and one compiled, are asked in turn, so that both see the same weather on the machine.
"""

import gc
import json
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from bus.can import Frame
from plant.plant import Plant
from scenarios.lab.prepare import prepare
from scenarios.lab.session import Session
from scenarios.lab.wiring import start_steps
from scenarios.native import compiled
from tests.benchmarks import network, virtual
from tests.benchmarks.bare import BareLoop

_SECOND_NS = 1_000_000_000


class Worker:
    """Everything set up once; each part goes on from where it was."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.session = network.session(folder)
        self.in_c: Session | None = None
        scenario, model = prepare(network.SCENARIO)
        self.bare = BareLoop(Plant(model, 1, start_steps(scenario)))
        self.bare.advance(_SECOND_NS)
        self.plant = Plant(model, 1, start_steps(scenario))
        self.plant.advance(_SECOND_NS)
        self.session.recorder.flush()
        self._traffic = last_second(folder / "can.log")
        gc.freeze()  # as `schmidt run` does; all parts have it

    def night(self, seconds: int) -> dict[str, float]:
        """The whole network, host and all logs; what still waits to be written is written, as a part would
        else leave it to another."""
        return self._advance(self.session, seconds)

    def night_in_c(self, seconds: int) -> dict[str, float]:
        """The same with both axis boards in C."""
        if self.in_c is None:  # set up by the first round, which counts for nothing
            folder = self.folder / "c"
            folder.mkdir()
            self.in_c = network.session(folder, in_c=True)
        return self._advance(self.in_c, seconds)

    def _advance(self, session: Session, seconds: int) -> dict[str, float]:
        queue, wire = session.network.queue, session.network.wire
        frames = wire.frames
        session.advance(queue.now_ns + seconds * _SECOND_NS)
        recorder = session.recorder
        session.network.plant.flush()
        recorder.flush()
        for trace in (*recorder.truth.values(), recorder.host, recorder.focus):
            trace.flush()
        return {"frames": wire.frames - frames}

    def bare_loop(self, seconds: int) -> dict[str, float]:
        """The yardstick."""
        frames, ticks = self.bare.frames, self.bare.ticks
        self.bare.advance(self.bare.now_ns + seconds * _SECOND_NS)
        return {"frames": self.bare.frames - frames, "ticks": self.bare.ticks - ticks}

    def plant_alone(self, seconds: int) -> dict[str, float]:
        """The kernels, every 5 ms."""
        start = self.plant.now_ns
        for t_ns in range(start, start + seconds * _SECOND_NS + 1, 5_000_000):
            self.plant.advance(t_ns)
        return {}

    def virtual_bus(self, seconds: int) -> dict[str, float]:
        """The same traffic over python-can's virtual bus."""
        for _ in range(seconds):
            lost = virtual.replay(self._traffic)["lost"]
        return {"lost": lost, "frames": seconds * len(self._traffic)}


def last_second(log: Path) -> list[tuple[int, Frame, str]]:
    """The traffic of a log's last second: time ns, frame, sender (the device type is in the identifier)."""
    rows = [line.split() for line in log.read_text(encoding="ascii").splitlines()[-5000:]]
    end_s = float(rows[-1][0].strip("()"))
    found = []
    for stamp, _, text in rows:
        t_s = float(stamp.strip("()"))
        identifier, data = text.split("#")
        if t_s > end_s - 1.0:
            frame = Frame(int(identifier, 16), bytes.fromhex(data))
            found.append((round(t_s * 1e9), frame, f"{frame.identifier & 0x7F:02X}"))
    return found


def main() -> None:
    """Serve until the line is closed."""
    with tempfile.TemporaryDirectory() as folder:
        worker = Worker(Path(folder))
        parts: dict[str, Callable[[int], dict[str, float]]] = {
            "night": worker.night,
            "in C": worker.night_in_c,
            "bare": worker.bare_loop,
            "plant": worker.plant_alone,
            "virtual": worker.virtual_bus,
        }
        _say({"ready": True, "compiled": compiled()})
        for line in sys.stdin:
            part, _, seconds = line.rpartition(" ")
            cpu, wall = time.process_time(), time.perf_counter()
            found = parts[part](int(seconds))
            cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
            _say({"cpu_s": cpu, "wall_s": wall, **found})
        worker.session.recorder.close()


def _say(figures: dict[str, Any]) -> None:
    print(json.dumps(figures), flush=True)


if __name__ == "__main__":
    main()
