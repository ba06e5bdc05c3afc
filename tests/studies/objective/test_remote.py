import numpy as np
import pytest

from plant.model import load
from tests.studies.objective import observer
from tests.studies.objective.remote import CALCULATED_S, hold, reader

HIGH = load("high_preload_motor_units")


def test_a_reading_without_age_is_the_observers_own():
    made = observer.design(HIGH, delay_s=CALCULATED_S)
    row, correction = reader(HIGH, made, 0.0)
    assert row == pytest.approx(np.eye(observer.SIZE)[0])
    assert correction == pytest.approx(made.correction, rel=1e-6)


def test_an_older_reading_is_where_the_axis_was():
    row, _ = reader(HIGH, observer.design(HIGH), 0.003)
    moving = np.zeros(observer.SIZE)
    moving[[0, 1]] = 1e-3, 2e-3  # rad, rad/s; the rest pulls within 3 ms by far less
    moving[3], moving[4] = moving[0], moving[1]
    assert row @ moving == pytest.approx(1e-3 - 0.003 * 2e-3, abs=2e-6)


def test_high_preload_is_held_by_readings_three_milliseconds_old():
    """From a start, with a seed, that no table uses. The PI leaps at 395 arcsec/s there."""
    assert np.abs(hold(HIGH, HIGH, 0.003, 10.0, 143.3, seed=9)).max() < 1.0
