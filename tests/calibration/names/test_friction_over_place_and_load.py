"""Friction over the place and under a load, lines of an encoder, a roller that slips: columns by hand."""

from dataclasses import replace
from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.finding import Finding, Parameter
from calibration.inputs.declaration import Stage
from calibration.names import encoder_subdivision, load_friction, position_friction, roller_slip
from calibration.names.inplant import Facts
from plant.gears import ORDERS
from plant.units import ARCSEC
from tests.calibration.names.made import PERIOD_S, back_and_forth, drive

ROWS = 1000
T = np.arange(0.0, ROWS) * PERIOD_S
X = np.sin(2 * np.pi * T / 4.0)
WAY = np.sign(np.gradient(X))
PULL = 3.0 * np.cos(2 * np.pi * T / 1.3) + np.sin(2 * np.pi * T / 0.7)  # N, what the drive carries
slips: Any = roller_slip
loads: Any = load_friction
places: Any = position_friction


def loaded(mu: float, *, constant: float = 0.0, known: float = 0.0, force: Any = PULL, **more: Any) -> Any:
    """A force of a pull, of Coulomb's 2 N, and in proportion to the load; `known` is declared."""
    load = np.abs(force + constant + known)
    y = force + constant + 2.0 * WAY + mu * load * WAY
    rig = {"constants": {"offset": known}} if known else {}
    s = drive(X, base=np.column_stack([force, WAY, np.ones(ROWS)]), y=y,
              declared={"inertia": 1.0, "coulomb": 2.0},
              rig=rig, **more)  # fmt: skip
    s.problem.base_labels = [("inertia", "kg"), ("coulomb", "N"), ("offset", "N")]
    return s


@pytest.mark.parametrize(("constant", "known"), [(0.0, 0.0), (4.0, 0.0), (0.0, 5.0)])
def test_friction_grows_with_what_the_terms_make_or_that_without_friction(
    constant: float, known: float
) -> None:
    s = loaded(0.2, constant=constant, known=known)
    whole, carried = load_friction.columns(s)
    load = np.abs(PULL + constant + known)
    assert carried.columns[:, 0] == pytest.approx(WAY * load, rel=1e-3, abs=1e-3)
    made = s.problem.y + known
    assert np.corrcoef(np.abs(whole.columns[:, 0]), np.abs(made))[0, 1] > 0.99
    assert (whole.sign, whole.most, whole.labels) == (1, 0.5, (("coefficient", "1"),))


def test_a_load_that_does_not_rub_or_has_one_size_is_none() -> None:
    assert (
        load_friction.columns(loaded(-0.2))
        == []
        == load_friction.columns(loaded(0.2, direction=np.ones(ROWS)))
    )
    still = loaded(0.2, force=1e-3 * np.sin(7 * T), constant=9.0)
    one = load_friction.columns(still)  # the load is one of nine newtons, what the motor makes is not
    assert len(one) == 1 and np.ptp(np.abs(one[0].columns)) > 1.0


@pytest.mark.parametrize(
    ("declared", "dynamic", "enough"),
    [
        ({"applied": 1.0}, False, True), ({"inertia": 1.0}, True, True), ({"inertia": 1.0}, False, False),
        ({"gravity_cos": 1.0}, True, True), ({"gravity_cos": 1.0}, False, False), 
        ({"coulomb": 1.0}, True, False),
    ],
)  # fmt: skip
def test_a_load_is_accelerated_hangs_or_is_applied(
    declared: dict[str, float], dynamic: bool, enough: bool
) -> None:
    s = drive(X, declared=declared, dynamic=dynamic)
    assert (load_friction.lacks(s) == "") == enough
    if not enough:
        assert load_friction.columns(s) == []


def test_two_trains_carry_the_load_and_twice_the_counter_torque() -> None:
    s = drive(X)
    pair: Any = Some(load=-PULL, lagging=WAY, sliding=None)
    (c,) = load_friction.columns(replace(s, pair=pair))
    assert c.columns[:, 0] == pytest.approx(s.view.direction * (np.abs(PULL) + 2.0))


