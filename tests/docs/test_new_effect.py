"""docs/guides/new-effect.md: each kind of effect is four files, sixty lines; named and written back."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "guides" / "new-effect.md"
COUNT = 1  # line of FIDELITY.md that says how many effects there are, and is changed beside the new row
NEEDED = ("tests/__init__.py", "tests/calibration/__init__.py", "tests/calibration/logs.py")


def recipes() -> dict[str, dict[str, str]]:
    """Of every effect of the page, its files in order: path -> text; of FIDELITY.md the new row."""
    out = {}
    for part in PAGE.read_text(encoding="utf-8").split("\n## ")[1:]:
        files = dict(re.findall(r"^\*\*`(\S+)`\*\*.*?```\w+\n(.*?)```", part, re.DOTALL | re.MULTILINE))
        if files:
            out[Path(next(iter(files))).stem] = files
    return out


RECIPES = recipes()


def test_a_torque_an_effect_on_a_stage_and_one_of_friction() -> None:
    hooks = {
        name: re.findall(r"Hook\.(\w+)", files[f"plant/effects/{name}.py"])[0]
        for name, files in RECIPES.items()
    }
    staged = {name for name, files in RECIPES.items() if "stages=" in files[f"plant/effects/{name}.py"]}
    assert hooks == {"eddy_brake": "AXIS_TORQUE", "loose_key": "AXIS_TORQUE", "dry_sector": "FRICTION"}
    assert staged == {"loose_key"}


@pytest.mark.parametrize("name", RECIPES)
def test_four_files_and_sixty_lines(name: str) -> None:
    lines = [line for text in RECIPES[name].values() for line in text.splitlines() if line.strip()]
    assert list(RECIPES[name]) == [
        f"plant/effects/{name}.py",
        f"calibration/names/{name}.py",
        "FIDELITY.md",
        f"tests/calibration/test_{name}.py",
    ]
    assert len(lines) + COUNT <= 60


@pytest.mark.parametrize("name", RECIPES)
def test_the_row_fits_its_table(name: str) -> None:
    effects = (ROOT / "FIDELITY.md").read_text(encoding="utf-8").split("## Effects")[1].split("\n## ")[0]
    header = next(line for line in effects.splitlines() if line.startswith("|"))
    assert RECIPES[name]["FIDELITY.md"].count("|") == header.count("|")


@pytest.mark.slow
def test_they_are_simulated_named_and_written_back(tmp_path: Path) -> None:
    """In a copy of the project, compiled anew: nothing but the files of the page is added."""
    for room in ("plant", "calibration"):
        shutil.copytree(ROOT / room, tmp_path / room, ignore=shutil.ignore_patterns("__pycache__"))
    for needed in NEEDED:
        (tmp_path / needed).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / needed, tmp_path / needed)
    for name, text in ((name, text) for files in RECIPES.values() for name, text in files.items()):
        if name.endswith(".py"):
            assert not (tmp_path / name).exists()
            (tmp_path / name).write_text(text, encoding="utf-8")
    here = {"PYTHONPATH": str(tmp_path), "SCHMIDT_CACHE_DIR": str(tmp_path / "compiled")}
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--rootdir", str(tmp_path)]
    done = subprocess.run(
        [*command, *(f"tests/calibration/test_{name}.py" for name in RECIPES)],
        cwd=tmp_path,
        env={**os.environ, **here},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0 and "3 passed" in done.stdout, done.stdout + done.stderr
