"""Nothing that a file holds ends in a hang, a traceback, or more than one line."""

import os
import re
import subprocess
import sys
import time
from pathlib import Path

import pytest

from scenarios.lab.prepare import prepare
from scenarios.lab.wiring import wire
from tests.scenarios.conftest import Command
from tests.scenarios.language.broken import BASE, REFUSED

SECONDS = 5.0


@pytest.mark.timeout(30)
@pytest.mark.parametrize(("name", "text"), REFUSED, ids=[name for name, _ in REFUSED])
def test_a_broken_scenario_is_refused_at_once(tmp_path: Path, name: str, text: str) -> None:
    file = tmp_path / "x.yaml"
    file.write_bytes(text.encode())
    start = time.perf_counter()
    with pytest.raises((ValueError, OSError)) as caught:
        wire(*prepare(file))
    assert time.perf_counter() - start < SECONDS
    said = "\n".join([str(caught.value), *getattr(caught.value, "__notes__", ())])
    assert str(file) in said
    assert not re.search(r"\b(True|False|None|Errno|NoneType)\b| \? ", said), said


def test_the_base_of_them_all_is_good(tmp_path: Path) -> None:
    file = tmp_path / "x.yaml"
    file.write_text(BASE)
    wire(*prepare(file))


@pytest.mark.timeout(30)
def test_a_pipe_and_a_device_are_not_read(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.yaml")
    for file in (tmp_path / "pipe.yaml", Path("/dev/zero"), tmp_path):
        with pytest.raises(ValueError, match="no regular file"):
            prepare(file)
    (tmp_path / "big.yaml").write_bytes(b"a" * 5_000_000)
    with pytest.raises(ValueError, match="longer than"):
        prepare(tmp_path / "big.yaml")


@pytest.mark.timeout(30)
@pytest.mark.parametrize("name", ["pipe", "/dev/zero"])
@pytest.mark.parametrize(
    "words",
    [("--mute", "AXIS_RA", "--feed"), ("--compensation",), ("--from",)],
    ids=["feed", "compensation", "from"],
)
def test_no_option_of_a_run_reads_a_pipe_or_a_device(
    words: tuple[str, ...], name: str, short: Path, schmidt: Command
) -> None:
    os.mkfifo(short.parent / "pipe")
    scenario = () if "--from" in words else (short,)
    done = schmidt("run", *scenario, *words, name, "--out", "run")
    assert done.returncode == 2
    assert done.stderr == f"schmidt: {name}: cannot be read: it is no regular file\n"


COMMANDS = (
    ("run", "nowhere.yaml", "--speed", "nan"),
    ("run", "nowhere.yaml", "--speed", "inf"),
    ("run", "nowhere.yaml", "--speed", "1e12"),
    ("run", "nowhere.yaml", "--log-rate", "nan"),
    ("run", "nowhere\n.yaml"),
    ("run", "n" * 5000),
    ("serve", "--can", "virtual:x", "--speed", "inf"),
    ("serve", "--can", "virtual:x", "--speed", "1e12"),
    ("serve", "--can", "virtual:x", "--speed", "1e-12"),
    ("serve", "--can", "virtual:x", "--duration", "nan"),
    ("serve", "--can", "virtual:x", "--duration", "inf"),
    ("serve", "--can", "udp_multicast:239.74.163.2,port=70000"),
    ("serve", "--can", "udp_multicast:nonsense"),
    ("serve", "--can", "socketcan:" + "x" * 300),
    ("serve", "--serial", "tcp:65533"),
    ("serve", "--serial", "tcp:99999999999999999999"),
    ("serve", "--serial", "tcp:256.1.1.1:7000"),
    ("serve", "--serial", "pty:/proc/nowhere"),
    ("serve", "--serial", "usb:1"),
    ("serve", "--hid", "unix:" + "y" * 300),
    ("serve", "--hid", "unix:/"),
    ("serve", "--hid", "nonsense"),
    ("serve", "--control", "70000"),
    ("serve", "--control", "-1"),
    ("serve",),
    ("control", "status", "--at", "70000"),
    ("control", "status", "--at", "1"),
    ("replay", "nowhere"),
    ("conformance", "--tolerance", "nan"),
)


@pytest.mark.slow
@pytest.mark.timeout(60)
@pytest.mark.parametrize("words", COMMANDS, ids=lambda words: " ".join(words)[:60].replace("\n", " "))
def test_a_broken_command_line_is_one_line_and_status_2(words: tuple[str, ...], tmp_path: Path) -> None:
    command = [sys.executable, "-c", "from scenarios.cli import main; main()", *words]
    root = Path(__file__).parents[3]
    result = subprocess.run(
        command,
        capture_output=True,
        text=True,
        timeout=50,
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(root)},
    )
    assert result.returncode == 2, result.stderr
    assert result.stderr.startswith("schmidt: ")
    assert result.stderr.count("\n") == 1
    assert len(result.stderr) < 1000


@pytest.mark.slow
@pytest.mark.timeout(60)
def test_more_runs_than_any_memory_holds_is_one_line(tmp_path: Path) -> None:
    root = Path(__file__).parents[3]
    for name in ("what-fails-first.yaml", "short-night.yaml"):
        text = (root / "scenarios" / "campaigns" / name).read_text()
        (tmp_path / name).write_text(text.replace("{runs: 200}", "{runs: 1000000000000000}"))
    words = ["campaign", "what-fails-first.yaml", "--out", "out"]
    result = subprocess.run(
        [sys.executable, "-c", "from scenarios.cli import main; main()", *words],
        capture_output=True, text=True, timeout=50, cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(root), "SCHMIDT_PURE": "1"},
    )  # fmt: skip
    assert result.returncode == 2
    assert result.stderr.startswith("schmidt: what-fails-first.yaml: 1000000000000000 runs are planned")
    assert result.stderr.count("\n") == 1
