"""One air: what the site says is what plant, weather stations and focus have."""

from pathlib import Path

import pytest

from bus.protocol.nodes import WEATHER
from plant.air import Air, best_focus_m, with_air
from plant.model import load
from scenarios.lab.eye import look
from scenarios.lab.prepare import prepare
from scenarios.lab.wiring import wire

HOUR_NS = 3_600_000_000_000
TEXT = """name: air
start_utc: 2026-02-10T14:00:00Z
network: {name: final}
site: {temperature: -5 degC, humidity: 0.8}
steps: [{power_on: {}}]
"""


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


def test_the_sites_air_is_that_of_plant_stations_and_focus(tmp_path: Path) -> None:
    file = tmp_path / "air.yaml"
    file.write_text(TEXT)
    scenario, model = prepare(file)
    network = wire(scenario, model)
    assert network.plant.model.environment.temperature.si == -5.0
    for name in WEATHER.nodes:
        board = network.boards[name]
        assert (board.read("temperature", 0), board.read("humidity", 0)) == (-5.0, 80.0)  # type: ignore[attr-defined]
        assert board.read("temperature", HOUR_NS) == pytest.approx(-6.0)  # type: ignore[attr-defined]
    away = look(network.plant, scenario, 0).focus_m - network.plant.focus.position_m(0)
    assert away == pytest.approx(90e-6)
