"""Short scenarios for tests, and a way to call the command as a user does."""

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
Command = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture
def short(tmp_path: Path) -> Path:
    """A scenario of two simulated seconds."""
    path = tmp_path / "short.yaml"
    path.write_text(SHORT)
    return path


@pytest.fixture
def schmidt(tmp_path: Path) -> Command:
    """Run the command in a folder of its own."""

    def call(*arguments: object, **environment: str) -> "subprocess.CompletedProcess[str]":
        import os

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
