"""`schmidt campaign` over runs that are written down: its journal, its status and its last words."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from scenarios.campaign import run_campaign, table
from scenarios.campaign.executor import Done
from scenarios.campaign.options import CampaignOptions
from scenarios.campaign.plan import Case
from scenarios.campaign.run_campaign import campaign
from scenarios.language.document import ScenarioError

PROBE = "0123456789abcdef"


def case(key: str, index: int) -> Case:
    return Case(key=key, index=index, values={}, document={}, beside=".", metrics=())


class Plan:
    """Runs by their keys."""

    keep = "nothing"
    time_s: float | None = None

    def __init__(self, keys: str) -> None:
        self.keys, self.count = keys, len(keys)

    def cases(self) -> Iterator[Case]:
        return (case(key, index) for index, key in enumerate(self.keys))


class Desk:
    """What a worker makes of a key is its row, or the error that it raises."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.out = folder / "out"
        self.plan = Plan("abc")
        self.clock = 0.0
        self.results: dict[str, Any] = {}
        self.asked: list[tuple[str, str | None]] = []
        self.shown_at: list[tuple[float | None, str]] = []
        self.total: tuple[Any, ...] = ()
        self.written: list[Any] = []
        monkeypatch.setattr("scenarios.campaign.plan.load", lambda file: self.plan)
        monkeypatch.setattr(run_campaign, "digest", lambda: PROBE)
        monkeypatch.setattr(run_campaign, "shown", self.shown)
        monkeypatch.setattr(run_campaign, "each", self.each)
        monkeypatch.setattr(run_campaign, "write", lambda *given: self.written.append(given))
        monkeypatch.setattr(table, "write", self.written.append)
        clock = SimpleNamespace(perf_counter=lambda: 50.0 + self.clock)
        monkeypatch.setattr(run_campaign, "time", clock)

    @contextmanager
    def shown(self, *given: Any) -> Iterator[Any]:
        self.total = given
        yield lambda done, text: self.shown_at.append((done, text))

    def each(self, task: Any, inputs: Iterable[tuple[str, Case]], **where: Any) -> Iterator[Done[Any]]:
        assert where == {"jobs": 2, "scheduler": "tcp://a:1"}
        for key, given in inputs:
            self.clock += 10.0
            self.asked.append((key, given.kept))
            result = self.results.get(key, {"probe": PROBE})
            if isinstance(result, BaseException):
                raise result
            if result is None:
                yield Done(key, None, "died")
            else:
                yield Done(key, {"key": key, "index": given.index, "failure": "", **result})

    def __call__(self, resume: bool = False) -> int:
        where: dict[str, Any] = {"jobs": 2, "scheduler": "tcp://a:1"}
        return campaign(CampaignOptions(file=Path("m.yaml"), out=self.out, resume=resume, **where))


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Desk:
    return Desk(tmp_path, monkeypatch)


def words(desk: Desk, runs: str) -> str:
    return f"{runs}, report {desk.out / 'report.html'}, table {desk.out / 'runs.parquet'}\n"


def test_all_runs_are_journalled_and_reported(desk: Desk, capsys: pytest.CaptureFixture[str]) -> None:
    assert desk() == 0
    assert capsys.readouterr() == (words(desk, "3 of 3 runs"), "")
    assert [row["key"] for row in table.rows(desk.out / table.JOURNAL)] == ["a", "b", "c"]
    assert desk.total == ("runs", 3, 0) and desk.asked == [(key, None) for key in "abc"]
    assert desk.shown_at == [(1, "1 of 3"), (2, "2 of 3"), (3, "3 of 3")]
    assert desk.written == [desk.out, (desk.plan, desk.out, 30.0, 3)]  # the report is of the table


def test_logs_are_kept_in_a_folder_of_the_campaign(desk: Desk) -> None:
    desk.plan.keep = "failed"
    desk()
    assert desk.asked[0] == ("a", str(desk.out.resolve() / "runs"))


def test_a_run_whose_worker_died_is_missing_and_made_again(
    desk: Desk, capsys: pytest.CaptureFixture[str]
) -> None:
    desk.results["b"] = None
    assert desk() == 1
    said, error = capsys.readouterr()
    assert said == words(desk, "2 of 3 runs")
    assert error == "schmidt: workers were lost, 1 runs are missing: --resume makes them\n"
    lost = [row for row in table.rows(desk.out / table.JOURNAL) if row["key"] == "b"]
    assert lost == [{"key": "b", "index": -1, "failure": "died", "lost": True}]
    del desk.results["b"]
    desk.asked.clear()
    assert desk(resume=True) == 0 and desk.asked == [("b", None)]
    assert desk.total == ("runs", 3, 2) and desk.written[-1][3] == 1


def test_an_interrupted_campaign_goes_on(desk: Desk, capsys: pytest.CaptureFixture[str]) -> None:
    desk.results["b"] = KeyboardInterrupt()
    assert desk() == 130
    assert capsys.readouterr().err == "schmidt: interrupted, 2 runs are missing: --resume makes them\n"


def test_without_a_run_there_is_no_report(desk: Desk, capsys: pytest.CaptureFixture[str]) -> None:
    desk.results["a"] = KeyboardInterrupt()
    assert desk() == 130
    desk.results = dict.fromkeys("abc")
    assert desk() == 1 and not desk.written
    none = f"schmidt: no run has ended; nothing is in {desk.out}\n"
    assert capsys.readouterr() == ("", none * 2)
    desk.plan = Plan("")
    assert desk() == 1


def test_a_run_that_is_planned_twice_is_made_once(desk: Desk, capsys: pytest.CaptureFixture[str]) -> None:
    desk.plan = Plan("abab")
    assert desk() == 0
    assert capsys.readouterr() == (words(desk, "2 of 2 runs (2 more are alike)"), "")


def test_rows_of_another_plan_do_not_count(desk: Desk, capsys: pytest.CaptureFixture[str]) -> None:
    desk()
    desk.plan = Plan("cd")
    capsys.readouterr()
    assert desk(resume=True) == 0
    assert capsys.readouterr() == (words(desk, "2 of 2 runs"), "")


@pytest.mark.parametrize(("time_s", "made"), [(20.0, 3), (19.9, 2), (0.0, 1)])
def test_time_that_is_over_is_told(
    time_s: float, made: int, desk: Desk, capsys: pytest.CaptureFixture[str]
) -> None:
    """A run takes ten seconds here; at twenty the third may still begin."""
    desk.plan.time_s = time_s
    assert desk() == (0 if made == 3 else 1)
    said, error = capsys.readouterr()
    assert said == words(desk, f"{made} of 3 runs")
    late = f"schmidt: out of time, {3 - made} runs are missing: --resume makes them\n"
    assert error == (late if made < 3 else "")


def test_a_worker_of_another_version_ends_it(desk: Desk) -> None:
    desk.results["b"] = {"probe": "f" * 16, "machine": "far", "version": "9"}
    with pytest.raises(ScenarioError) as caught:
        desk()
    assert str(caught.value) == (
        "the worker on far runs another version (schmidt 9): "
        "the digest of its probe is ffffffffffff, here it is 0123456789ab"
    )
