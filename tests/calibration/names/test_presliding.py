"""Friction that builds up over a travel: loops and bristles less the declared friction, by their laws."""

import numpy as np
import pytest

from calibration.inputs.declaration import FrictionLaw, Response
from calibration.names.name import TOLERANCE
from calibration.names.presliding import NAME, columns
from tests.calibration.names.made import drive

RADII = (0.0005, 0.002, 0.005, 0.01, 0.02, 0.04, 0.08, 0.14, 0.2, 0.28, 0.36)
X = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(3000) / 1000)  # slow where it turns


def element(x: np.ndarray, radius: float) -> np.ndarray:
    """A spring that slides at 1: after a reversal it goes from one side to the other over two radii."""
    out = np.zeros(len(x))
    for k in range(1, len(x)):
        out[k] = min(max(out[k - 1] + (x[k] - x[k - 1]) / radius, -1.0), 1.0)
    return out


def test_loops_of_one_and_of_two_widths_less_the_friction_that_is_declared() -> None:
    s = drive(X)
    found = columns(s)
    bent = [c for c in found if "breakaway_travel" in c.fixed]
    assert [c.width for c in bent] == [1, 2] * 11 and len(found) == 33
    assert all(len(c.labels) == c.width for c in found)
    assert [c.fixed["breakaway_travel"][0] for c in bent[::2]] == pytest.approx(
        [part * s.stroke for part in RADII]
    )
    radius = RADII[6] * s.stroke
    one, two = bent[12:14]
    wide, narrow = (element(X, r) - s.view.direction for r in (radius, radius / 2))
    assert one.columns[:, 0] == pytest.approx(wide)
    assert two.columns == pytest.approx(np.column_stack([wide, narrow]))
    assert one.labels == (("loop_force", "N"),) and one.sign == two.sign == 1
    assert two.labels[1] == ("second_loop_force", "N")


def test_bristles_give_way_by_and_by() -> None:
    """Dahl: after a reversal the friction is 1 - 2 exp(-travel / bristle travel) of the new side."""
    s = drive(X)
    c = [c for c in columns(s) if "bristle_travel" in c.fixed][6]
    travel = c.fixed["bristle_travel"][0]
    assert travel == pytest.approx(0.08 * s.stroke)
    stroke = slice(520, 980)
    back = 1.0 - X[stroke]
    dahl = -(1.0 - 2.0 * np.exp(-back / travel)) + 1.0
    assert c.columns[stroke, 0] == pytest.approx(dahl, abs=0.03)
    assert c.sign == 1


def test_a_travel_stays_within_what_is_resolved_and_what_slides() -> None:
    s = drive(X)
    shape = [c.shape for c in columns(s) if c.width == 1 and "breakaway_travel" in c.fixed][3]
    assert shape is not None
    for asked, taken in ((9.0, 0.36 * s.stroke), (0.0, 1e-6 * s.stroke), (0.1, 0.1)):
        assert shape(np.array([asked]))[:, 0] == pytest.approx(element(X, taken) - s.view.direction)
    s.view.__dict__["noise"] = 0.05 / (6 * np.sqrt(12))
    one, two = (
        next(c.shape for c in columns(s) if c.width == width and "breakaway_travel" in c.fixed)
        for width in (1, 2)
    )
    assert one is not None and two is not None
    assert one(np.array([0.01]))[:, 0] == pytest.approx(element(X, 0.05) - s.view.direction)
    for asked, wide, narrow in ((0.06, 0.06, 0.05), (0.01, 0.05, 0.05), (0.2, 0.2, 0.1)):
        expected = np.column_stack([element(X, r) - s.view.direction for r in (wide, narrow)])
        assert two(np.array([asked])) == pytest.approx(expected)


def test_a_loop_is_tried_where_the_position_resolves_it_and_enough_rows_lie_within() -> None:
    s = drive(X)
    s.view.__dict__["noise"] = 0.015 * s.stroke / (6 * np.sqrt(12))
    assert len(columns(s)) == 3 * 7  # from 0.02 of the stroke on
    assert len(columns(drive(X, since=np.where(np.arange(len(X)) % 200 < 1, 0.0, 1.0)))) == 33  # just that
    few = drive(X, since=np.where(np.arange(len(X)) % 250 < 1, 0.0, 1.0))
    assert columns(few) == []  # one row in 250 is less than half a per cent
    many = drive(X, since=np.where(np.arange(len(X)) % 150 < 1, 0.0, 1.0))
    assert len(columns(many)) == 33
    twice = drive(X, since=np.where(np.arange(len(X)) % 150 < 1, 0.03, 1.0))
    # a loop is closed after two radii: 0.03 lies within those of 0.02 on
    assert min(c.point[0] for c in columns(twice)) == 0.02


def test_no_loop_one_way_and_every_file_begins_at_rest() -> None:
    assert columns(drive(np.linspace(0, 1, 3000))) == []
    files = np.repeat([0, 1], 1500)
    s = drive(X, files=files)
    for c in columns(s)[18:21]:
        assert c.columns[1500] == pytest.approx(c.columns[0] + s.view.direction[0] - s.view.direction[1500])


def test_a_declared_dip_is_taken_off_with_the_friction() -> None:
    law = FrictionLaw(stiction_ratio=1.5, stribeck_speed=0.2)
    s = drive(X, rig={"friction_law": law}, response=Response("force", "N"))
    c = columns(s)[0]
    declared = s.view.direction * (1 + 0.5 * np.exp(-((s.view.speed / 0.2) ** 2)))
    assert c.columns[:, 0] == pytest.approx(element(X, 0.0005 * s.stroke) - declared)


def test_no_element_is_narrower_than_a_millionth_of_the_stroke() -> None:
    slow = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(40_000) / 40_000)  # 6e-9 from the first row to the second
    s = drive(slow)
    s.view.__dict__["noise"] = 0.0
    shape = columns(s)[0].shape
    assert shape is not None
    expected = element(slow, 1e-6 * s.stroke) - s.view.direction
    assert shape(np.array([0.0]))[:50, 0] == pytest.approx(expected[:50])


def test_a_stiffness_is_another_beyond_what_nobody_published_and_an_estimates_scatter() -> None:
    """1.7 times, and 1.29 times more."""
    assert NAME.changed is not None and NAME.changed.factor == pytest.approx(1.7 * TOLERANCE, rel=0.01)
