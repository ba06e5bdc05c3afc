"""Why one drive misses E2, E6, E13 and E14: the arithmetic of docs/reference/paper.md."""

from math import exp, pi, radians, sqrt

import numpy as np
import pytest

from plant.model import load
from scenarios.studies.options import LOW
from tests.studies.paper.docs_page import PAGE

N = 360.48864
"""Gear ratio of a motor to its axis (paper, Table 1)."""
ARCSEC = pi / 180 / 3600
MOTOR = load(LOW).axes.ra.motor
DAMPING = (MOTOR.torque_constant.value * N) ** 2 / MOTOR.resistance.value
EXPONENT = 0.53


def falls(rate: float, drop: float, stribeck: float) -> float:
    """By how much sliding friction falls with the rate, N m s/rad."""
    x = (rate / stribeck) ** EXPONENT
    return drop * EXPONENT / rate * x * exp(-x)


def test_E2_a_leap_ends_at_ten_times_its_limit() -> None:
    freed = (1.490 - 0.217) * N
    assert freed == pytest.approx(459, abs=0.5)
    settles = freed / (11_300 + DAMPING) / ARCSEC
    assert settles == pytest.approx(1520, abs=10)
    assert settles > 10 * (10 * 15)  # 1000 % of 15 arcsec/s


def test_E6_at_100_arcsec_s_next_to_nothing_holds_the_speed() -> None:
    left = [DAMPING + 6700 - falls(speed * ARCSEC, (0.621 - 0.229) * N, 4e-4) for speed in (100.0, 196.0)]
    assert left == pytest.approx([1000, 31_900], abs=60)
    swings = [10 / each / ARCSEC for each in left]
    assert swings[0] > 20 * 100
    assert swings[1] == pytest.approx(65, abs=1)


def test_E13_contradicts_E3_and_a_step_is_more_than_is_allowed() -> None:
    assert 2 / sqrt(2) > 1  # percent: rms of a sine with the least peak of E3
    step = 24 * MOTOR.torque_constant.value * N / MOTOR.resistance.value / 3000
    inertia = 1602.9 + 2 * MOTOR.rotor_inertia.value * N**2
    assert step * 0.005 / inertia / ARCSEC == pytest.approx(1.5, abs=0.1)


def test_E14_3_deg_s_are_out_of_reach_with_its_resistance() -> None:
    speed = radians(3) * N
    torque = 0.229 + 6700 * radians(3) / N
    constant = np.linspace(0.01, 5.0, 100_000)
    for ohm, least in ((24 / 6, 26.2), (24 / 6.6, 24.0)):  # as printed, and at the row's upper limit
        supply = 2 * constant * speed + torque * ohm / constant - 0.7
        assert supply.min() >= least
        assert supply.min() == pytest.approx(2 * sqrt(2 * speed * torque * ohm) - 0.7, rel=1e-6)


def test_the_page_says_so() -> None:
    text = PAGE.read_text(encoding="utf-8")
    for words in ("1520", "leave 1000", "1.4 % rms", "26.2 V", '65"/s of swing'):
        assert words in text
