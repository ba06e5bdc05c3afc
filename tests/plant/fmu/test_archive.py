"""The archive of an axis and the library within, with a compiler that is only asked."""

import os
import platform
import shutil
import subprocess
import sysconfig
import zipfile
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from plant import model
from plant.fmu import archive, library
from plant.fmu.library import FmuError
from plant.kernels import layout as at
from plant.world import Numbers
from tests.plant.test_world import NUMBERS, row


@pytest.fixture
def headers(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, int]]:
    """On a machine of a kind that is known, with a library that holds nothing."""
    asked: list[tuple[str, int]] = []

    def build(header: str, fmi: int) -> bytes:
        asked.append((header, fmi))
        return b"machine code"

    monkeypatch.setattr(archive, "build", build)
    monkeypatch.setattr(platform, "machine", lambda: "x86_64")
    monkeypatch.setattr(platform, "system", lambda: "Linux")
    return asked


@pytest.mark.parametrize(("fmi", "place"), [(2, "linux64"), (3, "x86_64-linux")])
def test_an_archive_has_a_description_a_library_and_the_plant_file(
    tmp_path: Path, headers: list[tuple[str, int]], fmi: int, place: str
) -> None:
    plant, file = model.load("low_preload"), tmp_path / "drive.fmu"
    made = archive.write(plant, "dec", 4, file, fmi)
    assert (made.axis, made.seed) == ("dec", 4)
    with zipfile.ZipFile(file) as inside:
        found = {each.filename: inside.read(each) for each in inside.infolist()}
        assert all(each.compress_type == zipfile.ZIP_DEFLATED for each in inside.infolist())
    library_file = f"binaries/{place}/axis.so"
    assert set(found) == {"modelDescription.xml", library_file, "resources/plant.yaml"}
    assert found[library_file] == b"machine code"
    assert model.loads(found["resources/plant.yaml"].decode()) == plant
    ((header, version),) = headers
    token = header.splitlines()[0].split('"')[1]
    assert version == fmi and f'"{token}"'.encode() in found["modelDescription.xml"]
    assert token[0] + token[-1] == "{}" and len(token) == 34
    int(token[1:-1], 16)


def test_a_token_is_another_one_for_another_version_or_another_number(
    tmp_path: Path, headers: list[tuple[str, int]]
) -> None:
    plant = model.load("low_preload")
    other = model.with_value(plant, "supply.voltage", 23.0)
    for made, fmi in ((plant, 3), (plant, 2), (other, 3), (plant, 3)):
        archive.write(made, "ra", 1, tmp_path / "a.fmu", fmi)
    tokens = [header.splitlines()[0] for header, _ in headers]
    assert tokens[0] == tokens[3] and len(set(tokens)) == 3


def test_version_3_unless_another_one_is_asked_for(tmp_path: Path, headers: list[tuple[str, int]]) -> None:
    archive.write(model.load("low_preload"), "ra", 1, tmp_path / "a.fmu")
    assert headers[0][1] == 3


def test_what_is_there_is_written_over_and_a_folder_is_refused(
    tmp_path: Path, headers: list[tuple[str, int]]
) -> None:
    (tmp_path / "a.fmu").write_bytes(b"old")
    archive.write(model.load("low_preload"), "ra", 1, tmp_path / "a.fmu")
    assert zipfile.is_zipfile(tmp_path / "a.fmu")
    with pytest.raises(FmuError, match="is no regular file, which an archive needs"):
        archive.write(model.load("low_preload"), "ra", 1, tmp_path)


def test_a_project_that_is_not_installed_has_no_version(
    tmp_path: Path, headers: list[tuple[str, int]], monkeypatch: pytest.MonkeyPatch
) -> None:
    def none(name: str) -> str:
        raise PackageNotFoundError(name)

    for version, words in ((lambda _: "4.5", "schmidt 4.5"), (none, "schmidt 0")):
        monkeypatch.setattr(archive, "version", version)
        archive.write(model.load("low_preload"), "ra", 1, tmp_path / "a.fmu")
        with zipfile.ZipFile(tmp_path / "a.fmu") as inside:
            assert f'generationTool="{words}"'.encode() in inside.read("modelDescription.xml")


@pytest.mark.parametrize(
    ("system", "machine", "good"),
    [("Linux", "x86_64", True), ("Linux", "aarch64", True), ("Linux", "riscv64", False),
     ("Darwin", "x86_64", False)],
)  # fmt: skip
def test_only_linux_of_two_kinds_has_a_library(
    monkeypatch: pytest.MonkeyPatch, system: str, machine: str, good: bool
) -> None:
    monkeypatch.setattr(platform, "machine", lambda: machine)
    monkeypatch.setattr(platform, "system", lambda: system)
    if good:
        assert archive._place(3) == f"binaries/{machine}-linux/axis.so"
        return
    with pytest.raises(FmuError, match=f"on Linux only, not on {system} {machine}"):
        archive._place(3)


Command = list[str]


