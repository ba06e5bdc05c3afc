"""`python -m tests.benchmarks.night [--hours H]`: a long night really run, with every log; its peak memory.

Every quarter of an hour another field at the zenith of Nainital, where the main scenario stands.
"""

import os
import re
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import click

ROOT = Path(__file__).parents[2]
_FIELD_S, _FOLLOWED_S = 900.0, 860
_FIRST_S = (4 * 60 + 31) * 60.0
"""Right ascension of the zenith at 14:00 UTC on 10 February 2026, s of time."""
_SIDEREAL = 1.0027379
"""Sidereal over solar time (IAU 1982)."""
_LOOK_S = 0.1
_HEAD = """\
name: Long night
start_utc: 2026-02-10T14:00:00Z
time_limit: %g h
steps:
  - power_on: {}
"""
_FIELD = """\
  - name: acquire %d
    goto:
      target: {name: field %d, ra: "%02d:%02d:%04.1f", dec: "+29:40:00"}
  - track: {for: %d s}
"""
_TAIL = """\
  - park: {}
expect:
  - overruns: {at_most: 0}
"""


def scenario(hours: float) -> str:
    """The night as a scenario: slews take their time on top of `hours`."""
    text = _HEAD % (1.5 * hours + 0.5)
    for field in range(max(1, round(hours * 3600.0 / _FIELD_S))):
        ra_s = (_FIRST_S + field * _FIELD_S * _SIDEREAL) % 86400.0
        text += _FIELD % (field, field, ra_s // 3600, ra_s % 3600 // 60, ra_s % 60, _FOLLOWED_S)
    return text + _TAIL


def measure(hours: float, quiet: bool = False) -> dict[str, float]:
    """Run a night in a process of its own. Its peak memory, MiB, growth after the first third, MiB an hour,
    CPU and wall seconds, size of its logs, MB; RuntimeError when it does not end well."""
    with tempfile.TemporaryDirectory(prefix="schmidt-night-") as folder:
        (Path(folder) / "night.yaml").write_text(scenario(hours))
        command = [sys.executable, "-c", "from scenarios.cli import main; main()"]
        command += ["run", "night.yaml", "--out", "out", "--no-report"]
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        said = subprocess.DEVNULL if quiet else None
        before, begin = _children_s(), time.perf_counter()
        resident: list[float] = []
        peak = 0.0
        with subprocess.Popen(command, cwd=folder, env=environment, stdout=said, stderr=said) as process:
            while process.poll() is None:
                now, most = _memory_mib(process.pid)
                resident += [now] if now else []
                peak = max(peak, most)
                time.sleep(_LOOK_S)
        wall_s = time.perf_counter() - begin
        size = sum(path.stat().st_size for path in (Path(folder) / "out").glob("*"))
    if process.returncode:
        raise RuntimeError(f"the long night ended with status {process.returncode}")
    return {
        "hours": hours,
        "peak_MiB": peak or float("nan"),  # without /proc nobody knows
        "MiB_per_hour": growth(resident) / hours,
        "cpu_s": _children_s() - before,
        "wall_s": wall_s,
        "logs_MB": size / 1e6,
    }


def growth(resident: list[float]) -> float:
    """By how much a series grows from its first third to its end, over the whole of it: medians of a tenth
    each, from 30 to 40 and from 90 to 100 %, whose middles are six tenths apart."""
    tenth = len(resident) // 10
    if not tenth:
        return float("nan")
    early, late = resident[3 * tenth : 4 * tenth], resident[-tenth:]
    return (statistics.median(late) - statistics.median(early)) / 0.6


def _memory_mib(pid: int) -> tuple[float, float]:
    """Resident set and its peak so far. Not from getrusage: what that tells of a child holds the peak of
    whoever has started it."""
    try:
        text = Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return 0.0, 0.0
    found = dict(re.findall(r"(VmRSS|VmHWM):\s+(\d+) kB", text))
    return int(found.get("VmRSS", 0)) / 1024.0, int(found.get("VmHWM", 0)) / 1024.0


def _children_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def line(found: dict[str, float]) -> str:
    """Peak, growth, time and logs in words."""
    memory = f"peak {found['peak_MiB']:.0f} MiB, {found['MiB_per_hour']:+.1f} MiB/h after the first third"
    return f"{memory}; {found['cpu_s']:.0f} s CPU, {found['wall_s']:.0f} s, logs {found['logs_MB']:.0f} MB"


@click.command()
@click.option("--hours", default=10.0, show_default=True)
def main(hours: float) -> None:
    """Run a night and print what it took."""
    print(f"{hours:g} hours: {line(measure(hours))} (asked: peak <= 250 MiB, aim 120)")


if __name__ == "__main__":
    main()
