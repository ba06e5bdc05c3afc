"""Lines of shafts, discs and motors, and what each becomes in a plant: worked out from the place."""

from dataclasses import replace
from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.finding import UNKNOWN, Finding, Parameter
from calibration.inputs.declaration import Response, Stage
from calibration.inputs.train import SHAFT
from calibration.names import (
    encoder_eccentricity,
    friction_asymmetry,
    gear_eccentricity,
    magnet_weakening,
    preload_change,
    supply_sag,
    torque_ripple,
    winding_heating,
)  # fmt: skip
from calibration.names.inplant import Facts
from plant.gears import ORDERS
from tests.calibration.names.made import PERIOD_S, drive

ROWS = 2000
T = PERIOD_S * np.arange(0.0, ROWS)
X = 5.0 * np.sin(2 * np.pi * T / 10.0)  # 10 units of travel
SENSORS = Response("position2", "arcsec")


def discs(*stages: Stage, turn: float | None = 4.0, x: Any = X, pair: Any = None, files: Any = None) -> Any:
    s = drive(x, response=SENSORS, turn=turn, rig={"stages": stages}, files=files)
    return encoder_eccentricity.columns(replace(s, pair=pair))


def test_a_disc_has_two_lines_of_its_turn_where_no_stage_is_as_long() -> None:
    one, two = discs()
    assert [(c.stage, c.harmonic, c.order) for c in (one, two)] == [("axis", 1, 1.0), ("axis", 2, 2.0)]
    phase = 2 * np.pi * X / 4.0
    assert one.columns == pytest.approx(np.column_stack([np.cos(phase), np.sin(phase)]))
    assert two.columns == pytest.approx(np.column_stack([np.cos(2 * phase), np.sin(2 * phase)]))
    assert one.twins == (SHAFT,) and one.kind == "line" and one.labels == (("amplitude", "arcsec"),)
    assert discs(turn=None) == []
    as_long = discs(Stage("disc", 4.0, None, 1, "encoder_eccentricity"))
    assert sorted(c.order for c in as_long if c.stage == "axis") == [2.0]
    assert [c.order for c in as_long if c.stage == "disc"] == [1.0]
    half = discs(Stage("half", 2.0, None, 1, "encoder_eccentricity"))
    assert [c.order for c in half if c.stage == "axis"] == [1.0]


@pytest.mark.parametrize(("turn", "there"), [(24.9, True), (25.0, False), (25.1, False)])
def test_a_disc_s_own_turn_is_looked_for_from_two_fifths_of_it_on(turn: float, there: bool) -> None:
    x = np.concatenate([X[:-1], [5.0]])
    x[500], x[1500] = 5.0, -5.0  # a travel of just ten
    assert bool(discs(turn=turn, x=x)) == there


def test_a_disc_that_does_not_come_round_is_any_function_of_the_place() -> None:
    far = discs(Stage("disc", 12.0, None, 6, "encoder_eccentricity"), turn=None)
    whole = [c for c in far if c.name == UNKNOWN]
    assert len(whole) == 1 and whole[0].twins == ("encoder_eccentricity", SHAFT)
    assert {c.twins for c in far if c.name != UNKNOWN} == {(SHAFT,)}


def test_an_axis_has_both_harmonics_of_its_absolute_encoder_as_one() -> None:
    motion = Some(frame=Some(train=Some(motor="motor")))
    pair = Some(motion=motion, motor=None, train=Some(motor="motor", one=lambda name: name), sliding=None)
    found = discs(Stage("roller", 0.5, None, 1, "encoder_eccentricity"), x=X / 5, turn=2 * np.pi, pair=pair)
    *rollers, own = found
    assert {c.labels for c in rollers} == {(("amplitude", "arcsec"),)} and rollers[0].stage == "roller"
    each = [g(k * X / 5) for k in (1, 2) for g in (np.cos, np.sin)]
    assert own.columns == pytest.approx(np.column_stack(each))
    assert (own.stage, own.harmonic, own.order, own.kind) == ("axis", 1, 1.0, "line")
    assert [name for name, _ in own.labels] == ["amplitude", "second"]


def line(
    name: str, stage: str | None, harmonic: int | None = None, channel: str = "K", **sizes: float
) -> Finding:
    return Finding(name, channel, "axis_angle", stage=stage, harmonic=harmonic,
                   parameters={k: Parameter(v, "") for k, v in sizes.items()})  # fmt: skip


