"""A weight, a cable, end stops, dents and bent torques: their columns, and what they are in a plant."""

from typing import Any

import numpy as np
import pytest

from calibration.finding import Finding, Parameter
from calibration.inputs.declaration import Response, Stage
from calibration.names import cable_wrap, gravity_imbalance
from calibration.names.bearing_pass import between, of_a_guess, of_no_stage
from calibration.names.inplant import Facts
from calibration.names.scene import Scene
from calibration.names.unknown_alone import alone
from tests.calibration.names.made import back_and_forth, drive

ROWS = 4000
X: np.ndarray = 1.0 + 3.0 * back_and_forth(4, 1000, 2.0)  # units of which a turn has eight
FACTS = Facts("log", middle=0.5, supply=24.0, half_play=0.01)


def scene(x: np.ndarray = X, turn: float | None = 8.0, **more: Any) -> Scene:
    return drive(x, turn=turn, **{"dynamic": True, **more})


def test_a_weight_is_a_sine_over_the_angle() -> None:
    (c,) = gravity_imbalance.columns(scene())
    angle = 2 * np.pi * X / 8
    assert c.columns @ [1.0, 1.0] == pytest.approx(c.columns[:, 0] + c.columns[:, 1])
    both = np.column_stack([np.cos(angle), np.sin(angle)])
    left = both - c.columns @ np.linalg.lstsq(c.columns, both, rcond=None)[0]
    assert np.abs(left).max() < 1e-9 and np.linalg.norm(c.columns, axis=1) == pytest.approx(np.ones(ROWS))
    assert (c.stage, c.harmonic, c.order, c.kind, c.twins) == ("axis", 1, 1.0, "line", ())
    loaded = scene(columns={"load": 2.0 + X})
    assert gravity_imbalance.columns(loaded)[0].columns == pytest.approx(c.columns * (2 + X)[:, None])
    first, second = gravity_imbalance.columns(scene(columns={"joint": 0 * X}))
    assert np.array_equal(second.columns, first.columns) and second.note.startswith(
        "over the sum of this joint's"
    )
    joint = 0.5 * X**2
    _, second = gravity_imbalance.columns(scene(columns={"joint": joint}))
    angle = 2 * np.pi * (X + joint) / 8
    assert np.ptp(second.columns @ np.linalg.pinv(second.columns) @ np.cos(angle) - np.cos(angle)) < 1e-9
    assert gravity_imbalance.columns(scene(declared={"gravity_cos": 1.0})) == []


@pytest.mark.parametrize(
    ("part", "twins", "told"), [(0.09, False, True), (0.08, True, True), (0.013, True, False)]
)
def test_over_a_small_part_of_a_turn_a_weight_is_a_slope(part: float, twins: bool, told: bool) -> None:
    """A twelfth of a turn, beside a cable; a seventy-second, beside an offset."""
    s = scene(back_and_forth(4, 1000, 8.0 * part))
    found = gravity_imbalance.columns(s)
    assert bool(found) == told
    assert [c.twins for c in found] == ([("cable_wrap",) if twins else ()] if told else [])
    assert gravity_imbalance.lacks(s) == ("" if told else "a motion over at least 0.014 turns")
    no_turn = "an angle: give position in rad, deg or turns, or 'turn' (position units per turn)"
    assert gravity_imbalance.lacks(scene(turn=None)) == no_turn


def once(
    name: str = "gear_eccentricity", order: float = 1.0, harmonic: int = 1, **more: Any
) -> tuple[str, Any]:
    motor = Stage("motor", 8.0, None, 1, "motor_cogging")
    s = scene(**{"rig": {"stages": (motor,)}, **more})
    f = gravity_imbalance.once_a_turn(
        Finding(name, "T", "axis_angle", order=order, harmonic=harmonic, stage="a"), s
    )
    return f.name, f.stage


