"""Numbers of a campaign's report, from a table that is written down here."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import yaml

from scenarios.campaign import report_page
from scenarios.campaign.inputs import Input

BASE: dict[str, Any] = {
    "_folder": ".",
    "name": "x",
    "start_utc": "2026-02-10T14:00:00Z",
    "steps": [{"power_on": {}}],
    "expect": [
        {"name": "error", "pointing_error": {"at_most": "10 arcsec"}},
        {"name": "lost", "overruns": {"at_most": 0}},
    ],
}


def varied(name: str, *values: Any) -> Input:
    return Input(name, name, lambda share: share, lambda document, value: None, values, values)


def plan(*inputs: Input, **more: Any) -> Any:
    return SimpleNamespace(inputs=inputs, base=BASE, scenario=Path("x.yaml"), name="many", **more)


def table(count: int, **columns: list[Any]) -> dict[str, list[Any]]:
    """So many runs that all went well, but for these columns."""
    usual: dict[str, list[Any]] = {
        "key": [f"k{k}" for k in range(count)], "index": list(range(count)),
        "failure": [""] * count, "missed": [""] * count,
    }  # fmt: skip
    return usual | {name.replace("__", ": "): values for name, values in columns.items()}


def test_limits_and_units_are_the_scenarios() -> None:
    limits, units = report_page._expected(plan())
    assert limits == {"error": (10.0, True), "lost": (0.0, True)}
    assert units == {"error": "arcsec"}


@pytest.mark.parametrize(("limits", "limit", "missed"), [
    ({"error": (3.0, True)}, "≤ 3", "25.0% (4.6%–69.9%)"),
    ({"error": (3.0, False)}, "≥ 3", "50.0% (15.0%–85.0%)"),
    ({}, None, None),
])  # fmt: skip
def test_a_metric_is_summed_up(limits: dict[str, Any], limit: str | None, missed: str | None) -> None:
    """Of 1, 2, 3, 4 one is above three and two are below; Wilson's intervals of 1 and of 2 of 4."""
    columns = table(5, metric__error=[1.0, 2.0, None, 3.0, 4.0])
    row = report_page._summary(columns, "metric: error", limits, {"error": "arcsec"})
    assert (row["name"], row["unit"], row["runs"]) == ("error", "arcsec", 4)
    assert (row["quantiles"], row["largest"]) == (["1.15", "2.5", "3.85"], "4")
    assert (row.get("limit"), row.get("missed")) == (limit, missed)


def test_a_metric_without_numbers_has_no_quantiles() -> None:
    row = report_page._summary(table(2, metric__error=[None, None]), "metric: error", {}, {})
    assert row == {"name": "error", "unit": "", "runs": 0}


def test_speed_is_of_all_runs() -> None:
    columns = table(3, cpu_s=[1.0, 3.0, 8.0], simulated_s=[1800.0, None, 5400.0],
                    machine=["b", "a", None], compiled=[True, False, True])  # fmt: skip
    assert report_page._speed(columns, 4.0, 2) == {
        "wall_s": 4.0, "made": 2, "cpu_s": 3.0, "simulated_h": 2.0, "machines": ["a", "b"], "compiled": 2
    }  # fmt: skip
    old = report_page._speed(table(1), 4.0, 2)
    assert (old["cpu_s"], old["simulated_h"], old["machines"], old["compiled"]) == (0.0, 0.0, [], 0)


def test_runs_are_grouped_by_the_first_input_of_words() -> None:
    inputs = varied("a", 1, 2), varied("b", "x", "y"), varied("c", "u")
    columns = table(3, input__a=[1, 2, 1], input__b=["y", "x", "y"], input__c=["u", "u", "u"])
    assert report_page._groups(plan(*inputs), columns) == {"y": [0, 2], "x": [1]}
    assert report_page._groups(plan(*inputs[:1]), columns) == {"all runs": [0, 1, 2]}
    assert report_page._groups(plan(varied("d", "lost")), columns) == {"all runs": [0, 1, 2]}


def test_only_inputs_of_numbers_that_are_there_are_ranked() -> None:
    inputs = varied("a", 1, 2), varied("b", "x"), varied("c", 1)
    columns = table(8, input__a=list(range(8)), input__b=["x"] * 8, metric__m=list(range(8)),
                    metric__same=[1] * 8)  # fmt: skip
    (found,) = report_page._influences(plan(*inputs), columns, ["metric: m", "metric: same"])
    assert found[:3] == ("input: a", "metric: m", 1.0)


LIMITS = {"error": (10.0, True), "rate": (4.0, False), "lost": (0.0, True)}


