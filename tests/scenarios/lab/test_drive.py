"""What axis boards are set to for a drive, by the formulas in the comments of the module and hardware.md."""

from math import pi
from types import SimpleNamespace
from typing import Any

import pytest

from scenarios.lab import drive
from scenarios.lab.drive import axis_config

RATIO = 360.48863990040456
COUNTS = 112_896_000
"""Of the incremental encoder, per turn of the axis."""
TORQUE = 2.0
"""N m at the axis for a PWM step, of the stub."""


def number(value: float) -> Any:
    return SimpleNamespace(si=value)


def axis(inertia: float, rotor: float, damping: float = 1.0, drop: float | None = None) -> Any:
    motor = SimpleNamespace(rotor_inertia=number(rotor), diode_drop=None if drop is None else number(drop))
    return SimpleNamespace(
        inertia=number(inertia), motor=motor, gear=SimpleNamespace(damping=number(damping))
    )


def plant(ra: Any, dec: Any, split: float = 0.1) -> Any:
    controller = SimpleNamespace(
        kp=number(0.9), ki=number(0.07), counter_split=number(split), pwm_steps=number(3000.4),
        pwm_frequency=number(20000.2),
    )  # fmt: skip
    return SimpleNamespace(model=SimpleNamespace(axes=SimpleNamespace(ra=ra, dec=dec), controller=controller))


@pytest.fixture(autouse=True)
def torque(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(drive, "step_torque", lambda model, motor: TORQUE)


def unit_gain(inertia: float, rotor: float, share: float) -> float:
    """Steps for 1 count / 5 ms in a second: the whole inertia over the torque and counts of a rad/s."""
    whole = inertia + 2.0 * rotor * RATIO**2
    return whole / (share * TORQUE * COUNTS / (2 * pi) * 0.005)


@pytest.mark.parametrize(("drop", "share"), [(None, 0.9), (0.7, 1.0)])
def test_gains_of_the_pointing_loop_are_its_bandwidth(drop: float | None, share: float) -> None:
    """22 rad/s, 33 in wind; Ki/Kp of 0.08, 0.1 or 0.2 while it creeps, 0.05 in wind."""
    ra, dec = axis(1000.0, 1e-3, drop=drop), axis(500.0, 1e-3, drop=drop)
    for name, inertia, creep in (("ra", 1000.0, 0.1), ("dec", 500.0, 0.2)):
        made = axis_config(plant(ra, dec), name, (5, 9), 500_000)
        kp = 22.0 * unit_gain(inertia, 1e-3, share)
        gust = 33.0 * unit_gain(inertia, 1e-3, share)
        found = (made.kp_pointing, made.ki_pointing, made.ki_creep, made.kp_gust, made.ki_gust)
        assert found == pytest.approx((kp, 0.08 * kp, creep * kp, gust, 0.05 * gust))
        assert (made.low, made.high) == (5, 9)


def test_the_file_s_gains_are_scaled_by_the_inertia_of_the_axis() -> None:
    ra, dec = axis(1000.0, 1e-3), axis(400.0, 2e-3)
    made = axis_config(plant(ra, dec), "ra", (0, 1), 500_000)
    assert (made.kp, made.ki) == pytest.approx((0.9, 0.07))
    scale = (400.0 + 4e-3 * RATIO**2) / (1000.0 + 2e-3 * RATIO**2)
    made = axis_config(plant(ra, dec), "dec", (0, 1), 500_000)
    assert (made.kp, made.ki) == pytest.approx((0.9 * scale, 0.07 * scale))


@pytest.mark.parametrize(
    ("bandwidth", "pointing", "gust"), [(21.0, 22.0, 33.0), (30.0, 30.0, 33.0), (40.0, 40.0, 40.0)]
)
def test_trains_that_damp_well_allow_a_faster_loop(bandwidth: float, pointing: float, gust: float) -> None:
    """Half of the damping over both rotors, 0.5 d / (2 J n^2)."""
    rotor = 1e-3
    ra = axis(1000.0, rotor, damping=bandwidth * 4.0 * rotor * RATIO**2)
    made = axis_config(plant(ra, ra), "ra", (0, 1), 500_000)
    unit = unit_gain(1000.0, rotor, 0.9)
    assert (made.kp_pointing, made.kp_gust) == pytest.approx((pointing * unit, gust * unit))


@pytest.mark.parametrize(
    ("bitrate", "frame_ns"), [(500_000, 240_000), (250_000, 480_000), (1_000_000, 120_000)]
)
def test_the_PWM_is_in_whole_numbers_and_a_frame_has_120_bits(bitrate: int, frame_ns: int) -> None:
    ra = axis(1000.0, 1e-3)
    made = axis_config(plant(ra, ra, 0.6), "ra", (0, 1), bitrate)
    assert (made.counter_split, made.pwm_steps, made.pwm_hz) == (60, 3000, 20000)
    assert made.frame_ns == frame_ns
