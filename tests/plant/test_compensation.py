"""compensation.yaml: the wave that cancels a wave, from the drive's arithmetic by hand; and what reads it."""

import math
from pathlib import Path

import numpy as np
import pytest

from boards.axis.compensator import Compensator
from bus.protocol import HARMONICS
from plant import compensation as written
from plant.gears import ORDERS, RATIO
from plant.model import load, with_effects
from plant.parts import EffectModel, Number, PlantModel
from plant.units import ARCSEC
from scenarios.language.configure import FORMAT, SCHEMA_FILE, load_compensation
from scenarios.language.document import ScenarioError
from scenarios.language.validate import schema

HEAD = "format: schmidt-compensation 1\naxis: ra\nfriction: {steps: 1, travel_arcsec: 1}\n"


@pytest.fixture(scope="module")
def low() -> PlantModel:
    return load("low_preload_motor_units")


def per_step(model: PlantModel) -> float:
    """N m at the axis that one PWM step of effort gives, with the counter torque taken off, by hand."""
    motor = model.axes.ra.motor
    ohm = motor.resistance.si + 0.085 + 0.1
    return 24.0 / 3000 / ohm * motor.torque_constant.si * (113 / 27 * 123 / 21 * 250 / 17) * 0.9


def test_both_sides_agree_on_what_they_cannot_share() -> None:
    assert written.FORMAT == FORMAT
    assert written.LINES == HARMONICS == schema(SCHEMA_FILE)["properties"]["lines"]["maxItems"]


@pytest.mark.parametrize("phase", [0.0, 0.7, -2.1])
def test_the_board_pushes_against_the_torque(low: PlantModel, tmp_path: Path, phase: float) -> None:
    parameters = {"amplitude": Number(5.0, "N m", ""), "phase": Number(phase, "rad", "")}
    model = with_effects(low, "ra", (EffectModel("gear_mesh", "mesh2", 1, parameters),))
    written.write(tmp_path / "c.yaml", model, "ra")
    board = Compensator()
    table = load_compensation(tmp_path / "c.yaml")
    for k, line in enumerate(table.lines):
        board.orders_q16[k] = round(line.order * 65536)
        board.cosines_q8[k], board.sines_q8[k] = round(line.cosine * 256), round(line.sine * 256)
    board.refresh()
    for position in range(1 << 27, 1 << 28, 12_345_679):
        torque = 5.0 * math.sin(ORDERS["mesh2"] * position / 2**29 * 2 * math.pi + phase)
        push = board.effort_q16(position, 0, 0) / 65536 * per_step(model)
        assert push == pytest.approx(-torque, abs=0.05)  # 1 % of the wave


def test_cogging_of_both_motors_is_one_wave_of_the_axis(low: PlantModel) -> None:
    parameters = {"cycles": Number(20.0, "1", ""), "amplitude": Number(0.02, "N m", "")}
    model = with_effects(low, "ra", (EffectModel("motor_cogging", parameters=parameters),))
    (row,), _ = written.lines(model, "ra")
    assert row["order"] == pytest.approx(20 * RATIO)
    drive = written.drive_of(model, model.axes.ra)
    # two equal waves, apart by the angle between the motors: 2 A cos(half of it)
    apart = 20 * RATIO * (drive.motors[0] - drive.motors[1])
    assert row["torque_Nm"] == pytest.approx(2 * 0.02 * RATIO * abs(math.cos(apart / 2)), abs=1e-3)


def test_ripple_of_both_motors_pulls_against_itself(low: PlantModel, tmp_path: Path) -> None:
    """Torque is constant times current, A pulls in + and B in -: two waves, apart by their angles."""
    parameters = {"cycles": Number(37.0, "1", ""), "ripple": Number(0.2, "1", "")}
    model = with_effects(low, "ra", (EffectModel("torque_ripple", parameters=parameters),))
    (row,), _ = written.lines(model, "ra")
    drive = written.drive_of(model, model.axes.ra)
    a, b = (
        0.2 * model.axes.ra.motor.torque_constant.si * RATIO * amperes * np.exp(37j * RATIO * lead)
        for amperes, lead in zip(drive.currents, drive.motors, strict=True)
    )
    assert drive.currents[0] > drive.currents[1] > 0
    assert row["torque_Nm"] == pytest.approx(abs(a - b), abs=1e-3)
    # a wave C cos + S sin is the real part of (C - i S) e^(i order angle); the board pushes against it
    pushed = complex(float(row["cosine_steps"]), -float(row["sine_steps"])) * drive.per_step
    assert pushed == pytest.approx(-(a - b), abs=0.01 * abs(a - b))
    written.write(tmp_path / "c.yaml", model, "ra")
    assert "friction at 15.041 arcsec/s," in (tmp_path / "c.yaml").read_text()


