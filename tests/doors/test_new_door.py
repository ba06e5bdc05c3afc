"""A new door is one file and one row: the options of the command line and all else follow from the table."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FILE = """
from pathlib import Path

class TimeFile:
    def __init__(self, spec, live):
        self.name, self._file, self._live = f"--timefile {spec}", Path(spec), live
    def open(self):
        self._file.write_text("open")
    def poll(self, now_ns):
        self._file.write_text(str(now_ns))
    def close(self):
        pass
    def state(self):
        return "written"
"""
ROW = """
from scenarios.doors import table
from timefile import TimeFile

table.ON_NETWORK += (
    table.DoorKind(
        name="timefile",
        form="FILE",
        help="Simulated time.",
        make=lambda asked, live: TimeFile(asked.spec, live),
        attach={"": "cat {spec}"},
    ),
)
from scenarios.cli import main
main()
"""


def schmidt(folder: Path, *words: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", ROW, *words],
        env={**os.environ, "PYTHONPATH": f"{folder}:{ROOT}"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert not done.returncode, done.stderr
    return done.stdout


@pytest.mark.slow
def test_a_door_is_a_file_and_a_row(tmp_path: Path) -> None:
    (tmp_path / "timefile.py").write_text(FILE)
    assert "--timefile FILE" in schmidt(tmp_path, "serve", "-h")
    said = schmidt(tmp_path, "serve", "--timefile", str(tmp_path / "now"), "--duration", "0.5")
    assert "--timefile" in said and "written" in said and f"cat {tmp_path / 'now'}" in said
    assert int((tmp_path / "now").read_text()) > 0, "simulated time went on, however loaded the machine is"
