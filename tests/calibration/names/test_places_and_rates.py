"""Names of two sensors and of a force along one motion: their columns are what the effect makes."""

from typing import Any, cast

import numpy as np
import pytest

from calibration.finding import Finding, Parameter
from calibration.inputs.declaration import Column, Response
from calibration.names import (
    channel_delay,
    coulomb_change,
    encoder_thermal_drift,
    friction_asymmetry,
    preload_change,
    roller_ratio,
    shaft_compliance,
    stribeck_change,
)  # fmt: skip
from calibration.names.coupling import coupling
from calibration.names.inplant import Facts
from calibration.names.scene import Scene
from tests.calibration.names.made import PERIOD_S, drive

ROWS = 2000
T: np.ndarray = PERIOD_S * np.arange(ROWS)
X: np.ndarray = 2.0 + np.sin(2 * np.pi * T / 5) + 0.3 * np.sin(2 * np.pi * T / 1.7)
BOTH = {"direction": np.sign(np.gradient(X))}


def sensors(ratio: float | None = None, **more: Any) -> Scene:
    return drive(X, response=Response("position2", "m", ratio=ratio), **more)


def force(**more: Any) -> Scene:
    return drive(more.pop("x", X), response=Response("force", "N"), **more)


def test_a_late_sensor_falls_behind_by_its_rate_times_the_delay() -> None:
    one, *late = channel_delay.columns(sensors(declared={"scale": 3.0}))
    rate = np.gradient(X, PERIOD_S)
    assert one.columns[:, 0] == pytest.approx(-3 * rate) and one.labels == (("delay", "s"),)
    assert one.most == pytest.approx(2 * PERIOD_S)
    declared = channel_delay.columns(sensors(-0.5))[0]
    assert declared.columns[:, 0] == pytest.approx(0.5 * rate)
    assert channel_delay.columns(sensors())[0].columns[:, 0] == pytest.approx(-rate)
    assert [c.fixed["delay"][0] for c in late] == pytest.approx([k * PERIOD_S for k in (1, 2, 4, 8)])
    c = late[2]
    assert c.columns[4:, 0] == pytest.approx(X[:-4] - X[4:]) and not c.columns[0].any()
    assert c.steps == pytest.approx((0.2 * PERIOD_S,)) and (c.sign, c.searched) == (1, 1)
    assert c.labels == (("ratio", "m/m"),)
    assert c.shape is not None and not c.shape(np.array([-0.05])).any()


def test_a_delay_is_a_hundredth_of_the_log_at_most_and_of_sensors_alone() -> None:
    short = sensors()
    short.view.t = T / 20  # 1 s: up to a row of 0.01 s, not included
    assert len(channel_delay.columns(short)) == 1
    short.view.t = T / 9
    assert len(channel_delay.columns(short)) == 3
    thinned = sensors()
    thinned.view.rows = np.arange(0, ROWS, 2)
    assert channel_delay.columns(thinned)[1].fixed["delay"][0] == pytest.approx(2 * PERIOD_S)
    assert channel_delay.columns(force()) == []
    lacks = channel_delay.NAME.lacks
    assert lacks(force(dynamic=False)) == "a balance with accelerations ('inertia')"
    assert lacks(force(dynamic=True)) == lacks(sensors()) == ""


def test_a_late_column_is_told_with_its_interval() -> None:
    f = channel_delay.late_column("why", 0.03, 0.01, 0.5)
    p = f.parameters["delay"]
    assert [p.value, p.low, p.high] == pytest.approx([0.03, 0.0104, 0.0496])
    assert f.evidence == pytest.approx(4.5 / np.log(10)) and (f.share, f.note) == (0.5, "why")
    wide = channel_delay.late_column("", 0.03, 0.01, reach=3.0)
    assert wide.parameters["delay"].high == pytest.approx(0.06) and wide.share == 1.0
    assert channel_delay.against_position("aux", 0.1) == "the aux column is late against the position"
    assert channel_delay.against_position("aux", -0.1) == "the aux column is early against the position"