def test_a_force_once_a_turn_is_a_weight_or_a_motor_s_that_turns_on() -> None:
    far = 3.0 * back_and_forth(4, 1000, 8.0)
    assert once("motor_cogging") == ("gravity_imbalance", "axis")
    assert once("gravity_imbalance", x=far) == ("motor_cogging", "motor")
    assert once("motor_cogging", order=1.1) == ("motor_cogging", "a") == once("motor_cogging", harmonic=2)
    assert once("brake_drag") == ("brake_drag", "a")
    assert once("motor_cogging", response=Response("position2", "m")) == ("motor_cogging", "a")
    assert once("motor_cogging", response=Response("velocity", "m/s")) == ("motor_cogging", "a")


def element(x: np.ndarray, radius: float) -> np.ndarray:
    out = np.zeros(len(x))
    for k in range(1, len(x)):
        out[k] = min(max(out[k - 1] + (x[k] - x[k - 1]) / radius, -1.0), 1.0)
    return out


def test_a_cable_is_a_spring_with_a_loop() -> None:
    found = cable_wrap.columns(scene())
    widths = [c.fixed["width"][0] for c in found[:-1]]
    assert widths == pytest.approx([8 * part for part in (0.002, 0.005, 0.01, 0.02, 0.04)])
    c = found[2]
    assert c.columns == pytest.approx(np.column_stack([X - X.mean(), element(X, 0.08)]))
    assert c.labels == (("stiffness", "N/m"), ("hysteresis", "N")) and c.positive == (0, 1)
    assert c.twins == ("gravity_imbalance",)
    hangs = found[-1]
    assert hangs.columns[:, 0] == pytest.approx(X - X.mean()) and hangs.positive == (0,) and hangs.fixed == {}
    assert cable_wrap.columns(scene(4.0 * back_and_forth(4, 1000, 2.0)))[0].twins == ()  # a whole turn
    assert c.shape is not None
    assert c.shape(np.array([0.0]))[:, 1] == pytest.approx(element(X, 8e-4))
    assert cable_wrap.columns(scene(direction=np.ones(ROWS))) == []
    short = scene(back_and_forth(4, 1000, 0.15))
    assert len(cable_wrap.columns(short)) == 4  # loops of less than the travel


def test_a_cable_s_memory_ends_where_another_session_is_elsewhere() -> None:
    x, session = np.array([0.0, 1.0, 1.05, 2.0, 5.0]), np.array([0, 0, 1, 1, 2])
    assert cable_wrap._memory(x, session, 0.1).tolist() == [0, 0, 0, 0, 1]
    assert cable_wrap._memory(x, session, 0.01).tolist() == [0, 0, 1, 1, 2]


def test_a_cable_in_the_plant_has_its_neutral_place() -> None:
    sizes = {"stiffness": 20.0, "hysteresis": 3.0, "neutral_torque": 4.0, "width": 0.02}
    given = {k: Parameter(v, "") for k, v in sizes.items()}
    f = Finding("cable_wrap", "T", "axis_angle", parameters=given)
    (effect,) = cable_wrap.to_plant(f, FACTS).effects
    assert effect.parameters["centre"].value == pytest.approx(0.5 - 0.2)
    assert effect.parameters["width"].value == pytest.approx(np.degrees(0.02))
    bare = Finding("cable_wrap", "T", "axis_angle", parameters={"hysteresis": given["hysteresis"]})
    (effect,) = cable_wrap.to_plant(bare, FACTS).effects
    assert effect.parameters["centre"].value == 0.5
    assert effect.parameters["width"].value == pytest.approx(np.degrees(0.01))


def test_shapes_alone_are_an_end_stop_and_a_bent_torque_or_a_dent() -> None:
    low, span = 1.0, 6.0
    effort = scene(response=Response("effort", "A"), y=np.sin(X), base=np.ones((ROWS, 1)))
    bent, *stops = alone(effort)
    assert bent.domain == "current" and len(stops) == 10
    up, down = stops[0], stops[5]
    assert up.fixed["begin"][0] == pytest.approx(low + 0.5 * span)
    assert up.columns[:, 0] == pytest.approx(np.maximum(X - low - 3.0, 0) ** 2 / span**2)
    assert down.columns[:, 0] == pytest.approx(-(np.maximum(low + 3.0 - X, 0) ** 2) / span**2, abs=1e-9)
    assert up.positive == (0,) and up.steps == pytest.approx((0.06,))
    assert len(alone(scene())) == 10  # of a force no iron
    assert alone(scene(dynamic=False)) == [] == alone(scene(response=Response("acceleration", "m/s2")))
    assert alone(scene(slow_offset=0)) == [] == alone(scene(ok=np.zeros(ROWS, dtype=bool)))
    assert alone(scene(response=Response("velocity", "m/s"))) == []


