"""Are the 5 ms ticks of a served network on time? `schmidt serve` in a process of its own, on one core."""

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

from scenarios.doors.stepped import Stepped

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


def stepped(seconds: int, native: bool, step_ms: int) -> dict[str, dict[str, float]]:
    """By way: times real time of a network that a host in another process steps, hearing every frame.

    Both processes share one core, where the system lets them; otherwise by the CPU time of both together.
    """
    ways = {"plain": True} | ({"compiled": False} if native else {})
    return {way: _stepped(seconds, pure, step_ms) for way, pure in ways.items()}


def _stepped(seconds: int, pure: bool, step_ms: int) -> dict[str, float]:
    with (
        _on_one_core(),
        tempfile.TemporaryDirectory() as folder,
        _served(pure, Path(folder), "--clock", "steps", "--serial", f"pty:{folder}/ports") as (
            port,
            process,
        ),
    ):
        with Stepped(str(port)) as clock:
            clock.step("1 s")
            cpu, began_s = _cpu_s(process.pid), time.process_time()
            frames = sum(len(clock.step(f"{step_ms} ms")) for _ in range(1000 * seconds // step_ms))
            cpu, own = _cpu_s(process.pid) - cpu, time.process_time() - began_s
        ask(port, "stop")
    return {"times_real_time": seconds / (cpu + own), "host_cpu_s": own, "frames": frames}


@contextlib.contextmanager
def _on_one_core() -> Iterator[None]:
    """This process beside the served one, on the core that that one takes; afterwards where it was."""
    if not hasattr(os, "sched_setaffinity"):
        yield
        return
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(before)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)


def _cpu_s(pid: int) -> float:
    """CPU time of a process so far, s (proc(5): fields 14 and 15 of stat, in clock ticks)."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


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
    with (
        tempfile.TemporaryDirectory() as folder,
        _served(pure, Path(folder), *_doors(folder, realtime)) as (
            port,
            _,
        ),
    ):
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


def _doors(folder: str, realtime: bool) -> list[str]:
    """Those that a host needs: CAN, HID, LX200."""
    doors = ["--can", "virtual:bench", "--hid", f"unix:{folder}/gateway", "--lx200", f"pty:{folder}/lx200"]
    return [*doors, "--realtime" if realtime else "--no-realtime"]


def ask(port: int, line: str) -> dict[str, Any]:
    """A command of the control plane; what `status` says, or nothing."""
    with socket.create_connection(("127.0.0.1", port), 30) as s, s.makefile() as lines:
        s.sendall(line.encode() + b"\n")
        answer = lines.readline().removeprefix("ok ")
    found: dict[str, Any] = json.loads(answer) if answer.startswith("{") else {}
    return found


@contextlib.contextmanager
def _served(pure: bool, folder: Path, *doors: str) -> Iterator[tuple[int, subprocess.Popen[bytes]]]:
    """The control plane's port and the process of a network with these doors."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = int(probe.getsockname()[1])
    words = ["serve", "--control", str(port), *doors]
    environment = {**os.environ, "SCHMIDT_PURE": "1" if pure else "0", "PYTHONPATH": str(ROOT)}
    with (folder / "said").open("w") as said, subprocess.Popen(
        [sys.executable, "-c", _PROGRAM, *words], env=environment, stdout=said, stderr=subprocess.STDOUT
    ) as process:  # fmt: skip
        try:
            end = time.monotonic() + _START_S
            while not _answers(port):
                if process.poll() is not None or time.monotonic() > end:
                    raise ValueError(" ".join((folder / "said").read_text().split())[-300:])
                time.sleep(0.1)
            yield port, process
            process.wait(60)
        finally:
            process.kill()


def _answers(port: int) -> bool:
    try:
        ask(port, "status")
    except OSError:
        return False
    return True
