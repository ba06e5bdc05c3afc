"""One air: what the site says is what plant, weather stations and focus have."""

from pathlib import Path

import pytest

from bus.protocol.nodes import WEATHER
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