TRAVEL: np.ndarray = back_and_forth(travel=3.0)
WAYS: np.ndarray = np.repeat([1.0, -1.0, 1.0, -1.0], 500)


def uneven(turn: float | None = None, *stages: Stage, coulomb: float = 0.5, **more: Any) -> Any:
    return position_friction.columns(
        drive(
            TRAVEL, turn=turn, declared={"coulomb": coulomb}, rig={"stages": stages}, direction=WAYS, **more
        )
    )


def test_friction_over_the_range_over_stages_and_of_any_length() -> None:
    span = 3.0
    found = uneven()
    fixed, free = found[:3], found[3:]
    assert [c.order for c in fixed] == pytest.approx([h / span for h in (1, 2, 3)])
    assert [(c.stage, c.harmonic, c.most) for c in fixed] == [("axis", h, 1.0) for h in (1, 2, 3)]
    for h, c in enumerate(fixed, 1):
        phase = 2 * np.pi * TRAVEL * h / span
        assert c.columns == pytest.approx(WAYS[:, None] * np.column_stack([np.cos(phase), np.sin(phase)]))
        assert (c.kind, c.labels) == ("line", (("amplitude", "N"),))
    waves = [c.fixed["order"][0] * span for c in free]
    assert waves == pytest.approx(np.arange(0.75, 12.1, 0.5)) and len(waves) == 23
    assert free[0].steps == (pytest.approx(0.1 / span),) and free[0].kind == "line"
    phase = 2 * np.pi * TRAVEL * 0.75 / span
    assert free[0].columns[:, 1] == pytest.approx(WAYS * np.sin(phase))
    assert uneven(coulomb=0.0)[0].most == np.inf
    turned = uneven(2.0)
    assert [c.order for c in turned[:3]] == pytest.approx([1.0, 2.0, 3.0])  # per turn, which is shorter
    assert turned[3].fixed["order"][0] == pytest.approx(0.75 * 2.0 / span)
    assert uneven(9.0)[0].order == pytest.approx(9.0 / span)


def test_friction_over_a_stage_turns_one_and_a_half_times() -> None:
    one = Stage("worm", 1.9, None, 20, None)
    by_stage = [c for c in uneven(None, one) if c.stage == "worm"]
    assert [c.harmonic for c in by_stage] == [*range(1, 13), None]  # and all of them as one
    slow = [c for c in uneven(None, Stage("worm", 2.1, None, 1, None)) if c.stage == "worm"]
    assert slow == []  # 1.4 turns
    phase = 2 * np.pi * TRAVEL / 1.9
    assert by_stage[0].columns[:, 0] == pytest.approx(WAYS * np.cos(phase))


def test_friction_over_the_place_needs_both_ways_and_travel() -> None:
    assert uneven(ok=np.zeros(2000, dtype=bool)) == []
    one_way = drive(TRAVEL, direction=np.ones(2000))
    assert position_friction.columns(one_way) == []
    still = drive(np.zeros(2000), direction=WAYS)
    assert position_friction.columns(still) == []


@pytest.mark.parametrize("order", [1.0, 2.0, 3.4, 17.3, 123.4, 1e5])
def test_the_place_of_an_order_is_the_nearest_harmonic_of_a_stage(order: float) -> None:
    stage, harmonic = position_friction.nearest_place(order)
    best = min(abs(one * h - order) for one in ORDERS.values() for h in range(1, 1001))
    assert abs(ORDERS[stage] * harmonic - order) == pytest.approx(best) and 1 <= harmonic <= 1000


@pytest.mark.parametrize(("off", "span", "told"), [(0.4, 0.49, False), (0.4, 0.51, True), (-0.4, 0.51, True)])
def test_a_phase_is_right_at_mid_travel_and_what_walks_off_is_told(
    off: float, span: float, told: bool
) -> None:
    f = Finding("position_friction", "T", "axis_angle", order=1.0 + off)
    f = f.having(amplitude=Parameter(2.0, "N m"), phase=Parameter(0.3, "rad"))
    made = position_friction.to_plant(f, Facts("a.log", middle=0.7, span=span))
    (effect,) = made.effects
    stage, harmonic = position_friction.nearest_place(1.0 + off)
    written = ORDERS[stage] * harmonic
    phase = -0.3 + (written - 1.0 - off) * 0.7
    assert (
        effect.parameters["phase"].value == pytest.approx(phase) and effect.parameters["amplitude"].value == 2
    )
    assert (effect.stage, effect.harmonic) == (stage, harmonic)
    assert bool(made.remarks) == (abs(written - 1.0 - off) * span / 2 > 0.1)
    if written == 1.0:
        assert bool(made.remarks) == told


