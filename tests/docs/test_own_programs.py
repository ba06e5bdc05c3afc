"""Lines of the guides that are other people's programs, and those on a file of one's own."""

import os
import re
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from tests.docs.guides import GUIDES, Step, run, text_of
from tests.doors.process import PROGRAM, ROOT
from tests.host.lx200 import test_indi
from tests.ports import free_ports


def lines(page: str, program: str) -> list[str]:
    """Indented lines of a guide that call a program."""
    return [line.strip() for line in re.findall(rf"^    (.*\b{program} .*)$", text_of(page), re.MULTILINE)]


@pytest.mark.parametrize("page", sorted(path.name for path in GUIDES.glob("*.md")))
def test_every_guide_is_named_by_a_test(page: str) -> None:
    others = [path for path in (ROOT / "tests").rglob("*.py") if path != Path(__file__)]
    assert any(page in path.read_text(encoding="utf-8") for path in others), f"nothing executes {page}"


@pytest.mark.slow
def test_the_line_of_python_asks_where_the_telescope_points(tmp_path: Path) -> None:
    (line,) = (line for line in lines("attach-a-host.md", "python") if ":GR#" in line)
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    port = free_ports()
    served = [sys.executable, "-c", PROGRAM, "serve", "--lx200", str(port), "--duration", "120"]
    here = os.environ | {"PYTHONPATH": str(ROOT), "PATH": path}
    with subprocess.Popen(served, cwd=tmp_path, env=here, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdout is not None
        while "--lx200" not in (said := server.stdout.readline()):
            assert said, "serve has ended"
        command = line.replace("4030", str(port))
        for _ in range(20):  # the host's process opens its port a moment later
            done = subprocess.run(
                ["sh", "-c", command], env=here, capture_output=True, text=True, check=False
            )
            if done.stdout:
                break
            time.sleep(1.0)
        server.terminate()
    assert re.fullmatch(r"b'\d\d:\d\d(:\d\d|\.\d)#'", done.stdout.strip()), done.stderr


def test_the_line_with_indiserver_names_a_driver_that_is_tried() -> None:
    """tests/host/lx200/test_indi.py starts that driver by indiserver and attaches it to a telescope."""
    (line,) = lines("attach-a-host.md", "indiserver")
    program, driver = line.split()
    assert program == "indiserver"
    assert driver in test_indi.DRIVERS


@pytest.mark.slow
@pytest.mark.parametrize("drafted", [True, False])
def test_a_log_of_ones_own_goes_the_way_of_the_guide(tmp_path: Path, drafted: bool) -> None:
    """A table with the drafted rig file, or with the first example's, by the commands as they stand."""
    t = np.arange(0.0, 24.0, 0.004)
    q = 0.08 * np.sin(0.9 * t) + 0.03 * np.sin(2.3 * t)
    v, a = np.gradient(q, t), np.gradient(np.gradient(q, t), t)
    force = 95.0 * a + 210.0 * v + 20.0 * np.tanh(v / 1e-4)
    noise = np.random.default_rng(1).normal(0.0, 0.01, t.size)
    table = np.column_stack([t, q, force / 35.15 + noise])
    np.savetxt(tmp_path / "my-log.csv", table, delimiter=",", header="t,qm,vir", comments="", fmt="%.8g")
    commands = [line for line in lines("calibrate-a-log.md", "schmidt") if "my-drive.yaml" in line]
    assert len(commands) == 3
    draft, _, told = commands[0].partition(" > ")
    text = run(Step(draft, False, ()), tmp_path).stdout
    if not drafted:
        examples = (ROOT / "docs" / "reference" / "rig-examples.md").read_text(encoding="utf-8")
        text = examples.split("```yaml\n")[1].split("```")[0]
    (tmp_path / told).write_text(text, encoding="utf-8")
    for command in commands[1:]:
        done = run(Step(command, False, ()), tmp_path)
        assert done.returncode == 0, done.stderr
    assert (tmp_path / "columns.png").stat().st_size > 10_000
    assert (tmp_path / "out" / "mine" / "report.html").exists()


@pytest.mark.slow
def test_the_night_is_changed_as_the_guide_says(tmp_path: Path) -> None:
    """Another seed, another plant: other traces."""
    night = text_of("first-night.md").split("```yaml\n")[1].split("```")[0].replace("60 s", "10 s")
    (tmp_path / "my-night.yaml").write_text(night, encoding="utf-8")
    commands = re.findall(r"`(schmidt run my-night.yaml [^`]+)`", text_of("first-night.md"))
    assert len(commands) == 2
    digests = set()
    for command in commands:
        done = run(Step(f"{command} --no-report", False, ()), tmp_path)
        assert done.returncode in (0, 1), done.stderr
        digests.add(re.findall(r"digest (\w+)", done.stdout)[0])
    assert len(digests) == 2