@pytest.mark.parametrize(
    ("column", "delay", "remark"),
    [
        (None, 0.02, "channel_delay: left out, the log does not say which column is late (why)"),
        (1.0, -0.02, "channel_delay: left out, a column is 0.02 s early and a plant is never early"),
        (1.0, 0.02, "channel_delay: why"), (1.0, 0.0, "channel_delay: why"),
    ],
)  # fmt: skip
def test_a_plant_s_columns_are_late_and_known(column: float | None, delay: float, remark: str) -> None:
    given = {"delay": Parameter(delay, "s")} | ({} if column is None else {"column": Parameter(column, "1")})
    made = channel_delay.to_plant(
        Finding("channel_delay", "S", "clock", parameters=given, note="why"), Facts("log")
    )
    assert made.remarks == [remark] and len(made.effects) == (remark == "channel_delay: why")


def test_a_ratio_is_an_error_in_proportion_to_the_way() -> None:
    (c,) = roller_ratio.columns(sensors(1.0))
    assert c.columns[:, 0] == pytest.approx(X - X.mean()) and c.labels == (("error", "m/m"),)
    assert roller_ratio.columns(sensors()) == []
    assert (
        roller_ratio.lacks(sensors()) == "a declared ratio of two sensors"
        and roller_ratio.lacks(sensors(1.0)) == ""
    )
    assert roller_ratio.lacks(drive(X, response=Response("position3", "m", ratio=1.0))) != ""


@pytest.mark.parametrize(
    ("there", "first"), [("force effort current", "force"), ("effort current", "effort")]
)
def test_a_shaft_winds_up_with_the_first_effort_there_is(there: str, first: str) -> None:
    s = sensors(columns={name: T * k for k, name in enumerate(there.split(), 1)})
    s.view.rig.columns.update({name: Column(f"{name}s") for name in there.split()})
    (c,) = shaft_compliance.columns(s)
    assert c.columns[:, 0] == pytest.approx(T) and c.labels == (("compliance", f"m/{first}s"),)
    assert shaft_compliance.NAME.lacks(s) == "" and shaft_compliance.columns(sensors()) == []
    assert shaft_compliance.NAME.lacks(sensors()) == "a column of the effort, the current or the force"


@pytest.mark.parametrize(("change", "told"), [(0.5, False), (0.51, True)])
def test_a_sensor_drifts_with_a_temperature_that_changes(change: float, told: bool) -> None:
    s = sensors(columns={"temperature": 20 + change * T / T[-1]})
    found = encoder_thermal_drift.columns(s)
    assert len(found) == told
    if found:
        t = s.view.columns["temperature"]
        assert found[0].columns[:, 0] == pytest.approx(t - t.mean()) and found[0].labels == (
            ("drift", "m/K"),
        )
    wanted = "" if told else "a temperature that changes by more than 0.5 K"
    assert encoder_thermal_drift.lacks(s) == wanted
    assert encoder_thermal_drift.lacks(sensors()) == "a temperature column"


@pytest.mark.parametrize(("change", "told"), [(0.29, 1), (0.31, 2)])
def test_an_axis_sensor_drifts_with_less_and_with_the_time(change: float, told: int) -> None:
    """Of an axis the encoder's own angle is subtracted, and a log without a temperature may have warmed."""
    s = sensors(columns={"temperature": 20 + change * T / T[-1]})
    s.pair = cast(Any, object())
    found = encoder_thermal_drift.columns(s)
    assert [c.domain for c in found] == ["temperature", "time"][2 - told :]
    steady = found[-1].columns[:, 0]
    assert steady == pytest.approx((T - T.mean()) / T[-1]) and found[-1].labels == (("drift", "m"),)
    if told == 2:
        t = s.view.columns["temperature"]
        assert found[0].columns[:, 0] == pytest.approx(t.mean() - t)


