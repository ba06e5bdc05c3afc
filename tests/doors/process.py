"""`schmidt serve` in a process of its own, as a user starts it, with a control door to ask."""

from __future__ import annotations

import json
import socket
import subprocess
import sys
import time
from pathlib import Path
from types import TracebackType
from typing import Any

from tests.ports import free_ports

ROOT = Path(__file__).parents[2]
PROGRAM = "from scenarios.cli import main; main()"
_START_S = 180.0
"""Far beyond what a busy machine needs to compile and start; only a broken server takes as long."""


class Serving:
    """The process. said: what it printed, whole once it has ended."""

    def __init__(self, folder: Path, *words: str) -> None:
        self.control = free_ports()
        self._file = folder / "said.txt"
        self._said = self._file.open("w")
        self.process = subprocess.Popen(
            [sys.executable, "-c", PROGRAM, "serve", "--control", str(self.control), *words],
            cwd=ROOT, stdout=self._said, stderr=subprocess.STDOUT,
        )  # fmt: skip

    def __enter__(self) -> Serving:
        end = time.monotonic() + _START_S
        while True:
            try:
                self.ask("status")
                return self
            except OSError:
                if self.process.poll() is not None or time.monotonic() >= end:
                    self.process.kill()
                    self.process.wait()
                    raise AssertionError(self.end()) from None
                time.sleep(0.1)

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.end()

    def ask(self, line: str) -> str:
        """One command of the control plane; its answer."""
        with socket.create_connection(("127.0.0.1", self.control), 60) as s, s.makefile() as lines:
            s.sendall(line.encode() + b"\n")
            return lines.readline()

    def status(self) -> dict[str, Any]:
        """`status` as it is answered."""
        found: dict[str, Any] = json.loads(self.ask("status").removeprefix("ok "))
        return found

    def wait(self, simulated_s: float) -> dict[str, Any]:
        """Until this simulated time; the status then. Simulated time must go on."""
        last, last_s, still = -1.0, time.monotonic(), 60.0
        while True:
            now = self.status()
            if now["simulated_s"] >= simulated_s:
                return now
            if now["simulated_s"] > last:
                last, last_s = now["simulated_s"], time.monotonic()
            assert time.monotonic() - last_s < still, "simulated time stands still"
            time.sleep(0.1)

    @property
    def said(self) -> str:
        """What it has printed, on one line."""
        return " ".join(self._file.read_text().split())

    def end(self) -> str:
        """Stop it; what it said."""
        try:
            if self.process.poll() is None:
                self.ask("stop")
            self.process.wait(120)
        finally:
            self.process.kill()
            self._said.close()
        return self.said
