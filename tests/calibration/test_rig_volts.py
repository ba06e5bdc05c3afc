"""A rig with volts and current: a brushed motor simulated here, and what its electrical balance says."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calibration.errors import CalibrationInputError
from calibration.inputs.rigfile import load_rig
from tests.calibration.test_drives import answer

PERIOD_S, SUBSTEPS = 0.002, 4
R, L, K, INERTIA = 1.8, 0.9e-3, 0.052, 4.0e-4  # ohm, H, N m/A, kg m2: a small brushed servo motor
SUPPLY_V = 24.0
TURN = 2 * np.pi
RIG = f"""rig: spindle
columns:
  time: {{column: t, unit: s}}
  position: {{column: x, unit: rad}}
  current: {{column: i, unit: A}}
  duty: {{column: d, unit: "1"}}
supply_V: {SUPPLY_V}
response: {{channel: current, unit: N m, gain: {K}}}
estimate: [inertia, viscous, coulomb]
stages:
  - {{name: motor, period: {TURN}, harmonics: 8, kind: motor_cogging}}
"""

Change = Callable[[float, float, float], float]


def spindle(
    seed: int,
    constant: Change = lambda t, angle, i: K,
    resistance: Change = lambda t, angle, i: R,
    sag_ohm: float = 0.0,
    dead: float = 0.0,
    offset_a: float = 0.0,
    heat: tuple[float, float] | None = None,
) -> tuple[np.ndarray, ...]:
    """Time, angle, current and duty of 60 s. Torque constant and resistance may follow time, angle and
    current; `heat` is K/W and s of the winding."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 60.0, PERIOD_S)
    f, phase = rng.uniform(0.05, 0.7, 4), rng.uniform(0, TURN, 4)
    wanted = sum(np.sin(TURN * f[k] * t + phase[k]) for k in range(4)) * 30.0
    angle, speed, i, whole, kelvin = 0.0, 0.0, 0.0, 0.0, 0.0
    h = PERIOD_S / SUBSTEPS
    out = np.zeros((len(t), 3))
    for k in range(len(t)):
        error = wanted[k] - speed
        whole += error * PERIOD_S
        duty = float(np.clip(0.02 * error + 0.05 * whole, -1.0, 1.0))
        out[k] = angle, i, duty
        given = np.sign(duty) * max(abs(duty) - dead, 0.0)
        for _ in range(SUBSTEPS):
            winding = resistance(t[k], angle, i) * (1 + 0.00393 * kelvin)
            if heat is not None:
                kelvin += (heat[0] * winding * i * i - kelvin) * h / heat[1]
            constant_now = constant(t[k], angle, i)
            volts = given * (SUPPLY_V - sag_ohm * given * i)
            i += (volts - winding * i - constant_now * speed) / L * h
            torque = constant_now * i - 2e-4 * speed - 0.02 * np.tanh(speed / 0.5)
            speed += torque / INERTIA * h
            angle += speed * h
    position = np.round(out[:, 0] / TURN * 65536) * TURN / 65536
    current = np.round((out[:, 1] + offset_a + 0.002 * rng.standard_normal(len(t))) / 0.001) * 0.001
    return t, position, current, np.round(out[:, 2] * 4096) / 4096


def electrical(folder: Path, **changes: Any) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    data = answer(folder, RIG, *[spindle(k, **changes) for k in range(3)], header="t,x,i,d")
    return [e for e in data["effects"] if e["channel"] == "E"], data


@pytest.mark.slow
def test_a_sound_motor_gives_its_numbers_and_no_name(tmp_path: Path) -> None:
    found, data = electrical(tmp_path)
    assert found == []
    for name, value in (("resistance", R), ("torque_constant", K)):
        assert data["calibrated"][name]["value"] == pytest.approx(value, rel=0.02)
    row = data["error"]["electrical"]
    assert row["unit"] == "V" and row["after"] < 0.1


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "size", "value", "changes"),
    [
        ("supply_sag", "resistance", 0.4, {"sag_ohm": 0.4}),
        ("pwm_deadband", "deadband", 0.02, {"dead": 0.02}),
        ("adc_offset", "offset", 0.05, {"offset_a": 0.05}),
        ("winding_heating", "thermal_resistance", 12.0, {"heat": (12.0, 25.0)}),
        (
            "magnet_weakening",
            "loss",
            0.08,
            {"constant": lambda t, angle, i: K * (1 - 0.08 * np.clip((t - 22.0) / 5.0, 0.0, 1.0))},
        ),
        (  # most of the log is weak: its mean constant is not the one that fell
            "magnet_weakening",
            "loss",
            0.25,
            {"constant": lambda t, angle, i: K * (1 - 0.25 * (t > 5.0))},
        ),
        (
            "torque_ripple",
            "ripple",
            0.06,
            {"constant": lambda t, angle, i: K * (1 + 0.06 * np.cos(6 * angle))},
        ),
    ],
)
def test_a_name_of_the_motor(
    tmp_path: Path, name: str, size: str, value: float, changes: dict[str, Any]
) -> None:
    found, data = electrical(tmp_path, **changes)
    assert [name] == [f["name"] for f in found]
    assert found[0]["parameters"][size]["value"] == pytest.approx(value, rel=0.12)
    row = data["error"]["electrical"]
    assert row["after"] < 0.6 * row["before"]


@pytest.mark.slow
def test_a_burnt_commutator_is_unknown_over_the_motor(tmp_path: Path) -> None:
    found, _ = electrical(tmp_path, resistance=lambda t, angle, i: R * (1 + 0.3 * np.cos(2 * angle)))
    assert found and {(f["name"], f["domain"]) for f in found} == {("unknown", "motor_angle")}


@pytest.mark.parametrize(
    ("was", "now", "said"),
    [
        ("  current: {column: i, unit: A}\n", "  effort: {column: i, unit: A}\n", "needs the current"),
        ("supply_V: 24.0\n", "", "needs what a duty of 1 gives"),
        ('unit: "1"', "unit: V", "columns.duty.unit: 'V', must be 1"),
        (
            'duty: {column: d, unit: "1"}',
            "voltage: {column: d, unit: V}",
            "supply_V: is for a column of the duty",
        ),
    ],
)
def test_a_wrong_motor_is_one_line(tmp_path: Path, was: str, now: str, said: str) -> None:
    path = tmp_path / "rig.yaml"
    text = RIG.replace(was, now)
    if "effort" in now:
        text = text.replace("channel: current", "channel: effort")
    path.write_text(text)
    with pytest.raises(CalibrationInputError, match=said):
        load_rig(path)
