"""Rows of a compensation by hand: sizes, order, what is left out and why; and the drive behind them."""

from dataclasses import replace
from math import cos, exp, sin
from pathlib import Path
from typing import Any

import pytest
import yaml

from plant.compensation import drive_of, lines, write
from plant.model import with_effects, with_value
from plant.parts import EffectModel, Number, PlantModel
from plant.units import ARCSEC
from tests.plant.bench import bare, switching

RATIO = 113 / 27 * 123 / 21 * 250 / 17
RATE = 15.041 * ARCSEC
AMPERES = 24.0 / (2.2 + 0.085 + 0.1) / 3000  # a step of low_preload.yaml
NEWTON = AMPERES * 0.39 * RATIO
PER_STEP = 0.9 * NEWTON  # a tenth is the counter torque
UNITS = {"amplitude": "N m", "deadband": "1", "order": "1", "phase": "rad", "cycles": "1", "ripple": "1"}


def effect(name: str, stage: str | None = None, harmonic: int = 1, **given: float) -> EffectModel:
    return EffectModel(name, stage, harmonic, {word: Number(v, UNITS[word], "") for word, v in given.items()})


def made(*effects: EffectModel, base: PlantModel | None = None) -> tuple[list[dict[str, Any]], list[str]]:
    return lines(with_effects(base or bare(), "ra", effects), "ra")


def test_a_wave_becomes_the_effort_against_it() -> None:
    """A sin(order angle + phase) is A sin(phase) of the cosine and A cos(phase) of the sine."""
    (row,), left = made(effect("gear_mesh", "mesh3", 2, amplitude=7.0, phase=0.7))
    assert row == {
        "order": 500.0,
        "cosine_steps": round(-7 * sin(0.7) / PER_STEP, 4),
        "sine_steps": round(-7 * cos(0.7) / PER_STEP, 4),
        "torque_Nm": 7.0,
        "source": "gear_mesh on mesh3, harmonic 2",
    }
    assert left == []


def test_orders_have_six_digits_and_torques_three() -> None:
    (row,), _ = made(effect("bearing_pass", order=437.12345678, amplitude=7.123456))
    assert (row["order"], row["torque_Nm"], row["source"]) == (437.123457, 7.123, "bearing_pass")


def test_a_weight_out_of_balance_is_one_wave_a_turn() -> None:
    """A cos(angle + phase), or its like: 5 N m of size, at order 1."""
    (row,), _ = made(effect("gravity_imbalance", amplitude=5.0))
    assert row["order"] == 1.0 and row["torque_Nm"] == 5.0


def test_friction_over_the_angle_brakes_where_it_is_more() -> None:
    """Both Tc and Ts rise by it, so that steady friction does: -A cos(order angle - phase)."""
    (row,), _ = made(effect("position_friction", "roller", amplitude=12.0, phase=0.4))
    expected = [12 * cos(0.4) / PER_STEP, 12 * sin(0.4) / PER_STEP]
    assert [row["cosine_steps"], row["sine_steps"]] == pytest.approx(expected, abs=1e-3)
    assert row["order"] == 24.5


def test_cogging_of_one_motor_is_where_that_motor_stands() -> None:
    """It leads by half the play and its wind-up: a sine of the motor's angle, whose torque the train has."""
    duty = drive_of(bare(), bare().axes.ra).friction / PER_STEP + 36  # a bias of 1.2 * 1 % of 3000 steps
    gear = bare().axes.ra.gear
    lead = 0.5 * gear.backlash.si + NEWTON * duty / (0.5 * gear.stiffness.si)
    cogging = effect("motor_cogging", cycles=20.0, amplitude=0.03, phase=0.3)
    one = EffectModel("motor_cogging", parameters={**cogging.parameters, "motor": Number(1.0, "1", "")})
    (row,), _ = made(one)
    turn = 20 * RATIO * lead + 0.3
    assert row["order"] == pytest.approx(20 * RATIO, abs=1e-6)
    size = 0.03 * RATIO
    expected = [-size * sin(turn) / PER_STEP, -size * cos(turn) / PER_STEP]
    assert [row["cosine_steps"], row["sine_steps"]] == pytest.approx(expected, abs=1e-3)


def test_the_strongest_come_first_and_the_table_has_eight_lines() -> None:
    sizes = [3.0, 9.0, 4.0, 8.0, 5.0, 7.0, 6.0, 2.0, 10.0, 1.0]
    rows, left = made(*(effect("gear_mesh", "mesh1", k + 1, amplitude=a) for k, a in enumerate(sizes)))
    assert [row["torque_Nm"] for row in rows] == sorted(sizes, reverse=True)[:8]
    assert left == [f"gear_mesh on mesh1, harmonic {k}: the table has 8 lines" for k in (8, 10)]


def test_what_is_off_is_not_spoken_of_and_what_is_no_torque_neither() -> None:
    off = EffectModel("gear_mesh", "mesh1", enabled=False)
    assert made(off, EffectModel("adc_gain"), EffectModel("encoder_eccentricity", "axis")) == ([], [])
    _, left = made(EffectModel("wind_torque"), EffectModel("damaged_tooth", "mesh1"))
    assert left == [
        f"{name}: not a wave of torque over the position" for name in ("wind_torque", "damaged_tooth")
    ]


