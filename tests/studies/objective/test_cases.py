"""Rows of the objective's table from runs that are given: numbers, verdicts, texts, the runs' orders."""

import json
from pathlib import Path

import numpy as np
import pytest

from bus.protocol import AxisParameter
from plant.model import load
from scenarios.studies.objective import cases, run_holds
from scenarios.studies.objective.bench import Held
from scenarios.studies.objective.bound import Bound
from scenarios.studies.objective.cases import (
    Case,
    Row,
    bound_line,
    line,
    markdown,
    measure,
    over_paper,
    starts,
)
from scenarios.studies.options import LOW, ObjectiveOptions

PLANTS = load(LOW), load("high_preload_bridge")


def row(peaks: list[float], lost: int = 0, judged: bool = True, case: str = "a", rms: float = 0.5) -> Row:
    return Row(case, "TRACK", peaks, [rms] * len(peaks), [0.25] * len(peaks), lost, judged)


def test_figures_of_a_hold() -> None:
    held = Held(np.arange(4.0), np.array([0.0, -3.0, 1.0, 2.0]), np.array([1.0, -2.0, 4.0, 0.0]), 0)
    assert (held.peak, held.wander) == (3.0, 3.0)
    assert held.rms == pytest.approx((14.0 / 4.0) ** 0.5)


@pytest.mark.parametrize(
    ("peak", "lost", "judged", "passed", "verdict"),
    [
        (1.0, 0, True, True, "met"),
        (1.001, 0, True, False, "missed"),
        (0.5, 1, True, False, "missed"),
        (9.0, 1, False, True, "printed"),
    ],
)
def test_a_judged_row_is_within_one_arcsecond_per_second_and_loses_nothing(
    peak: float, lost: int, judged: bool, passed: bool, verdict: str
) -> None:
    found = row([0.25, peak, 0.5], lost, judged)
    assert found.passed is passed
    middle = sorted([0.25, peak, 0.5])[1]
    assert line(found) == f"| a | TRACK | {peak:.3f} | {middle:.3f} | 0.500 | 0.250 | 3 | {verdict} |"
    document = found.as_json()
    assert (document["worst"], document["median"], document["runs"]) == (peak, middle, 3)
    assert document["passed"] is passed and document["case"] == "a"


def test_starts_move_together_and_come_round() -> None:
    apart = 180.0 / 7.87
    assert starts(0.0) == pytest.approx([85.0 + apart * k for k in range(8)])
    assert starts(10.0, 2) == pytest.approx([95.0, 95.0 + 180.0 / 1.87])
    assert starts(179.0, 2)[1] == pytest.approx(84.0 + 180.0 / 1.87)  # beyond the end, from the beginning
    assert starts(180.0, 1) == pytest.approx([85.0])


def test_wind_is_compared_run_by_run_with_the_papers_firmware() -> None:
    paper = row([1.0, 1.0], case=f"wind 3, {cases.PAPER}")._replace(rms=[2.0, 1.0])
    fine = row([1.0, 1.0], case="wind 3")._replace(rms=[1.0, 0.8])
    alone = row([1.0], case="wind 9")
    calm = row([1.0], case="calm"), row([1.0], case=f"calm, {cases.PAPER}")
    assert over_paper([fine, paper, alone, *calm]) == {"wind 3, TRACK": 0.8}
    assert over_paper([fine, paper._replace(mode="RATE")]) == {}


def test_the_page_has_a_line_for_every_row_and_every_bound() -> None:
    bound = Bound(rms=0.1234, exact=0.1, torque=1.0, available=9.0)
    assert bound_line("w", bound) == "| w, the least possible |  |  |  | 0.123 |  |  | bound |"
    text = markdown([row([0.5])], "schmidt objective", {"w": bound}).splitlines()
    assert text[0].endswith("`schmidt objective`") and text[1] == ""
    assert len(text) == 6 and text[2].count("|") == text[3].count("|") == text[4].count("|")


def test_a_table_has_compensated_rows_only_with_a_compensation() -> None:
    every, plain = cases.cases(True), cases.cases(False)
    assert list(plain) == [each for each in every if not each.compensated] and len(plain) < len(every)
    assert all(each.name for each in cases.ladder())


