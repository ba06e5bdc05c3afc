"""`python -m scenarios.bench.night [--hours H]`: a long night really run, with every log; its peak memory.

Every quarter of an hour another field at the zenith of Nainital, where the main scenario stands.
"""

from __future__ import annotations

import os
import resource
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


@click.command()
@click.option("--hours", default=10.0, show_default=True)
def main(hours: float) -> None:
    """Run a night and print what it took."""
    with tempfile.TemporaryDirectory(prefix="schmidt-night-") as folder:
        (Path(folder) / "night.yaml").write_text(scenario(hours))
        command = [sys.executable, "-c", "from scenarios.cli import main; main()"]
        command += ["run", "night.yaml", "--out", "out", "--no-report"]
        begin = time.perf_counter()
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        done = subprocess.run(command, cwd=folder, env=environment, check=False)
        wall_s = time.perf_counter() - begin
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        size = sum(path.stat().st_size for path in (Path(folder) / "out").iterdir())
    cpu_s = used.ru_utime + used.ru_stime
    memory = f"peak {used.ru_maxrss / 1024:.0f} MiB (<= 250, aim 120)"
    print(f"{hours:g} hours: {memory}, logs {size / 1e6:.0f} MB, {cpu_s:.0f} s CPU, {wall_s:.0f} s")
    raise SystemExit(done.returncode)


if __name__ == "__main__":
    main()
