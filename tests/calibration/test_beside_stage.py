"""A line within the cell of a stage's order: the stage's own, or a bearing's next to it."""

import numpy as np
import pytest

from calibration.candidates.axis_lines import gear_lines
from calibration.candidates.context import Context
from calibration.channels.problem import Problem
from calibration.decide.select import Selection, select
from calibration.inputs.telescope import telescope
from calibration.inputs.train import train_of
from plant.gears import ORDERS as STAGES

PERIOD_S, ROWS = 0.03, 6000
TRAVEL = 0.3  # of a turn of the axis, as the logs of the blind tests travel: a cell is 3.3 orders
AMPLITUDE, NOISE = 4.0, 0.8  # N m


def said(order: float) -> Selection:
    """What is chosen among the gear's lines when a line of `order` per axis turn is in the torque."""
    rng = np.random.default_rng(5)
    t = PERIOD_S * np.arange(ROWS)
    turns = TRAVEL / 2 * (1 - np.cos(2 * np.pi * t / 60.0))  # there and back, three times
    speed = np.gradient(2 * np.pi * turns, PERIOD_S)
    run = np.repeat(np.arange(4), ROWS // 4)
    zero = np.zeros(ROWS)
    session = np.zeros(ROWS, dtype=np.int64)
    c = Context(
        t,
        2 * np.pi * turns,
        speed,
        np.sign(speed),
        zero,
        run,
        session,
        "N m",
        "rad",
        2 * np.pi,
        zero,
        train=train_of(telescope("ra")),
    )
    y = AMPLITUDE * np.cos(2 * np.pi * order * turns + 0.7) + NOISE * rng.standard_normal(ROWS)
    base = np.column_stack([np.ones(ROWS), speed])
    labels = [("offset", "N m"), ("viscous", "N m s/rad")]
    valid = np.ones(ROWS, dtype=bool)
    problem = Problem("T", "N m", y, base, labels, t, run, session, valid, run == 3, PERIOD_S)
    return select(problem, gear_lines(c, PERIOD_S), rng)


def test_a_bearing_beside_a_stage_is_not_that_stage() -> None:
    order = STAGES["roller"] - 1.0  # 0.3 of a cell
    (found,) = said(order).chosen
    assert found.candidate.name == "bearing_pass"
    assert found.candidate.fixed["order"][0] == pytest.approx(order, abs=0.05)


@pytest.mark.parametrize("stage", ["roller", "shaft2", "mesh1", "motor"])
def test_a_stage_keeps_its_line(stage: str) -> None:
    (found,) = said(STAGES[stage]).chosen
    assert (found.candidate.stage, found.candidate.harmonic) == (stage, 1)