@pytest.mark.parametrize(
    ("stage", "harmonic", "turned", "place"),
    [("roller", 3, np.pi / 2, ("roller", 3)), ("roller", None, np.pi / 2, ("roller", 1)),
     (None, 2, -np.pi / 2, ("axis", 1)), ("axis", 2, -np.pi / 2, ("axis", 1))],
)  # fmt: skip
def test_a_disc_in_a_plant_is_the_roller_s_or_the_absolute_one(
    stage: str | None, harmonic: int | None, turned: float, place: tuple[str, int]
) -> None:
    f = line("encoder_eccentricity", stage, harmonic, amplitude=3.0, phase=0.2, second=1.0, second_phase=0.1)
    (effect,) = encoder_eccentricity.to_plant(f, Facts("a.log")).effects
    assert (effect.stage, effect.harmonic) == place
    numbers = {k: n.value for k, n in effect.parameters.items()}
    assert (numbers["amplitude"], numbers["second"]) == (3.0, 1.0)
    assert numbers["phase"] == pytest.approx(0.2 + turned)
    assert numbers["second_phase"] == pytest.approx(0.1 + turned)


def test_a_gear_s_torque_has_the_twist_that_the_encoders_show() -> None:
    """The axis has less of what the motors add, a sine; a twist of the same line stands beside it."""
    f = line(SHAFT, "shaft2", 2, "T", amplitude=5.0, phase=0.3)
    alone = gear_eccentricity.to_plant(f, Facts("a.log"))
    (effect,) = alone.effects
    assert (effect.stage, effect.harmonic, alone.remarks) == ("shaft2", 2, [])
    assert effect.parameters["phase"].value == pytest.approx(0.3 - np.pi / 2)
    assert effect.parameters["amplitude"].value == 5.0 and effect.parameters["kinematic"].value == 0.0
    both = gear_eccentricity.to_plant(f, Facts("a.log", twists={("shaft2", 2): (7.0, 0.1)}))
    twist = both.effects[1]
    assert twist.parameters["kinematic"].value == 7.0 and twist.parameters["amplitude"].value == 0.0
    assert twist.parameters["phase"].value == pytest.approx(0.1 - np.pi / 2) and twist.harmonic == 2
    assert len(gear_eccentricity.to_plant(f, Facts("a.log", twists={("shaft2", 1): (7.0, 0.1)})).effects) == 1
    one = gear_eccentricity.to_plant(f.having(kinematic=Parameter(1.0, "arcsec")), Facts("a.log"))
    assert len(one.effects) == 1 and one.remarks == [
        "gear_eccentricity on shaft2: its twist shows in one train, the plant's acts on both: left out"
    ]
    whole = gear_eccentricity.to_plant(line(SHAFT, None, None, "T", amplitude=5.0), Facts("a.log"))
    assert (whole.effects[0].stage, whole.effects[0].harmonic) == ("axis", 1)


@pytest.mark.parametrize(("mesh", "shaft"), [("mesh1", "motor"), ("mesh2", "shaft1"), ("mesh3", "shaft2")])
def test_a_mesh_s_twist_is_a_harmonic_of_its_wheel_s_shaft(mesh: str, shaft: str) -> None:
    made = gear_eccentricity.to_plant(line(SHAFT, mesh, 2, amplitude=4.0, phase=0.4), Facts("a.log"))
    (effect,) = made.effects
    teeth = round(ORDERS[mesh] / ORDERS[shaft])
    assert (effect.stage, effect.harmonic) == (shaft, 2 * teeth) and teeth > 5
    assert effect.parameters["kinematic"].value == 4.0
    assert effect.parameters["phase"].value == pytest.approx(0.4 - np.pi / 2)
    assert made.remarks == [f"the twist at {mesh} is written as harmonic {2 * teeth} of {shaft}"]


def test_an_asymmetry_of_two_motors_is_at_most_the_friction_itself() -> None:
    s = drive(X)
    answer = Some(steady=np.full(ROWS, 2.0), drag=-3.0 * np.ones(ROWS), answer=lambda x: x)
    pair: Any = Some(sliding=answer)
    both, one = friction_asymmetry.columns(replace(s, pair=pair))
    assert one.columns[:, 0] == pytest.approx(2.0 * s.view.direction) and one.most == 1.0
    assert both.columns == pytest.approx(np.column_stack([2.0 * s.view.direction, np.full(ROWS, 3.0)]))
    assert both.most == (1.0, 1.0) and [name for name, _ in both.labels] == [
        "coulomb_asymmetry", "viscous_asymmetry",
    ]  # fmt: skip


