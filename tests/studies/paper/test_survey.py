from math import exp

import numpy as np
import pytest

from scenarios.studies.paper.starts import STARTS, Benches
from tests.studies.paper.compiled import CompiledBench
from tests.studies.paper.cost import BY_ID, Term, worst
from tests.studies.paper.objective import Objective
from tests.studies.paper.space import SPACE, bounds
from tests.studies.paper.statics import shortfalls_of
from tests.studies.paper.survey import Look, draw, looks, markdown


@pytest.fixture(scope="module")
def objective():
    return Objective(STARTS, 10, print)


def test_points_are_the_seeds_lie_everywhere_within_the_bounds_and_pass_the_statics(objective, monkeypatch):
    monkeypatch.setattr("tests.studies.paper.survey.DRAWN", 1 << 12)
    points, share = draw(objective, 5)
    again, _ = draw(objective, 5)
    other, _ = draw(objective, 6)
    assert np.array_equal(points, again)
    assert not np.array_equal(points[:5], other[:5])
    assert share == len(points) / (1 << 12)
    low, high = np.array(bounds()).T
    assert ((low <= points) & (points <= high)).all()
    for k, free in enumerate(SPACE):
        if free.name not in ("torque_constant", "resistance", "electrical_time"):  # those, statics decide
            assert np.ptp(points[:, k]) > 0.9 * (high[k] - low[k]), free.name
    for x in points[:20]:
        found = {free.name: exp(v) for free, v in zip(SPACE, x, strict=True)}
        assert shortfalls_of(found, 1.0 / 2.774) == 0.0


def test_a_point_is_run_from_the_start_that_its_place_says(objective):
    points, _ = draw(objective, 1)
    one = next(looks(objective, points[:1], ("E4", "E9")))
    assert set(one.terms) == {"E4", "E9"}
    bench = Benches(CompiledBench, objective.plants(points[0]), STARTS[0])
    assert one.terms["E4"] == worst(BY_ID["E4"], [bench])
    assert set(one.found) == {free.name for free in SPACE}


def term(row, figure, value, excess):
    return Term(row, figure, value, excess, max(0.0, excess) / 3.0)


def test_the_table_counts_what_is_met_and_says_what_is_never_met_together():
    def look(e9, e14):
        return Look({}, {"E9": term("E9", "effort", 15.0, e9), "E14": term("E14", "stall", 6.2, e14)})

    text = markdown([look(-0.1, 1.0), look(-0.2, 2.0), look(0.5, -0.1)], 0.25, "seed 9", ("E9", "E14"))
    assert "3 points, seed 9; statics allow 25 % of the space. At most 1 of these 2 rows" in text
    e9, e14 = (line for line in text.splitlines() if line.startswith("| E"))
    assert e9.startswith("| E9 | 2 | settled effort off 15 % (-20–20) |")
    assert e9.endswith("| all |")
    assert e14.startswith("| E14 | 1 | stalled current at full duty 6.2 A (5.4–6.6) |")