@pytest.fixture
def compiler(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[Command]:
    """A compiler that is there, notes how it is called, and copies what it finds in its folder."""
    calls: list[Command] = []

    def run(command: Command, **options: Any) -> SimpleNamespace:
        assert options == {"capture_output": True, "text": True, "check": False}
        calls.append(command)
        folder = next(each[2:] for each in command if each.startswith("-I"))
        made = command[command.index("-o") + 1]
        Path(made).write_bytes(b"from " + Path(folder, "model.h").read_bytes())
        return SimpleNamespace(returncode=0, stderr="")

    monkeypatch.setattr(subprocess, "run", run)
    monkeypatch.setattr(library, "_kernels", lambda: [tmp_path / "one.o", tmp_path / "two.o"])
    monkeypatch.setattr(shutil, "which", lambda _: "/bin/cc")
    monkeypatch.setenv("CC", "cc -m64")
    return calls


@pytest.mark.parametrize("fmi", [2, 3])
def test_the_compiler_gets_the_header_the_wrapper_and_both_kernels(
    compiler: list[Command], tmp_path: Path, fmi: int
) -> None:
    assert library.build("a header", fmi) == b"from a header"
    (command,) = compiler
    assert command[:2] == ["cc", "-m64"] and f"-DFMI={fmi}" in command and command[-1] == "-lm"
    assert {"-shared", "-fPIC", "-ffp-contract=off", "-Wl,-z,defs"} <= set(command)
    assert [str(tmp_path / "one.o"), str(tmp_path / "two.o")] == command[-5:-3]
    assert command[-6].endswith("wrapper.c") and Path(command[-6]).exists()


def test_a_compiler_that_is_not_there_is_named(
    compiler: list[Command], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shutil, "which", lambda _: None)
    with pytest.raises(FmuError, match="needs a C compiler, and there is no cc here"):
        library.build("", 3)
    assert not compiler


def test_what_the_compiler_says_is_one_line_of_300_letters(
    compiler: list[Command], monkeypatch: pytest.MonkeyPatch
) -> None:
    def run(_: Command, **__: Any) -> SimpleNamespace:
        return SimpleNamespace(returncode=1, stderr="wrapper.c:\n  wrong\n" + "x" * 400)

    monkeypatch.setattr(subprocess, "run", run)
    with pytest.raises(FmuError) as caught:
        library.build("", 3)
    said = str(caught.value)
    assert said.startswith("cc: wrapper.c: wrong xxx") and len(said) == len("cc: ") + 300


def test_without_a_word_the_compiler_is_python_s_own(
    compiler: list[Command], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("CC")
    monkeypatch.setattr(sysconfig, "get_config_var", lambda _: "gcc-9")
    library.build("", 3)
    monkeypatch.setattr(sysconfig, "get_config_var", lambda _: None)
    library.build("", 3)
    assert [command[0] for command in compiler] == ["gcc-9", "cc"]


def test_kernels_are_compiled_once_and_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[str] = []

    def compiled(name: str, function: object, signature: object) -> bytes:
        assert callable(function)
        row = "Array(float64, 1, 'C', False, aligned=True)"
        assert (
            str(signature)
            == {"prepare": f"({row}, {row}) -> none", "advance": f"({row}, int64) -> none"}[
                name.removeprefix("kernel_")
            ]
        )
        made.append(name)
        return name.encode()

    monkeypatch.setattr(library, "_object", compiled)
    monkeypatch.setattr(library, "cache_folder", lambda: tmp_path)
    for _ in range(2):
        paths = library._kernels()
        assert [each.name for each in paths] == ["fmu-prepare.o", "fmu-advance.o"]
        assert [each.read_bytes() for each in paths] == [b"kernel_prepare", b"kernel_advance"]
    assert made == ["kernel_prepare", "kernel_advance"]
    assert sorted(os.listdir(tmp_path)) == ["fmu-advance.o", "fmu-prepare.o"]


def test_numbers_may_be_given_in_an_array() -> None:
    w, numbers = np.zeros(at.WIDTH), np.array(NUMBERS)
    library._from_array()(w, numbers)
    assert len(numbers) == len(Numbers._fields)
    assert np.array_equal(w, row())


def test_an_axis_is_advanced_by_its_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Sequence[object]] = []
    monkeypatch.setattr(library, "advance_axis", lambda w, steps: asked.append((w, steps)))
    w = np.zeros(3)
    library._advance(w, 7)
    assert asked == [(w, 7)]


def test_a_kernel_becomes_an_object_file_for_any_processor_of_this_kind(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Nothing of Python's calls is made; the text is checked, and its name is the one that C knows."""
    llvm, numba = pytest.importorskip("llvmlite.binding"), pytest.importorskip("numba")
    done: list[object] = []
    signature = object()

    def njit(given: object, **options: object) -> Any:
        assert given is signature
        done.append(options)
        code = SimpleNamespace(get_llvm_str=lambda: "define @long.name() { call @long.name() }")
        made = SimpleNamespace(library=code, fndesc=SimpleNamespace(llvm_func_name="long.name"))
        return lambda _: SimpleNamespace(signatures=["first"], overloads={"first": made})

    def parsed(text: str) -> SimpleNamespace:
        done.append(text)
        return SimpleNamespace(verify=lambda: done.append("checked"))

    def machine(**options: object) -> SimpleNamespace:
        done.append(options)
        return SimpleNamespace(emit_object=lambda _: bytearray(b"code"))

    monkeypatch.setattr(numba, "njit", njit)
    monkeypatch.setattr(llvm, "parse_assembly", parsed)
    target = SimpleNamespace(create_target_machine=machine)
    monkeypatch.setattr(llvm, "Target", SimpleNamespace(from_default_triple=lambda: target))
    assert library._object("kernel_some", lambda: None, signature) == b"code"
    assert done == [
        {"error_model": "numpy", "_nrt": False, "no_cpython_wrapper": True, "no_cfunc_wrapper": True},
        "define @kernel_some() { call @kernel_some() }",
        "checked",
        {"opt": 2, "reloc": "pic", "codemodel": "default"},
    ]
