"""The command as a user meets it: one clear line, exit status 2, never a traceback."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.scenarios.conftest import ROOT, SHORT, Command


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["run", "none.yaml"], "none.yaml: no such file"),
        (["run", "bad.yaml"], "bad.yaml:6: unknown field 'set_rat'"),
        (["run", "short.yaml", "--seed", "-1"], "-1"),
        (["run", "short.yaml", "--plant", "hihg-preload"], "did you mean 'high_preload'"),
        (["run"], "SCENARIO"),
        (["rum"], "rum"),
        (["effects", "gear_mash"], "did you mean 'gear_mesh'"),
        (["run", "short.yaml", "--out", "short.yaml/x"], "cannot be made"),
        (["objective", "--only", "TRACK"], "the rows are: the paper's firmware; "),
        (["objective", "--shift", "nan"], "nan is no number"),
        (["objective", "--seconds", "nan"], "nan is no number"),
        (["serve", "--lx200", "4030", "--token", ""], "it is one word"),
        (["serve", "--lx200", "4030", "--token", "a b"], "it is one word"),
    ],
)
def test_unusable_input_is_one_line_and_status_2(
    arguments: list[str], words: str, short: Path, schmidt: Command
) -> None:
    (short.parent / "bad.yaml").write_text(SHORT.replace("set_rate", "set_rat"))
    done = schmidt(*arguments)
    assert done.returncode == 2
    assert done.stderr.startswith("schmidt: ")
    assert done.stderr.count("\n") == 1
    assert words in done.stderr


def test_run_prints_verdicts_and_exits_with_them(short: Path, schmidt: Command) -> None:
    done = schmidt("run", short, "--out", "good")
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("ok   programme completed")
    short.write_text(SHORT + "expect:\n  - bus_load: {at_most: 1 %}\n")
    done = schmidt("run", short, "--out", "bad")
    assert done.returncode == 1
    assert "MISS bus load" in done.stdout


def test_scenarios_of_schmidt_go_by_name(schmidt: Command) -> None:
    done = schmidt("run", "quick_look", "--no-report", "--network", "serial", "--seed", "3")
    assert "quick-look.yaml" in done.stderr, "the serial network has no gateway"
    done = schmidt("run", "quick-lok")
    assert done.returncode == 2
    assert "quick-lok: no such file" in done.stderr and "did you mean 'quick-look'?" in done.stderr


def test_effects_lists_the_catalogue(schmidt: Command) -> None:
    done = schmidt("effects")
    assert done.returncode == 0
    assert len(done.stdout.splitlines()) >= 36
    assert "amplitude" in schmidt("effects", "gear_mesh").stdout


@pytest.mark.slow
def test_an_interrupted_run_leaves_readable_logs(short: Path, tmp_path: Path) -> None:
    from host.logs import traces

    short.write_text(SHORT.replace("for: 1 s", "for: 4 h"))
    process = subprocess.Popen(
        [sys.executable, "-c", "from scenarios.cli import main; main()", "run", "short.yaml", "--out", "run"],
        cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(ROOT)},
        stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        # a script's background jobs ignore the interrupt, and so would their children
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )  # fmt: skip
    log = tmp_path / "run" / "can.log"
    end = time.monotonic() + 60
    while time.monotonic() < end and not (log.exists() and log.stat().st_size > 200_000):
        time.sleep(0.1)
    process.send_signal(signal.SIGINT)
    _, error = process.communicate(timeout=60)
    assert process.returncode == 130, error
    assert "interrupted, logs up to t=" in error
    assert "Traceback" not in error
    reached_s = float(error.split("t=")[1].split(" s")[0])
    for name in ("can.log", "axis-ra.csv", "commands.log", "sensors.log"):
        assert (tmp_path / "run" / name).read_text().endswith("\n")
    truth = traces.read(tmp_path / "run" / "truth-ra.parquet", ("angle",), 0.0, 1e9)
    assert truth["t_s"][-1] == pytest.approx(reached_s, abs=1.1)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full on this system")
@pytest.mark.parametrize("name", ["can.log", "commands.log", "axis-ra.csv", "summary.json", "report.html"])
def test_a_full_disk_is_one_line(name: str, short: Path, schmidt: Command) -> None:
    (short.parent / "run").mkdir()
    (short.parent / "run" / name).symlink_to("/dev/full")
    done = schmidt("run", short, "--out", "run")
    assert done.returncode == 2
    assert f"run/{name}: no space left" in done.stderr.replace(" cannot be written:", "")
    assert done.stderr.count("\n") == 1
    others = [path for path in (short.parent / "run").glob("axis-dec.csv") if path.name != name]
    for path in others:
        assert path.read_text().endswith("\n")


def test_serve_paces_and_ends_and_names_a_wrong_interface(schmidt: Command) -> None:
    done = schmidt("serve", "--can", "virtual:test", "--duration", "0.5")
    assert done.returncode == 0, done.stderr
    assert "serving 11 boards" in done.stdout
    done = schmidt("serve", "--can", "vertual:test", "--duration", "0.5")
    assert done.returncode == 2
    assert done.stderr.startswith("schmidt: ")
    assert "vertual" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="needs a pseudo-terminal")
def test_a_terminal_gets_a_progress_bar_and_a_pipe_lines(
    short: Path, tmp_path: Path, schmidt_process: Command
) -> None:
    import pty

    lines = schmidt_process("run", short, "--out", "a").stderr.splitlines()  # none when it is quick
    assert all(re.fullmatch(r"schmidt: .*: \d+ %, .*", line) for line in lines), lines
    leader, follower = pty.openpty()
    process = subprocess.Popen(
        [sys.executable, "-c", "from scenarios.cli import main; main()", "run", "short.yaml", "--out", "b"],
        cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(ROOT), "TERM": "xterm"},
        stderr=follower, stdout=subprocess.DEVNULL,
    )  # fmt: skip
    os.close(follower)
    shown = b""
    while True:
        try:
            piece = os.read(leader, 4096)
        except OSError:  # the other end is closed
            break
        if not piece:
            break
        shown += piece
    assert process.wait(60) == 0
    os.close(leader)
    assert b"starting" in shown
