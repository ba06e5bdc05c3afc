"""What a row says about figures from many starts: median, worst, and that one start is enough to miss it."""

from datetime import date

import pytest

from scenarios.studies.paper.experiments import EXPERIMENTS
from scenarios.studies.paper.experiments.experiment import EVER, Experiment, Limit
from scenarios.studies.paper.rows import Row, markdown
from scenarios.studies.paper.run_experiments import measure, row_of, select
from scenarios.studies.paper.starts import ANGLES_DEG, QUICK, SEEDS, STARTS
from tests.studies.paper.docs_page import PAGE, page

BAND = Limit(figure="peak", unit="%", low=10.0, high=25.0, words="peak", scale=5.0)
FLOOR = Limit(figure="cycles", unit="1", low=3.0, high=EVER, words="cycles", scale=2.0)


def experiment(measure=None):
    return Experiment(
        id="E1",
        limits=(BAND, FLOOR),
        measure=measure or (lambda b: {}),
    )


def row(*peaks, failed=None):
    found = {start: {"peak": peak, "cycles": 5.0} for start, peak in zip(STARTS, peaks, strict=False)}
    return Row(experiment(), found, failed or {})


def test_a_row_is_met_at_every_start_or_not_at_all():
    assert row(12.0, 20.0, 24.9).passed
    assert not row(12.0, 20.0, 25.1).passed
    assert not row(9.9, 20.0, 20.0).passed
    assert not row(12.0, float("nan")).passed
    assert not row().passed
    assert not row(12.0, failed={STARTS[5]: "no steady state"}).passed


def test_the_worst_is_the_value_farthest_out_and_the_median_stands_beside_it():
    found = row(12.0, 20.0, 40.0)
    assert found.worst(BAND) == 40.0
    assert found.median("peak") == 20.0
    assert found.decisive is BAND
    assert row(20.0, 4.0, 26.0).worst(BAND) == 4.0
    assert found.reason.startswith(
        "MISS: peak 20, worst 40 % (10–25) at 1 of 3 starts. cycles 5, worst 5 (≥ 3)"
    )


def test_a_row_as_json_has_the_agreed_fields():
    document = row(12.0, 40.0).as_json()
    assert {"id", "published", "emulated", "unit", "passed", "reason"} <= set(document)
    assert (document["emulated"], document["unit"], document["passed"]) == (40.0, "%", False)
    assert [limit["missed_at"] for limit in document["limits"]] == [1, 0]
    assert len(document["starts"]) == 2


def test_the_markdown_table_counts_what_is_met():
    text = markdown([row(12.0), row(40.0)], ["a", "b"], "schmidt paper", date(2026, 11, 22))
    assert "**1 of 2 rows are met**" in text and "2026-11-22" in text
    assert "**miss**" in text.split("## Missed")[1].split("## Met")[0]
    assert "**miss**" not in text.split("## Met")[1]
    names, rule = text.split("## Missed\n")[1].split("\n")[:2]
    assert names.count("|") == rule.count("|") == 8


def test_eight_angles_and_three_seeds():
    assert len(set(ANGLES_DEG)) >= 8
    assert {start.seed for start in STARTS} == set(SEEDS)
    assert len(SEEDS) >= 3
    assert len(STARTS) == len(ANGLES_DEG)
    assert set(QUICK) < set(STARTS)


def test_every_row_quotes_the_paper_and_says_what_it_is_held_to():
    assert [row.id for row in EXPERIMENTS] == [f"E{k}" for k in range(1, 16)]
    for row in EXPERIMENTS:
        assert len(row.said["quote"]) > 20 and len(row.said["bound"]) > 20
        assert row.limits
        assert all(limit.low <= limit.high and limit.scale > 0.0 for limit in row.limits)


def test_an_experiment_that_cannot_be_evaluated_misses_its_row_and_stops_nothing():
    def refuse(_benches):
        raise ValueError("the axis did not come to rest")

    refusing = experiment(refuse)
    found = row_of(refusing, {start: measure(refusing, {}, start) for start in QUICK})
    assert not found.passed
    assert "did not come to rest" in found.reason


def test_rows_can_be_chosen_and_a_wrong_name_is_said():
    assert [row.id for row in select("e6, E1")] == ["E1", "E6"]
    assert len(select(None)) == 15
    with pytest.raises(ValueError, match="'E99' is no row; there are E1"):
        select("E99")


def test_the_page_is_what_the_rows_say():
    assert PAGE.read_text(encoding="utf-8") == page()
