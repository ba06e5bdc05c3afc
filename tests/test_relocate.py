"""A wheel's rooms lie below `schmidt`; a user's plant.py, bus/ and boards/ stay the user's."""

import os
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import pytest

from tests.docs.test_new_board import BOARDS, examples

ROOT = Path(__file__).parents[1]
SPEC = spec_from_file_location("build_of_schmidt", ROOT / "setup.py")
assert SPEC is not None and SPEC.loader is not None
BUILD = module_from_spec(SPEC)
SPEC.loader.exec_module(BUILD)
Run = Callable[..., subprocess.CompletedProcess[str]]


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("from plant.model import load\n", "from schmidt.plant.model import load\n"),
        ("from bus import protocol as p; x = 'ä'\n", "from schmidt.bus import protocol as p; x = 'ä'\n"),
        ("if 1:\n    from host.sky import (\n a)\n", "if 1:\n    from schmidt.host.sky import (\n a)\n"),
        ("import plant\n", "import schmidt.plant as plant\n"),
        ("import plant.model as m\n", "import schmidt.plant.model as m\n"),
        ("x = 'ö'; import bus # bus\n", "x = 'ö'; import schmidt.bus as bus # bus\n"),
        ("from busy import a\nfrom . import plant\n", "from busy import a\nfrom . import plant\n"),
        ('"""from plant import x"""\n', '"""from plant import x"""\n'),
    ],
)  # fmt: skip
def test_import_statements_are_rewritten_and_nothing_else(before: str, after: str) -> None:
    assert BUILD.rewritten(before) == after


@pytest.mark.parametrize("source", ["import plant.model\n", "import os, bus\n"])
def test_what_would_bind_another_name_is_refused(source: str) -> None:
    with pytest.raises(BUILD.RelocationError, match=r"x\.py:1"):
        BUILD.rewritten(source, "x.py")


@pytest.mark.slow
def test_every_file_of_the_rooms_can_be_rewritten() -> None:
    for room in BUILD.OURS:
        for file in (ROOT / room).rglob("*.py"):
            compile(BUILD.rewritten(file.read_text(encoding="utf-8"), str(file)), str(file), "exec")


def test_entry_points_follow() -> None:
    assert BUILD.entry_point("scenarios.cli:main") == "schmidt.scenarios.cli:main"
    assert BUILD.entry_point("other.cli:main") == "other.cli:main"


def user(folder: Path) -> Path:
    """A folder with modules that are called like ours and are not."""
    folder.mkdir()
    (folder / "plant.py").write_text("raise RuntimeError('the plant of the user')\n")
    for name in ("bus", "boards"):
        (folder / name).mkdir()
        (folder / name / "__init__.py").write_text("MINE = True\n")
    return folder


def run(folder: Path, path: list[Path], *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, path)), "SCHMIDT_PURE": "1"}
    command = [sys.executable, *arguments]
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=300, check=False
    )


COMMAND = """
import sys
from importlib.metadata import entry_points
(point,) = entry_points(group="console_scripts", name="schmidt")
sys.argv = ["schmidt", *sys.argv[1:]]
point.load()()
"""


