"""A library that does not fit is never used, and never without a word."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from scenarios.native import build, finder, stamp
from scenarios.native.modules import ROOT, selected

SOURCE = "from typing import Final\n\nLIMIT: Final = 3\n"


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A small checkout: one module to compile, and one of ours that it imports from."""
    for folder in ("bus/time", "bus/can", "boards", "scenarios"):
        (tmp_path / folder).mkdir(parents=True)
        (tmp_path / folder / "__init__.py").touch()
    (tmp_path / "bus" / "__init__.py").touch()
    (tmp_path / "bus" / "time" / "limits.py").write_text(SOURCE)
    (tmp_path / "scenarios" / "units.py").write_text("NS = 1\n")
    (tmp_path / "bus" / "can" / "wire.py").write_text("from scenarios.units import NS\n\nWIDTH = NS\n")
    return tmp_path


@pytest.fixture
def path() -> Iterator[None]:
    before = list(sys.meta_path)
    yield
    sys.meta_path[:] = before


def write(library: Path, stamped: dict[str, object]) -> None:
    library.mkdir(exist_ok=True)
    (library / stamp.STAMP).write_text(json.dumps({**stamped, "modules": {}}))


def test_a_library_fits_the_files_it_was_made_of_and_no_others(tree: Path) -> None:
    made = stamp.make(tree)
    assert stamp.difference(made, tree) is None
    (tree / "bus" / "time" / "limits.py").write_text(SOURCE.replace("3", "4"))
    assert stamp.difference(made, tree) == "was built before bus/time/limits.py changed"
    (tree / "bus" / "time" / "limits.py").write_text(SOURCE)
    (tree / "scenarios" / "units.py").write_text("NS = 2\n")
    assert stamp.difference(made, tree) == "was built before scenarios/units.py changed"
    (tree / "scenarios" / "units.py").write_text("NS = 1\n")
    (tree / "boards" / "new.py").touch()
    assert stamp.difference(made, tree) == "was built before boards/new.py came"
    (tree / "boards" / "new.py").unlink()
    (tree / stamp.CHOICE).parent.mkdir()
    (tree / stamp.CHOICE).write_text("PLAIN = ()\n")
    assert stamp.difference(made, tree) == f"was built before {stamp.CHOICE} changed"
    (tree / stamp.CHOICE).unlink()
    (tree / "bus" / "can" / "wire.py").unlink()
    assert stamp.difference(made, tree) == "was built before bus/can/wire.py changed"
    assert "another Python" in str(stamp.difference({**made, "suffix": ".cpython-38.so"}, tree))


def test_modules_that_look_beside_themselves_stay_plain(tree: Path) -> None:
    (tree / "bus" / "can" / "file.py").write_text("from pathlib import Path\n\nHERE = Path(__file__)\n")
    assert selected(tree) == ["bus/can/wire.py", "bus/time/limits.py"]


def test_what_is_selected_is_there() -> None:
    chosen = selected()
    assert {"bus/can/wire.py", "boards/axis/firmware.py", "plant/axis.py", "host/link.py"} <= set(chosen)
    assert "bus/protocol/database.py" not in chosen
    assert all((ROOT / path).is_file() for path in chosen)


def test_a_stale_library_is_said_in_one_line_and_left_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], path: None
) -> None:
    monkeypatch.setenv(finder.PURE, "")
    sys.meta_path[:] = [each for each in sys.meta_path if not isinstance(each, finder.Finder)]
    write(tmp_path, {**stamp.make(), "suffix": ".other"})
    finder.use(tmp_path)
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "running plain" in said
    assert not finder.compiled()
    monkeypatch.setenv(finder.PURE, "0")
    with pytest.raises(ImportError, match="another Python"):
        finder.use(tmp_path)
    with pytest.raises(ImportError, match="is not there"):
        finder.use(tmp_path / "nowhere")


def test_without_a_library_nothing_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for word in ("", "1"):
        monkeypatch.setenv(finder.PURE, word)
        finder.use(tmp_path)
    assert not capsys.readouterr().err


def test_nothing_is_built_when_nothing_changed(tree: Path, tmp_path: Path) -> None:
    library = tmp_path / "library"
    write(library, stamp.make(tree))
    assert not build.build(library, root=tree)


def test_without_a_compiler_the_reason_is_one_line(tree: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(build.BuildError, match="no C compiler"):
        build.build(tree / "library", root=tree)


def test_a_machine_without_a_compiler_hears_of_it_once(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "scenarios.native"],
        cwd=ROOT,
        env={**os.environ, "PATH": str(tmp_path), "SCHMIDT_PURE": "1", "CC": "no-such-compiler"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert not done.stderr
    assert done.stdout in ("", "schmidt: not compiled, running plain Python: there is no C compiler\n")


def test_who_insists_on_a_library_that_does_not_fit_reads_one_line(tmp_path: Path) -> None:
    program = (
        "import sys; import scenarios.native.finder as f; f.use.__defaults__ = (__import__('pathlib')"
        ".Path(sys.argv[1]),); import importlib, os; os.environ['SCHMIDT_PURE'] = '0';"
        "import scenarios; importlib.reload(scenarios)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program, str(tmp_path)],
        cwd=ROOT,
        env={**os.environ, "SCHMIDT_PURE": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1
    assert done.stderr.startswith("schmidt: the compiled library is not there")
    assert done.stderr.count("\n") == 1


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_a_module_that_mypyc_refuses_stays_plain_and_the_others_are_compiled(tree: Path) -> None:
    """`in` with a starred tuple ends mypyc 2.4 in the middle; the rest must not suffer."""
    if not build.compiler():
        pytest.skip("there is no C compiler")
    (tree / "scenarios" / "run").mkdir()
    (tree / "scenarios" / "run" / "__init__.py").touch()
    (tree / "scenarios" / "run" / "probe.py").write_text("print('the same')\n")
    (tree / "scenarios" / "native").mkdir()
    for file in (ROOT / "scenarios" / "native").glob("*.py"):
        (tree / "scenarios" / "native" / file.name).write_text(file.read_text())
    (tree / "boards" / "bad.py").write_text(
        "A = (1, 2)\n\n\ndef known(x: int) -> bool:\n    return x in (*A, 3)\n"
    )
    said: list[str] = []
    assert build.build(tree / "library", said.append, tree)
    assert len(said) == 1
    assert said[0].startswith("boards/bad.py stays plain: ")
    program = (
        "from scenarios.native import finder; from pathlib import Path; finder.use(Path('library'));"
        "import boards.bad, bus.time.limits; print(boards.bad.__file__, bus.time.limits.__file__)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=tree,
        env={"PYTHONPATH": str(tree), "SCHMIDT_PURE": "", "PATH": "/usr/bin:/bin"},
        capture_output=True,
        text=True,
        check=True,
    )
    bad, limits = done.stdout.split()
    assert bad.endswith("bad.py")
    assert limits.endswith(stamp.suffix())


def test_declared_boards_that_inherit_their_constructor_stay_plain() -> None:
    """Compiled, mypyc's would run twice: two ports of one board on the wire."""
    firmware = {path for path in selected() if path.endswith("/firmware.py")}
    assert "boards/axis/firmware.py" in firmware
    for path in sorted((ROOT / "boards").glob("*/firmware.py")):
        if "(DeclaredBoard)" in path.read_text(encoding="utf-8"):
            assert path.relative_to(ROOT).as_posix() not in firmware, path
