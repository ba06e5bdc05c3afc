"""`schmidt paper` over rows that are written down: jobs and their order, files, last words."""

import json
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from datetime import date
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from scenarios.campaign.executor import Done
from scenarios.studies.options import PaperOptions
from scenarios.studies.paper import run_experiments
from scenarios.studies.paper.experiments import EXPERIMENTS
from scenarios.studies.paper.run_experiments import measure, paper, row_of, run_rows
from scenarios.studies.paper.starts import STARTS, Start, others
from tests.scenarios.studies.paper.bench import HIGH, LOW

PLANTS = {"low": LOW, "high": HIGH}
E1, E7 = (next(each for each in EXPERIMENTS if each.id == name) for name in ("E1", "E7"))
TWO = (Start(100.0, 1), Start(200.0, 2))


def test_an_experiment_that_cannot_be_evaluated_says_why() -> None:
    def broken(_benches: Any) -> Any:
        raise ValueError("no steady state")

    fine: Any = SimpleNamespace(measure=lambda benches: {"peak": benches.start.angle_deg})
    bad: Any = SimpleNamespace(measure=broken)
    assert measure(fine, PLANTS, TWO[0]) == ({"peak": 100.0}, "")
    assert measure(bad, PLANTS, TWO[0]) == ({}, "no steady state")


def test_a_row_parts_what_was_found_from_what_was_not() -> None:
    row = row_of(E1, {TWO[0]: ({"a": 1.0}, ""), TWO[1]: ({}, "why")})
    assert (row.found, row.failed) == ({TWO[0]: {"a": 1.0}}, {TWO[1]: "why"})


def test_every_start_of_every_row_of_every_drive_is_a_job(monkeypatch: pytest.MonkeyPatch) -> None:
    """The dearest row first, whatever the order of the table; answers may come in any order."""
    asked: list[Any] = []
    told: list[tuple[int, str]] = []

    def each(task: Any, inputs: Iterable[Any], **where: Any) -> Iterator[Done[Any]]:
        assert where == {"jobs": 3, "scheduler": "tcp://a:1"} and task is run_experiments._job
        asked.extend(inputs)
        for key, (plants, _, start) in asked[::-1]:
            yield Done(key, ({"at": start.angle_deg, "drive": plants}, ""))

    monkeypatch.setattr(run_experiments, "each", each)
    many: Any = {"a": "plants a", "b": "plants b"}
    found = run_rows(
        many, (E1, E7), TWO, workers=3, scheduler="tcp://a:1", progress=lambda *each: told.append(each)
    )
    order = [(name, drive, start) for name in ("E7", "E1") for drive in many for start in TWO]
    assert [(name, plants[-1], start) for _, (plants, name, start) in asked] == order
    assert told == list(enumerate([name for name, _, _ in order[::-1]], 1))
    assert [row.id for row in found["b"]] == ["E1", "E7"] and list(found) == ["a", "b"]
    figures = {start: {"at": start.angle_deg, "drive": "plants b"} for start in TWO}
    assert all(row.found == figures for row in found["b"])


def test_a_job_that_failed_ends_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run_experiments, "each", lambda *_, **__: [Done(" E1 0", None, "OSError: full")])
    with pytest.raises(RuntimeError, match="E1 0: OSError: full"):
        run_rows({"": PLANTS}, (E1,), TWO)


def test_a_process_finds_its_experiment_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run_experiments, "measure", lambda *given: given)
    found: Any = run_experiments._job((PLANTS, "E7", TWO[0]))
    assert found == (E7, PLANTS, TWO[0])