def test_a_case_adds_effects_and_wind_to_its_preload() -> None:
    low, high = PLANTS
    assert Case("x").plant(low, high).axes.ra.effects == low.axes.ra.effects
    preloads = [Case("x", high=each).plant(low, high).axes.ra.friction for each in (False, True)]
    assert preloads == [low.axes.ra.friction, high.axes.ra.friction] and preloads[0] != preloads[1]
    blown = Case("x", wind_m_s=3.0).plant(low, high).axes.ra.effects
    assert [each.name for each in blown[len(low.axes.ra.effects) :]] == ["wind_torque"]


def test_each_case_runs_in_both_modes_from_every_start_with_every_seed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[tuple[object, ...]] = []

    def held(*given: object) -> Held:
        asked.append(given)
        return Held(np.zeros(1), np.array([float(len(asked))]), np.zeros(1), 1)

    monkeypatch.setattr(cases, "hold", held)
    monkeypatch.setattr(cases, "parameters_of", lambda *_: {12: 7, 13: 8})
    options, told = ObjectiveOptions(starts=1, seeds=2, seconds=5.0), list[str]()
    plain = Case("a", compensated=True, without=(AxisParameter(12).name,))
    rows = list(
        measure([plain, Case("b"), Case("c", firmware="paper")], PLANTS, [(40, 1)], options, told.append)
    )
    assert [(each.case, each.mode) for each in rows] == [(c, m) for c in "abc" for m in ("TRACK", "RATE")]
    assert [each[1:] for each in asked[:3]] == [
        (85.0, 1, "TRACK", [(13, 8), (40, 1)], 5.0),
        (85.0, 2, "TRACK", [(13, 8), (40, 1)], 5.0),
        (85.0, 1, "RATE", [(13, 8), (40, 1)], 5.0),
    ]
    assert asked[4][4] == [(12, 7), (13, 8)]
    assert told[1] == "a, TRACK, 85.0 deg, seed 2" and len(told) == 12
    assert rows[0].peaks == [1.0, 2.0] and rows[0].lost == 2
    assert [each.judged for each in rows[::2]] == [False, True, False]
    for unjudged in (Case("d", high=True), Case("d", wind_m_s=1.0)):
        assert not any(each.judged for each in measure([unjudged], PLANTS, [], options, told.append))


def objective(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, rows: list[Row], **given: object) -> int:
    """The command on rows that are given."""
    monkeypatch.setattr(cases, "measure", lambda *_: iter(rows))
    monkeypatch.setattr(run_holds, "bound", lambda *_: Bound(0.1, 0.1, 1.0, 9.0))
    options: dict[str, object] = {"out": tmp_path / "new", "only": cases.cases(False)[0].name}
    return run_holds.objective(ObjectiveOptions(**(options | given)))  # type: ignore[arg-type]


def test_the_command_ends_well_where_rows_are_met_and_wind_is_no_worse(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    paper = row([1.0], judged=False, case=f"wind, {cases.PAPER}", rms=0.5)
    assert objective(tmp_path, monkeypatch, [row([1.0]), row([2.0], judged=False, case="wind"), paper]) == 0
    worse = row([2.0], judged=False, case="wind", rms=0.51)
    assert objective(tmp_path, monkeypatch, [worse, paper]) == 1
    assert objective(tmp_path, monkeypatch, [row([1.1])], seeds=2, steps=True, only="", shift=2.5) == 1
    data = json.loads((tmp_path / "new/objective.json").read_text())
    assert data["command"] == "schmidt objective --seeds 2 --shift 2.5 --only '' --steps"
    assert data["starts_deg"] == starts(2.5) and data["rows"][0]["worst"] == 1.1
    page = (tmp_path / "new" / "one-arcsecond.md").read_text()
    assert page == markdown([row([1.1])], data["command"], {})


def test_a_name_of_no_row_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ValueError, match=r"^--only nil: no row's name contains this; the rows are: "):
        objective(tmp_path, monkeypatch, [], only="nil")