@pytest.mark.parametrize(("columns", "worst"), [
    ({"failure": ["", "broken", ""], "missed": ["a; b", "", ""]}, 1),
    ({"missed": ["a", "b; a", ""]}, 1), ({"missed": ["a", None, "c; "]}, 0),
    ({"metric__error": [9.0, 12.0, 11.0]}, 1), ({"metric__error": [None, None, 1.0]}, 2),
    ({"metric__rate": [4.0, 5.0, 3.0]}, 2),
    ({"metric__error": [11.0, 0, 0], "metric__rate": [4.0, 2.0, 4.0]}, 1),
    ({"metric__lost": [0, 5, 0], "metric__error": [0, 0, 1.0]}, 2),
    ({"metric__error": [15.0, 0, 0], "metric__rate": [4.0, 3.2, 4.0]}, 0),
    ({"index": [-1, 1, 2], "missed": ["a; b", "", "a"]}, 2), ({"index": [0, -1, -1]}, 0), ({}, 0),
])  # fmt: skip
def test_the_worst_run(columns: dict[str, list[Any]], worst: int) -> None:
    """Failures come first, then what misses most, then what is furthest over a limit, as its share."""
    found = report_page._worst(plan(varied("a", 1)), table(3, **columns, input__a=[5, 6, 7]), LIMITS)
    assert found is not None
    assert (found["key"], found["inputs"]) == (f"k{worst}", {"a": 5 + worst})
    assert found["digest"] == "" and found["missed"] == (columns.get("missed") or [""] * 3)[worst]
    assert found["failure"] == (columns.get("failure") or [""] * 3)[worst]


def test_no_planned_run_is_the_worst() -> None:
    assert report_page._worst(plan(), table(2, index=[-1, -1]), {}) is None
    digests = table(2, missed=["", "a"], digest=["x", "y"])
    found = report_page._worst(plan(), digests, {})
    assert found is not None and (found["digest"], found["index"], found["missed"]) == ("y", 1, "a")


@pytest.mark.parametrize("block", [True, False])
@pytest.mark.parametrize("there", [True, False])
def test_the_worst_run_finds_its_plant_from_anywhere(tmp_path: Path, block: bool, there: bool) -> None:
    beside = tmp_path / "mine.yaml"
    if there:
        beside.touch()
    given: Any = {"file": "mine.yaml", "effects": []} if block else "mine.yaml"
    case = SimpleNamespace(document={"name": "ü", "plant": given, "expect": []}, key="abc")
    one = plan(case=lambda index: case)
    one.scenario = tmp_path / "x.yaml"
    report_page._write_worst(one, 3, tmp_path / "worst.yaml")
    text = (tmp_path / "worst.yaml").read_text(encoding="utf-8")
    assert text.startswith("# run 3 of the campaign many, abc\nname: ü\nplant:")
    assert list(yaml.safe_load(text)) == ["name", "plant", "expect"]
    file = str(beside) if there else "mine.yaml"
    assert yaml.safe_load(text)["plant"] == ({"file": file, "effects": []} if block else file)


def test_the_page_holds_what_was_summed_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A page that is written down instead: what it is given."""
    columns = table(3, passed=[True, False, True], silent_faults=[2, 0, 1], metric__error=[1.0, 12.0, 2.0],
                    input__a=[1, 2, 3])  # fmt: skip
    columns |= {"failure": ["", "broken", "broken"], "index": [-1, -1, -1]}
    seen: dict[str, Any] = {}

    def rendered(_template: Path, **given: Any) -> str:
        seen.update(given)
        return "page"

    monkeypatch.setattr("scenarios.campaign.table.read", lambda path: columns)
    monkeypatch.setattr("scenarios.campaign.figures.distributions", lambda *_: "drawn")
    monkeypatch.setattr(report_page, "picture", lambda figure, path: (figure, path.name))
    monkeypatch.setattr(report_page, "rendered", rendered)
    report_page.write(plan(varied("a", 1, 2, 3)), tmp_path, 5.0, 2)
    assert (tmp_path / "report.html").read_text() == "page"
    assert not (tmp_path / "worst.yaml").exists() and seen["worst"] is None
    assert (seen["runs"], seen["silent"], seen["passed"][0]) == (3, 2, pytest.approx(2 / 3))
    assert seen["pictures"] == [("drawn", "distributions.png")] and seen["failures"] == [("broken", 2)]
    assert [each["name"] for each in seen["metrics"]] == ["error"]
    assert seen["repeat"] == f"schmidt run {tmp_path / 'worst.yaml'}"


def test_the_worst_run_is_written_and_twenty_failures_are_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    columns = table(30, passed=[False] * 30)
    columns["failure"] = [f"f{k}" for k in range(25)] + ["f24"] * 5
    told: dict[str, Any] = {}
    written: list[Any] = []
    monkeypatch.setattr("scenarios.campaign.table.read", lambda path: columns)
    for name in ("distributions", "influences", "failures"):
        monkeypatch.setattr(f"scenarios.campaign.figures.{name}", lambda *_: None)
    monkeypatch.setattr(report_page, "_write_worst", lambda *given: written.append(given[1:]))
    monkeypatch.setattr(report_page, "rendered", lambda template, **given: told.update(given) or "page")
    report_page.write(plan(), tmp_path, 5.0, 2)
    assert written == [(0, tmp_path / "worst.yaml")] and told["pictures"] == []
    assert len(told["failures"]) == 20 and told["failures"][0] == ("f24", 6)
