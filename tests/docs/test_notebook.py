"""docs/guides/lab.ipynb: every cell is run, in order, and prints what the notebook shows."""

import io
import json
import os
import subprocess
import sys
from contextlib import redirect_stdout
from typing import Any

import pytest

from tests.docs.guides import GUIDES, run, steps, write_files
from tests.doors.process import ROOT

NOTEBOOK = json.loads((GUIDES / "lab.ipynb").read_text(encoding="utf-8"))


def test_it_is_a_notebook_as_jupyter_writes_them() -> None:
    assert (NOTEBOOK["nbformat"], NOTEBOOK["nbformat_minor"]) == (4, 5)
    names = [cell["id"] for cell in NOTEBOOK["cells"]]
    assert len(set(names)) == len(names)
    for cell in NOTEBOOK["cells"]:
        fields = {"cell_type", "id", "metadata", "source"}
        assert set(cell) == fields | (
            {"execution_count", "outputs"} if cell["cell_type"] == "code" else set()
        )


def test_every_cell_prints_what_it_shows(monkeypatch: Any) -> None:
    monkeypatch.setenv("MPLBACKEND", "Agg")
    import matplotlib

    matplotlib.use("Agg")
    names: dict[str, Any] = {}
    for cell in NOTEBOOK["cells"]:
        if cell["cell_type"] == "code":
            said = io.StringIO()
            with redirect_stdout(said):
                exec(cell["source"], names)
            assert said.getvalue() == "".join(each["text"] for each in cell["outputs"]), cell["id"]
    assert len(names["figure"].axes) == 2
    matplotlib.pyplot.close(names["figure"])


@pytest.mark.slow
def test_the_fixture_of_the_page_is_that_of_the_mark(tmp_path: Any) -> None:
    assert write_files("from-python.md", tmp_path) == ["test_mine.py"]
    (tmp_path / "test_other.py").write_text("def test_fresh(lab):\n    assert lab.now_s == 0.0\n")
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "--strict-markers", "-p", "scenarios.lab.fixture", "-p",
         "no:cacheprovider"],
        cwd=tmp_path, env=os.environ | {"PYTHONPATH": str(ROOT)}, capture_output=True, text=True, timeout=300,
    )  # fmt: skip
    assert done.returncode == 0 and "2 passed" in done.stdout, done.stdout + done.stderr


@pytest.mark.slow
def test_five_lines_are_five(tmp_path: Any) -> None:
    step = next(steps("from-python.md"))
    assert len([line for line in step.code.splitlines() if line.strip()]) == 5
    done = run(step, tmp_path)
    assert done.stdout.splitlines() == list(step.shown), done.stderr
