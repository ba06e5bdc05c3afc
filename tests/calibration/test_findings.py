"""Findings, their parameters, and what the command says of runs that nobody has."""

import json
from functools import partial
from math import inf, nan, sqrt
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from calibration import command
from calibration.arrays import by_median
from calibration.command import _check_names, calibrate, look, write_report
from calibration.errors import CalibrationInputError
from calibration.finding import Finding, Parameter, deviation, normal, of_columns
from calibration.inputs.run import Run
from tests.calibration.logs import tiny_log


def test_an_error_has_its_file_line_and_column() -> None:
    told = [
        CalibrationInputError("a.csv", "bad"), CalibrationInputError(Path("a.csv"), "bad", 0),
        CalibrationInputError("a.csv", "bad", None, ""), CalibrationInputError("a.csv", "bad", 3, "q"),
    ]  # fmt: skip
    assert [str(e) for e in told] == [
        "a.csv: bad", "a.csv:0: bad", "a.csv: column '': bad", "a.csv:3: column 'q': bad"
    ]  # fmt: skip
    assert (told[3].path, told[3].line, told[3].column) == ("a.csv", 3, "q")


def test_an_interval_is_of_standard_errors() -> None:
    assert normal(5.0, 2.0, "m") == Parameter(5.0, "m", 5.0 - 1.96 * 2, 5.0 + 1.96 * 2)
    assert normal(5.0, 2.0, "m", 3.0) == Parameter(5.0, "m", -1.0, 11.0)
    assert deviation(4.0, 8.0, "V") == normal(4.0, 4.0 / sqrt(16.0), "V")
    assert normal(5.0, 2.0, "m", 3.0).half == 6.0 and Parameter(5.0, "m").half == 0.0
    assert Parameter(5.0, "m", 4.0).times(3.0) == Parameter(15.0, "m", 12.0, None)


def test_a_median_size_is_that_of_normal_values() -> None:
    assert by_median(np.array([-1.0, 2.0, nan, 3.0])) == pytest.approx(1.4826 * 2.0)


def test_a_finding_gathers_notes_and_parameters() -> None:
    one, two = Parameter(1.0, "m"), Parameter(2.0, "m")
    f = Finding("drag", "T", "time", stage="wheel", harmonic=2, parameters={"a": one})
    assert f.noted("x").note == "x" and f.noted("x").noted("y").note == "x; y"
    assert f.having(a=two, b=one).parameters == {"a": two, "b": one}
    assert f.key == ("drag", "wheel", 2) and (f.evidence, f.share) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("channel", "domain", "share", "so"),
    [
        ("S", "clock", 0.0, True),
        ("S", "clock", 0.1, False),
        ("T", "clock", 0.0, False),
        ("S", "time", 0.0, False),
    ],
)
def test_a_columns_fault_takes_nothing_off_a_response(
    channel: str, domain: str, share: float, so: bool
) -> None:
    assert Finding("late", channel, domain, share=share).of_column is so


def test_a_fault_of_columns_is_found_before_any_balance() -> None:
    f = of_columns("late", {}, 7.0, note="so")
    assert (f.name, f.channel, f.domain, f.evidence, f.share, f.note) == (
        "late",
        "S",
        "clock",
        7.0,
        1.0,
        "so",
    )


def run(name: str, path: str) -> Run:
    return Run(name, Path(path), name, {"t": np.arange(5.0)})


def noted(pages: list[Any], *given: Any) -> str:
    pages.append(given)
    return "<p>"


RUNS = [run("night", "logs/night.txt"), run("night#2", "logs/night.txt")]


@pytest.mark.parametrize("name", ["night", "night#2", "night.txt", "logs/night.txt", "given/as.txt"])
def test_a_run_is_held_out_by_its_name_or_its_file(name: str) -> None:
    if name == "night#2":
        _check_names([name], RUNS, [Path("given/as.txt")])
    elif name == "given/as.txt":
        _check_names([name], RUNS, [Path(name)])
    else:
        with pytest.raises(CalibrationInputError) as caught:
            _check_names([name], RUNS[:1], [])
        assert str(caught.value) == "--hold-out: every run is held out: nothing is left to fit"


