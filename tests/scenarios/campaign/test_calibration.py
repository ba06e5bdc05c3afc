"""A campaign over a calibration, from logs to table: what is found depends on what is declared."""

from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from scenarios.campaign import table
from scenarios.campaign.run_campaign import CampaignOptions, campaign
from tests.calibration.logs import effect, write_logs

FRICTION = "axes.ra.friction.viscous"


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_two_declared_plants_against_the_same_logs(tmp_path: Path) -> None:
    """The logs have a gear mesh of 6 N m; one of the two declared plants has twice the viscous friction."""
    logs = write_logs(tmp_path, [effect("gear_mesh", "mesh3", amplitude=(6.0, "N m"))])
    file = tmp_path / "declared.yaml"
    file.write_text(
        yaml.safe_dump(
            {
                "name": "declared",
                "calibration": {"logs": [log.name for log in logs], "plant": "low-preload"},
                "inputs": [{"name": "viscous", "plant": FRICTION, "times": [1.0, 2.0]}],
                "sample": "grid",
            }
        )
    )
    out = tmp_path / "out"
    options = CampaignOptions(file=file, out=out, jobs=1)
    assert campaign(options) == 0
    rows = {row["index"]: row for row in table.rows(out / table.JOURNAL)}
    assert [rows[k]["failure"] for k in (0, 1)] == ["", ""]
    assert rows[1]["input: viscous"] == pytest.approx(2.0 * rows[0]["input: viscous"])
    assert rows[0]["digest"] != rows[1]["digest"]
    for row in rows.values():
        before = [name for name in row if name.endswith(" before")]
        assert before
        assert any(row[name.replace(" before", " after")] < 0.9 * row[name] for name in before)
        assert "gear_mesh" in row["effects"]
    columns = table.read(out / table.TABLE)
    assert sorted(columns["index"]) == [0, 1]
    assert "schmidt calibrate" in (out / "report.html").read_text()
    assert campaign(replace(options, resume=True)) == 0, "nothing is left to do"
    assert len(list(table.rows(out / table.JOURNAL))) == 2