class Desk:
    """The command with rows of a test; asked: what was to be run."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.out, self.passed = folder / "out", [True, True]
        self.asked: dict[str, Any] = {}
        self.total = 0
        self.printed: list[str] = []
        clock = iter([100.0, 112.26, 200.0, 212.26])
        monkeypatch.setattr(run_experiments, "run_rows", self.run_rows)
        monkeypatch.setattr(run_experiments, "shown", self.shown)
        monkeypatch.setattr(run_experiments, "monotonic", clock.__next__)
        monkeypatch.setattr(run_experiments, "date", SimpleNamespace(today=lambda: date(2026, 3, 1)))
        monkeypatch.setattr(run_experiments, "markdown", lambda *given: f"table of {given[1:]}")
        markdown = "scenarios.studies.paper.varied.markdown"
        monkeypatch.setattr(markdown, lambda *given: f"varied of {given[1:]}")
        console = SimpleNamespace(print=lambda text, **_: self.printed.append(text))
        monkeypatch.setattr(run_experiments, "Console", lambda: console)

    @contextmanager
    def shown(self, _title: str, total: int) -> Iterator[Any]:
        self.total = total
        yield "tell"

    def run_rows(self, many: Any, chosen: Any, starts: Any, **where: Any) -> Any:
        self.asked = {"many": many, "chosen": [row.id for row in chosen], "starts": starts, **where}
        return {drive: [SimpleNamespace(passed=passed, as_json=lambda p=passed: {"passed": p})
                        for passed in self.passed] for drive in many}  # fmt: skip

    def __call__(self, **options: Any) -> int:
        return paper(PaperOptions(out=self.out, **options))

    def document(self, name: str) -> Any:
        return json.loads((self.out / name).read_text())


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Desk:
    return Desk(tmp_path, monkeypatch)


def test_the_papers_rows_are_run_from_eight_starts(desk: Desk) -> None:
    assert desk(rows="E1,E7", jobs=3, scheduler="s") == 0
    assert desk.asked == {
        "many": {"": PLANTS}, "chosen": ["E1", "E7"], "starts": STARTS, "workers": 3, "scheduler": "s",
        "progress": "tell",
    }  # fmt: skip
    assert desk.total == 16
    text = (desk.out / "paper.json").read_text()
    assert text.startswith('{\n  "plant": ') and text.endswith("}\n")
    found = desk.document("paper.json")
    assert (found["plant"], found["wall_s"]) == ("low_preload_bridge", 12.3)
    assert found["plants"] == {"low": "low_preload_bridge", "high": "high_preload_bridge"}
    assert found["starts"][0] == {"angle_deg": 97.3, "seed": 1} and len(found["rows"]) == 2
    table = f"table of {(['low_preload_bridge', 'high_preload_bridge'], 'schmidt paper', date(2026, 3, 1))}"
    assert (desk.out / "experiments.md").read_text() == table
    assert desk.printed == [table, "2 of 2 rows met at 8 starts, 12 s"]
    assert not (desk.out / ".probe").exists()


def test_a_row_that_is_missed_is_the_status(desk: Desk, tmp_path: Path) -> None:
    desk.passed = [True, False]
    assert desk(quick=True, json_file=tmp_path / "rows.json") == 1
    said = "1 of 2 rows met at 2 starts (eight decide: leave --quick out), 12 s"
    assert desk.printed[1] == said and (tmp_path / "rows.json").exists() and desk.total == 15 * 2


def test_other_starts_are_named_in_the_command(desk: Desk) -> None:
    assert desk(others=3) == 0
    assert desk.asked["starts"] == others(3) and "'schmidt paper --others 3'" in desk.printed[0]


@pytest.mark.parametrize("quick", [False, True])
def test_a_drive_may_be_off(quick: bool, desk: Desk) -> None:
    """Five numbers, below and above."""
    assert desk(vary=2.5, quick=quick) == 0
    assert len(desk.asked["many"]) == 10 and desk.total == 10 * 15 * (2 if quick else 8)
    command = "schmidt paper --vary 2.5 --quick" if quick else "schmidt paper --vary 2.5"
    assert (desk.out / "varied.md").read_text() == f"varied of {(command, 2.5)}"
    assert list(desk.document("varied.json")) == list(desk.asked["many"])
    assert desk.printed[1].startswith("20 of 20 rows met")


def test_a_plants_file_is_told_by_its_name(desk: Desk, tmp_path: Path) -> None:
    from plant.model import dump

    dump(LOW, tmp_path / "mine.yaml")
    assert desk(plant=str(tmp_path / "mine.yaml")) == 0
    assert "['mine', 'high_preload_bridge']" in desk.printed[0]
