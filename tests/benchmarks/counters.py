"""Instructions per simulated second, where they can be counted: what no neighbour on the machine disturbs.

By `perf` where the machine lets it count, else by valgrind, which has no vector instructions beyond AVX2:
kernels are then compiled for a plain processor and SHA-256 has no instruction of its own, so the two are not
to be compared with each other.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[2]
_SHORT_S, _LONG_S = 20, 120
_PROGRAM = """
import sys, tempfile
from pathlib import Path
from tests.benchmarks.network import session
with tempfile.TemporaryDirectory() as folder:
    made = session(Path(folder))
    made.advance(made.network.queue.now_ns + int(sys.argv[1]) * 10**9)
    made.recorder.close()
"""

UNDER_VALGRIND_S = 5
"""Simulated seconds; valgrind is some fifty times slower than the machine."""
MARKS = """
import os, subprocess, sys
def count(word):
    command = ["callgrind_control", "-i", word, str(os.getpid())]
    if sys.argv[-1] == "x":
        subprocess.run(command, stdout=subprocess.DEVNULL, check=True)
"""
"""The head of a program that says what is counted: count("on"), count("off")."""
_MARKED = (
    MARKS
    + """
import tempfile
from pathlib import Path
from tests.benchmarks.network import session
with tempfile.TemporaryDirectory() as folder:
    made = session(Path(folder))
    count("on")
    made.advance(made.network.queue.now_ns + int(sys.argv[1]) * 10**9)
    count("off")
    made.recorder.close()
"""
)


def instructions(native: bool) -> dict[str, float]:
    """Million instructions per simulated second by way; empty where nothing here may count."""
    return _by_perf(native) or _by_valgrind(native)


def _by_valgrind(native: bool) -> dict[str, float]:
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, pure in (("plain", "1"), ("compiled", "0"))[: 1 + native]:
            refs = under_valgrind(_MARKED, [str(UNDER_VALGRIND_S)], ROOT, pure, folder)
            if refs is None:
                return {}
            found[name] = refs / UNDER_VALGRIND_S / 1e6
    return found


def under_valgrind(program: str, arguments: list[str], root: Path, pure: str, cache: str) -> int | None:
    """Instructions between a program's marks; None where they cannot be counted.

    root: the checkout it runs from. pure: "1" for plain Python. cache: a folder for compiled kernels, which
    the program fills in a first run that is not counted.
    """
    if shutil.which("valgrind") is None:
        return None
    environment = {
        **os.environ, "SCHMIDT_PURE": pure, "PYTHONPATH": str(root), "OPENBLAS_NUM_THREADS": "1",
        "NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": "", "SCHMIDT_CACHE_DIR": cache,
        "PYTHONHASHSEED": "0",
    }  # fmt: skip
    command = [sys.executable, "-c", program, *arguments]
    counted = ["valgrind", "--tool=callgrind", "--instr-atstart=no", "--callgrind-out-file=/dev/null"]
    subprocess.run(command, cwd=root, env=environment, capture_output=True, check=False)
    done = subprocess.run(
        [*counted, *command, "x"], cwd=root, env=environment, capture_output=True, text=True, check=False
    )
    refs = re.search(r"I +refs: +([\d,]+)", done.stderr)
    return int(refs[1].replace(",", "")) if refs is not None and not done.returncode else None


def _by_perf(native: bool) -> dict[str, float]:
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
