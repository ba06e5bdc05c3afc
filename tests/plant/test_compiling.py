"""How functions are asked to be compiled, and where the machine code is kept; nothing is compiled here."""

import atexit
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
import pytest

from plant import ahead, compiled

Options = dict[str, Any]


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[Options]:
    """Options that numba is given, which returns functions as they are."""
    found: list[Options] = []

    def njit(**options: Any) -> Callable[..., Any]:
        found.append(options)
        return lambda function: function

    monkeypatch.setattr(numba, "njit", njit)
    monkeypatch.setattr(numba.config, "CACHE_DIR", "before", raising=False)
    monkeypatch.setattr(compiled, "KERNELS", {})
    monkeypatch.setattr(compiled, "cache_folder", lambda: tmp_path)
    return found


def some(number: float) -> float:
    return 2.0 * number


def test_a_kernel_counts_no_references_and_is_kept(asked: list[Options], tmp_path: Path) -> None:
    assert compiled.kernel(some) is some
    assert asked == [{"error_model": "numpy", "cache": True, "_nrt": False}]
    assert {"some": some} == compiled.KERNELS
    assert str(tmp_path) == numba.config.CACHE_DIR  # type: ignore[attr-defined]


def test_a_kernel_of_the_library_is_taken_from_there(
    asked: list[Options], monkeypatch: pytest.MonkeyPatch
) -> None:
    def made(number: float) -> float:
        return number

    monkeypatch.setattr(ahead, "find", lambda name: made if name == "some" else None)
    assert compiled.kernel(some) is made and not asked
    assert {"some": some} == compiled.KERNELS


def test_an_entry_may_allocate_and_is_kept(asked: list[Options], tmp_path: Path) -> None:
    assert compiled.entry(some) is some
    assert asked == [{"error_model": "numpy", "cache": True}]
    assert str(tmp_path) == numba.config.CACHE_DIR  # type: ignore[attr-defined]


def test_an_inner_function_is_compiled_into_its_caller_once(asked: list[Options]) -> None:
    made: Any = compiled.inner(some)
    assert made(4.0) == 8.0 and made.py_func is some and made.__name__ == "some"
    assert not asked, "as long as nothing calls it"
    assert made.compiled is made.compiled is some
    assert asked == [
        {
            "error_model": "numpy", "no_cpython_wrapper": True, "no_cfunc_wrapper": True,
            "forceinline": True, "_nrt": False,
        }
    ]  # fmt: skip
    assert numba.config.CACHE_DIR == "before", "it has no cache of its own"  # type: ignore[attr-defined]


@pytest.fixture
def places(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    for name in (compiled.BASE, "NUMBA_CACHE_DIR", "XDG_CACHE_HOME", "HOME"):
        monkeypatch.delenv(name, raising=False)
    return monkeypatch


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({"SCHMIDT_CACHE_DIR": "a", "NUMBA_CACHE_DIR": "b", "HOME": "c"}, "a"),
        ({"NUMBA_CACHE_DIR": "b", "XDG_CACHE_HOME": "d"}, "b"),
        ({"XDG_CACHE_HOME": "d", "HOME": "c"}, "d/schmidt"),
        ({"XDG_CACHE_HOME": "d"}, "d/schmidt"),
        ({"HOME": "c"}, "c/.cache/schmidt"),
        ({"SCHMIDT_CACHE_DIR": "blocked/x", "HOME": "c"}, "c/.cache/schmidt"),
    ],
)
def test_compiled_code_lies_in_the_first_folder_that_can_be_written(
    places: pytest.MonkeyPatch, tmp_path: Path, given: dict[str, str], expected: str
) -> None:
    (tmp_path / "blocked").write_text("no folder")
    for name, word in given.items():
        places.setenv(name, str(tmp_path / word))
    folder = compiled.cache_folder()
    assert folder.parent == tmp_path / expected and folder.is_dir()
    head, _, digest = folder.name.partition("-")
    assert head == "compiled" and len(digest) == 16
    int(digest, 16)
    assert not any(folder.iterdir()), "nothing is left of the trial"


def test_without_a_place_of_its_own_it_is_a_folder_that_goes(
    places: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    left: list[tuple[Any, ...]] = []
    places.setattr(atexit, "register", lambda *call, **options: left.append((*call, options)))
    places.setattr(tempfile, "tempdir", str(tmp_path))
    folder = compiled.cache_folder()
    assert folder.parent == tmp_path and folder.name.startswith("schmidt-compiled-")
    ((remove, path, options),) = left
    remove(path, **options)
    assert path == folder and not folder.exists() and options == {"ignore_errors": True}


def test_another_compiler_has_another_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its version is part of the name."""
    before = compiled._fingerprint()
    monkeypatch.setattr(compiled, "version", lambda name: f"{name} 99")
    assert compiled._fingerprint() != before and len(before) == 16
