"""Short scenarios for tests, and two ways to call the command: in this process, and as a user does."""

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

SHORT = """\
name: short
start_utc: 2026-02-10T14:00:00Z
steps:
  - power_on: {}
  - name: go
    set_rate: {axis: ra, rate: 100 arcsec/s, for: 1 s}
"""
ROOT = Path(__file__).parents[2]
Done = subprocess.CompletedProcess
Command = Callable[..., "Done[str]"]


@pytest.fixture
def short(tmp_path: Path) -> Path:
    """A scenario of two simulated seconds."""
    path = tmp_path / "short.yaml"
    path.write_text(SHORT)
    return path


@pytest.fixture
def schmidt(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Command:
    """Run the command in a folder of its own, in this process: Python starts slower than most runs."""
    from scenarios.cli import main

    def call(*arguments: object) -> "Done[str]":
        words = [str(each) for each in arguments]
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(sys, "argv", ["schmidt", *words])
        capsys.readouterr()
        before = signal.getsignal(signal.SIGTERM)
        try:
            main()
            status = 0
        except SystemExit as end:
            status = end.code if isinstance(end.code, int) else int(end.code is not None)
        finally:
            signal.signal(signal.SIGTERM, before)
        output = capsys.readouterr()
        return subprocess.CompletedProcess(words, status, output.out, output.err)

    return call


@pytest.fixture
def schmidt_process(tmp_path: Path) -> Command:
    """Run the command in a process and a folder of its own."""

    def call(*arguments: object, **environment: str) -> "Done[str]":
        return subprocess.run(
            [sys.executable, "-c", "from scenarios.cli import main; main()", *map(str, arguments)],
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": str(ROOT), **environment},
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )

    return call