def rippled(
    *stages: Stage, declared: Any = None, windings: Any = None, channel: str = "force", turn: Any = None
) -> Any:
    load = 3.0 + np.cos(T)
    known = {"inertia": 1.0} if declared is None else declared
    s = drive(X, y=load + 0.5, residual=np.full(ROWS, 0.5), declared=known,
              rig={"stages": stages}, response=Response(channel, "N"), turn=turn)  # fmt: skip
    s.windings = windings
    return torque_ripple, s, load


MOTOR = Stage("motor", 2.0, None, 20, "motor")


def test_ripple_goes_with_the_force_that_the_motor_makes() -> None:
    name, s, load = rippled(MOTOR, Stage("worm", 2.0, None, 3, None))
    found = name.columns(s)
    assert [c.harmonic for c in found] == list(range(1, 13)) and {c.stage for c in found} == {"motor"}
    phase = np.pi * X
    assert found[0].columns == pytest.approx(load[:, None] * np.column_stack([np.cos(phase), np.sin(phase)]))
    assert found[0].most == 0.5 and found[0].labels == (("ripple", "1"),)
    volts: Any = Some()
    _, v, _ = rippled(
        Stage("motor", 2.0, None, 1, "motor"), declared={"torque_constant": 4.0}, windings=volts
    )
    (c,) = name.columns(v)
    rate = np.gradient(X, PERIOD_S)
    assert c.columns[:, 0] == pytest.approx(4.0 * rate * np.cos(phase))


@pytest.mark.parametrize(
    ("declared", "channel", "there"),
    [
        ({"inertia": 1.0}, "force", True), ({"stiffness": 1.0}, "force", True),
        ({"coulomb": 1.0}, "force", False),
        ({"gravity_cos": 1.0}, "force", True), ({"inertia": 1.0}, "acceleration", False),
    ],
)  # fmt: skip
def test_ripple_needs_a_force_beside_friction(declared: dict[str, float], channel: str, there: bool) -> None:
    name, s, _ = rippled(MOTOR, declared=declared, channel=channel)
    assert (name.lacks(s) == "") == there == bool(name.columns(s))


def test_a_ripple_in_a_plant_is_a_constant_that_is_missing() -> None:
    """r cos(x + p) more of the motors is a torque constant less by it: half a turn, and half the play."""
    f = Finding("torque_ripple", "T", "motor_angle", harmonic=3)
    f = f.having(ripple=Parameter(0.05, "1"), phase=Parameter(0.2, "rad"), motor=Parameter(2.0, ""))
    (effect,) = torque_ripple.NAME.to_plant(f, Facts("a.log", half_play=0.1)).effects
    numbers = {k: n.value for k, n in effect.parameters.items()}
    assert (numbers["ripple"], numbers["cycles"], numbers["motor"]) == (0.05, 3.0, 2.0)
    turned = 0.2 + np.pi + 3 * 0.1
    assert np.exp(1j * numbers["phase"]) == pytest.approx(np.exp(1j * turned))


@pytest.mark.parametrize(
    ("supply", "channel", "over", "lacks"),
    [
        (24 + 0.5 * np.sin(T), "effort", None, ""),
        (24 + 0.33 * np.sin(T), "effort", None, "a supply that changes by more than a percent"),
        (24 + 0.35 * np.sin(T), "effort", None, ""),  # rms 0.2475 of 0.24
        (None, "effort", None, "a column of the supply"),
        (24 + 0.5 * np.sin(T), "force", None, "an effort that is not over the supply already"),
        (24 + 0.5 * np.sin(T), "effort", "supply", "an effort that is not over the supply already"),
    ],
)
def test_an_effort_follows_a_supply_that_changes(supply: Any, channel: str, over: Any, lacks: str) -> None:
    columns = {} if supply is None else {"supply": supply}
    y = 2.0 + np.cos(3 * T)
    s = drive(
        X,
        y=y,
        residual=0.25 * np.ones(ROWS),
        columns=columns,
        response=Response(channel, "1", divide_by=over),
    )
    assert supply_sag.lacks(s) == lacks
    found = supply_sag.columns(s)
    assert bool(found) == (lacks == "")
    if found:
        assert found[0].columns[:, 0] == pytest.approx((0.25 - y) * (supply / supply.mean() - 1))
        assert (found[0].sign, found[0].most, found[0].labels) == (1, 3.0, (("share", "1"),))


