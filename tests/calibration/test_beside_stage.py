"""A line within the cell of a stage's order: the stage's own, or a bearing's next to it."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from calibration.balances.problem import Problem
from calibration.decide.select import select
from calibration.decide.selection import Selection
from calibration.inputs.rigfile import telescope
from calibration.inputs.train import train_of
from calibration.look.scene import view_of_pair
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
    m, train = moved(2 * np.pi * turns), train_of(telescope("ra"))
    run, session = np.repeat(np.arange(4), ROWS // 4), np.zeros(ROWS, dtype=np.int64)
    made = m.at(AMPLITUDE * np.cos(2 * np.pi * order * turns + 0.7))
    y = made + NOISE * rng.standard_normal(len(m.pick))
    base = np.column_stack([np.ones(len(y)), m.rate[m.pick]])
    labels = [("offset", "N m"), ("viscous", "N m s/rad")]
    at = run[m.pick]
    valid = np.ones(len(y), dtype=bool)
    problem = Problem(
        channel="T",
        unit="N m",
        y=y,
        base=base,
        base_labels=labels,
        t=t[m.pick],
        run=at,
        session=session[m.pick],
        valid=valid,
        held=at == 3,
        period_s=m.period_s,
    )
    log = SimpleNamespace(rig=telescope("ra"), train=train, t=t, one_clock=t, run=session, period_s=DT)
    frame = cast(Any, log)
    pair = cast(Pair, SimpleNamespace(motion=m, train=train))
    view = view_of_pair(frame, m)
    scene = Scene(view, problem, {}, y, np.zeros((len(y), 0)), pair=pair)
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