def test_each_motor_leads_by_its_play_and_its_train_s_wind_up(low: PlantModel) -> None:
    """A pulls with all of the effort, B back with a tenth of it, both with the bias: 1.2 times 1 % of 3000
    steps. A train is half as stiff as both."""
    part = with_effects(low, "ra", ()).axes.ra
    drive = written.drive_of(low, part)
    effort = drive.friction / drive.per_step
    duties = effort + 36, 0.1 * effort + 36
    half, train = 0.5 * part.gear.backlash.si, 0.5 * part.gear.stiffness.si
    ahead, behind = (half + per_step(low) / 0.9 * duty / train for duty in duties)
    assert drive.motors == pytest.approx((ahead, -behind), rel=1e-6)
    amperes = 24.0 / 3000 / (part.motor.resistance.si + 0.085 + 0.1)
    assert drive.currents == pytest.approx([amperes * duty for duty in duties], rel=1e-6)


def test_the_drive_turns_friction_within_the_bristles_travel(low: PlantModel) -> None:
    f = low.axes.ra.friction
    rate = 15.041 * ARCSEC
    level = f.coulomb.si + (f.stiction.si - f.coulomb.si) * math.exp(
        -((rate / f.stribeck_rate.si) ** f.stribeck_exponent.si)
    )
    drive = written.drive_of(low, low.axes.ra)
    assert drive.per_step == pytest.approx(per_step(low), rel=1e-6)
    assert drive.friction == pytest.approx(level + f.viscous.si * rate, rel=1e-6)
    assert drive.travel == pytest.approx(level / f.bristle_stiffness.si, rel=1e-6)


def test_what_is_no_wave_is_said(low: PlantModel, tmp_path: Path) -> None:
    model = with_effects(low, "ra", (EffectModel("wind_torque"), EffectModel("damaged_tooth", "mesh1")))
    left = written.write(tmp_path / "c.yaml", model, "ra")
    assert len(left) == 2
    assert left[0].startswith("wind_torque")
    assert load_compensation(tmp_path / "c.yaml").lines == ()


def test_a_wrong_table_is_wrong_by_what_was_asked(low: PlantModel, tmp_path: Path) -> None:
    written.write(tmp_path / "c.yaml", low, "ra")
    table = load_compensation(tmp_path / "c.yaml")
    for line, wrong in zip(table.lines, table.wrong(0.8, 0.2).lines, strict=True):
        before, after = complex(line.cosine, -line.sine), complex(wrong.cosine, -wrong.sine)
        assert abs(after / before) == pytest.approx(0.8)
        assert abs(np.angle(after / before)) == pytest.approx(0.2)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("format: other", "format"),
        ("format: schmidt-compensation 1\naxis: ra", "field 'friction' is missing"),
        (HEAD.replace("ra", "x"), "axis: 'x' is not known"),
        (HEAD.replace("travel", "way"), "unknown field 'way_arcsec' in friction; did you mean"),
        (HEAD + "linse: []", "unknown field 'linse'; did you mean 'lines'"),
        (HEAD + "lines: [{order: 1}]", "lines.0: field 'cosine_steps' is missing"),
        (HEAD + "lines: [{order: -1, cosine_steps: 1, sine_steps: 0}]", "lines.0.order: -1 is out of range"),
        (HEAD + "lines: [{order: .nan, cosine_steps: 1, sine_steps: 0}]", "nan is no number"),
        ("[", "not YAML"),
    ],
)  # fmt: skip
def test_a_bad_file_is_one_clear_line(tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "c.yaml"
    file.write_text(text)
    with pytest.raises(ScenarioError, match=message) as caught:
        load_compensation(file)
    assert "\n" not in str(caught.value)
    assert str(file) in str(caught.value)


def test_a_table_that_is_half_loaded_never_acts(low: PlantModel, tmp_path: Path) -> None:
    written.write(tmp_path / "c.yaml", low, "ra")
    rows = load_compensation(tmp_path / "c.yaml").parameters()
    assert rows[0] == (13, 0)
    assert rows[-1] == (13, 1)
    assert len(rows) == len(set(rows)) == 28
