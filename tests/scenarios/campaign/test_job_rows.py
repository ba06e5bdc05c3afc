"""A row of one run, over a runner that is written down: metrics, logs that are kept, and what is measured."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from scenarios.campaign import job
from scenarios.campaign.plan import Case
from scenarios.run.evaluate import Verdict

SUMMARY = {"trace_digest": "d", "simulated_s": 2.0, "silent_faults": 0, "bus_load": 0.25, "word": "x"}
GOOD, BAD = Verdict("error", 1.0, 2.0, "arcsec", True), Verdict("dome", 3.0, 2.0, "deg", True)


class Desk:
    """The runner leaves a log; its verdicts are a test's."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.verdicts = [GOOD]
        self.interrupted = False
        self.ways: list[Any] = []
        clocks = {"perf_counter": iter([10.0, 13.0]), "process_time": iter([5.0, 7.0])}
        stand_in = SimpleNamespace(**{name: each.__next__ for name, each in clocks.items()})
        monkeypatch.setattr(job, "time", stand_in)
        monkeypatch.setattr(job, "digest", lambda: "probe")
        monkeypatch.setattr(job, "prepare", self.prepare)
        monkeypatch.setattr("scenarios.run.run.run", self.run)

    def prepare(self, document: Any) -> tuple[str, str]:
        self.document = document
        return "scenario", "model"

    def run(self, scenario: str, model: str, folder: Path, show: Any, way: Any) -> Any:
        show("step", 0.0, 0.0)
        self.ways.append(way)
        (folder / "can.log").write_text("log")
        passed = all(each.passed for each in self.verdicts)
        return SimpleNamespace(
            summary=SUMMARY, interrupted=self.interrupted, passed=passed, verdicts=self.verdicts
        )


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch) -> Desk:
    return Desk(monkeypatch)


def case(metrics: tuple[str, ...] = (), **more: Any) -> Case:
    values = {"fault": {"node_off": {"node": "DISPLAY"}, "at": "1 s"}, "none": None, "x": 2.5}
    return Case(
        key="k", index=3, values=values, document={"name": "n"}, beside="/there", metrics=metrics, **more
    )


def test_a_row_says_what_was_run_where_and_how_long(desk: Desk) -> None:
    """A document that belongs beside the scenario's file; nothing is drawn."""
    row = job.run(case())
    assert (row["key"], row["index"], row["failure"], row["missed"], row["passed"]) == ("k", 3, "", "", True)
    assert (row["wall_s"], row["cpu_s"], row["probe"]) == (3.0, 2.0, "probe")
    assert (row["digest"], row["simulated_s"], row["silent_faults"]) == ("d", 2.0, 0)
    assert row["input: fault"] == "node_off DISPLAY" and row["input: none"] == "None"
    assert row["input: x"] == 2.5
    assert desk.document.file == Path("/there/k.yaml") and desk.document.data == {"name": "n"}
    assert [way.report for way in desk.ways] == [False]


def test_metrics_are_verdicts_or_figures_of_the_summary(desk: Desk) -> None:
    desk.verdicts = [GOOD, BAD]
    row = job.run(case(("dome", "bus_load")))
    assert (row["metric: dome"], row["metric: bus_load"]) == (3.0, 0.25) and "metric: error" not in row
    assert (row["passed"], row["missed"]) == (False, "dome")


def test_expectations_are_all_verdicts(desk: Desk) -> None:
    desk.verdicts = [GOOD, BAD, Verdict("gone", None, 2.0, "deg")]
    row = job.run(case(("expectations",)))
    assert (row["metric: error"], row["metric: dome"], row["metric: gone"]) == (1.0, 3.0, None)
    assert row["missed"] == "dome; gone"


@pytest.mark.parametrize("metric", ["word", "nothing"])
def test_a_metric_that_is_no_figure_is_the_rows_failure(metric: str, desk: Desk) -> None:
    row = job.run(case((metric,)))
    assert (row["failure"], row["passed"], row["missed"]) == (f"the run has no figure {metric!r}", False, "")


@pytest.mark.parametrize(("keep", "passed", "kept"), [
    ("all", True, True), ("all", False, True), ("failed", True, False), ("failed", False, True),
    ("nothing", False, False),
])  # fmt: skip
def test_logs_of_runs_stay_as_asked(keep: str, passed: bool, kept: bool, desk: Desk, tmp_path: Path) -> None:
    (tmp_path / "k").mkdir()  # of a run before
    desk.verdicts = [GOOD if passed else BAD]
    job.run(case(keep=keep, kept=str(tmp_path)))
    assert (tmp_path / "k" / "can.log").exists() is kept


def test_nowhere_to_keep_is_nothing_kept(desk: Desk) -> None:
    assert job.run(case(keep="all"))["passed"]


def test_an_interruption_is_no_row(desk: Desk) -> None:
    desk.interrupted = True
    with pytest.raises(KeyboardInterrupt):
        job.run(case())
