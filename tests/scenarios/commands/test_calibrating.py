"""`schmidt calibrate` and `schmidt rig`: which logs are whose, how long it usually takes, what is refused."""

import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from click.testing import CliRunner, Result
from numpy.linalg import LinAlgError

from scenarios.commands import calibrating


class Desk:
    """Both commands, with a finder that finds nothing and writes down what it is given."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.given: list[Any] = []
        self.needed: list[str] = []
        self.usual: dict[str, float] = {}
        self.entered: list[str] = []
        self.error: Exception | None = None
        functions = {"calibrate": self.calibrate, "draft": self.draft, "show_rig": self.show}
        monkeypatch.setitem(sys.modules, "calibration.command", SimpleNamespace(**functions))
        monkeypatch.setattr("scenarios.progress.stages", self.stages)
        monkeypatch.setattr(calibrating, "need", lambda *extras: self.needed.extend(extras))

    @contextmanager
    def stages(self, _title: str, usual_s: dict[str, float]) -> Iterator[Callable[[str], None]]:
        self.usual = usual_s
        yield self.entered.append

    def calibrate(self, *given: Any, on_step: Callable[[str], None]) -> int:
        self.given.extend(given)
        for step in ("reading", "anything", "running the closed loop again", "writing the report"):
            on_step(step)
        warnings.warn("of nothing", RuntimeWarning, stacklevel=1)
        if self.error is not None:
            raise self.error
        return 7

    def draft(self, file: Path) -> str:
        return f"draft of {file.name}"

    def show(self, file: Path, logs: list[Path], plot: Path | None) -> str:
        self.given.extend((file, logs, plot))
        return "shown"

    def __call__(self, command: Any, *words: object) -> Result:
        return CliRunner().invoke(command, [str(each) for each in words])


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch) -> Desk:
    return Desk(monkeypatch)


def logs(folder: Path) -> list[Path]:
    """A megabyte and a half in two files, and one that is not there."""
    for name, size in (("a.csv", 1_000_000), ("b.csv", 500_000)):
        (folder / name).write_bytes(b"\n" * size)
    return [folder / name for name in ("a.csv", "b.csv", "c.csv")]


def test_logs_and_options_go_to_the_finder(desk: Desk, tmp_path: Path) -> None:
    """Each stage takes a time of its own, and more for a megabyte; docs/example's are in the module."""
    files = logs(tmp_path)
    done = desk(calibrating.calibrate, *files, "--rig", "r.yaml", "--hold-out", "night", "--plant", "p.yaml",
                "--out", "there")  # fmt: skip
    assert done.exit_code == 7 and desk.needed == ["calibrate"]
    assert desk.given == [files, Path("r.yaml"), ["night"], Path("there"), Path("p.yaml")]
    assert desk.entered == ["searching", "searching", "replaying", "writing the report"]
    expected = {name: begin + 1.5 * more for name, (begin, more) in calibrating.USUAL.items()}
    assert desk.usual == pytest.approx(expected)
    assert list(expected) == ["reading", "searching", "replaying", "writing the report"]


def test_sizes_are_megabytes(tmp_path: Path) -> None:
    assert calibrating.megabytes(logs(tmp_path)) == 1.5


def test_a_fit_that_does_not_converge_names_the_log(desk: Desk, tmp_path: Path) -> None:
    desk.error = LinAlgError("singular")
    done = desk(calibrating.calibrate, "a.csv", "b.csv", "--rig", "r", "--out", "there")
    assert str(done.exception) == "a.csv: no fit converges; see scale and gain of the rig file"


def test_a_rig_and_its_logs_are_shown(desk: Desk, tmp_path: Path) -> None:
    files = logs(tmp_path)
    done = desk(calibrating.rig, "r.yaml", *files, "--plot", "p.png")
    assert (done.exit_code, done.output) == (0, "shown\n") and desk.needed == ["calibrate"]
    assert desk.given == [Path("r.yaml"), files, Path("p.png")]
    begin_s, per_mb_s = calibrating.RIG_S, calibrating.RIG_PER_MEGABYTE_S
    assert desk.usual == {"3 file(s)": begin_s + 1.5 * per_mb_s}
    desk.given.clear()
    assert desk(calibrating.rig, *files, "--rig", "r.yaml").exit_code == 0
    assert desk.given == [Path("r.yaml"), files, None]


def test_a_rig_file_is_drafted_from_one_log(desk: Desk, tmp_path: Path) -> None:
    first, *more = logs(tmp_path)
    assert desk(calibrating.rig, first, "--new").output == "draft of a.csv\n"
    assert list(desk.usual) == ["1 file(s)"]
    for words in (more, ["--plot", "p.png"], ["--rig", "r.yaml"]):
        done = desk(calibrating.rig, first, *words, "--new")
        assert done.exit_code == 2 and "--new drafts from one log, and draws nothing" in done.output


@pytest.mark.parametrize(("words", "missing"), [((), "LOGS"), (("a.csv",), "--out")])
def test_logs_and_a_folder_have_to_be_given(words: tuple[str, ...], missing: str, desk: Desk) -> None:
    done = desk(calibrating.calibrate, *words)
    assert done.exit_code == 2 and "Missing " in done.output and missing in done.output
