"""One run of a campaign: what its row says."""

from pathlib import Path
from typing import Any

import pytest
import yaml

from scenarios.campaign.job import run
from scenarios.campaign.plan import Case
from tests.scenarios.conftest import SHORT

ACTS: dict[str, Any] = {"sensor_bias": {"sensor": "focus.lvdt", "offset": 0.01}}
SILENT: dict[str, Any] = {"frame_loss": {"identifier": 0x7FF}}


@pytest.mark.parametrize(
    ("faults", "count", "passed"),
    [([ACTS], 0, True), ([ACTS, SILENT], 1, False), ([{**SILENT, "may_not_act": True}], 1, True)],
    ids=["acts", "silent", "allowed"],
)
def test_a_row_counts_faults_that_never_acted(
    faults: list[dict[str, Any]], count: int, passed: bool, tmp_path: Path
) -> None:
    document = {**yaml.safe_load(SHORT), "faults": faults}
    document["start_utc"] = "2026-02-10T14:00:00Z"
    values = {"fault": faults[-1]}
    job = Case(
        key="a", index=0, values=values, document=document, beside=str(tmp_path), metrics=("expectations",),
    )  # fmt: skip
    row = run(job)
    assert (row["failure"], row["silent_faults"], row["passed"]) == ("", count, passed)
    assert "may_not_act" not in row["input: fault"]
    assert ("frame_loss" in row["missed"]) == (not passed)