def test_a_preload_s_change_in_a_plant_is_a_ramp_of_the_shortest() -> None:
    f = Finding("preload_change", "T", "time").having(change=Parameter(0.2, "1"), start=Parameter(9.0, "s"))
    (effect,) = preload_change.to_plant(f, Facts("a.log")).effects
    assert effect.parameters["duration"].value == 0.01 and effect.parameters["start"].value == 9.0
    slow = f.having(duration=Parameter(5.0, "s"))
    assert preload_change.to_plant(slow, Facts("a.log")).effects[0].parameters["duration"].value == 5.0


@pytest.mark.parametrize(
    ("declared", "speeds", "there"),
    [
        ({"viscous": 0.5, "coulomb": 1.0}, True, True), ({"viscous": 0.5, "coulomb": 0.0}, True, False),
        ({"viscous": 0.0, "coulomb": 1.0}, True, False), ({"viscous": 0.5}, True, False),
        ({"viscous": 0.5, "coulomb": 1.0}, False, False),
    ],
)  # fmt: skip
def test_a_preload_shows_beside_friction_of_two_kinds_at_two_speeds(
    monkeypatch: pytest.MonkeyPatch, declared: dict[str, float], speeds: bool, there: bool
) -> None:
    asked: Any = []
    module: Any = preload_change

    def steps(s: Any, name: str, size: Any, weigh: Any, lengths: Any, most: float) -> Any:
        asked.append((name, size, lengths, most))
        return [weigh(np.full(ROWS, 0.5))]

    monkeypatch.setattr(module, "steps", steps)
    speed = np.where(np.arange(ROWS) % 2, 1.0, 3.0) if speeds else np.ones(ROWS)
    s = drive(X, declared=declared, speed=speed)
    found = module.columns(s)
    assert bool(found) == there
    if there:
        assert found[0] == pytest.approx(0.5 * s.view.direction + 0.5 * 0.5 * speed)
        assert asked == [("preload_change", ("change", "1"), (), np.inf)]


def test_a_winding_in_a_plant_warms_as_its_part_of_the_loop() -> None:
    f = Finding("winding_heating", "E", "time").having(
        thermal_resistance=Parameter(0.5, "K/W"), time_constant=Parameter(40.0, "s")
    )
    (effect,) = winding_heating.to_plant(f, Facts("a.log", resistance=3.0, winding=2.0)).effects
    assert effect.parameters["thermal_resistance"].value == pytest.approx(0.5 * 2.25)
    assert effect.parameters["time_constant"].value == 40.0


@pytest.mark.parametrize(("start", "told"), [(None, False), (12.4, True)])
def test_magnets_of_a_plant_do_not_know_the_time(start: float | None, told: bool) -> None:
    f = Finding("magnet_weakening", "E", "time").having(loss=Parameter(0.1, "1"), motor=Parameter(2.0, ""))
    if start is not None:
        f = f.having(start=Parameter(start, "s"))
    made = magnet_weakening.to_plant(f, Facts("a.log"))
    assert (
        made.effects[0].parameters["loss"].value == 0.1 and made.effects[0].parameters["motor"].value == 2.0
    )
    since = "the loss found from 12 s on is there from the start"
    said = f"magnet_weakening: the plant's magnets do not know the time, {since}"
    assert made.remarks == [said] * told


def test_what_magnets_have_left_falls_along_a_ramp() -> None:
    clock = np.array([0.0, 10.0, 15.0, 20.0, 30.0])
    c: Any = Some(fixed={"start": (10.0, "s"), "duration": (10.0, "s")})
    assert magnet_weakening.torque_kept(c, 0.2, clock, 1.5) == pytest.approx([1.0, 1.0, 0.85, 0.7, 0.7])
    assert magnet_weakening.torque_kept(Some(fixed={}), 0.2, clock, 1.0) == pytest.approx([0.8] * 5)  # type: ignore[arg-type]
