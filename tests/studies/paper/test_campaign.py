"""The table on the emulator at two starts, over processes: what it says to be met is met there too."""

import json
import re
from pathlib import Path

import pytest

from plant.model import load
from scenarios.studies.options import HIGH, LOW
from scenarios.studies.paper.experiments import EXPERIMENTS
from scenarios.studies.paper.run_experiments import as_json, run_rows
from scenarios.studies.paper.starts import QUICK

pytestmark = pytest.mark.long

TABLE = Path(__file__).parents[3] / "docs" / "results" / "experiments.md"


@pytest.fixture(scope="module")
def plants():
    return {"low": load(LOW), "high": load(HIGH)}


@pytest.fixture(scope="module")
def rows(plants):
    return run_rows({"": plants}, EXPERIMENTS, QUICK)[""]


def test_the_json_has_the_agreed_shape(rows):
    document = json.loads(json.dumps(as_json(rows, {"low": LOW, "high": HIGH}, 1.0, QUICK)))
    assert [row["id"] for row in document["rows"]] == [f"E{k}" for k in range(1, 16)]
    for row in document["rows"]:
        assert isinstance(row["passed"], bool)
        assert row["published"] and row["unit"] and row["reason"]
        assert row["reason"].startswith("MISS") is not row["passed"]


def test_rows_that_the_table_calls_met_are_met_here(rows):
    text = TABLE.read_text(encoding="utf-8").split("## One number of the drive off")[0]
    verdicts = dict(re.findall(r"^\| (E\d+) \|.*?\| (met|\*\*miss\*\*) \|", text, flags=re.M))
    assert len(verdicts) == len(rows)
    assert [row.id for row in rows if verdicts[row.id] == "met" and not row.passed] == []


def test_the_plants_are_the_papers_where_the_paper_speaks(plants):
    for preload, sigma2, vs, coulomb, stiction in (
        ("low", 6700.0, 4e-4, 229.0, 621.0),
        ("high", 11300.0, 7e-4, 217.0, 1490.0),
    ):
        friction = plants[preload].axes.ra.friction
        assert friction.viscous.value == sigma2
        assert friction.stribeck_rate.value == vs
        assert friction.coulomb.value == coulomb
        assert friction.stiction.value == stiction
    assert plants["low"].controller == plants["high"].controller
    assert plants["low"].axes.ra.motor == plants["high"].axes.ra.motor
