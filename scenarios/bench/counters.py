"""Instructions per simulated second, where they can be counted: what no neighbour on the machine disturbs."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
_SHORT_S, _LONG_S = 20, 120
_PROGRAM = """
import sys, tempfile
from pathlib import Path
from scenarios.bench.network import session
with tempfile.TemporaryDirectory() as folder:
    made = session(Path(folder))
    made.advance(made.network.queue.now_ns + int(sys.argv[1]) * 10**9)
    made.recorder.close()
"""


def instructions(native: bool) -> dict[str, float]:
    """Million instructions per simulated second by way; empty where `perf` is not there or may not count."""
    if shutil.which("perf") is None:
        return {}
    found = {}
    for name, pure in (("plain", "1"), ("compiled", "0")):
        if pure == "0" and not native:
            continue
        short, long = _count(_SHORT_S, pure), _count(_LONG_S, pure)
        if short is None or long is None:
            return {}
        found[name] = (long - short) / (_LONG_S - _SHORT_S) / 1e6
    return found


def _count(seconds: int, pure: str) -> float | None:
    """Instructions of a whole process that simulates `seconds` beyond the start."""
    command = ["perf", "stat", "-x,", "-e", "instructions:u", sys.executable, "-c", _PROGRAM, str(seconds)]
    environment = {**os.environ, "SCHMIDT_PURE": pure, "PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    rows = [line.split(",") for line in done.stderr.splitlines() if "instructions" in line]
    return float(rows[-1][0]) if rows and rows[-1][0].isdigit() else None
