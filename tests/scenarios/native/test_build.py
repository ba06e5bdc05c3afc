"""How the library is built, over a stub compiler: what is refused, how often, and what is checked."""

import json
import subprocess
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from scenarios.native import build as building
from scenarios.native import stamp
from scenarios.native.build import BuildError, build, compiler

FILE = "bus/can/frame.py"


class Process:
    """A Python that was started: its output line by line, and its end."""

    def __init__(self, code: int = 0, out: str = "", errors: str = "") -> None:
        self.returncode, self.out, self.errors = code, out, errors

    @property
    def stdout(self) -> Iterator[str]:
        return iter(self.out.splitlines(keepends=True))

    def communicate(self) -> tuple[str, str]:
        return self.out, self.errors

    def __enter__(self) -> "Process":
        return self

    def __exit__(self, *_: object) -> None: ...


class Desk:
    """A checkout of one module, and processes that end as they are told."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, folder: Path) -> None:
        self.root, self.library = folder / "root", folder / "library"
        for path in (FILE, stamp.CHOICE):
            (self.root / path).parent.mkdir(parents=True, exist_ok=True)
            (self.root / path).write_text("x = 1\n")
        self.ends: list[Process] = []
        self.commands: list[list[str]] = []
        self.said: list[str] = []
        self.stages: list[str] = []
        self.missing: set[str] = {"numba"}
        self.patch = monkeypatch
        monkeypatch.setattr(building, "_started", self.start)
        monkeypatch.setattr(building, "compiler", lambda: True)
        find = SimpleNamespace(find_spec=lambda name: None if name in self.missing else 1)
        monkeypatch.setattr(building, "importlib", SimpleNamespace(util=find))

    def start(self, command: list[str], root: Path, pure: str, stderr: int = subprocess.PIPE) -> Process:
        self.commands.append(command)
        end = self.ends.pop(0)
        if command[1].endswith("compile") and not end.returncode:
            made = Path(command[2]) / "library" / "bus" / "can"
            made.mkdir(parents=True)
            (made / f"frame{stamp.suffix()}").write_text("code")
        return end

    def build(self) -> bool:
        return build(self.library, self.said.append, self.root, self.stages.append)


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Desk:
    return Desk(monkeypatch, tmp_path)


def test_a_library_is_built_once_and_bears_what_it_was_made_of(desk: Desk) -> None:
    desk.ends = [Process(out="schmidt: translated\n")]
    assert desk.build()
    found = json.loads((desk.library / stamp.STAMP).read_text())
    assert found["modules"] == {"bus.can.frame": f"bus/can/frame{stamp.suffix()}"}
    assert set(found["sources"]) == {FILE, stamp.CHOICE} and found["suffix"] == stamp.suffix()
    assert desk.stages == ["translating to C", "compiling", "holding it against Python"]
    assert desk.commands[0][3:] == [FILE] and desk.said == []
    assert not desk.build()  # it fits
    assert not (desk.library.parent / "library.new").exists()


def test_a_file_that_is_refused_stays_plain_with_its_first_reason(desk: Desk) -> None:
    (desk.root / "bus/can/wire.py").write_text("y = 2\n")
    refused = (
        "bus/can/wire.py:3: error: no generators\nbus/can/wire.py:9: error: nor this\nelse.py:1: error: x\n"
    )
    desk.ends = [Process(1, refused), Process()]
    assert desk.build()
    assert desk.said == ["bus/can/wire.py stays plain: no generators"]
    assert [command[3:] for command in desk.commands] == [[FILE, "bus/can/wire.py"], [FILE]]


def test_a_compiler_that_fails_is_told_with_its_last_words(desk: Desk) -> None:
    desk.ends = [Process(1, " ".join(f"w{k}" for k in range(50)))]
    with pytest.raises(BuildError) as caught:
        desk.build()
    assert str(caught.value) == "the compiler failed: " + " ".join(f"w{k}" for k in range(10, 50))
    assert not desk.library.exists()


def test_five_rounds_are_enough(desk: Desk) -> None:
    names = [f"bus/can/f{k}.py" for k in range(6)]
    for name in names:
        (desk.root / name).write_text("y = 2\n")
    desk.ends = [Process(1, f"{name}:1: TypeError: no\n") for name in names]
    with pytest.raises(BuildError, match=r"^mypyc refused files 5 times over$"):
        desk.build()
    assert len(desk.commands) == 5 and desk.said == [f"{name} stays plain: no" for name in names[:4]]


@pytest.mark.parametrize(
    ("need", "said"),
    [("mypyc", "mypyc is not installed (pip install mypy)"),
     ("setuptools", "setuptools is not installed (pip install setuptools)")],
)  # fmt: skip
def test_what_is_missing_is_said(desk: Desk, need: str, said: str) -> None:
    desk.missing = {need}
    with pytest.raises(BuildError) as caught:
        desk.build()
    assert str(caught.value) == said


def test_without_a_compiler_nothing_is_begun(desk: Desk) -> None:
    desk.patch.setattr(building, "compiler", lambda: False)
    with pytest.raises(BuildError, match=r"^there is no C compiler$"):
        desk.build()


@pytest.mark.parametrize(
    ("native", "said"),
    [(Process(1, "", "a\nlast line\n"), "it cannot be used: last line"),
     (Process(1), r"it cannot be used: \?"), (Process(0, "same"), ""),
     (Process(0, "other"), "its digest is not that of plain Python; please report it")],
)  # fmt: skip
def test_a_library_is_held_against_plain_python(desk: Desk, native: Process, said: str) -> None:
    desk.missing = set()
    desk.library.mkdir()
    desk.ends = [Process(), Process(0, "same"), native]
    if not said:
        assert desk.build()
        assert desk.commands[1] == ["-m", "scenarios.run.probe"] and len(desk.commands[2]) == 3
        return
    with pytest.raises(BuildError, match=f"^{said}$"):
        desk.build()
    assert not any(desk.library.iterdir())  # the one that was there is left alone


@pytest.mark.parametrize(("command", "there"), [("sh -O2", True), ("no-such-compiler -O2", False)])
def test_the_compiler_is_the_first_word_of_CC(
    command: str, there: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CC", command)
    assert compiler() is there


def test_another_python_runs_on_the_sources_alone(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    asked: list[Any] = []
    monkeypatch.setattr(subprocess, "Popen", lambda command, **more: asked.append((command, more)))
    monkeypatch.setenv("PYTHONPATH", "own")
    building._started(["-m", "x"], tmp_path, "1")
    monkeypatch.delenv("PYTHONPATH")
    building._started(["-m", "x"], tmp_path, "", subprocess.STDOUT)
    (command, first), (_, second) = asked
    assert command[1:] == ["-m", "x"] and first["cwd"] == tmp_path and first["text"] is True
    assert first["env"]["PYTHONPATH"] == f"{tmp_path}:own" and second["env"]["PYTHONPATH"] == str(tmp_path)
    assert (first["env"]["SCHMIDT_PURE"], second["env"]["SCHMIDT_PURE"]) == ("1", "")
    assert (first["stderr"], second["stderr"]) == (subprocess.PIPE, subprocess.STDOUT)
