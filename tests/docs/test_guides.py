"""The guides are done as they stand: their files written, their commands run, their output compared."""

from pathlib import Path

import pytest

from tests.docs.guides import GUIDES, Step, run, steps, text_of, write_files

PROGRAMS = list(steps("from-python.md"))


def test_every_program_shows_what_it_prints() -> None:
    assert len(PROGRAMS) == 5
    assert all(step.is_program and step.shown for step in PROGRAMS)


@pytest.mark.slow
@pytest.mark.parametrize("step", PROGRAMS, ids=lambda step: step.code.split("\n")[0][:30])
def test_a_program_prints_what_the_page_shows(tmp_path: Path, step: Step) -> None:
    done = run(step, tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == list(step.shown)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("page", "file", "status"),
    [("first-night.md", "my-night.yaml", 0), ("read-a-report.md", "bad-night.yaml", 1)],
)
def test_a_night_of_the_guides_prints_what_the_page_shows(
    tmp_path: Path, page: str, file: str, status: int
) -> None:
    assert write_files(page, tmp_path) == [file]
    step = next(each for each in steps(page) if file in each.code)
    done = run(step, tmp_path)
    assert done.returncode == status, done.stderr
    assert done.stdout.splitlines()[:-1] == list(step.shown)
    folder = tmp_path / "out" / file.removesuffix(".yaml")
    assert (folder / "report.html").exists()
    for name in ("can.log", "axis-ra.csv", "truth-ra.parquet", "errors.log", "commands.log", "summary.json"):
        assert (folder / name).exists(), name
    if status:
        shown = text_of(page).split("errors.log`:\n\n```text\n")[1].split("```")[0]
        assert shown in (folder / "errors.log").read_text(encoding="utf-8")


@pytest.mark.slow
def test_the_run_of_the_pointing_guide_prints_what_the_page_shows(tmp_path: Path) -> None:
    """The verdicts of the example scenario: other stars, and a star that is tracked."""
    step = next(steps("pointing-model.md"))
    done = run(step, tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[:-1] == list(step.shown)
    names = {path.name for path in (tmp_path / "out" / "pointing-model").iterdir()}
    assert {"pointing-run.png", "pointing-model.json", "pointing-stars.csv"} <= names


@pytest.mark.slow
def test_the_check_of_the_guide_prints_what_the_page_shows(tmp_path: Path) -> None:
    step = next(steps("check-a-board.md"))
    done = run(step, tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == list(step.shown)


@pytest.mark.slow
def test_the_board_that_is_not_there_is_reported_as_the_picture_shows(tmp_path: Path) -> None:
    done = run(Step("schmidt conformance --board axis:0x11 --board axis:0x10", False, ()), tmp_path)
    assert done.returncode == 1
    assert done.stdout.splitlines()[-1] == "156 checks: 151 ok, 1 info, 0 issues, 4 errors"


@pytest.mark.parametrize(
    "page",
    ["first-night.md", "attach-a-host.md", "check-a-board.md", "calibrate-a-log.md", "read-a-report.md"],
)
def test_the_first_guides_have_pictures(page: str) -> None:
    assert "![" in text_of(page), f"{GUIDES / page}: no picture"


@pytest.mark.slow
@pytest.mark.parametrize("page", ["fmu.md", "recordings.md"])
def test_a_page_on_other_tools_does_as_it_says(tmp_path: Path, page: str) -> None:
    pytest.importorskip("fmpy" if page == "fmu.md" else "mcap", reason="an extra, see the page")
    write_files(page, tmp_path)
    for step in steps(page):
        done = run(step, tmp_path)
        assert done.returncode == 0, done.stderr
        if step.shown:
            assert done.stdout.splitlines() == list(step.shown)