def test_a_stage_of_a_finding_has_its_order() -> None:
    f = Finding("position_friction", "T", "axis_angle", stage="shaft2", harmonic=2)
    (effect,) = position_friction.to_plant(f, Facts("a.log")).effects
    assert ORDERS[effect.stage or ""] * effect.harmonic == pytest.approx(2 * ORDERS["shaft2"])
    (axis,) = position_friction.to_plant(
        Finding("position_friction", "T", "axis_angle"), Facts("a.log")
    ).effects
    assert (axis.stage, axis.harmonic) == ("axis", 1)


def subdivided(speed: Any, lines: float | None = 100.0) -> Any:
    s = drive(X, speed=speed, rig={"encoder_periods": lines, "stages": (
        Stage("tape", 0.1, None, 1, "encoder_subdivision"),
    )})  # fmt: skip
    s.problem.channel = "S"
    return encoder_subdivision.columns(s)


@pytest.mark.parametrize(("slow", "there"), [(20, True), (19, False)])
def test_interpolation_shows_where_a_fiftieth_of_the_rows_is_slow(slow: int, there: bool) -> None:
    """Three tenths of a line a row: 1.885 rad/s of a hundred lines a turn, every 10 ms."""
    limit = 0.3 * 2 * np.pi / 100.0 / PERIOD_S
    found = subdivided(np.where(np.arange(ROWS) < slow, 0.999 * limit, limit))
    assert bool(found) == there
    if there:
        (c,) = found
        phase = 100.0 * X
        each = [g(k * phase) for k in (1, 2) for g in (np.cos, np.sin)]
        assert c.columns == pytest.approx(np.column_stack(each))
        assert (c.order, c.harmonic, c.kind) == (100.0, 1, "line")
        assert [name for name, _ in c.labels] == ["amplitude", "second"]


def test_lines_that_are_declared_as_a_stage_or_by_no_count() -> None:
    assert {c.stage for c in subdivided(np.ones(ROWS), None)} == {"tape"}


@pytest.mark.parametrize(("order", "second"), [(None, False), (16384.0, True)])
def test_an_interpolation_error_in_a_plant_is_the_absolute_encoder_s(
    order: float | None, second: bool
) -> None:
    f = Finding("encoder_subdivision", "S", "axis_angle", order=order)
    f = f.having(amplitude=Parameter(0.02, "arcsec"), phase=Parameter(0.5, "rad"))
    if second:
        f = f.having(second=Parameter(0.01, "arcsec"), second_phase=Parameter(0.2, "rad"))
    (effect,) = encoder_subdivision.to_plant(f, Facts("a.log")).effects
    numbers = {k: n.value for k, n in effect.parameters.items()}
    assert numbers["lines"] == (order or 32768.0) and numbers["encoder"] == 1.0
    assert numbers["amplitude"] == 0.02 and numbers["phase"] == pytest.approx(0.5 - np.pi / 2)
    assert numbers["second"] == (0.01 if second else 0.0)
    if second:
        assert numbers["second_phase"] == pytest.approx(0.2 - np.pi / 2)


def test_a_roller_loses_a_share_or_what_is_beyond_its_limit() -> None:
    """Of an acceleration that is shaken within a row: half of a row at the limit, all of it far beyond."""
    rate, chatter = np.array([2.0, 2.0, -2.0, 2.0, 2.0]), 0.1
    acceleration = np.array([1.0, 1.5, -1.5, 0.5, 1.1])
    share = slips._share(rate, acceleration, 1.0, chatter)
    assert share == pytest.approx([1.0, 2.0, -2.0, 0.0, 2 * 0.8413], abs=1e-4)
    small = slips._share(rate[:1], np.zeros(1), 0.1, 0.1)  # beyond either limit once in three
    assert small == pytest.approx([2 * 0.3173], abs=1e-4)
    excess = slips._excess(rate, acceleration, 1.0, chatter)
    at_limit, one_off = chatter / np.sqrt(2 * np.pi), chatter * (0.24197 + 0.84134)
    assert excess == pytest.approx([at_limit, 0.5, -0.5, 0.0, one_off], abs=1e-5)


