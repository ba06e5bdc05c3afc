"""Parts of a draft: units by steps, factors of a rate, a second sensor, a force that nobody named."""

from typing import Any

import numpy as np
import pytest

from calibration.inputs.draft import (
    _against_the_set_point,
    _by_motion,
    _Draft,
    _integral,
    _like,
    _response,
    _Role,
    _same_place,
    _scaled,
    _smoothest,
    _unit,
    _unnamed,
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


def explained(rate: np.ndarray, *roles: _Role, **named: _Role) -> _Draft:
    d = drafted()
    d.roles = {"position": _Role("p", "deg", np.cumsum(rate))} | named
    _response(d)
    return d


FREE = np.concatenate([np.ones(600), -np.ones(400)])


@pytest.mark.parametrize(
    ("rate", "terms"),
    [
        (FREE, ["inertia", "viscous", "coulomb", "offset"]),
        (np.where(np.arange(1000) < 940, 1.0, -1.0), ["inertia", "viscous", "coulomb", "offset"]),
        (np.where(np.arange(1000) < 960, 1.0, -1.0), ["inertia", "viscous", "offset"]),
        (1.0 + 0.31 * np.sin(np.arange(1000) / 50), ["inertia", "viscous", "offset"]),
        (1.0 + 0.25 * np.sin(np.arange(1000) / 50), ["offset"]),
    ],
)
def test_terms_are_those_that_the_motion_tells_apart(rate: np.ndarray, terms: list[str]) -> None:
    d = explained(rate, effort=_Role("u", "A", rate))
    assert d.fields["response"] == ({"channel": "effort", "unit": "A"}, "")
    assert d.fields["estimate"] == (terms, "")


def test_the_first_force_is_explained_by_the_normal_one_where_both_have_a_unit() -> None:
    roles = {"effort": _Role("u", "", FREE), "force": _Role("f", "N", FREE), "normal": _Role("n", "N", FREE)}
    d = explained(FREE, **roles)
    assert d.fields["response"][0] == {"channel": "force", "unit": "1", "divide_by": "normal"}
    assert d.unsaid == ["'u' is not explained: force is"] and set(d.roles) == {"position", "force", "normal"}
    roles["normal"] = _Role("n", "kN", FREE)
    d = explained(FREE, **roles)
    assert d.fields["response"][0] == {"channel": "force", "unit": "N"} and "normal" not in d.roles
    assert explained(FREE, effort=_Role("u", "", FREE)).fields["response"][0]["unit"] == "units"


ONE_WAY = np.full(1000, 1.0)


@pytest.mark.parametrize(
    ("rate", "named", "response", "terms"),
    [
        (ONE_WAY, {"velocity": _Role("v", "deg/s", ONE_WAY)}, ("velocity", "deg/s"), ["offset"]),
        (
            FREE,
            {"velocity": _Role("v", "deg/s", FREE)},
            ("acceleration", "deg/s2"),
            ["viscous", "coulomb", "offset"],
        ),
        (FREE, {}, ("acceleration", "deg/s2"), ["viscous", "coulomb", "offset"]),
        (ONE_WAY, {}, ("position", "deg"), None),
        (FREE, {"reference": _Role("r", "", FREE)}, ("position2", "deg"), None),
    ],
)
def test_without_a_force_a_speed_or_a_free_motion_is_explained(
    rate: np.ndarray, named: dict[str, _Role], response: tuple[str, str], terms: list[str] | None
) -> None:
    d = explained(rate, **named)
    told, why = d.fields["response"]
    assert (told["channel"], told["unit"]) == response
    assert why == ("" if response[0] == "position2" else "the log shows no force")
    assert d.fields.get("estimate") == (None if terms is None else (terms, ""))


def test_a_position_at_constant_rate_has_no_stages_and_an_integral_explains_the_speed() -> None:
    d = drafted()
    d.roles, d.fields["stages"] = {"position": _Role("p", "deg", K * 1.0)}, ([], "")
    _response(d)
    assert "stages" not in d.fields
    d = drafted()
    d.roles = {
        "position": _Role("v", "deg", np.cumsum(FREE), more={"integrated": True}),
        "velocity": _Role("v", "deg/s", FREE),
        "reference": _Role("r", "", FREE),
    }
    _response(d)
    assert d.fields["response"][0]["channel"] == "velocity" and d.roles["reference"].unit == "deg"