def test_a_run_that_nobody_has_is_refused() -> None:
    with pytest.raises(
        CalibrationInputError, match=r"^--hold-out: no run is called 'nigth'; did you mean 'night'"
    ):
        _check_names(["nigth"], RUNS, [])
    _check_names([], [], [])


@pytest.mark.parametrize(
    ("rig", "who"),
    [
        (SimpleNamespace(motors="two", drifts=False), "axis"),
        (SimpleNamespace(motors=None, drifts=True), "drift"),
        (SimpleNamespace(motors=None, drifts=False), "response"),
        (None, "drift"),
    ],
)
def test_a_drive_is_looked_at_as_it_is_declared(monkeypatch: pytest.MonkeyPatch, rig: Any, who: str) -> None:
    for name in ("axis", "drift", "response"):
        monkeypatch.setattr(command, f"look_at_{name}", lambda *_, name=name: name)
    assert look(SimpleNamespace(rig=rig, runs=[]), None) == who  # type: ignore[arg-type, comparison-overlap]


@pytest.mark.parametrize(("count", "words"), [(1, "1 run: "), (2, "2 runs: "), (13, "13 runs: ")])
def test_a_report_lists_a_dozen_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, count: int, words: str
) -> None:
    pages: list[Any] = []
    monkeypatch.setattr(command, "page", partial(noted, pages))
    data: dict[str, Any] = {"effects": [], "a": np.float64(1.5)}
    write_report(data, [], "A title", [run(f"r{k}", "a") for k in range(count)], tmp_path)
    told = ", ".join(f"r{k} (4 s, 5 rows)" for k in range(min(count, 12)))
    assert pages[0][2:] == ("A title", words + told) and (tmp_path / "report.html").read_text() == "<p>"
    assert json.loads((tmp_path / "report.json").read_text()) == {"effects": [], "a": 1.5}
    assert (tmp_path / "report.json").read_text().endswith("}\n")


def test_what_the_command_cannot_do_is_said_before_any_work(tmp_path: Path) -> None:
    with pytest.raises(CalibrationInputError, match=r"^calibrate: give at least one log$"):
        calibrate([])
    guide = tmp_path / "g.txt"
    guide.write_text('Frame,Time,mount,RARawDistance,RAGuideDistance\n1,1,"Mount",0,0\n')
    with pytest.raises(
        CalibrationInputError, match=r"^--plant: is for axis logs: no other drive has a plant file$"
    ):
        calibrate([guide], plant=guide, out=tmp_path)
    assert by_median(np.array([inf, 1.0, 1.0])) == pytest.approx(1.4826)


def test_a_calibration_goes_step_by_step(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    log = tmp_path / "a.log"
    log.write_text(tiny_log(5))
    steps: list[str] = []
    asked: dict[str, Any] = {}

    def looked(drive: Any, options: Any) -> Any:
        asked["options"] = options
        return SimpleNamespace(title="t", said=["a remark"])

    monkeypatch.setattr(command, "look", looked)
    monkeypatch.setattr(command, "with_curves", lambda found: found)
    monkeypatch.setattr(command, "correct_and_replay", lambda found, options: "again")
    monkeypatch.setattr(command, "report_of", lambda found, again: {"effects": []})
    monkeypatch.setattr(command, "pictures", lambda found, again: ["drawn"])
    monkeypatch.setattr(command, "write_report", lambda data, drawn, *_: asked.update(drawn=drawn))
    monkeypatch.setattr(command, "show", lambda data, said, out: asked.update(said=said))
    out = tmp_path / "deep" / "out"
    assert calibrate([log], out=out, on_step=steps.append) == 0 and out.is_dir()
    assert steps == ["writing the report"] and asked["drawn"] == ["drawn"] and asked["said"] == ["a remark"]
    assert (asked["options"].hold_out, asked["options"].replay, asked["options"].out) == ([], True, out)
    assert calibrate([log], out=out, plots=False, replay=False) == 0
    assert asked["drawn"] == [] and asked["options"].replay is False
