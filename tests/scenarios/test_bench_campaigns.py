"""The bench of campaigns: its run that does nothing goes the way of a real one."""

from pathlib import Path

import pytest

from scenarios.bench import campaigns
from scenarios.campaign import table


@pytest.mark.slow
def test_planned_runs_that_do_nothing_end_in_a_table_and_a_report(tmp_path: Path) -> None:
    found = campaigns.planned(tmp_path, 40, 1)
    assert found["runs"] == 40
    columns = table.read(tmp_path / "out" / table.TABLE)
    assert sorted(columns["index"]) == list(range(40))
    assert (tmp_path / "out" / "report.html").exists()
