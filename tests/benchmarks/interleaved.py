"""Parts of both ways in turn, in the same minutes: CPU ms per simulated second, and ratios of those."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from tests.benchmarks.network import spread

ROOT = Path(__file__).parents[2]
PARTS = {"night": 20, "in C": 20, "bare": 20, "plant": 20, "virtual": 3}
"""Simulated seconds of each part in a round."""
ROUNDS = 12


class Way:
    """A worker process."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self._process = process
        self.compiled = bool(self._read()["compiled"])
        self.rounds: dict[str, list[float]] = {part: [] for part in PARTS}
        self.frames: dict[str, float] = {}

    def ask(self, part: str) -> None:
        """Run a part and keep its CPU ms per simulated second."""
        seconds = PARTS[part]
        assert self._process.stdin is not None
        self._process.stdin.write(f"{part} {seconds}\n")
        self._process.stdin.flush()
        found = self._read()
        self.rounds[part].append(1e3 * found["cpu_s"] / seconds)
        if "frames" in found:
            self.frames[part] = found["frames"] / seconds

    def _read(self) -> dict[str, Any]:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            raise RuntimeError("the bench's worker has died")
        found: dict[str, Any] = json.loads(line)
        return found


@contextmanager
def _way(pure: bool) -> Iterator[Way]:
    environment = {**os.environ, "SCHMIDT_PURE": "1" if pure else "0", "PYTHONPATH": str(ROOT)}
    with subprocess.Popen(
        [sys.executable, "-m", f"{__package__}.worker"],
        env=environment,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        yield Way(process)


def measure(rounds: int = ROUNDS, native: bool = True) -> dict[str, Any]:
    """Figures by way, and ratios taken round by round: both sides of a ratio saw the same machine."""
    with ExitStack() as stack:
        ways = {"plain": stack.enter_context(_way(pure=True))}
        if native:
            ways["compiled"] = stack.enter_context(_way(pure=False))
        parts = [part for part in PARTS if native or part != "in C"]  # which needs the compiler, too
        for way in ways.values():
            for part in parts:
                way.ask(part)
                way.rounds[part].clear()  # set up
        for _ in range(rounds):
            for part in parts:
                for way in ways.values():
                    way.ask(part)
    figures: dict[str, Any] = {"rounds": rounds, "seconds": dict(PARTS)}
    for name, way in ways.items():
        figures[name] = {part: spread(values) for part, values in way.rounds.items() if values}
        figures[name]["frames_per_s"] = way.frames["night"]
        figures[name]["bare over night"] = _ratio(way, "bare", way, "night")
        figures[name]["python-can over night"] = _ratio(way, "virtual", way, "night")
    if native:
        plain, fast = ways["plain"], ways["compiled"]
        for name, way in ways.items():
            figures[name]["night over night in C"] = _ratio(way, "night", way, "in C")
        figures["plain over compiled night"] = _ratio(plain, "night", fast, "night")
        figures["compiled"]["bare on compiled pins over night"] = figures["compiled"]["bare over night"]
        # the yardstick is plain Python, whatever the emulator is
        figures["compiled"]["bare over night"] = _ratio(plain, "bare", fast, "night")
        figures["compiled"]["python-can over night"] = _ratio(plain, "virtual", fast, "night")
    return figures


def _ratio(one: Way, part: str, other: Way, beside: str) -> dict[str, float]:
    pairs = zip(one.rounds[part], other.rounds[beside], strict=True)
    return spread([a / b for a, b in pairs])