def test_the_checkouts_command_takes_its_own_rooms(tmp_path: Path) -> None:
    mine = user(tmp_path / "mine")
    done = run(mine, [mine], "-c", "from scenarios.cli import main; main()", "effects", "play")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("play: ")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wheel, built of a copy of the sources and unpacked."""
    source = tmp_path_factory.mktemp("source")
    for room in BUILD.OURS:
        ignored = shutil.ignore_patterns("__pycache__", "library", "*.png")
        shutil.copytree(ROOT / room, source / room, ignore=ignored)
    for name in ("pyproject.toml", "setup.py", "schmidt.py", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, source)
    built = source / "wheel"
    options = ["--quiet", "--no-deps", "--no-build-isolation", "--no-index", "--wheel-dir", str(built)]
    done = run(source, [], "-m", "pip", "wheel", *options, str(source))
    assert done.returncode == 0, done.stderr
    (wheel,) = built.glob("*.whl")
    unpacked = tmp_path_factory.mktemp("site")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(unpacked)
    return unpacked


@pytest.mark.slow
def test_a_wheel_has_one_top_level_name(site: Path) -> None:
    (metadata,) = site.glob("*.dist-info")
    assert {each.name for each in site.iterdir()} == {"schmidt", metadata.name}
    assert (metadata / "top_level.txt").read_text().split() == ["schmidt"]


@pytest.mark.slow
def test_the_installed_command_among_a_users_modules(site: Path, tmp_path: Path) -> None:
    mine = user(tmp_path / "mine")
    done = run(mine, [mine, site], "-c", COMMAND, "conformance", "--board", "display:0x51")
    told = [line for line in done.stderr.splitlines() if "time left" not in line]  # a slow machine's progress
    assert (done.returncode, told) == (0, [])
    assert "0 errors" in done.stdout


@pytest.mark.slow
def test_the_installed_command_finds_scenarios_and_plants_by_name(site: Path, tmp_path: Path) -> None:
    mine = user(tmp_path / "mine")
    words = ("run", "quick-look", "--plant", "low_preload_bridge", "--no-report", "--out", "out")
    done = run(mine, [mine, site], "-c", COMMAND, *words)
    assert done.returncode == 0, done.stdout + done.stderr
    assert (mine / "out" / "can.log").stat().st_size > 0
    wrong = run(mine, [mine, site], "-c", COMMAND, "run", "quick-lok")
    assert "did you mean 'quick-look'?" in wrong.stderr


@pytest.mark.slow
def test_the_installed_command_runs_the_guides_boards(site: Path, tmp_path: Path) -> None:
    """With the page's word for an installation: `schmidt.` before the rooms."""
    mine = user(tmp_path / "mine")
    for name, text in examples().items():
        (mine / name).write_text(BUILD.rewritten(text) if name.endswith(".py") else text, encoding="utf-8")
    for name in BOARDS:
        done = run(mine, [mine, site], "-c", COMMAND, "run", f"{name}.yaml", "--no-report", "--out", name)
        assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.slow
def test_the_installed_kit_among_a_users_modules(site: Path, tmp_path: Path) -> None:
    mine = user(tmp_path / "mine")
    (mine / "conftest.py").write_text(
        "from schmidt.bus.registry import publish\n"
        "from schmidt.scenarios.lab.wiring import network\n"
        "made = network()\n"
        "publish('bench', made.wire)\n"
    )
    (mine / "test_mine.py").write_text(
        "import boards, bus\n"
        "def test_mine(conformance_bus, board):\n"
        "    assert bus.MINE and boards.MINE and board.device == 0x51\n"
        "    assert conformance_bus.recv(2.0) is not None\n"
        "def test_lab(lab):\n"
        "    import schmidt\n"
        "    assert type(lab) is schmidt.Lab and lab.run('5 ms').now_s == 0.005\n"
    )
    options = ["-q", "-p", "no:cacheprovider", "--can", "schmidt:bench", "--can-stamps", "0"]
    done = run(mine, [mine, site], "-m", "pytest", *options, "--board", "display:0x51")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "27 passed, 3 skipped" in done.stdout  # no motion, wrong state or sequence on a display
    wrong = run(mine, [mine, site], "-m", "pytest", *options, "--board", "display")
    assert wrong.returncode == pytest.ExitCode.USAGE_ERROR
    assert "expected TYPE:ID" in wrong.stderr
    absent = run(mine, [mine, site], "-m", "pytest", *options, "--board", "display:0x52")
    assert absent.returncode == pytest.ExitCode.TESTS_FAILED
    assert "conformance[DISPLAY:0x52-answers]" in absent.stdout
