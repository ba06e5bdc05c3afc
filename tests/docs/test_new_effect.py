"""docs/new-effect.md does what it says: four files, sixty lines; simulated, named and written back."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "new-effect.md"
COUNT = 1  # line of FIDELITY.md that says how many effects there are, and is changed beside the new row
NEEDED = ("tests/__init__.py", "tests/calibration/__init__.py", "tests/calibration/logs.py")


def blocks() -> dict[str, str]:
    """Files of the page, in its order: path -> text; of FIDELITY.md the row that is added."""
    text = PAGE.read_text(encoding="utf-8")
    return dict(re.findall(r"^\*\*`(\S+)`\*\*.*?```\w+\n(.*?)```", text, re.DOTALL | re.MULTILINE))


def test_four_files_and_sixty_lines() -> None:
    lines = [line for text in blocks().values() for line in text.splitlines() if line.strip()]
    assert list(blocks()) == [
        "plant/effects/eddy_brake.py",
        "calibration/names/eddy_brake.py",
        "FIDELITY.md",
        "tests/calibration/test_eddy_brake.py",
    ]
    assert len(blocks()) <= 4 and len(lines) + COUNT <= 60


def test_the_row_fits_its_table() -> None:
    effects = (ROOT / "FIDELITY.md").read_text(encoding="utf-8").split("## Effects")[1].split("\n## ")[0]
    header = next(line for line in effects.splitlines() if line.startswith("|"))
    assert blocks()["FIDELITY.md"].count("|") == header.count("|")


@pytest.mark.slow
def test_it_is_simulated_named_and_written_back(tmp_path: Path) -> None:
    """In a copy of the project, compiled anew: nothing but the files of the page is added."""
    for room in ("plant", "calibration"):
        shutil.copytree(ROOT / room, tmp_path / room, ignore=shutil.ignore_patterns("__pycache__"))
    for name in NEEDED:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    for name, text in blocks().items():
        if name.endswith(".py"):
            assert not (tmp_path / name).exists()
            (tmp_path / name).write_text(text, encoding="utf-8")
    here = {"PYTHONPATH": str(tmp_path), "SCHMIDT_CACHE_DIR": str(tmp_path / "compiled")}
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--rootdir", str(tmp_path)]
    done = subprocess.run(
        [*command, "tests/calibration/test_eddy_brake.py"],
        cwd=tmp_path,
        env={**os.environ, **here},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0 and "1 passed" in done.stdout, done.stdout + done.stderr
