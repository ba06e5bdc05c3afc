"""The cache of compiled code: never stale, and never in the way."""

from pathlib import Path
from typing import Any

import numba
import numpy as np
import pytest

from plant import compiled


def test_cache_folder_is_named_after_the_sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(compiled.BASE, str(tmp_path))
    before = compiled.cache_folder()
    assert before.parent == tmp_path
    assert compiled.cache_folder() == before
    room = tmp_path / "room"
    room.mkdir()
    (room / "kernel.py").write_text("from plant.compiled import entry\n")
    monkeypatch.setattr(compiled, "ROOM", room)
    first = compiled.cache_folder()
    (room / "kernel.py").write_text("from plant.compiled import entry  # changed\n")
    assert len({before, first, compiled.cache_folder()}) == 3


def test_cache_folder_falls_back_to_a_temporary_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    for word in (compiled.BASE, "XDG_CACHE_HOME"):
        monkeypatch.setenv(word, str(blocked / word))
    folder = compiled.cache_folder()
    assert folder.is_dir()
    assert tmp_path not in folder.parents
    folder.rmdir()


@compiled.inner
def _add(row: compiled.Floats, more: float) -> None:
    row[0] += more


def _each_row(world: compiled.Floats, more: float) -> None:
    for k in range(world.shape[0]):
        _add(world[k], more)


def _references(function: Any) -> int:
    """Calls that count references in the machine code of `function`, compiled here and now."""
    llvm: str = function.inspect_llvm(function.signatures[0])
    return sum("call" in line and "NRT_" in line for line in llvm.splitlines())


def test_kernels_count_no_references() -> None:
    """numba's private option `_nrt` still does what plant/compiled.py uses it for."""
    kernel, counting = compiled._njit(_each_row, _nrt=False), compiled._njit(_each_row)
    for function in (kernel, counting):
        world = np.zeros((3, 2))
        function(world, 2.0)
        assert world.tolist() == [[2.0, 0.0]] * 3
    assert _references(kernel) == 0
    assert _references(counting) > 0, "the search finds them where they are"


def test_a_kernel_that_allocates_is_refused_by_the_compiler() -> None:
    def allocates(count: int) -> float:
        return float(np.zeros(count).sum())

    with pytest.raises(numba.core.errors.NumbaError):
        compiled._njit(allocates, _nrt=False)(3)


def test_inner_functions_are_compiled_into_their_callers() -> None:
    kernel: Any = compiled._njit(_each_row, _nrt=False)
    kernel(np.zeros((1, 1)), 1.0)
    calls = [line for line in kernel.inspect_llvm(kernel.signatures[0]).splitlines() if " call " in line]
    assert not [line for line in calls if "_add" in line]