def slipping(quick: int, roller: str | None = "roller", rates: bool = True, pair: bool = True) -> Any:
    """A thousand rows, of which so many are beyond all limits that are tried, and the others at rest."""
    x = np.where(np.arange(ROWS) < 500, 1e-3 * np.arange(ROWS) ** 2 * PERIOD_S**2, 0.0)
    m = Some(x=x, acceleration=np.where(np.arange(ROWS) < quick, 0.03, 0.0), rows=np.arange(ROWS),
             at=lambda full: full)  # fmt: skip
    s = drive(X)
    s.problem.channel = "S" if rates else "K"
    train = Some(one=lambda name: roller)
    given: Any = Some(motion=Some(width=7, **vars(m)), train=train, motor=None) if pair else None
    return roller_slip.columns(replace(s, pair=given))


@pytest.mark.parametrize(("quick", "there"), [(2, False), (3, True), (599, True), (600, False)])
def test_a_limit_is_tried_where_some_rows_are_beyond_it_and_not_most(quick: int, there: bool) -> None:
    found = slipping(quick)
    assert len(found) == (8 * 2 * 2 if there else 0)
    if there:
        first, second = found[:2]
        assert first.fixed == {"threshold": (0.0005, "rad/s2"), "chatter": (pytest.approx(5e-5), "rad/s2")}
        assert second.fixed["chatter"] == (0.00025, "rad/s2") and first.labels[0][0] == "slip"
        assert found[2].labels[0][0] == "creep" and first.stage == "roller" and first.sign == 1
        assert first.steps == pytest.approx((5e-5, 1e-5)) and first.searched == 0


def test_a_slip_is_of_rates_and_of_a_roller() -> None:
    assert slipping(99, roller=None) == [] == slipping(99, rates=False) == slipping(99, pair=False)


def test_a_slip_s_columns_are_minus_the_rate_that_is_lost() -> None:
    """Twice the acceleration of 1e-3 rad/s2, four times the limit: all of the rate, in arcsec/s."""
    c = slipping(99)[0]
    row = 250
    rate = 2e-3 * row * PERIOD_S
    assert c.columns[row, 0] == pytest.approx(-rate / ARCSEC, rel=1e-6)
    assert c.shape is not None
    tight = c.shape(np.array([9.0, 9.0]))  # a limit is a tenth at most, and half of it is chatter
    wide = c.shape(np.array([-0.1, 0.05]))
    assert tight == pytest.approx(wide) and not np.array_equal(tight, c.columns)
    creep = slipping(99)[2]
    assert creep.columns[row, 0] == pytest.approx(-(2e-3 - 0.0005) / ARCSEC, rel=1e-3)


def test_what_is_applied_may_switch_its_sign() -> None:
    """Of 4 N to and fro, behind no filter: the load is what is applied, with the pull, and its friction."""
    applied = np.where(np.arange(ROWS) // 70 % 2 == 0, 4.0, -4.0)
    y = PULL - 1.5 * applied + 2.0 * WAY + 0.2 * np.abs(PULL - 1.5 * applied) * WAY
    base = np.column_stack([PULL, WAY, applied])
    s = drive(X, base=base, y=y, declared={"applied": 1.0}, columns={"applied": applied})
    s.problem.base_labels = [("inertia", "kg"), ("coulomb", "N"), ("applied", "1")]
    whole, carried = load_friction.columns(s)
    assert carried.columns[:, 0] == pytest.approx(WAY * np.abs(PULL - 1.5 * applied), abs=1e-2)
    moves = s.view.direction != 0
    assert np.abs(whole.columns[moves, 0]) == pytest.approx(np.abs(y[moves]), abs=0.1)
