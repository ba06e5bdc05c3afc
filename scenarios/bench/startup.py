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
    """Wall seconds until `schmidt run` simulates, without compiled code and with; and of a short run."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "start.yaml").write_text(_TWO_SECONDS)
        environment = {**os.environ, "SCHMIDT_CACHE_DIR": str(Path(folder) / "cache")}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)  # users have it written
        first, _ = _run(folder, environment)
        pairs = [_run(folder, environment) for _ in range(3)]
        later, whole = min(start for start, _ in pairs), min(end for _, end in pairs)
        bare = min(_time(["--version"], folder, environment) for _ in range(3))
        catalogue = min(_time(["effects"], folder, environment) for _ in range(3))
    return {
        "first_run_s": first,
        "later_run_s": later,
        "short_run_with_report_s": whole,
        "version_s": bare,
        "effects_s": catalogue,
    }


def _run(folder: str, environment: dict[str, str]) -> tuple[float, float]:
    """Seconds until the run opens its logs (all is imported and compiled by then), and until its end."""
    start = "from scenarios.cli import main; main()"
    command = [sys.executable, "-c", start, "run", "start.yaml", "--out", "out"]
    log = Path(folder) / "out" / "can.log"
    log.unlink(missing_ok=True)
    begin = time.perf_counter()
    environment = {**environment, "PYTHONPATH": str(Path(__file__).parents[2])}
    with subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.DEVNULL) as process:
        while not log.exists() and process.poll() is None:
            time.sleep(0.01)
        started = time.perf_counter() - begin
    if process.returncode:
        raise RuntimeError(f"schmidt run ended with status {process.returncode}")
    return started, time.perf_counter() - begin


def _time(arguments: list[str], folder: str, environment: dict[str, str]) -> float:
    root = str(Path(__file__).parents[2])
    environment = {**environment, "PYTHONPATH": root}
    start = time.perf_counter()
    command = [sys.executable, "-c", "from scenarios.cli import main; main()", *arguments]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"schmidt {' '.join(arguments)}: {done.stderr.strip()}")
    return time.perf_counter() - start
