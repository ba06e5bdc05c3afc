"""Parts of a draft: units by steps, factors of a rate, a second sensor, a force that nobody named."""

from typing import Any

import numpy as np
import pytest

from calibration.inputs.draft import (
    _Draft,
    _like,
    _Role,
    _scaled,
    _unit,
)  # fmt: skip

K = np.arange(2000.0)
SLOW = np.sin(2 * np.pi * K / 500)  # what a filter of five rows leaves as it is, but for two in a thousand
OTHER = np.sin(2 * np.pi * 3 * K / 500)  # is not like it at all


def drafted(period_s: float = 1.0, **left: Any) -> _Draft:
    columns: dict[str | int, Any] = {str(c): x for c, x in left.items()}
    return _Draft(columns, period_s=period_s)


@pytest.mark.parametrize(
    ("role", "line"),
    [
        (_Role("q", "deg", K), "  position: {column: q, unit: deg}"),
        (
            _Role(3, "", K, 2.5, "by luck"),
            "  position: {column: 3, unit: units, scale: 2.5}   # guessed: by luck",
        ),
        (_Role("", "turn", K, more={"integrated": True}), "  position: {unit: turn, integrated: true}"),
    ],
)
def test_a_role_is_a_line_of_the_rig_file(role: _Role, line: str) -> None:
    assert role.line("position") == line


def test_a_column_is_put_in_its_channel_in_its_unit() -> None:
    d = drafted(a=K * 1.0, b=K * 1.0)
    found = d.put("effort", "a", "A", 1e-3, "so")
    assert (found.column, found.unit, found.scale, found.why) == ("a", "A", 1e-3, "so")
    assert found.x.tolist() == (1e-3 * K).tolist() and d.roles == {"effort": found} and set(d.left) == {"b"}
    assert _Draft({}).period_s == 1.0 and d.put("force", "b", "N").scale == 1.0
    assert drafted(0.1).rate(0.3 * K) == pytest.approx(np.full(2000, 3.0))


def test_a_share_and_a_slope_are_those_of_a_straight_line() -> None:
    assert _like(2 * SLOW + 1, SLOW + 5) == pytest.approx((1.0, 2.0))
    assert _like(SLOW + OTHER, SLOW) == pytest.approx((0.5, 1.0))
    assert _like(SLOW, np.ones(2000)) == pytest.approx((0.0, 0.0))


def position(x: np.ndarray, unit: str = "", column: str = "p", **more: Any) -> tuple[_Draft, _Role]:
    d, p = drafted(), _Role(column, unit, x, more=more)
    _unit(d, p)
    return d, p


def stepped(step: float, travel: float = 4.0) -> np.ndarray:
    """To and fro by `travel` in steps, each of which comes."""
    count = round(travel / step)
    return step * np.concatenate([np.arange(count + 1.0), np.arange(count, -1.0, -1.0)])


BITS = "its unit: a turn is {} of its steps"


@pytest.mark.parametrize(
    ("x", "column", "unit", "why"),
    [
        (stepped(2 * np.pi / 4096), "p", "rad", BITS.format(4096)),
        (stepped(2 * np.pi / 128), "p", "rad", BITS.format(128)),
        (stepped(2 * np.pi / 64), "p", "units", "its unit is not said"),
        (stepped(360 / 2**14), "p", "deg", BITS.format(2**14)),
        (stepped(1 / 512, 2.0), "p", "turn", BITS.format(512)),
        (stepped(2 * np.pi / 4096 * (1 + 6e-5)), "p", "rad", BITS.format(4096)),
        (stepped(2 * np.pi / 4096 * (1 + 8e-5)), "p", "units", "its unit is not said"),
        (12.5 * SLOW / np.ptp(SLOW), "theta", "rad", "its unit, as the name is an angle's"),
        (12.6 * SLOW / np.ptp(SLOW), "theta", "units", "its unit is not said"),  # 4 pi are two turns
        (12.5 * SLOW / np.ptp(SLOW), "x", "units", "its unit is not said"),
    ],
)
def test_a_unit_is_told_by_the_steps_or_the_name(x: np.ndarray, column: str, unit: str, why: str) -> None:
    d, p = position(x, column=column)
    assert (p.unit, p.why) == (unit, why)
    assert d.unsaid == ["the gear table (stages)"] and "turn" not in d.fields