@pytest.mark.parametrize(("steps", "taken"), [(0.0499, False), (0.0501, True)])
def test_a_wave_below_a_twentieth_of_a_step_is_too_little(steps: float, taken: bool) -> None:
    size = steps * PER_STEP
    rows, left = made(effect("gear_mesh", "mesh1", amplitude=size))
    assert bool(rows) is taken
    told = f"gear_mesh on mesh1, harmonic 1: {size:.2g} N m is too little"
    assert left == ([] if taken else [told])


def test_a_wave_of_nothing_is_not_spoken_of() -> None:
    assert made(effect("gear_mesh", "mesh1", amplitude=0.0)) == ([], [])


def friction() -> float:
    """N m at the tracking rate, Table 2 of the paper."""
    return 229 + 392 * exp(-((RATE / 4e-4) ** 2)) + 6700 * RATE


def test_the_drive_of_the_printed_friction() -> None:
    drive = drive_of(bare(), bare().axes.ra)
    assert drive.per_step == pytest.approx(PER_STEP, rel=1e-9)
    assert drive.friction == pytest.approx(friction(), rel=1e-9)
    assert drive.travel == pytest.approx((friction() - 6700 * RATE) / 5.9e6, rel=1e-9)
    effort = friction() / PER_STEP
    assert drive.currents == pytest.approx((AMPERES * (effort + 36), AMPERES * (0.1 * effort + 36)))


def test_what_drivers_swallow_is_taken_from_both_motors() -> None:
    """2 % of 3000 steps and 1 % more: of the motor that lags less is left than nothing, so nothing."""
    swallowing = [effect("pwm_deadband", deadband=share) for share in (0.02, 0.01)]
    part = with_effects(bare(), "ra", swallowing).axes.ra
    drive = drive_of(bare(), part)
    effort = friction() / PER_STEP
    left = [max(0.0, duty + 36 - 90) for duty in (effort, 0.1 * effort)]
    assert drive.currents == pytest.approx([AMPERES * duty for duty in left])
    off = EffectModel("pwm_deadband", enabled=False)
    plain = drive_of(bare(), with_effects(bare(), "ra", (off,)).axes.ra)
    assert plain.currents == pytest.approx((AMPERES * (effort + 36), AMPERES * (0.1 * effort + 36)))
    # a motor without a current leads by the play alone
    high = drive_of(bare(), with_effects(bare(), "ra", [effect("pwm_deadband", deadband=0.1)]).axes.ra)
    assert high.currents[1] == 0.0 and -high.motors[1] == pytest.approx(0.5 * bare().axes.ra.gear.backlash.si)


def test_a_power_stage_has_a_dead_zone_and_a_bias_beyond_it() -> None:
    """d / (V + d - V R / (2 L f)) of the duty is dead; the bias is 1.2 times that and 1 %, rounded."""
    model = switching("low_preload", 0.7)
    motor = model.axes.ra.motor
    ripple = 24.0 * 2.2 / (2 * motor.inductance.si * 20e3)
    dead = 0.7 / (24.7 - ripple)
    amperes = 24.7 / 2.2 / 3000  # it freewheels past switch and sense resistor
    per_step = 0.9 * amperes * 0.39 * RATIO
    effort = friction() / per_step
    drive = drive_of(model, model.axes.ra)
    assert drive.per_step == pytest.approx(per_step)
    bias = round(1.2 * (dead + 0.01) * 3000)
    expected = [amperes * max(0.0, duty + bias - 3000 * dead) for duty in (effort, 0.1 * effort)]
    assert drive.currents == pytest.approx(expected)


def test_a_file_says_what_it_was_made_of(tmp_path: Path) -> None:
    model = with_effects(
        bare(), "dec", (EffectModel("wind_torque"), effect("gear_mesh", "mesh1", amplitude=5.0))
    )
    left = write(tmp_path / "c.yaml", model, "dec")
    text = (tmp_path / "c.yaml").read_text()
    assert text.startswith("# Loaded by schmidt run --compensation. Effort in PWM steps over the absolute")
    data = yaml.safe_load(text)
    assert list(data) == ["format", "axis", "plant", "lines", "friction", "left_out"]
    assert data["format"] == "schmidt-compensation 1" and data["axis"] == "dec"
    assert data["plant"] == "low_preload" and data["left_out"] == left and len(data["lines"]) == 1
    drive = drive_of(model, model.axes.dec)
    assert data["friction"] == {
        "steps": round(drive.friction / drive.per_step, 3),
        "travel_arcsec": round(drive.travel / ARCSEC, 3),
        "source": f"friction at 15.041 arcsec/s, {drive.friction:.1f} N m",
    }
    write(tmp_path / "c.yaml", replace(model, name="a " * 200), "dec")
    named = (tmp_path / "c.yaml").read_text().partition("plant: ")[2].splitlines()
    assert [len(line) for line in named[1:3]] == [111, 111]  # a word that begins up to column 110


def test_less_supply_makes_a_step_weaker() -> None:
    weak = with_value(bare(), "supply.voltage", 12.0)
    assert drive_of(weak, weak.axes.ra).per_step == pytest.approx(PER_STEP / 2)
