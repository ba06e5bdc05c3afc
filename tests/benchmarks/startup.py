"""How long a user waits: the first command after installation, which compiles, and the ones after it.

Wall time is what a user sees, CPU time what no neighbour on the machine disturbs.
"""

import os
import resource
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
_LOOK_S = 0.005


def startup() -> dict[str, float]:
    """Wall and CPU seconds until `schmidt run` simulates, without anything kept and with; and of a short run
    with its report. Of three the quickest."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "start.yaml").write_text(_TWO_SECONDS)
        environment = {**os.environ, "SCHMIDT_CACHE_DIR": str(Path(folder) / "cache")}
        environment["PYTHONPATH"] = str(Path(__file__).parents[2])
        environment.pop("PYTHONDONTWRITEBYTECODE", None)  # users have it written
        first = _run(folder, environment)
        later = [_run(folder, environment) for _ in range(3)]
        bare = min(_time(["--version"], folder, environment) for _ in range(3))
        catalogue = min(_time(["effects"], folder, environment) for _ in range(3))
    return {
        "first_run_s": first["start_s"],
        "first_run_cpu_s": first["start_cpu_s"],
        "later_run_s": min(each["start_s"] for each in later),
        "later_run_cpu_s": min(each["start_cpu_s"] for each in later),
        "short_run_with_report_s": min(each["whole_s"] for each in later),
        "short_run_with_report_cpu_s": min(each["whole_cpu_s"] for each in later),
        "version_s": bare,
        "effects_s": catalogue,
    }


def _run(folder: str, environment: dict[str, str]) -> dict[str, float]:
    """Seconds until the run opens its logs (all is imported and compiled by then), and until its end."""
    start = "from scenarios.cli import main; main()"
    command = [sys.executable, "-c", start, "run", "start.yaml", "--out", "out"]
    log = Path(folder) / "out" / "can.log"
    log.unlink(missing_ok=True)
    before, begin = _children_s(), time.perf_counter()
    with subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.DEVNULL) as process:
        while not log.exists() and process.poll() is None:
            time.sleep(_LOOK_S)
        started, cpu_s = time.perf_counter() - begin, _cpu_s(process.pid)
    whole_s = time.perf_counter() - begin
    if process.returncode:
        raise RuntimeError(f"schmidt run ended with status {process.returncode}")
    whole_cpu_s = _children_s() - before
    return {"start_s": started, "start_cpu_s": cpu_s, "whole_s": whole_s, "whole_cpu_s": whole_cpu_s}


def _cpu_s(pid: int) -> float:
    """CPU time of a running process, to a hundredth of a second; nan where there is no /proc."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return float("nan")
    return (int(fields[11]) + int(fields[12])) / float(os.sysconf("SC_CLK_TCK"))


def _children_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _time(arguments: list[str], folder: str, environment: dict[str, str]) -> float:
    start = time.perf_counter()
    command = [sys.executable, "-c", "from scenarios.cli import main; main()", *arguments]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"schmidt {' '.join(arguments)}: {done.stderr.strip()}")
    return time.perf_counter() - start
