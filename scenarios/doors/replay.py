"""`schmidt replay DIR`: a recorded session again, from what entered it, to the same digest."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from bus.node import OutsideNode
from plant.model import load as load_plant
from scenarios.doors.payload import unpack_frame
from scenarios.doors.recording import ENTERED, PLANT, SCENARIO, SESSION, Recording
from scenarios.doors.served import Served
from scenarios.served import chosen


class ReplayError(ValueError):
    """A folder that is no recorded session; one line."""


def replay(folder: Path, out: Path) -> tuple[str, str | None]:
    """Run the session in `folder` again into `out`; returns both digests (None: it was never closed)."""
    facts = _facts(folder)
    scenario_file = folder / SCENARIO if facts["scenario"] else None
    scenario, _ = chosen(scenario_file, int(facts["seed"]), network_name=facts.get("network"))
    model = load_plant(folder / PLANT)
    if out.resolve() == folder.resolve():
        raise ReplayError(f"{out}: a session is not replayed onto itself; give another --out")
    recording = Recording(out, scenario, model)
    served = Served(scenario, model, journal=recording)
    for kind in facts["kinds"]:
        if kind.startswith("can"):
            _register(served, kind)
    recording.attach(served)
    t_ns = 0
    for t_ns, kind, data in _entries(folder / ENTERED):
        served.run_until(t_ns)
        try:
            served.entry.enter(kind, data)
        except (KeyError, ValueError) as error:
            raise ReplayError(f"{folder / ENTERED}: {t_ns} {kind}: {error}") from None
    served.run_until(max(t_ns, int(facts.get("end_ns", t_ns))))
    return recording.close(served.now_ns), facts.get("digest")


def _register(served: Served, kind: str) -> None:
    index = int(kind[3:])
    network = served.network
    node = OutsideNode(network.queue, network.wire, f"outside {index}" if index else "outside")
    served.entry.register(kind, lambda data: node.arrive(unpack_frame(data)))


def _facts(folder: Path) -> dict[str, Any]:
    try:
        facts: dict[str, Any] = json.loads((folder / SESSION).read_text(encoding="utf-8"))
        wanted = {"scenario": bool, "seed": int, "kinds": list}
        if not all(isinstance(facts[key], kind) for key, kind in wanted.items()):
            raise ValueError("fields are missing")
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise ReplayError(f"{folder}: no recorded session ({SESSION}): {error}") from None
    return facts


def _entries(file: Path) -> Iterator[tuple[int, str, bytes]]:
    try:
        with file.open(encoding="utf-8") as lines:
            for number, line in enumerate(lines, 1):
                try:
                    t_ns, kind, data = line.rstrip("\n").split(" ")
                    yield int(t_ns), kind, bytes.fromhex(data)
                except ValueError:
                    raise ReplayError(f"{file}:{number}: not an entry: {line[:60]!r}") from None
    except OSError as error:
        raise ReplayError(f"{file}: {error.strerror}") from None
