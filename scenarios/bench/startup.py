"""How long a user waits: the first command after installation, which compiles, and the ones after it."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

_TWO_SECONDS = """\
name: start
start_utc: 2026-02-10T14:00:00Z
steps:
  - wait: {for: 100 ms}
"""


def startup() -> dict[str, float]:
    """Wall seconds of `schmidt run` on a scenario of a moment: with no compiled code kept, and again."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "start.yaml").write_text(_TWO_SECONDS)
        environment = {**os.environ, "SCHMIDT_CACHE_DIR": str(Path(folder) / "cache")}
        first = _time(["run", "start.yaml", "--out", "out"], folder, environment)
        later = min(_time(["run", "start.yaml", "--out", "out"], folder, environment) for _ in range(3))
        # the same without the work of the run itself
        bare = min(_time(["--version"], folder, environment) for _ in range(3))
        catalogue = min(_time(["effects"], folder, environment) for _ in range(3))
    return {"first_run_s": first, "later_run_s": later, "version_s": bare, "effects_s": catalogue}


def _time(arguments: list[str], folder: str, environment: dict[str, str]) -> float:
    root = str(Path(__file__).parents[2])
    environment = {**environment, "PYTHONPATH": root}
    start = time.perf_counter()
    command = [sys.executable, "-c", "from scenarios.cli import main; main()", *arguments]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"schmidt {' '.join(arguments)}: {done.stderr.strip()}")
    return time.perf_counter() - start
