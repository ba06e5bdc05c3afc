"""The dome: three minutes a turn, half a minute for the shutter, and an encoder of a tenth of a degree."""

import pytest

from plant.dome import DomePort

SECOND = 1_000_000_000


def test_a_turn_takes_three_minutes_either_way() -> None:
    dome = DomePort()
    dome.turn(0, 1)
    assert [dome.azimuth(t * SECOND) for t in (0, 1, 90, 270)] == pytest.approx([0.0, 2.0, 180.0, 540.0])
    dome.turn(270 * SECOND, -1)
    assert dome.azimuth(450 * SECOND) == pytest.approx(180.0)
    dome.turn(450 * SECOND, 0)
    assert dome.azimuth(900 * SECOND) == pytest.approx(180.0)


@pytest.mark.parametrize(("seconds", "count"), [(0.0, 0), (0.05, 1), (0.06, 1), (0.08, 2), (179.95, 3599)])
@pytest.mark.parametrize("turns", [-1, 0, 2])
def test_the_encoder_has_3600_counts_a_turn(seconds: float, count: int, turns: int) -> None:
    dome = DomePort()
    dome.turn(0, -1 if turns < 0 else 1)
    dome.turn(abs(turns) * 180 * SECOND, 1)
    assert dome.encoder(round((abs(turns) * 180 + seconds) * SECOND)) == count


def test_the_shutter_moves_between_its_ends() -> None:
    dome = DomePort()
    assert dome.shutter(0) == 0.0
    dome.slide(0, 1)
    assert [dome.shutter(t * SECOND) for t in (3, 15, 30, 60)] == pytest.approx([0.1, 0.5, 1.0, 1.0])
    dome.slide(60 * SECOND, -1)
    assert [dome.shutter(t * SECOND) for t in (75, 90, 120)] == pytest.approx([0.5, 0.0, 0.0])
    dome.slide(120 * SECOND, 1)
    dome.slide(126 * SECOND, 0)
    assert dome.shutter(130 * SECOND) == pytest.approx(0.2)


def test_nothing_moves_before_a_motor_is_on() -> None:
    dome = DomePort()
    assert (dome.azimuth(60 * SECOND), dome.encoder(60 * SECOND), dome.shutter(60 * SECOND)) == (0.0, 0, 0.0)