def test_a_dent_is_a_bell_at_a_place_of_the_travel() -> None:
    found = alone(scene(response=Response("position2", "m")))
    assert len(found) == 50
    c = found[25 + 10]
    assert c.fixed["place"][0] == pytest.approx(1 + 6 * 10.5 / 25) and c.fixed["width"][0] == pytest.approx(
        0.3
    )
    bell = np.exp(-0.5 * ((X - 1 - 6 * 10.5 / 25) / 0.3) ** 2)
    assert c.columns[:, 0] == pytest.approx(bell, abs=1e-12)
    assert c.steps == pytest.approx((0.06, 0.03)) and c.domain == "axis_angle"
    assert c.shape is not None
    narrow = c.shape(np.array([4.0, 0.0]))[:, 0]
    assert narrow == pytest.approx(np.exp(-0.5 * ((X - 4) / 0.006) ** 2), abs=1e-12)


def test_a_rate_moves_within_its_cell_and_not_to_a_stage_s() -> None:
    low, high = between(1.0, np.array([5.0]), 10.0)
    assert low < 1.0 < high
    near = between(1.0, np.array([0.96, 1.05]), 10.0)
    assert near == pytest.approx((0.96 + 0.035, 1.05 - 0.035))
    assert between(1.0, np.array([1.01]), 10.0)[1] >= between(1.0, np.array([1.01]), 10.0)[0]


def bearing(order: float, low: float, high: float, *stages: Stage, **more: Any) -> Finding:
    size = {"order": Parameter(order, "1", low, high), "amplitude": Parameter(1.0, "N")}
    f = Finding("bearing_pass", "T", "axis_angle", order=order, parameters=size)
    return of_no_stage(f, scene(rig={"stages": stages}, **more))


def test_a_line_of_no_stage_is_a_bearing_s_where_the_train_is_known() -> None:
    shaft = Stage("shaft", 0.8, None, 1, None)  # ten a turn
    known = bearing(33.3, 33.25, 33.35, shaft)
    assert known.name == "bearing_pass" and known.note == "period 0.24024 m"
    shown = bearing(30.02, 29.9, 30.1, shaft)
    assert (shown.name, shown.stage, shown.harmonic) == ("gear_eccentricity", "shaft", 3)
    assert set(shown.parameters) == {"amplitude"}
    assert shown.note == "period 0.26649 m; the order's interval holds 3 times that of shaft"
    wide = bearing(30.02, 27.0, 33.0, shaft)
    assert wide.name == "bearing_pass"
    quick = bearing(181.0, 180.95, 181.05, shaft)
    assert quick.name == "gear_eccentricity" and quick.note.endswith(
        "no declared stage turns quicker, so its stage cannot be named"
    )
    slow = bearing(2.9, 2.85, 2.95, shaft)
    assert slow.note.endswith("every declared stage turns quicker, so its stage cannot be named")
    none = bearing(33.3, 33.25, 33.35)
    assert none.note.endswith("no gear table was given, so its stage cannot be named")
    assert "bearing_pass" in none.equivalent and "gear_eccentricity" not in none.equivalent


def test_a_line_of_a_guessed_stage_may_be_a_gear_s_or_a_motor_s() -> None:
    guessed = Stage("wheel", 0.8, None, 1, "unknown")
    for stages, alike in (((guessed,), ["gear_mesh", "motor_cogging"]), ((), [])):
        f = Finding("gear_eccentricity", "T", "axis_angle", stage="wheel")
        assert list(of_a_guess(f, scene(rig={"stages": stages})).equivalent) == alike
