"""Shapes without a name: splines, scales that move, loops, springs and brushes, by their own formulas."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from calibration.balances.volts import Counter, Windings
from calibration.inputs.declaration import Response, Stage
from calibration.names import unknown_shapes as shapes
from calibration.names.scene import MOTOR, Scene
from tests.calibration.names.made import back_and_forth, drive

SENSOR = Response("second", "counts")
STROKES = back_and_forth()


@pytest.mark.parametrize("knots", [4, 7])
def test_splines_hold_every_cubic_but_one_without_the_first_column(knots: int) -> None:
    """Together with the constant they reproduce any cubic; all B-splines sum to one (de Boor)."""
    x = np.linspace(-2.0, 3.0, 400)
    columns = shapes.spline_columns(x, knots)
    assert columns.shape == (400, knots - 1)
    h = 5.0 / (knots - 3)
    first = np.clip(1.0 - (x + 2.0) / h, 0.0, 1.0) ** 3
    assert columns.sum(axis=1) == pytest.approx(1.0 - first, abs=1e-12)
    full = np.column_stack([np.ones(400), columns])
    cubic = 1.0 + x - 2.0 * x**2 + 0.5 * x**3
    assert full @ np.linalg.lstsq(full, cubic, rcond=None)[0] == pytest.approx(cubic, abs=1e-9)
    assert shapes.spline_columns(np.full(5, 2.0), knots).shape == (5, 0)


def test_a_loop_has_the_height_of_one_and_turns_over_within_twice_its_radius() -> None:
    s = drive(STROKES)
    one, half = shapes.loops(s.view, [0.1, 0.05]).T
    assert one[:500] == pytest.approx(np.minimum(STROKES[:500] / 0.1, 1.0))
    assert half[499] == 1.0
    back = 0.998 - STROKES[500:1000]  # from the last row before the turn
    # the first row after it goes 0.002 on
    assert one[501:1000] == pytest.approx(np.maximum(1.0 - (back[1:] + 0.002) / 0.1, -1.0))


def test_a_scale_that_moves_has_the_place_and_the_offset_along_with_it() -> None:
    x = 3.0 + STROKES
    s = drive(x, response=SENSOR)
    drift, knots = shapes.moving_scale(s)
    t = np.arange(len(x)) / (len(x) - 1)
    assert drift.columns == pytest.approx(np.column_stack([t * (x - x.mean()), t]))
    assert drift.labels == (("scale_drift_0", "counts/m"), ("offset_drift_0", "counts"))
    splines = shapes.spline_columns(s.view.t, 4)
    assert knots.columns == pytest.approx(np.hstack([splines * (x - x.mean())[:, None], splines]))
    assert knots.domain == "time" and len(knots.labels) == knots.width == 6
    assert shapes.moving_scale(drive(x)) == []
    s.problem.t = np.full(len(x), 2.0)  # no time goes by
    (still,) = shapes.moving_scale(s)
    assert not still.columns.any()


def test_lost_motion_is_three_loops_a_third_as_wide_each() -> None:
    """The widest is 0.02 to 0.4 of the stroke, which is the travel but for its last twentieth."""
    s = drive(STROKES, response=SENSOR)
    stroke = float(np.quantile(np.abs(s.view.since), 0.95))
    found = shapes.lost_motion(s)
    assert [c.domain for c in found] == ["reversal"] * 5 and {c.searched for c in found} == {1}
    for part, c in zip((0.02, 0.05, 0.1, 0.2, 0.4), found, strict=True):
        radii = [part * stroke, part * stroke / 3, part * stroke / 9]
        assert c.columns == pytest.approx(shapes.loops(s.view, radii))
        assert [label for label, _ in c.labels] == [f"loop_of_{r:.3g}" for r in radii]


def test_no_lost_motion_of_a_force_one_way_of_unlike_sensors_or_within_the_noise() -> None:
    unlike = Response("second", "counts", ratio=0)
    one_way = np.linspace(0, 1, 2000)
    for s in drive(STROKES), drive(one_way, response=SENSOR), drive(STROKES, response=unlike):
        assert shapes.lost_motion(s) == []
    s = drive(STROKES, response=SENSOR)
    s.view.__dict__["noise"] = 1.1 * 0.1 / 9 * s.stroke / (6 * np.sqrt(12))
    assert len(shapes.lost_motion(s)) == 2  # the narrowest loop of 0.02, 0.05 and 0.1 is not resolved


def test_a_spring_pulls_in_proportion_to_the_place_of_a_slide() -> None:
    (c,) = shapes.spring(drive(STROKES))
    assert c.columns[:, 0] == pytest.approx(STROKES - STROKES.mean())
    assert c.labels == (("stiffness", "N/m"),) and c.domain == "axis_angle"
    assert shapes.spring(drive(STROKES, response=SENSOR)) == []
    assert shapes.spring(drive(STROKES, rig={"estimate": ("stiffness",)})) == []
    assert shapes.spring(drive(STROKES, rig={"constants": {"stiffness": 1.0}})) == []


@pytest.mark.parametrize(("turns", "count"), [(0.9 / 72, 1), (1.1 / 72, 0)])
def test_over_an_angle_a_spring_is_one_on_less_than_a_weight_needs(turns: float, count: int) -> None:
    assert len(shapes.spring(drive(STROKES * turns * 360 / 0.998, unit="deg", turn=360.0))) == count


def test_grease_bends_with_the_square_of_the_speed() -> None:
    s = drive(np.where(np.arange(2000) < 1000, STROKES, 0.5 * STROKES), declared={"viscous": 1.0})
    (c,) = shapes.bend(s)
    top = np.quantile(np.abs(s.view.speed), 0.95)
    assert c.columns[:, 0] == pytest.approx(np.sign(s.view.speed) * (s.view.speed / top) ** 2)
    assert c.labels == (("square", "N"),) and c.domain == "velocity"
    assert shapes.bend(drive(STROKES)) == []
    assert shapes.bend(drive(STROKES, response=SENSOR, declared={"viscous": 1.0})) == []
    velocity = Response("velocity", "m/s")
    assert shapes.bend(drive(STROKES, response=velocity, declared={"viscous": 1.0})) == []
    assert not shapes.bend(drive(np.zeros(9), declared={"viscous": 1.0}))[0].columns.any()


@pytest.mark.parametrize("size", [0.0, 1.0])
def test_a_viscous_term_that_was_taken_out_is_a_part_of_the_bend(size: float) -> None:
    """A friction that is an arch over the speed rises first: the square alone only falls."""
    rate = np.gradient(STROKES)
    base = np.column_stack([np.ones(2000), size * rate])
    s = drive(STROKES, base=base, declared={"viscous": size})
    s.problem.base_labels = [("offset", "N"), ("viscous", "N s/m")]
    (c,) = shapes.bend(s)
    part = s.view.speed / s.view.top
    square = part * np.abs(part)
    assert c.columns == pytest.approx(np.column_stack([part, square] if size == 0 else [square]))
    assert [name for name, _ in c.labels] == (["slope", "square"] if size == 0 else ["square"])


def pulled(lagging: np.ndarray) -> Scene:
    """Of two motors, four rows each, A's first."""
    rows = np.arange(4)
    windings = Windings(
        at=lambda x: x,
        current=np.arange(8.0) + 1,
        rate=np.array([1.0, 2.0, 3.0, 4.0, 10.0, 20.0, 30.0, 40.0]),
        clock=np.zeros(8),
        counter=Counter(share=np.full(8, 0.5), lagging=lagging, dragged=np.zeros(8)),
        constant=0.2,
    )
    a = np.repeat([1.0, 0.0], 4)
    parts = {
        "windings": windings,
        "pair": SimpleNamespace(train=SimpleNamespace(ratio=100.0)),
        "view": SimpleNamespace(x=np.array([0.0, 0.001, 0.002, 0.003]), rows=np.tile(rows, 2)),
        "motors": [(a, {"motor": (1.0, MOTOR)}), (1 - a, {"motor": (2.0, MOTOR)})],
    }
    return cast(Scene, cast(Any, SimpleNamespace(**parts)))


