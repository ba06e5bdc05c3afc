"""A gap: the place in it between two sensors, friction that is missing in it, a side that is thrown."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from calibration.balances.view import acceleration
from calibration.finding import Finding, Parameter
from calibration.inputs.declaration import Response
from calibration.names.inplant import Facts
from calibration.names.play import NAME, columns, lag_in_gap, travel_of
from calibration.names.scene import Scene
from plant.units import ARCSEC
from tests.calibration.names.made import back_and_forth, drive

SENSOR = Response("second", "counts")
X = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(4000) / 1000)
PARTS = (0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1)


def driven_side(x: np.ndarray, gap: float) -> np.ndarray:
    """What follows through a gap, from its middle on: it is pushed by either flank and stands between."""
    out, at = np.zeros(len(x)), float(x[0])
    for k, place in enumerate(x):
        at = min(max(at, place - gap / 2), place + gap / 2)
        out[k] = at
    return out


def test_a_sensor_behind_a_gap_stands_until_it_is_crossed() -> None:
    lag = lag_in_gap(X, np.zeros(len(X), dtype=np.int64), 0.1)
    assert lag == pytest.approx(driven_side(X, 0.1) - X, abs=1e-12)


def test_two_sensors_differ_by_the_place_in_the_gap_over_it() -> None:
    noise = 0.001 * np.sin(2.0 * np.arange(4000))
    s = drive(X, response=SENSOR, residual=noise)
    *gaps, _ = columns(s)
    first = float(np.median(np.abs(noise))) / 8
    tried = [c.fixed["travel"][0] for c in gaps]
    assert tried == pytest.approx(first * 1.5 ** np.arange(len(tried)))
    assert tried[-1] < 0.2 < 1.5 * tried[-1]  # of the travel of 1
    c = gaps[-1]
    assert c.columns[:, 0] == pytest.approx((driven_side(X, tried[-1]) - X) / tried[-1], abs=1e-9)
    assert (c.sign, c.least, c.searched, c.labels) == (1, 6.0, 1, (("gap", "counts"),))
    assert c.steps == (pytest.approx(0.15 * tried[-1]),)
    assert travel_of(c) == pytest.approx(tried[-1])
    assert c.shape is not None
    tight = c.shape(np.array([-1.0]))[1:, 0]  # half of it, towards the way that it goes
    assert tight == pytest.approx(-0.5 * np.sign(np.diff(X)))


def test_of_unlike_sensors_either_may_be_behind() -> None:
    found = columns(drive(X, response=Response("second", "counts", ratio=0)))
    assert {c.sign for c in found} == {0} and {c.least for c in found} == {6.0}
    assert travel_of(found[-1]) is None  # a side that is thrown


def test_a_file_begins_where_in_the_gap_the_last_one_has_ended() -> None:
    """The second file starts at another place, which is no motion."""
    files = np.repeat([0, 1], 2000)
    x = np.where(files == 0, X, X + 5.0)
    s = drive(x, response=SENSOR, files=files, residual=np.full(4000, 0.1))
    c = columns(s)[3]
    gap = c.fixed["travel"][0]
    x[2000:] += x[1999] - x[2000]
    assert c.columns[:, 0] == pytest.approx((driven_side(x, gap) - x) / gap, abs=1e-9)


def test_a_driven_side_is_thrown_half_the_gap_back_while_the_drive_pulls() -> None:
    s = drive(X, response=SENSOR)
    c = columns(s)[-1]
    a = acceleration(s.view)
    usual = np.sqrt(np.mean(a**2))
    assert c.columns[:, 0] == pytest.approx(-0.5 * np.tanh(a / (0.1 * usual)))
    assert c.columns[20, 0] == pytest.approx(-0.5) and c.columns[500, 0] == pytest.approx(0.5)
    assert (c.sign, c.searched, c.twins, c.labels) == (1, 1, ("shaft_compliance",), (("gap", "counts"),))


def test_nothing_is_thrown_that_is_never_accelerated() -> None:
    still = drive(np.zeros(2000), response=SENSOR, direction=np.where(np.arange(2000) % 500 < 250, 1.0, -1.0))
    assert all(travel_of(c) is not None for c in columns(still))
    nothing = drive(X, response=SENSOR, ok=np.zeros(len(X), dtype=bool))
    assert columns(nothing) == []


def test_friction_is_missing_while_a_gap_is_crossed() -> None:
    s = drive(X)
    found = columns(s)
    gaps = [c.fixed["gap"][0] for c in found]
    assert gaps == pytest.approx([part * s.stroke for part in PARTS])
    c = found[-1]
    inside = np.abs(s.view.since) < gaps[-1]
    assert c.columns[:, 0] == pytest.approx(-s.view.direction * inside)
    assert (c.sign, c.searched, c.twins, c.labels) == (1, 4, ("presliding",), (("missing_force", "N"),))
    assert c.steps == (pytest.approx(0.15 * gaps[-1]),)
    assert travel_of(c) is None
    s.view.__dict__["noise"] = 0.015 * s.stroke / (6 * np.sqrt(12))
    found = columns(s)
    assert len(found) == 3 and found[0].shape is not None  # 0.02 of the stroke, 0.05 and 0.1
    least = np.abs(s.view.since) < 0.015 * s.stroke
    assert found[0].shape(np.array([0.0]))[:, 0] == pytest.approx(-s.view.direction * least)


def test_a_gap_needs_rows_within_it_and_a_drive_through_it() -> None:
    rows = np.arange(len(X))
    assert columns(drive(X, since=np.where(rows % 250 < 1, 0.0, 1.0))) == []
    assert len(columns(drive(X, since=np.where(rows % 200 < 1, 0.0, 1.0)))) == 8  # half a per cent
    assert columns(drive(X, response=Response("acceleration", "m/s2"))) == []
    assert columns(drive(np.linspace(0, 1, 2000))) == []


AXIS = back_and_forth(strokes=4, rows=500, travel=200.0)  # arcsec


def axis(force: bool = False, part: float = 1.0) -> Scene:
    """Two motors' rows, A first: apart by a wind-up of 3 arcsec per N m that the base knows."""
    x, rows = part * AXIS, np.arange(2000)
    twist = np.concatenate([0.5 + np.sin(rows / 50.0), -0.2 + 0.3 * np.cos(rows / 30.0)])
    gap = driven_side(x, 8.0) - x
    parts = {
        "both": True,
        "force": force,
        "problem": SimpleNamespace(
            y=3.0 * twist - np.tile(gap, 2), base=twist[:, None], place=lambda name: 0
        ),
        "pair": SimpleNamespace(motion=SimpleNamespace(rows=rows)),
        "declared": {"compliance": 3.0},
        "view": SimpleNamespace(x=(x + gap) * ARCSEC, run=np.zeros(2000, dtype=np.int64)),
    }
    return cast(Scene, cast(Any, SimpleNamespace(**parts)))


