"""Where the time goes, by function and by room: `python -m tests.benchmarks.profile SECONDS`, as JSON.

In a process of its own that runs plain: a profiler does not see into compiled code.
"""

import cProfile
import json
import os
import pstats
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from tests.benchmarks.network import session

ROOT = Path(__file__).parents[2]
_SECOND_NS = 1_000_000_000
_TICK = "routine"
"""Name of a board's timer routine."""


def measure(seconds: int) -> dict[str, Any]:
    """Profile a plain run; `functions` by own time, `rooms` with calls per frame and per tick."""
    environment = {**os.environ, "SCHMIDT_PURE": "1", "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", f"{__package__}.profile", str(seconds)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def profile(seconds: int) -> dict[str, Any]:
    """The same in this process; cProfile's overhead is in it."""
    with tempfile.TemporaryDirectory() as folder:
        made = session(Path(folder))
        wire = made.network.wire
        frames = wire.frames
        profiler = cProfile.Profile()
        profiler.enable()
        made.advance(made.network.queue.now_ns + seconds * _SECOND_NS)
        profiler.disable()
        frames = wire.frames - frames
        made.recorder.close()
    stats: Any = pstats.Stats(profiler)
    rows = [_row(key, found, stats.total_tt, seconds) for key, found in stats.stats.items()]
    ticks = sum(row["calls_per_s"] for row in rows if row["function"].endswith(f" {_TICK}"))
    return {
        "functions": sorted(rows, key=lambda row: -row["own_share"])[:25],
        "rooms": _rooms(rows, frames / seconds, ticks),
    }


def _row(key: tuple[str, int, str], found: Any, total: float, seconds: int) -> dict[str, Any]:
    file, line, name = key
    _, calls, own, cumulative, _ = found
    place = Path(file)
    inside = place.is_relative_to(ROOT) and "site-packages" not in file
    short = str(place.relative_to(ROOT)) if inside else place.name
    return {
        "function": f"{short}:{line} {name}" if line else name,
        "calls_per_s": calls / seconds,
        "own_share": own / total,
        "total_share": cumulative / total,
    }


def _rooms(rows: list[dict[str, Any]], frames: float, ticks: float) -> dict[str, dict[str, float]]:
    found: dict[str, dict[str, float]] = {}
    for row in rows:
        name = row["function"].split("/", 1)[0] if "/" in row["function"] else "libraries"
        room = found.setdefault(name, {"share": 0.0, "per_frame": 0.0, "per_tick": 0.0})
        room["share"] += row["own_share"]
        room["per_frame"] += row["calls_per_s"] / frames
        room["per_tick"] += row["calls_per_s"] / ticks
    return dict(sorted(found.items(), key=lambda item: -item[1]["share"]))


if __name__ == "__main__":
    print(json.dumps(profile(int(sys.argv[1]))))
