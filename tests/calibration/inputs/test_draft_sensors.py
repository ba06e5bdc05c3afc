"""Columns of a draft by what moves with what: set points, second sensors, rates and nameless forces."""

import numpy as np
import pytest

from calibration.inputs.draft import (
    _against_the_set_point,
    _by_motion,
    _Draft,
    _integral,
    _Role,
    _same_place,
    _smoothest,
    _unnamed,
)
from tests.calibration.inputs.test_draft_motion import OTHER, SLOW, K, drafted


def set_point(x: np.ndarray, p: np.ndarray, scale: float = 1.0) -> _Draft:
    d = drafted(other=x)
    d.roles["position"] = _Role("p", "deg", p * scale, scale)
    _same_place(d, d.roles["position"], np.gradient(p))
    return d


def test_what_leads_the_position_is_asked_for_and_what_lags_is_measured() -> None:
    late = np.roll(SLOW, 4)
    d = set_point(SLOW, late, 2.0)
    other = d.roles["reference"]
    assert (other.column, other.unit, other.scale) == ("other", "deg", 2.0)
    assert other.why == "it moves as the position does" and d.roles["position"].column == "p"
    d = set_point(late, SLOW)
    assert (d.roles["reference"].column, d.roles["position"].column) == ("p", "other")
    assert (
        d.roles["position"].x.tolist() == late.tolist() and d.roles["reference"].x.tolist() == SLOW.tolist()
    )


@pytest.mark.parametrize(("aside", "found"), [(0.14, True), (0.15, False)])
def test_two_columns_of_one_place_go_together_by_99_of_100(aside: float, found: bool) -> None:
    assert ("reference" in set_point(SLOW + aside * OTHER, SLOW).roles) is found  # 1 / sqrt(1 + aside^2)


@pytest.mark.parametrize(
    ("steps", "own", "found"),
    [
        (0.03, 0.03, "position2"),
        (0.03, 0.03002, "position2"),
        (0.03, 0.0301, ""),
        (0.01, 0.01, ""),  # what a text rounds to is no sensor
        (0.010015, 0.010015, ""),
        (0.01005, 0.01005, "position2"),
    ],
)
def test_a_sensor_of_the_same_steps_is_a_second_one(steps: float, own: float, found: str) -> None:
    rng = np.random.default_rng(1)
    x, p = (step * rng.integers(-40, 40, 2000) for step in (steps, own))
    d = set_point(x, p, 0.5)
    assert [c for c in d.roles if c != "position"] == ([found] if found else [])
    if found:
        said = d.roles[found]
        assert (said.unit, said.scale, said.why) == ("deg", 0.5, "it has the position's steps")


def test_a_position_of_another_scale_is_compared_in_the_columns_own_unit() -> None:
    """A counter of 256 steps that wraps, 0.5 deg each: the draft joins it before any rate is taken."""
    counts = np.round(4 * np.cumsum(SLOW)) % 256
    d = drafted(p=counts, v=SLOW)
    d.put("position", "p", "deg", 0.5)
    _by_motion(d)
    p = d.roles["position"]
    assert p.more == {"wrap": 256.0} and np.abs(np.diff(p.x)).max() <= 0.5 * 5
    assert d.roles["velocity"].column == "v" and d.roles["velocity"].scale == pytest.approx(2.0, rel=0.02)


def test_the_strongest_of_several_columns_is_the_rate() -> None:
    d = drafted(p=np.cumsum(SLOW), a=OTHER, v=SLOW)
    d.put("position", "p", "deg")
    _by_motion(d)
    assert d.roles["velocity"].column == "v" and set(d.left) == {"a"}


def test_a_set_point_stands_for_the_position_where_no_force_is_logged() -> None:
    d = drafted()
    d.roles = {"position": _Role("p", "deg", SLOW)}
    assert _against_the_set_point(d) == []
    d.roles["reference"] = _Role("r", "deg", SLOW)
    assert _against_the_set_point(d) == ["position2"]
    assert (d.roles["position"].column, d.roles["position2"].column) == ("r", "p")
    assert d.roles["position2"].why == "against what is asked for, as the log shows no force"
    d.roles = {c: _Role(c, "deg", SLOW) for c in ("position", "reference", "velocity")}
    assert _against_the_set_point(d) == [] and "position2" not in d.roles