def test_a_lagging_motor_that_follows_lacks_the_leading_ones_emf() -> None:
    """Its volts are the share of the leading motor's back-EMF: constant times share times rate."""
    lagging = np.array([1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0])
    following, *_ = shapes.of_volts(pulled(lagging))
    emf = 0.2 * 0.5 * np.array([10.0, 20.0, 0.0, 0.0, 0.0, 0.0, 3.0, 4.0])
    assert following.columns[:, 0] == pytest.approx(emf)
    assert (following.domain, following.sign, following.most) == ("current", 1, 2.0)


def test_brushes_of_either_motor_are_volts_and_ohms_over_its_turn() -> None:
    _, *brushes = shapes.of_volts(pulled(np.zeros(8)))
    told = [(c.fixed["motor"][0], c.labels[0][1]) for c in brushes]
    assert told == [(1.0, "V"), (1.0, "ohm"), (2.0, "V"), (2.0, "ohm")]
    turn = 100.0 * np.tile([0.0, 0.001, 0.002, 0.003], 2)
    second = np.repeat([0.0, 1.0], 4)
    assert brushes[2].columns[:, :2] == pytest.approx(
        second[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
    )
    ohms = second * (np.arange(8) + 1)
    assert brushes[3].columns[:, -1] == pytest.approx(ohms * np.sin(6 * turn))
    for c in brushes:
        assert (c.kind, c.stage, c.harmonic, c.domain) == ("line", "motor", 1, "motor_angle")


@pytest.mark.parametrize("kind", ["motor", "motor_cogging"])
def test_one_motors_brushes_are_a_resistance_over_its_angle(kind: str) -> None:
    x = np.linspace(0, 3.0, 3000)
    stages = (Stage("drum", 0.5, None, 2, "shaft"), Stage("motor", 1.0, None, 1, kind))
    current = 2.0 + x
    s = drive(x, rig={"stages": stages}, columns={"current": current}, response=Response("voltage", "V"))
    found = shapes.of_volts(s)
    assert [(c.stage, c.harmonic, c.labels[0]) for c in found] == [
        ("motor", h, ("amplitude", "ohm")) for h in range(1, 7)
    ]
    third = 2 * np.pi * 3 * x
    assert found[2].columns == pytest.approx(
        current[:, None] * np.column_stack([np.cos(third), np.sin(third)])
    )
    assert {c.domain for c in found} == {"motor_angle"}
    without = Windings(at=lambda y: y, current=current, rate=current, clock=current)
    s.windings = without
    assert len(shapes.of_volts(s)) == 6
