"""Columns of lines: of a stage in an axis' encoders, of an order that moves."""

from dataclasses import replace

import numpy as np
import pytest

from calibration.balances.problem import Problem
from calibration.inputs.declaration import Response
from calibration.inputs.train import SHAFT
from calibration.names.lines import cell, movable, stage_lines
from calibration.names.pair import Pair
from calibration.names.scene import Scene
from plant.gears import ORDERS
from tests.calibration.test_physics import DT, moved

ROWS = 9000
TRAVEL = 0.3  # of a turn


def scene(channel: str) -> Scene:
    """Of an axis that goes there and back; K: motor A's rows before motor B's."""
    t = DT * np.arange(ROWS)
    turns = TRAVEL / 2 * (1 - np.cos(2 * np.pi * t / 60.0))
    m = moved(2 * np.pi * turns)
    stacked = 2 if channel == "K" else 1
    at = np.tile(m.rows, stacked)
    one = np.zeros(len(at))
    problem = Problem(
        channel=channel,
        unit="arcsec" if channel == "K" else "N m",
        y=one,
        base=one[:, None],
        base_labels=[("offset", "")],
        t=t[at],
        run=one.astype(np.int64),
        session=one.astype(np.int64),
        valid=one == 0,
        held=one > 0,
        period_s=m.cell_s,
    )
    response = Response("motor", "arcsec") if channel == "K" else m.response
    view = replace(m, rows=at, response=response)
    motor = np.repeat([0.0, 1.0], len(m.rows)) if channel == "K" else None
    pair = Pair(motion=m, motor=motor)
    return Scene(view, problem, {}, one, np.zeros((len(one), 0)), pair=pair)


def test_a_shaft_twists_both_trains_or_one() -> None:
    s = scene("K")
    found = [c for c in stage_lines(s, SHAFT) if (c.stage, c.harmonic) == ("shaft2", 1)]
    assert len(found) == 3
    half = len(s.problem.y) // 2
    shown = [(bool(c.columns[:half].any()), bool(c.columns[half:].any())) for c in found]
    assert shown == [(True, True), (True, False), (False, True)]
    assert found[0].order == pytest.approx(ORDERS["shaft2"])
    assert not any(c.neighbours for c in found)


def test_a_motors_shaft_turns_with_the_motor() -> None:
    for channel in "KT":
        domains = {c.stage: c.domain for c in stage_lines(scene(channel), SHAFT)}
        assert domains.pop("motor") == "motor_angle"
        assert set(domains.values()) == {"axis_angle"}


def test_a_torques_line_has_others_within_its_cell_on_both_sides() -> None:
    s = scene("T")
    one = next(c for c in stage_lines(s, SHAFT) if c.stage == "shaft2")
    low, high = cell(ORDERS["shaft2"], TRAVEL)
    off = [(c.order or 0.0) - ORDERS["shaft2"] for c in one.neighbours]
    assert min(off) < 0 < max(off)
    assert all(low < (c.order or 0.0) < high for c in one.neighbours)
    # a fifth of a cell off, and no nearer than a twentieth or further than 0.35 of it
    assert sorted(off) == pytest.approx([-0.2 / s.span * s.turn, 0.2 / s.span * s.turn])
    for c, way in zip(one.neighbours, np.sign(off), strict=True):
        for asked, part in ((way * 1e6, 0.35), (-way * 1e6, 0.05)):
            moved = c.moved(np.array([asked]))
            bound = ORDERS["shaft2"] + way * part / s.span * s.turn
            assert moved.at_order == pytest.approx(bound)
            assert c.shape is not None and moved.columns == pytest.approx(c.shape(np.array([bound])))


def test_an_order_moves_no_further_than_its_bounds() -> None:
    s = scene("T")
    rate = 20.0 / (2 * np.pi)  # per rad
    within = (rate - 0.1, rate + 0.2)
    (c,) = movable(s, rate, within)
    assert c.fixed["order"][0] == pytest.approx(20.0)
    far, bound = (c.moved(np.array([order])).columns for order in (40.0, within[1] * s.turn))
    assert far == pytest.approx(bound)
    assert c.moved(np.array([20.0])).columns == pytest.approx(c.columns)
    assert c.moved(np.array([20.5])).columns != pytest.approx(c.columns)
