"""The compiler's process and the command that builds, over a compiler and a builder that are stand-ins."""

import os
import runpy
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from plant import builder
from scenarios.native import __main__ as command
from scenarios.native import compile as compiling
from scenarios.native.build import BuildError


class Compiler:
    """mypyc and setuptools. asked: their words; extensions: of two modules."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.asked: dict[str, Any] = {}
        self.setup: dict[str, Any] = {}
        self.extensions = [
            SimpleNamespace(extra_compile_args=["-O2"], extra_link_args=None),
            SimpleNamespace(extra_compile_args=["-O2"], extra_link_args=["-lm"]),
        ]
        monkeypatch.setitem(sys.modules, "mypyc.build", SimpleNamespace(mypycify=self.mypycify))
        monkeypatch.setitem(sys.modules, "setuptools", SimpleNamespace(setup=self.setup.update))

    def mypycify(self, words: list[str], **more: str) -> list[Any]:
        self.asked = {"words": words, **more}
        return self.extensions


@pytest.mark.parametrize("platform", ["linux", "darwin"])
def test_sources_become_one_library(
    platform: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """On Linux calls within it do not go through the linker's table."""
    made = Compiler(monkeypatch)
    monkeypatch.setattr(sys, "platform", platform)
    monkeypatch.setattr(os, "cpu_count", lambda: 3)
    compiling.main(tmp_path, ["a.py", "b.py"])
    version = f"{sys.version_info.major}.{sys.version_info.minor}"
    assert made.asked["words"][0] == f"--python-version={version}"
    assert made.asked["words"][-2:] == ["a.py", "b.py"]
    assert f"--cache-dir={tmp_path}/cache" in made.asked["words"]
    assert (made.asked["target_dir"], made.asked["group_name"]) == (f"{tmp_path}/c", "schmidt")
    assert (made.asked["opt_level"], made.asked["debug_level"]) == ("2", "0")
    assert capsys.readouterr().out == "schmidt: translated\n"
    folders = [f"--build-lib={tmp_path}/library", f"--build-temp={tmp_path}/o"]
    words = ["--quiet", "build_ext", "--parallel=3", *folders]
    assert made.setup["script_args"] == words and made.setup["ext_modules"] == made.extensions
    one, two = made.extensions
    if platform == "linux":
        inside = ["-fvisibility=hidden", "-fno-semantic-interposition", "-fno-plt"]
        assert one.extra_compile_args == two.extra_compile_args == ["-O2", *inside]
        assert (one.extra_link_args, two.extra_link_args) == (["-Wl,-z,now"], ["-lm", "-Wl,-z,now"])
    else:
        assert one.extra_compile_args == ["-O2"] and one.extra_link_args is None


def test_nobody_knows_how_many_cores(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = Compiler(monkeypatch)
    monkeypatch.setattr(os, "cpu_count", lambda: None)
    compiling.main(tmp_path, [])
    assert "--parallel=1" in made.setup["script_args"]


def test_as_a_program_it_takes_a_folder_and_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = Compiler(monkeypatch)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["compile", "there", "a.py", "b.py"])
    runpy.run_path(compiling.__file__, run_name="__main__")
    assert made.asked["words"][-2:] == ["a.py", "b.py"] and made.asked["target_dir"] == f"{tmp_path}/there/c"


class Desk:
    """The command that builds; made: whether kernel and library are new."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.kernel: bool | Exception = False
        self.library: bool | Exception = False
        self.there = True
        self.stages: list[str] = []
        self.usual: dict[str, float] = {}
        clock = iter([100.0, 131.4])
        monkeypatch.setattr(command, "stages", self.show)
        monkeypatch.setattr(command, "compiler", lambda: self.there)
        monkeypatch.setattr(command, "build", self.build)
        monkeypatch.setattr(builder, "build", lambda: self.given(self.kernel))
        monkeypatch.setattr(command, "time", SimpleNamespace(perf_counter=clock.__next__))
        monkeypatch.setattr(sys, "argv", ["native"])

    @contextmanager
    def show(self, _title: str, usual: dict[str, float]) -> Iterator[Callable[[str], None]]:
        self.usual = usual
        yield self.stages.append

    def build(self, say: Callable[[str], None], stage: Callable[[str], None]) -> bool:
        for name in list(self.usual)[1:]:
            stage(name)
        say("x.py stays plain: no")
        return self.given(self.library)

    @staticmethod
    def given(answer: bool | Exception) -> bool:
        if isinstance(answer, Exception):
            raise answer
        return answer


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch) -> Desk:
    return Desk(monkeypatch)


PLAIN = "schmidt: x.py stays plain: no\n"


@pytest.mark.parametrize(("kernel", "library", "new"), [
    (False, False, False), (True, False, True), (False, True, True), (True, True, True),
])  # fmt: skip
def test_what_is_new_is_told_with_its_time(
    kernel: bool, library: bool, new: bool, desk: Desk, capsys: pytest.CaptureFixture[str]
) -> None:
    desk.kernel, desk.library = kernel, library
    assert command.main() == 0
    assert capsys.readouterr().out == PLAIN + ("schmidt: compiled in 31 s\n" if new else "")
    assert desk.stages == ["translating to C", "compiling", "holding it against Python"]


def test_a_kernel_may_be_compiled_later(desk: Desk, capsys: pytest.CaptureFixture[str]) -> None:
    desk.kernel = builder.AheadError("no compiler of its own")
    assert command.main() == 0
    later = "schmidt: the plant's kernel will be compiled when it is first needed: no compiler of its own\n"
    assert capsys.readouterr().out == later + PLAIN


def test_without_a_compiler_no_kernel_is_begun(desk: Desk) -> None:
    desk.there, desk.kernel = False, RuntimeError("begun")
    assert command.main() == 0


@pytest.mark.parametrize(("words", "status"), [(["native"], 0), (["native", "--strict"], 1)])
def test_a_library_that_cannot_be_is_a_failure_where_that_is_meant(
    words: list[str], status: int, desk: Desk, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    desk.library = BuildError("there is no C compiler")
    monkeypatch.setattr(sys, "argv", words)
    assert command.main() == status
    said = "schmidt: not compiled, running plain Python: there is no C compiler\n"
    assert capsys.readouterr().out == PLAIN + said
