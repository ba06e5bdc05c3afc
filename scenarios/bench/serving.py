"""Are the 5 ms ticks of a served network on time? `schmidt serve` in a process of its own, on one core."""

from __future__ import annotations

import contextlib
import json
import os
import resource
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
_PROGRAM = """
import os
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
from scenarios.cli import main
main()
"""
_FLOOR = """
import os, sys, time
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
count, worst, late, start = int(sys.argv[1]), 0.0, [], time.perf_counter()
for tick in range(1, count + 1):
    due = start + tick * 0.005
    time.sleep(max(0.0, due - time.perf_counter()))
    late.append(time.perf_counter() - due)
late.sort()
print(sum(each <= 1e-3 for each in late) / count, late[int(0.999 * count)] * 1e3, late[-1] * 1e3)
"""
"""A loop that sleeps until every 5 ms and does nothing: what this machine grants anybody just now."""
_START_S = 300.0
"""Until it answers: the first start compiles."""


class BenchError(RuntimeError):
    """The served network did not come up, or ended early."""


def punctuality(seconds: int, native: bool) -> dict[str, dict[str, float]]:
    """By way: shares and times of ticks over `seconds` of wall time at speed 1, and the system's load while
    that went on.

    The best way there is (compiled or plain) also with `--realtime`, where the system grants that: then the
    other programs' load does not count, only what the machine and this program can do.
    """
    ways = {"plain": True} | ({"compiled": False} if native else {})
    found = {"a loop that only sleeps": _floor(seconds)}
    found |= {name: _measure(seconds, pure) for name, pure in ways.items()}
    best = list(ways)[-1]
    if _realtime():
        found[f"{best}, --realtime"] = _measure(seconds, ways[best], realtime=True)
    return found


def _floor(seconds: int) -> dict[str, float]:
    ticks = seconds * 200
    said = subprocess.run(
        [sys.executable, "-c", _FLOOR, str(ticks)], capture_output=True, text=True, check=True
    ).stdout.split()
    on_time, late_999_ms, worst_ms = map(float, said)
    return {
        "on_time": on_time, "ticks": ticks, "late_999_ms": late_999_ms, "worst_ms": worst_ms, "slips": 0,
        "load": os.getloadavg()[0],
    }  # fmt: skip


def _realtime() -> bool:
    """Whether this system lets us have the real-time class."""
    try:
        before = os.sched_getscheduler(0)
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(1))
        os.sched_setscheduler(0, before, os.sched_param(0))
    except (AttributeError, OSError):
        return False
    return True


def _measure(seconds: int, pure: bool, realtime: bool = False) -> dict[str, float]:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with tempfile.TemporaryDirectory() as folder, _served(pure, realtime, Path(folder)) as port:
        began_s = time.perf_counter()
        while time.perf_counter() - began_s < seconds:
            time.sleep(1.0)
        status = ask(port, "status")
        load = os.getloadavg()[0]
        ask(port, "stop")
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return {
        "on_time": status["on_time"],
        "ticks": status["ticks"],
        "late_999_ms": status["late_999_ms"],
        "worst_ms": status["worst_ms"],
        "slips": status["slips"],
        "load": load,
        "cpu_s": used.ru_utime + used.ru_stime - before.ru_utime - before.ru_stime,
    }


def ask(port: int, line: str) -> dict[str, Any]:
    """A command of the control plane; what `status` says, or nothing."""
    with socket.create_connection(("127.0.0.1", port), 30) as s, s.makefile() as lines:
        s.sendall(line.encode() + b"\n")
        answer = lines.readline().removeprefix("ok ")
    found: dict[str, Any] = json.loads(answer) if answer.startswith("{") else {}
    return found


@contextlib.contextmanager
def _served(pure: bool, realtime: bool, folder: Path) -> Iterator[int]:
    """The port of the control plane of a network with the doors a host needs: CAN, HID, LX200."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = int(probe.getsockname()[1])
    words = ["serve", "--control", str(port), "--can", "virtual:bench", "--hid", f"unix:{folder}/gateway",
             "--lx200", f"pty:{folder}/lx200", *(["--realtime"] if realtime else [])]  # fmt: skip
    environment = {**os.environ, "SCHMIDT_PURE": "1" if pure else "0", "PYTHONPATH": str(ROOT)}
    with (folder / "said").open("w") as said, subprocess.Popen(
        [sys.executable, "-c", _PROGRAM, *words], env=environment, stdout=said, stderr=subprocess.STDOUT
    ) as process:  # fmt: skip
        try:
            end = time.monotonic() + _START_S
            while not _answers(port):
                if process.poll() is not None or time.monotonic() > end:
                    raise BenchError(" ".join((folder / "said").read_text().split())[-300:])
                time.sleep(0.1)
            yield port
            process.wait(60)
        finally:
            process.kill()


def _answers(port: int) -> bool:
    try:
        ask(port, "status")
    except OSError:
        return False
    return True
