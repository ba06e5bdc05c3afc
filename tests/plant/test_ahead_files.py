"""Which sources the library's name follows, and how it is found; nothing is compiled here."""

import importlib.util
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from plant import ahead, builder, compiled
from plant.kernels import advance


@pytest.fixture
def library(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Path]:
    """An empty folder of libraries."""
    monkeypatch.setattr(ahead, "LIBRARY", tmp_path / "library")
    (tmp_path / "library").mkdir()
    ahead._library.cache_clear()
    yield tmp_path / "library"
    ahead._library.cache_clear()


def test_the_name_follows_every_source_of_compiled_code_and_no_other(tmp_path: Path) -> None:
    def written(name: str, text: str) -> str:
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
        return ahead.fingerprint(tmp_path)

    seen = [ahead.fingerprint(tmp_path)]
    for name, text in (
        ("a.py", "from plant.compiled import inner"),
        ("b.py", "import plant.kernels.step"),
        ("kernels/c.py", ""),
        ("effects/d.py", ""),
        ("kernels/c.py", "X = 1"),
        ("e.py", "from plant.compiled import inner"),  # the text of a.py at another place
    ):
        seen.append(written(name, text))
        assert len(set(seen)) == len(seen), name
    for name, text in (("other.py", "import plant"), ("files/c.py", ""), ("kernels/c.txt", "X = 2")):
        assert written(name, text) == seen[-1], name
    assert all(len(each) == 16 for each in seen)


def test_a_library_is_loaded_once_and_asked_for_its_kernels(library: Path) -> None:
    assert ahead.find("advance") is None
    ahead._library.cache_clear()
    name = ahead.file().name
    assert ahead.file().parent == library and name.startswith(f"kernels-{ahead.fingerprint()}")
    assert name.endswith((".so", ".pyd"))


def test_a_kernel_is_that_of_the_library(library: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    source = library / "kernels.py"
    source.write_text("def advance(world, steps):\n    return (world, steps)\n\n\ncontrol_loop = advance\n")
    monkeypatch.setattr(ahead, "file", lambda: source)
    found = ahead.find("advance")
    assert found is not None and found(1, 2) == (1, 2)
    assert ahead.find("advance") is found
    assert ahead.find("control_loop") is None, "it is not compiled beforehand, whatever is there"


@pytest.mark.parametrize("missing", ["numba.pycc", "setuptools", "numba"])
def test_what_is_not_installed_is_named(library: Path, monkeypatch: pytest.MonkeyPatch, missing: str) -> None:
    def find_spec(name: str) -> object:
        if missing == "numba" and name == "numba.pycc":
            raise ModuleNotFoundError(name)
        return None if name == missing else object()

    monkeypatch.setattr(importlib.util, "find_spec", find_spec)
    word = "numba.pycc" if missing == "numba" else missing
    with pytest.raises(builder.AheadError, match=rf"^{word} is not installed$"):
        builder.build()
    assert not any(library.iterdir())


def test_the_compiler_is_asked_for_what_a_network_calls(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    calls: list[tuple[str, str, Callable[..., Any]]] = []

    class CC:
        output_file = "made.so"
        output_dir = ""
        use_nrt = True
        compiled = False

        def __init__(self, name: str, module: str) -> None:
            assert (name, module) == ("kernels", advance.__name__)
            made.append(self)

        def export(self, name: str, signature: str) -> Callable[[Callable[..., Any]], None]:
            return lambda function: calls.append((name, signature, function))

        def compile(self) -> None:
            assert self.output_dir == str(tmp_path) and calls
            self.compiled = True

    def imported(name: str) -> SimpleNamespace:
        assert name == "numba.pycc"
        warnings.warn("is to move", PendingDeprecationWarning, stacklevel=2)
        return SimpleNamespace(CC=CC)

    made: list[CC] = []
    monkeypatch.setattr(importlib, "import_module", imported)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert builder._compile(tmp_path) == tmp_path / "made.so"
    assert made[0].compiled and not made[0].use_nrt
    assert calls == [("advance", "void(float64[:, ::1], int64)", compiled.KERNELS["advance"])]