@pytest.mark.parametrize(("share", "found"), [(0.04, False), (0.06, True), (0.5, True)])
def test_a_column_that_goes_with_the_motion_is_a_force(share: float, found: bool) -> None:
    aside = np.sqrt(1 / share - 1)
    fast = np.sqrt(2.0) * np.cos(2 * np.pi * 7 * K / 500)  # is soft itself, and not like the motion
    root = SLOW / SLOW.std()
    soft = np.exp(-((5 * 2 * np.pi * 7 / 500) ** 2) / 2)
    d = drafted(weak=0.01 * np.cos(2 * np.pi * 11 * K / 500), u=root + aside * fast / soft)
    assert _unnamed(d, 3.0 * SLOW) == (["effort"] if found else [])
    if found:
        role = d.roles["effort"]
        by = "rate, direction and acceleration explain"
        assert role.why == f"{by} {100 * share:.0f} % of it" and (role.column, role.scale) == ("u", 1.0)


def test_no_column_is_no_force() -> None:
    assert _unnamed(drafted(), SLOW) == []


def test_a_position_that_nobody_logged_is_the_speeds_integral() -> None:
    d = drafted(0.5)
    none = _integral(d)
    assert none.line("position") == (
        "  position: {unit: turn, steps: [[0, 1.0]], integrated: true}   # guessed: there is "
        "none; give the speed"
    )
    assert len(none.x) == 9
    for unit, whole in (("deg/s", "deg"), ("rpm", "units")):
        d.roles["velocity"] = _Role("v", unit, np.full(4, 3.0), 2.0)
        found = _integral(d)
        assert (found.column, found.unit, found.scale, found.more) == ("v", whole, 2.0, {"integrated": True})
        assert found.x.tolist() == [1.5, 3.0, 4.5, 6.0]
        assert found.why == "there is none: the speed's integral"


def test_the_column_whose_slope_another_shows_is_the_position_else_the_smoothest() -> None:
    speed = SLOW + 0.5 * OTHER
    by_rate = "another column is its rate"
    assert _smoothest(drafted(a=OTHER, v=speed, x=np.cumsum(speed))) == ("x", "", 1.0, by_rate)
    other = _smoothest(drafted(a=OTHER, v=-speed, x=np.cumsum(speed)))  # the slope goes the other way
    assert other == ("x", "", 1.0, "the smoothest column")
    assert _smoothest(drafted(a=OTHER, b_deg=SLOW)) == ("b_deg", "deg", 1.0, "the smoothest column")
    wrapped = drafted(a=OTHER, b=7.0 * K % 360)
    assert _smoothest(wrapped)[0] == "b"  # a counter is smooth where it is joined


@pytest.mark.parametrize(
    ("mean", "aside", "found"),
    [(0.0, 0.4, True), (0.0, 0.47, False), (2.0, 0.49, True), (2.0, 0.52, False)],
)
def test_a_nameless_rate_is_one_by_four_fifths_and_more_so_than_by_its_sign(
    mean: float, aside: float, found: bool
) -> None:
    """Its sign explains 8 / pi^2 of a sine, and half of the rest may be left; of a one-way motion nothing."""
    rate, twice = mean + SLOW, np.cos(2 * np.pi * 2 * K / 500)
    d = drafted(p=np.cumsum(rate), v=rate + aside * twice)
    d.put("position", "p", "deg")
    _by_motion(d)
    assert ("velocity" in d.roles) is found
    if found:
        assert d.roles["velocity"].why.startswith("goes with the position's rate")


def test_friction_goes_with_the_direction_and_is_no_rate() -> None:
    d = drafted(p=np.cumsum(SLOW), u=np.sign(SLOW))
    d.put("position", "p", "deg")
    _by_motion(d)
    assert "velocity" not in d.roles
