"""`schmidt campaign` as a user runs it: to the end, interrupted, on a cluster whose workers die."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
import yaml

from scenarios.campaign import table

ROOT = Path(__file__).parents[3]
SHORT = """\
name: short
start_utc: 2026-02-10T14:00:00Z
steps:
  - power_on: {}
  - name: go
    set_rate: {axis: ra, rate: 100 arcsec/s, for: 1 s}
expect:
  - overruns: {at_most: 0}
"""
CAMPAIGN = {
    "name": "many",
    "scenario": "short.yaml",
    "inputs": [
        {"name": "friction", "plant": "axes.ra.friction.coulomb", "times": {"between": [0.8, 1.2]}},
        {"name": "fault", "fault": True, "is": ["none", {"node_off": {"node": "DISPLAY"}, "at": "0.5 s"}]},
    ],
    "metrics": ["expectations", "bus_load"],
}
pytestmark = pytest.mark.slow


def write(folder: Path, runs: int, seconds: int = 1) -> Path:
    (folder / "short.yaml").write_text(SHORT.replace("for: 1 s", f"for: {seconds} s"))
    path = folder / "many.yaml"
    path.write_text(yaml.safe_dump({**CAMPAIGN, "budget": {"runs": runs}}))
    return path


def command(*words: object) -> list[str]:
    return [sys.executable, "-c", "from scenarios.cli import main; main()", "campaign", *map(str, words)]


def environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(ROOT)}


def rows(folder: Path) -> int:
    journal = folder / table.JOURNAL
    return len(journal.read_text().splitlines()) if journal.exists() else 0


def digests(folder: Path) -> dict[str, Any]:
    found = table.read(folder / table.TABLE)
    return dict(zip(found["key"], found["digest"], strict=True))


def run(*words: object) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        command(*words), env=environment(), capture_output=True, text=True, timeout=500, check=False
    )


@pytest.mark.timeout(900)
def test_interrupted_and_resumed_it_is_the_undisturbed_one(tmp_path: Path) -> None:
    file = write(tmp_path, 60)
    whole = run(file, "--out", tmp_path / "whole", "--jobs", 2)
    assert not whole.returncode, whole.stderr
    assert "60 of 60 runs" in whole.stdout
    cut = tmp_path / "cut"
    with subprocess.Popen(command(file, "--out", cut, "--jobs", 1), env=environment()) as process:
        while process.poll() is None:
            if (cut / table.JOURNAL).exists() and len((cut / table.JOURNAL).read_text().splitlines()) >= 3:
                process.send_signal(signal.SIGINT)
                break
            time.sleep(0.05)
        assert process.wait(120) == 130
    before = {json.loads(line)["key"] for line in (cut / table.JOURNAL).read_text().splitlines()}
    assert 3 <= len(before) < 60
    refused = run(file, "--out", cut)
    assert refused.returncode == 2
    assert "--resume" in refused.stderr
    again = run(file, "--out", cut, "--jobs", 1, "--resume")
    assert not again.returncode, again.stderr
    assert digests(cut) == digests(tmp_path / "whole")
    alone = subprocess.run(
        [*command()[:-1], "run", str(cut / "worst.yaml"), "--out", str(tmp_path / "alone"), "--no-report"],
        env=environment(),
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    summary = json.loads((tmp_path / "alone" / "summary.json").read_text())
    assert summary["trace_digest"] in digests(cut).values(), alone.stderr
    for name in ("report.html", "distributions.png"):
        assert (cut / name).exists()


@pytest.mark.long
@pytest.mark.timeout(3000)
def test_workers_killed_on_a_cluster_cost_nothing(tmp_path: Path) -> None:
    """A local Dask cluster; every ten seconds one worker dies of kill -9."""
    pytest.importorskip("distributed")
    file = write(tmp_path, 40, seconds=600)  # three seconds each at 300 times real time: several deaths
    whole = run(file, "--out", tmp_path / "whole", "--jobs", 2)
    assert not whole.returncode, whole.stderr
    scheduler = subprocess.Popen(
        [sys.executable, "-m", "distributed.cli.dask_scheduler", "--port", "0", "--no-dashboard",
         "--scheduler-file", str(tmp_path / "scheduler.json"), "--host", "127.0.0.1"],
        env=environment(), stderr=subprocess.DEVNULL,
    )  # fmt: skip
    worker = [sys.executable, "-m", "distributed.cli.dask_worker", "--nworkers", "1", "--nthreads", "1"]
    worker += ["--no-nanny", "--no-dashboard", "--local-directory", str(tmp_path)]
    worker += ["--scheduler-file", str(tmp_path / "scheduler.json")]

    def start() -> "subprocess.Popen[bytes]":
        return subprocess.Popen(worker, env=environment(), stderr=subprocess.DEVNULL)

    workers = [start(), start()]
    killed = 0
    try:
        while not (tmp_path / "scheduler.json").exists():
            time.sleep(0.1)
        address = json.loads((tmp_path / "scheduler.json").read_text())["address"]
        with subprocess.Popen(
            command(file, "--out", tmp_path / "cut", "--scheduler", address), env=environment()
        ) as process:
            last, made = time.monotonic(), 0
            while process.poll() is None:
                time.sleep(0.1)
                if time.monotonic() - last > 10 and rows(tmp_path / "cut") > made:
                    made = rows(tmp_path / "cut")  # on a slow machine at least one run between two deaths
                    workers[killed % 2].kill()
                    workers[killed % 2].wait()
                    workers[killed % 2] = start()
                    killed, last = killed + 1, time.monotonic()
        assert process.returncode == 0
    finally:
        for each in (*workers, scheduler):
            each.kill()
            each.wait()
    print(f"{killed} workers killed")
    assert killed > 1
    assert digests(tmp_path / "cut") == digests(tmp_path / "whole")
