"""docs/guides/stepped-host.md: its commands are run as they stand there, in their order, on free ports."""

import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.docs.guides import text_of, write_files
from tests.doors.process import PROGRAM, ROOT
from tests.ports import free_ports

pytestmark = [pytest.mark.slow, pytest.mark.timeout(600)]


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_the_page_does_what_it_says(tmp_path: Path) -> None:
    write_files("stepped-host.md", tmp_path)
    control, line = free_ports(), free_ports(5)
    text = text_of("stepped-host.md").replace("7411", str(control)).replace("7501", str(line))
    serve, step, alone, both = re.findall(r"^    ((?:schmidt|cc|JOIN).*)$", text, re.MULTILINE)
    (tmp_path / "bin").mkdir()
    for name, words in (("schmidt", f"-c '{PROGRAM}'"), ("python", "")):
        file = tmp_path / "bin" / name
        file.write_text(f'#!/bin/sh\nexec {sys.executable} {words} "$@"\n')
        file.chmod(0o755)
    path = f"{tmp_path / 'bin'}:{os.environ['PATH']}"
    environment = os.environ | {"PYTHONPATH": str(ROOT), "PATH": path}
    environment.pop("SCHMIDT_PURE", None)  # log.py imports bus first

    def shell(command: str) -> str:
        done = subprocess.run(
            command, shell=True, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=300
        )
        assert done.returncode == 0, command + done.stderr
        return done.stdout

    with (tmp_path / "said").open("w") as said, subprocess.Popen(
        serve.split(), cwd=tmp_path, env=environment, stdout=said, stderr=subprocess.STDOUT
    ) as process:  # fmt: skip
        end = time.monotonic() + 180
        while "serving" not in (tmp_path / "said").read_text():
            assert process.poll() is None and time.monotonic() < end, (tmp_path / "said").read_text()
            time.sleep(0.1)
        assert shell(step) == "5000000\n"
        assert abs(int(shell(alone).split()[0]) - 20000) < 10_000
        assert re.search(r"\d+ bytes of the log", shell(f"{both}; wait"))
        assert '"simulated_s": 10.005' in shell(f"schmidt control status --at {control}")
        shell(f"schmidt control stop --at {control}")
        assert process.wait(60) == 0
    assert "digest" in (tmp_path / "said").read_text()
