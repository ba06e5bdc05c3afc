"""The air warms as the plant file says, and a warm tube is longer."""

import pytest

from plant.air import Air, best_focus_m, with_air
from plant.model import load

HOUR_NS = 3_600_000_000_000


def test_it_warms_as_the_plant_file_says() -> None:
    model = with_air(load(), -5.0)
    air = Air(model, 0.8)
    assert [air.temperature(hours * HOUR_NS) for hours in (0, 1, 3)] == pytest.approx([-5.0, -6.0, -8.0])
    assert air.humidity(0) == pytest.approx(80.0)


def test_a_steel_tube_of_half_a_metre_is_six_micrometres_longer_per_degree() -> None:
    """12e-6 of its length per kelvin, by hand; at 10 degrees the middle of the travel is in focus."""
    model = load()
    for celsius, um in ((10.0, 0.0), (20.0, 60.0), (-5.0, -90.0)):
        assert best_focus_m(with_air(model, celsius), 0) == pytest.approx(1e-6 * um, abs=1e-12)