def test_a_coupling_of_an_axis_encoder_stands_while_the_axis_crosses_it() -> None:
    """The axis is where the encoder is and by what both motors lead, less their wind-up."""
    s = axis()
    found = columns(s)
    assert [c.fixed["travel"][0] for c in found] == [0.6, 1.2, 2.5, 5.0, 10.0, 20.0, 40.0, 80.0]
    for gap in (8.0, 0.1):
        shape = found[0].shape
        assert shape is not None
        mine = (driven_side(AXIS, gap) - AXIS) / gap
        asked = gap if gap > 1 else -2.0
        assert shape(np.array([asked]))[:, 0] == pytest.approx(-np.tile(mine, 2), abs=1e-6)
    c = found[3]
    assert (c.sign, c.searched, c.stage, c.labels[0][0]) == (1, 0, "axis", "gap")
    assert c.fixed["travel"][1] == "arcsec" and columns(axis(force=True)) == []


def test_no_gap_of_an_axis_beyond_half_its_travel() -> None:
    assert [c.fixed["travel"][0] for c in columns(axis(part=0.1))] == [0.6, 1.2, 2.5, 5.0]


def test_no_gap_between_sensors_that_is_wider_than_a_fifth_of_the_travel() -> None:
    """The narrowest that is tried is an eighth of what is left."""
    for left, count in ((1.61, 0), (1.59, 1)):
        found = columns(drive(X, response=SENSOR, residual=np.full(len(X), left)))
        assert sum(travel_of(c) is not None for c in found) == count


def test_a_plant_has_the_gap_at_the_absolute_encoder() -> None:
    f = Finding("play", "K", "axis_angle", parameters={"gap": Parameter(3.0, "arcsec")})
    (effect,) = NAME.to_plant(f, Facts("a.log")).effects
    assert effect.parameters["gap"].value == 3.0 and effect.parameters["encoder"].value == 1.0
    second = NAME.to_plant(f.having(encoder=Parameter(2.0, "")), Facts("a.log")).effects[0]
    assert second.parameters["encoder"].value == 2.0