def test_a_drift_enters_the_plant_per_kelvin_or_by_its_own_warming() -> None:
    def made(unit: str, warming: float = 0.0) -> Any:
        f = Finding("encoder_thermal_drift", "K", "temperature", parameters={"drift": Parameter(3.0, unit)})
        return encoder_thermal_drift.to_plant(f, Facts("log", duration_s=100.0, warming=warming))

    assert made("arcsec/K").effects[0].parameters["drift"].value == 3.0
    none = made("arcsec")
    assert none.effects == [] and none.remarks == [
        "encoder_thermal_drift: left out, the plant's temperature does not change"
    ]
    warmed = made("arcsec", 0.01)
    assert warmed.effects[0].parameters["drift"].value == pytest.approx(-3.0)
    assert warmed.effects[0].parameters["encoder"].value == 1.0
    assert warmed.remarks[0] == (
        "encoder_thermal_drift: the log has no temperature, the plant's own warming is used"
    )


def stood(share: float) -> dict[str, np.ndarray]:
    return {"direction": np.where(np.arange(ROWS) < share * ROWS, 0.0, np.sign(np.gradient(X)))}


def test_asymmetry_is_even_in_direction_and_gone_at_rest() -> None:
    s = force(**stood(0.2), declared={"coulomb": 2.0, "viscous": 3.0})
    one, speed, both = friction_asymmetry.columns(s)
    assert one.columns[:, 0] == pytest.approx(np.abs(s.view.direction)) and one.most == 2.0
    assert speed.columns[:, 0] == pytest.approx(np.abs(s.view.speed)) and speed.most == 3.0
    assert both.most == (2.0, 3.0) and both.labels == (*one.labels, *speed.labels)
    assert one.labels == (("coulomb_asymmetry", "N"),) and speed.labels == (("viscous_asymmetry", "N s/m"),)
    assert np.array_equal(both.columns, np.hstack([one.columns, speed.columns]))
    free, _, _ = friction_asymmetry.columns(force(**stood(0.2), declared={"coulomb": -1.0}))
    assert free.most == np.inf
    (only,) = friction_asymmetry.columns(force(**BOTH))  # nothing stands
    assert only.labels == speed.labels and only.most == np.inf
    steady = np.where(T % 4 < 2, 1.0, -1.0)
    (only,) = friction_asymmetry.columns(force(**stood(0.2), speed=steady))
    assert only.labels == one.labels
    assert friction_asymmetry.columns(force(direction=np.ones(ROWS))) == []


def test_friction_that_nobody_estimates_may_be_another() -> None:
    (c,) = coulomb_change.columns(force(**BOTH))
    assert np.array_equal(c.columns[:, 0], BOTH["direction"]) and c.labels == (("coulomb_change", "N"),)
    assert coulomb_change.columns(force(**BOTH, rig={"estimate": ("coulomb",)})) == []
    assert coulomb_change.columns(force(direction=np.ones(ROWS))) == []


def test_a_dip_is_friction_at_rest_on_both_sides_of_its_speed() -> None:
    speed = np.linspace(-1, 1, ROWS)
    s = force(speed=speed, direction=np.sign(speed), declared={"coulomb": 1.0})
    found = stribeck_change.columns(s)
    top = np.quantile(np.abs(speed), 0.98)
    tried = [c.fixed["stribeck_speed"][0] for c in found]
    assert tried == pytest.approx([part * top for part in (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4)])
    c = found[4]
    assert np.abs(c.columns[:, 0]) == pytest.approx(np.exp(-((speed / (0.1 * top)) ** 2)), abs=1e-6)
    assert c.sign == 1 and c.labels == (("stribeck_force", "N"),) and c.steps[0] == pytest.approx(0.01 * top)
    assert c.fixed["stribeck_speed"][1] == "m/s" and c.twins == ("coulomb_change",)
    stated = force(speed=speed, direction=np.sign(speed), rig={"estimate": ("coulomb",)})
    assert stribeck_change.columns(stated)[0].twins == ()


