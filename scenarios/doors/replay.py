"""`schmidt replay DIR [--from SNAPSHOT]`: a recorded session again, to the same digest."""

import json
import re
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Any

from host.logs.files import reason
from plant.model import load as load_plant
from plant.yamltext import TextError, check_regular, read_text
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.doors.recording import BEGUN, ENTERED, PLANT, SCENARIO, SESSION, Recording, Rest
from scenarios.doors.snapshots import standing
from scenarios.lab.prepare import chosen
from scenarios.lab.snapshot.file import read
from scenarios.language.document import Document
from scenarios.language.validate import check, schema
from scenarios.progress import Show, shown

_STEP_NS = 1_000_000_000  # Simulated time between two looks at what is left.
_SCHEMA_FILE = Path(__file__).with_name("session.schema.json")


def replay(folder: Path, out: Path) -> tuple[str, str | None]:
    """Run the session in `folder` again into `out`; returns both digests (None: it was never closed)."""
    facts = _facts(folder)
    if out.resolve() == folder.resolve():
        raise ValueError(f"{out}: a session is not replayed onto itself; give another --out")
    begun = folder / BEGUN if facts.get("begun") else None
    if begun is not None:
        stood = standing(read(begun))
        scenario, model = stood.scenario, stood.model
    else:
        stood = None
        scenario_file = folder / SCENARIO if facts["scenario"] else None
        scenario, _ = chosen(scenario_file, int(facts["seed"]), network_name=facts.get("network"))
        model = load_plant(folder / PLANT)
    recording = Recording(out, begun)
    served = LiveNetwork(scenario, model, journal=recording, begun=stood)
    _nodes(served, facts)
    recording.attach(served)
    _enter(served, folder, facts)
    return recording.close(served.now_ns), facts.get("digest")


def replay_rest(folder: Path, snapshot: Path) -> tuple[str, str | None]:
    """What entered the session in `folder` after a snapshot of it, again, on from that snapshot. Returns the
    digest of the rest both ways (None: that one was not taken in this session, or it was never closed)."""
    facts = _facts(folder)
    stood = standing(read(snapshot))
    served = LiveNetwork(stood.scenario, stood.model, begun=stood)
    taken = [
        each.get("rest")
        for each in facts.get("snapshots", {}).values()
        if (each["t_ns"], each["entries"]) == (served.now_ns, stood.entries)
    ]
    _nodes(served, facts)
    rest = Rest(served)
    _enter(served, folder, facts, stood.entries)
    return rest.digest(), taken[0] if taken else None


def _nodes(served: LiveNetwork, facts: dict[str, Any]) -> None:
    for kind in dict.fromkeys(facts["kinds"]):
        if re.fullmatch(r"can\d{1,2}", kind):
            served.node(int(kind.removeprefix("can")))


def _enter(served: LiveNetwork, folder: Path, facts: dict[str, Any], after: int = 0) -> None:
    """Everything that entered, from number `after` on, and on to the session's end."""
    begun_ns = t_ns = served.now_ns
    end_ns = int(facts.get("end_ns", begun_ns))  # none: never closed, and nobody knows what is left
    with shown("replaying", end_ns, begun=begun_ns) as show:
        for t_ns, kind, data in islice(_entries(folder / ENTERED), after, None):
            if t_ns < served.now_ns:
                raise ValueError(f"{folder / ENTERED}: {t_ns} {kind}: is earlier than the time reached")
            if "end_ns" in facts and t_ns > end_ns:
                raise ValueError(f"{folder / ENTERED}: {t_ns} {kind}: is after the session's end")
            _go(served, t_ns, end_ns, show)
            try:
                served.entry.enter(kind, data)
            except (KeyError, ValueError) as error:
                raise ValueError(f"{folder / ENTERED}: {t_ns} {kind}: {error}") from None
        _go(served, max(t_ns, end_ns), end_ns, show)


def _go(served: LiveNetwork, t_ns: int, end_ns: int, show: Show) -> None:
    """On to `t_ns`, a second at a time."""
    while served.now_ns < t_ns:
        served.run_until(min(t_ns, served.now_ns + _STEP_NS))
        show(served.now_ns if end_ns else None, f"{served.now_ns / _STEP_NS:.0f} s simulated")


def _facts(folder: Path) -> dict[str, Any]:
    file = folder / SESSION
    try:
        facts: dict[str, Any] = json.loads(read_text(file))
        check(Document(file, facts, {}), schema(_SCHEMA_FILE))
    except (OSError, ValueError) as error:
        raise ValueError(f"{folder}: no recorded session ({SESSION}): {reason(error)}") from None
    return facts


def _entries(file: Path) -> Iterator[tuple[int, str, bytes]]:
    try:
        check_regular(file)
        with file.open(encoding="utf-8") as lines:
            for number, line in enumerate(lines, 1):
                try:
                    t_ns, kind, data = line.rstrip("\n").split(" ")
                    yield int(t_ns), kind, bytes.fromhex(data)
                except ValueError:
                    raise ValueError(f"{file}:{number}: not an entry: {line[:60]!r}") from None
    except OSError as error:
        raise ValueError(f"{file}: {error.strerror}") from None
    except TextError as error:
        raise ValueError(f"{file}: {error}") from None
