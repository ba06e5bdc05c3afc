"""docs/guides/firmware-in-c.md does what it says: its files are written, its commands run."""

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from scenarios.lab.prepare import Changes, prepare
from scenarios.run import run as runner

PAGE = Path(__file__).parents[2] / "docs" / "guides" / "firmware-in-c.md"
TEXT = PAGE.read_text(encoding="utf-8")
NAMES = ("tach.c", "tach.yaml", "axes.yaml")
"""Of the page's blocks, in its order."""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    blocks = re.findall(r"```\w+\n(.*?)```", TEXT, re.DOTALL)
    for name, text in zip(NAMES, blocks, strict=True):
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


def schmidt(folder: Path, command: str) -> subprocess.CompletedProcess[str]:
    main = "from scenarios.cli import main; main()"
    call = [sys.executable, "-c", main, *shlex.split(command)[1:]]
    return subprocess.run(call, capture_output=True, text=True, cwd=folder, check=False)


def test_the_command_of_the_page(folder: Path) -> None:
    command = re.findall(r"^    (schmidt run .*)$", TEXT, re.MULTILINE)[0]
    assert schmidt(folder, command).returncode == 0
    assert (folder / "tach" / "summary.json").exists()


@pytest.mark.parametrize("name", NAMES[1:])
def test_the_frames_are_those_of_the_boards_that_come_along(folder: Path, name: str) -> None:
    file = folder / name
    text = file.read_text()
    along = re.sub(r"\{firmware: \w+\.c\}", "{}", text)
    digests = []
    for used, isolated in ((along, False), (text, False), (text, True)):
        file.write_text(used)
        made = prepare(file, Changes(isolated=isolated))
        result = runner.run(*made, folder / "out", lambda *_: None, runner.Way(report=False))
        assert result.passed
        digests.append(result.summary["trace_digest"])
    assert digests == [digests[0]] * 3


def test_a_crash_is_the_line_of_the_page_and_the_logs_are_kept(folder: Path) -> None:
    line = re.findall(r"^    (schmidt: tach\.c: .*)$", TEXT, re.MULTILINE)[0]
    file = folder / "tach.c"
    wrong = "if (b->ticks == 100) *(volatile int *)8 = 0;"
    file.write_text(
        file.read_text().replace("    b->before = now;\n", f"    {wrong}\n    b->before = now;\n")
    )
    done = schmidt(folder, "schmidt run tach.yaml --out out --isolated")
    assert done.returncode == 2
    told = done.stderr.replace(f"{folder}/", "").splitlines()[-1]  # lines of progress before, if it is slow
    assert re.sub(r"[\d.]+ s", "T", told) == re.sub(r"[\d.]+ s", "T", line)
    assert len((folder / "out" / "can.log").read_text().splitlines()) > 500


@pytest.mark.skipif(shutil.which("gdb") is None, reason="no gdb")
@pytest.mark.slow
def test_a_debugger_stops_in_the_firmware(folder: Path) -> None:
    command = re.search(r"^    (gdb .*?tach\.yaml)$", TEXT, re.MULTILINE | re.DOTALL)
    assert command
    words = shlex.split(command[1].replace("\\\n", " "))
    words[words.index("python")] = sys.executable
    call = [words[0], "-batch", "-ex", "set debuginfod enabled off", *words[1:]]
    place = call.index("--args")
    call[place:place] = ["-ex", "run", "-ex", "print b->device"]
    done = subprocess.run(call, capture_output=True, text=True, cwd=folder, check=False, timeout=120)
    assert "$1 = 49" in done.stdout, done.stdout + done.stderr