def test_slow_motion_is_needed_for_a_dip() -> None:
    slow = "slow motion: ramps through the lowest speeds"
    assert stribeck_change.lacks(force(speed=np.linspace(0.4, 1.0, ROWS))) == ""
    assert stribeck_change.lacks(force(speed=np.linspace(0.5, 1.0, ROWS))) == slow
    assert stribeck_change.lacks(force(speed=np.ones(ROWS), ok=np.zeros(ROWS, dtype=bool))) == ""


def test_a_preload_scales_both_kinds_of_friction_from_a_time_on() -> None:
    s = force(**BOTH, declared={"coulomb": 2.0, "viscous": 3.0})
    found = preload_change.columns(s)
    assert len(found) == 24 and found[0].labels == (("change", "1"),)
    at = found[12].fixed["start"][0]
    late = at + 0.1 < T
    expected = 2 * s.view.direction + 3 * s.view.speed
    assert found[12].columns[late, 0] == pytest.approx(expected[late])
    assert not found[12].columns[at > T, 0].any()
    assert preload_change.columns(force(**BOTH, declared={"viscous": 3.0})) == []
    assert preload_change.columns(force(**BOTH, declared={"coulomb": 3.0})) == []
    why = "viscous friction beside Coulomb's, at two speeds: else a brake looks the same"
    assert preload_change.lacks(force(declared={"viscous": 0.0})) == why


def test_a_sudden_change_of_preload_is_the_plant_s_shortest() -> None:
    given = {"change": Parameter(-0.2, "1"), "start": Parameter(30.0, "s")}
    (effect,) = preload_change.to_plant(
        Finding("preload_change", "T", "time", parameters=given), Facts("log")
    ).effects
    assert effect.parameters["duration"].value == 0.01 and effect.parameters["change"].value == -0.2


def test_joints_couple_by_their_accelerations_and_rates() -> None:
    """Of one joint its acceleration alone, and with it by cosines, and products of rates."""
    joint = 0.5 * np.sin(2 * np.pi * T / 3)
    s = force(columns={"joint": joint}, dynamic=True, turn=2 * np.pi)
    one, every = coupling(s)
    bend, rate = np.gradient(np.gradient(joint, PERIOD_S), PERIOD_S), np.gradient(joint, PERIOD_S)
    mine_bend, mine = np.gradient(np.gradient(X, PERIOD_S), PERIOD_S), np.gradient(X, PERIOD_S)
    expected = [
        bend, bend * np.cos(joint), bend * np.cos(X), mine_bend * np.cos(joint), np.sin(joint) * rate**2,
        np.sin(joint) * rate * mine, np.sin(X) * rate**2,
    ]  # fmt: skip
    assert every.columns.shape == (ROWS, 7)
    for k, column in enumerate(expected):
        assert every.columns[5:-5, k] == pytest.approx(column[5:-5], abs=0.01 * np.abs(column).max())
    assert np.array_equal(one.columns, every.columns[:, :1])
    words = [name for name, _ in every.labels]
    assert words == [
        "acceleration_of_joint", "acceleration_of_joint_by_its_cos", "acceleration_of_joint_by_own_cos",
        "own_acceleration_by_cos_of_joint", "square_of_joint", "product_with_joint", "own_square_of_joint",
    ]  # fmt: skip
    assert [unit for _, unit in every.labels] == 4 * ["N s2/m"] + 3 * ["N s2/m2"]
    assert every.note == "the motion of joint comes back here: inertia that couples them"
    two = force(columns={"joint": joint, "joint2": X}, dynamic=True)
    assert [c.width for c in coupling(two)] == [1, 7, 1, 7, 2, 14]
    assert "joint and joint2" in coupling(two)[-1].note
    assert coupling(force(columns={"joint": joint}, dynamic=False)) == []
    assert coupling(sensors(columns={"joint": joint}, dynamic=True)) == []