@pytest.mark.parametrize(
    ("unit", "wrap", "travel", "turn"),
    [
        ("turn", 0.0, 3.0, None),
        ("turn", 0.0, 3.01, 1.0),
        ("deg", 0.0, 1081.0, 360.0),
        ("counts", 100.0, 301.0, 100.0),
    ],
)
def test_three_turns_are_worth_a_stage(unit: str, wrap: float, travel: float, turn: float | None) -> None:
    d, p = position(np.linspace(0.0, travel, 2000), unit, **dict[str, Any]({"wrap": wrap} if wrap else {}))
    shaft = [{"name": "shaft", "period": turn, "harmonics": 12, "kind": "unknown"}]
    stages = {"stages": (shaft, "one turn of the position; give the gear table")}
    said = {"turn": (100.0, "the counter's length is a turn")} if wrap else {}
    assert d.fields == ({} if turn is None else stages) | said
    assert d.unsaid == (["the gear table (stages)"] if turn is None else []) and p.unit == unit


def test_a_counters_length_has_the_columns_scale() -> None:
    d, p = drafted(), _Role("p", "", np.linspace(0.0, 900.0, 2000), -2.0, "so", {"wrap": 128.0})
    _unit(d, p)
    assert d.fields["turn"][0] == 256.0 and p.why == "so; its unit is not said"


@pytest.mark.parametrize("factor", [1.0, 1 / 60, 6.0, np.pi / 30, np.pi / 180, 180 / np.pi, 1e-3])
@pytest.mark.parametrize(("off", "exact"), [(1.0, True), (1.02, True), (-0.98, True), (1.1, False)])
def test_a_rates_factor_is_one_between_units_or_its_own(factor: float, off: float, exact: bool) -> None:
    d, p = drafted(), _Role("p", "deg", SLOW)
    v = _Role("v", "", SLOW / (factor * off), 1.0, "")
    d.roles["velocity"] = v
    _scaled(d, v, p, SLOW)
    if exact:
        assert v.scale == pytest.approx(np.copysign(factor, off), rel=1e-11) and v.why == ""
    else:
        assert v.scale == pytest.approx(factor * off, rel=4e-3)
        assert v.why == "its factor, by the position's rate" and float(f"{v.scale:.5g}") == v.scale
    assert v.unit == "deg/s" and v.x == pytest.approx(SLOW, abs=6e-3)


@pytest.mark.parametrize(("aside", "kept"), [(0.49, True), (0.52, False)])
def test_a_rate_explains_four_fifths_of_a_velocity(aside: float, kept: bool) -> None:
    d, p = drafted(), _Role("p", "deg", SLOW)
    v = d.roles["velocity"] = _Role("v", "", 2.0 * (SLOW + aside * OTHER), 0.5, "so")
    _scaled(d, v, p, SLOW)
    said = "what 'v' is: it does not go with the position's rate; it is left out"
    assert d.unsaid == ([] if kept else [said]) and ("velocity" in d.roles) is kept
    if kept:
        assert v.scale == pytest.approx(0.25 / (1 + aside**2), rel=0.01)
        assert v.why.startswith("so; its factor")


@pytest.mark.parametrize(("scatter", "kept"), [(0.19, True), (0.21, False)])
def test_a_steady_rate_has_the_factor_of_the_means(scatter: float, kept: bool) -> None:
    d, p = drafted(), _Role("p", "rad", SLOW)
    v = d.roles["velocity"] = _Role("v", "", np.full(2000, 1.0) + OTHER, 1.0, "")
    _scaled(d, v, p, 6.0 * (1 + np.sqrt(2) * scatter * SLOW))
    assert ("velocity" in d.roles) is kept
    assert v.scale == (6.0 if kept else 1.0)
