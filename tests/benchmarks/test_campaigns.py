"""The bench of campaigns: its run that does nothing goes the way of a real one."""

from pathlib import Path

import pytest

from scenarios.campaign import table
from scenarios.lab.prepare import load
from scenarios.language.model import check_targets
from tests.benchmarks import campaigns, night


@pytest.mark.slow
def test_planned_runs_that_do_nothing_end_in_a_table_and_a_report(tmp_path: Path) -> None:
    found = campaigns.planned(tmp_path, 40, 1)
    assert found["runs"] == 40
    columns = table.read(tmp_path / "out" / table.TABLE)
    assert sorted(columns["index"]) == list(range(40))
    assert (tmp_path / "out" / "report.html").exists()


def test_a_long_night_is_a_scenario_whose_fields_follow_the_sky(tmp_path: Path) -> None:
    file = tmp_path / "night.yaml"
    file.write_text(night.scenario(10.0))
    found = load(file)
    places = [step.arguments["target"] for step in found.steps if step.action == "goto"]
    assert len(places) == 40
    check_targets(found)
