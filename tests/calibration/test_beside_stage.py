"""A line within the cell of a stage's order: the stage's own, or a bearing's next to it."""

import numpy as np
import pytest

from calibration.balances.problem import Problem
from calibration.decide.select import select
from calibration.decide.selection import Selection
from calibration.names import NAMES
from calibration.names.pair import Pair
from calibration.names.scene import Scene
from plant.gears import ORDERS as STAGES
from tests.calibration.test_physics import DT, moved

ROWS = 18000
TRAVEL = 0.3  # of a turn of the axis, as the logs of the blind tests travel: a cell is 3.3 orders
AMPLITUDE, NOISE = 4.0, 0.8  # N m


def said(order: float) -> Selection:
    """What is chosen among the gear's lines when a line of `order` per axis turn is in the torque."""
    rng = np.random.default_rng(5)
    t = DT * np.arange(ROWS)
    turns = TRAVEL / 2 * (1 - np.cos(2 * np.pi * t / 60.0))  # there and back, three times
    m = moved(2 * np.pi * turns)
    run, session = np.repeat(np.arange(4), ROWS // 4), np.zeros(ROWS, dtype=np.int64)
    made = m.at(AMPLITUDE * np.cos(2 * np.pi * order * turns + 0.7))
    y = made + NOISE * rng.standard_normal(len(m.rows))
    base = np.column_stack([np.ones(len(y)), m.speed[m.rows]])
    labels = [("offset", "N m"), ("viscous", "N m s/rad")]
    at = run[m.rows]
    valid = np.ones(len(y), dtype=bool)
    problem = Problem(
        channel="T",
        unit="N m",
        y=y,
        base=base,
        base_labels=labels,
        t=t[m.rows],
        run=at,
        session=session[m.rows],
        valid=valid,
        held=at == 3,
        period_s=m.cell_s,
    )
    scene = Scene(m, problem, {}, y, np.zeros((len(y), 0)), pair=Pair(motion=m))
    lines = [c for name in ("gear_eccentricity", "gear_mesh") for c in NAMES[name].columns(scene)]
    return select(problem, lines, rng)


def test_a_bearing_beside_a_stage_is_not_that_stage() -> None:
    order = STAGES["roller"] - 1.0  # 0.3 of a cell
    (found,) = said(order).chosen
    assert found.candidate.name == "bearing_pass"
    assert found.candidate.fixed["order"][0] == pytest.approx(order, abs=0.05)


@pytest.mark.parametrize("stage", ["roller", "shaft2", "mesh1", "motor"])
def test_a_stage_keeps_its_line(stage: str) -> None:
    (found,) = said(STAGES[stage]).chosen
    assert (found.candidate.stage, found.candidate.harmonic) == (stage, 1)
