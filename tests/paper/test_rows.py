"""Verdicts on logs made by arithmetic: what passes, what does not, and what is said about it."""

from pathlib import Path

import numpy as np
import pytest

from plant.model import load
from scenarios.paper import judge_loop as judge
from scenarios.paper.campaign import Campaign
from scenarios.paper.command import DEFAULTS, pair
from scenarios.paper.judge_models import e8, e9
from scenarios.paper.measures import Step
from scenarios.paper.published import PUBLISHED
from scenarios.paper.rows import Row
from scenarios.paper.rundown import RunDown
from scenarios.paper.runs import HighSpeed, LowSpeed
from scenarios.paper.table import markdown
from tests.paper.synthetic import log_of

T = np.arange(0.0, 60.0, 0.01)


def wave(mean, percent, hertz=5.0, t=T):
    return log_of(mean * (1.0 + percent / 100.0 * np.sin(2 * np.pi * hertz * t)))


@pytest.mark.parametrize(("percent", "passed"), [(24.0, True), (26.0, False)])
def test_E1_peak_of_25_percent(percent, passed):
    assert judge.e1(wave(15.0, percent)).passed is passed


def test_E1_a_slow_error_within_the_peak_is_no_negligible_rms():
    row = judge.e1(wave(15.0, 20.0, hertz=0.05))
    assert not row.passed
    assert "rms" in row.reason.split(".")[0]


def test_E2_needs_limit_cycles_not_only_a_large_error():
    slip = np.tile(np.concatenate([np.zeros(600), np.full(150, 200.0)]), 8)
    assert judge.e2(log_of(slip)).passed
    assert not judge.e2(log_of(np.full(6000, 45.0))).passed


@pytest.mark.parametrize(
    ("percents", "passed"), [((3.0, 6.5), True), ((3.0, 7.5), False), ((1.0, 1.5), False)]
)
def test_E3_largest_peak_within_2_and_7_percent(percents, passed):
    runs = [HighSpeed(v, wave(v, p), None) for v, p in zip((600.0, 1000.0), percents, strict=True)]
    assert judge.e3(runs).passed is passed


@pytest.mark.parametrize(("percent", "passed"), [(0.9, True), (1.1, False)])
def test_E4_below_one_percent(percent, passed):
    assert judge.e4([(3600.0, wave(3600.0, percent))]).passed is passed


@pytest.mark.parametrize(("percent", "passed"), [(9.0, False), (12.0, True), (16.0, False)])
def test_E5_reaches_but_does_not_exceed(percent, passed):
    assert judge.e5([HighSpeed(600.0, wave(600.0, 4.0), wave(600.0, percent))]).passed is passed


def test_E6_slow_line_removed_by_the_loop():
    t = np.arange(0.0, 72.0, 0.01)
    opened = wave(100.0, 20.0, 0.0556, t)
    still = log_of(np.zeros(t.size))
    good = LowSpeed(wave(100.0, 2.0, 0.0556, t), [(90, opened), (89, still)])
    row = judge.e6(good)
    assert row.passed, row.reason
    assert row.emulated == pytest.approx(0.0556, abs=0.004)
    loud = LowSpeed(wave(100.0, 15.0, 0.0556, t), [(90, opened), (89, still)])
    assert not judge.e6(loud).passed
    stuck = LowSpeed(good.closed, [(90, still)])
    assert not judge.e6(stuck).passed


@pytest.mark.parametrize(("inertia", "passed"), [(1760.0, True), (1840.0, True), (1900.0, False)])
def test_E8_within_5_percent(inertia, passed):
    down = RunDown(inertia, 0.2, T, T)
    row = e8([down, down])
    assert row.passed is passed
    assert row.emulated == pytest.approx(inertia * 1e3)


def test_E9_similar_means_rise_overshoot_and_settled_value():
    linear = Step(0.1, 5.0, 600.0)
    assert e9(Step(0.12, 10.0, 601.0), linear, 600.0).passed
    assert not e9(Step(0.2, 10.0, 601.0), linear, 600.0).passed
    assert not e9(Step(0.12, 21.0, 601.0), linear, 600.0).passed
    assert not e9(Step(0.12, 10.0, 620.0), linear, 600.0).passed


def test_a_row_as_json_has_the_agreed_fields_and_a_miss_says_so():
    row = judge.e4([(3600.0, wave(3600.0, 2.0))])
    document = row.as_json()
    assert {"id", "published", "emulated", "unit", "passed", "reason"} <= set(document)
    assert document["id"] == "E4"
    assert document["passed"] is False
    assert document["reason"].startswith("MISS")


def test_every_row_has_its_quote_and_its_bound():
    assert list(PUBLISHED) == [f"E{k}" for k in range(1, 11)]
    assert all(len(said.quote) > 20 and len(said.bound) > 20 for said in PUBLISHED.values())


def test_the_markdown_table_counts_what_is_met():
    rows = [Row("E1", 23.5, True, "fine"), Row("E3", 8.0, False, "MISS: largest peak 8.0 %")]
    text = markdown(rows, ["a", "b"], "schmidt paper")
    assert text.startswith("1 of 2 rows met")
    assert "| E3 |" in text
    assert "**miss**" in text


def test_one_plant_file_brings_its_twin(tmp_path):
    assert pair(None, None) == DEFAULTS
    assert pair(Path("low_preload"), None) == {"low": "low_preload", "high": "high_preload"}
    (tmp_path / "my_low.yaml").touch()
    (tmp_path / "my_high.yaml").touch()
    assert pair(None, tmp_path / "my_high.yaml")["low"] == str(tmp_path / "my_low.yaml")
    assert pair(Path("other.yaml"), None)["high"] == DEFAULTS["high"]


def test_an_axis_that_never_moves_misses_its_rows_and_stops_nothing():
    class Dead:
        def closed_loop(self, arcsec_s, seconds):
            return log_of(np.zeros(round(seconds * 100)))

        def open_loop(self, effort, seconds):
            return log_of(np.zeros(round(seconds * 100)))

    plants = {preload: load(name) for preload, name in DEFAULTS.items()}
    rows = Campaign(lambda preload, gains=None: Dead(), plants, lambda text: None).rows()
    assert [row.id for row in rows] == [f"E{k}" for k in range(1, 11)]
    assert not any(row.passed for row in rows)
    assert all(row.reason.startswith("MISS") for row in rows)
