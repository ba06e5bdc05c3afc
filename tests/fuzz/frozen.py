"""An attack on snapshot files: bytes changed, lost, doubled, put under another head.

A snapshot that says by its digest that it is whole is trusted as a program is, so nothing here forges one.
"""

import tempfile
from pathlib import Path
from random import Random

from scenarios.doors.livenetwork import LiveNetwork
from scenarios.doors.snapshots import Snapshots, standing
from scenarios.lab.prepare import chosen
from scenarios.lab.snapshot.file import read
from scenarios.lab.snapshot.freeze import SnapshotError
from tests.fuzz.inputs import MEMORY, data
from tests.fuzz.left import counted

MS = 1_000_000
_INTACT = 0.005
"""Share of files that are left alone: each of them is a network."""


def snapshots(count: int, random: Random) -> dict[str, int]:
    """Files near a snapshot: what is taken goes on as the network it was taken of, all else is one line."""
    found = {"accepted": 0, "refused": 0}
    served = LiveNetwork(*chosen())
    served.run_until(20 * MS)
    with tempfile.TemporaryDirectory(dir=MEMORY) as folder:
        Snapshots(Path(folder), served).take("good")
        good = (Path(folder) / "good").read_bytes()
        served.run_until(30 * MS)
        path = Path(folder) / "x"
        for _ in counted(count):
            said = good if random.random() < _INTACT else _changed(random, good)
            path.write_bytes(said)
            try:
                stood = standing(read(path))
            except SnapshotError as error:
                if said == good or "\n" in str(error) or not str(error).startswith(str(path)):
                    raise AssertionError(f"a refusal of its own kind: {str(error)!r}") from None
                found["refused"] += 1
                continue
            if said != good:
                raise AssertionError("a file that was changed was taken")
            again = LiveNetwork(stood.scenario, stood.model, begun=stood)
            again.run_until(30 * MS)
            if again.network.wire.frames != served.network.wire.frames:
                raise AssertionError("it went on as another network")
            found["accepted"] += 1
    return found


def _changed(random: Random, good: bytes) -> bytes:
    """Mostly one place; in the head more often than its length would have it."""
    at = random.randrange(100) if random.random() < 0.3 else random.randrange(len(good))
    kind = random.random()
    if kind < 0.4:
        return good[:at] + bytes([good[at] ^ 1 << random.randrange(8)]) + good[at + 1 :]
    if kind < 0.6:
        return good[:at]
    if kind < 0.8:
        return good[:at] + data(random, 40) + good[at + random.randrange(40) :]
    if kind < 0.9:
        return good[:at] + good[at:] * 2
    return data(random, 300)
