"""Dome, weather and power from the host, on the final network (H7)."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from bus.protocol.nodes import DOME, POWER, WEATHER
from host.console.pages.dome import dome_text
from host.procedures.dome import opcode
from host.telescope import Activity, Job, Refused
from tests.host.telescope.conftest import Rig


@pytest.fixture
def house(tmp_path: Path) -> Iterator[Rig]:
    made = Rig(tmp_path, network="final")
    yield made
    made.host.close()


@pytest.mark.slow
def test_H7_the_dome_turns_opens_and_stops_by_the_host(house: Rig) -> None:
    telescope = house.telescope
    assert telescope.house.boards(DOME) == ["DOME"]
    house.run(lambda t: t.house.turn(30.0))
    house.run(lambda t: t.house.shutter(True))
    house.advance(5.0)
    under_way = telescope.house.reading("DOME")
    assert under_way is not None and under_way["Moving"]
    assert "turning to 30.0°; shutter" in dome_text(under_way)
    house.advance(30.0)
    there = telescope.house.reading("DOME")
    assert there is not None
    assert there["Azimuth"] == pytest.approx(30.0, abs=0.6)  # the board's tolerance, 0.5 deg, and a count
    assert dome_text(there).endswith("shutter open")
    house.run(lambda t: t.house.shutter(False))
    house.advance(1.0)
    house.run(lambda t: t.house.stop())
    house.advance(1.0)
    stopped = telescope.house.reading("DOME")
    assert stopped is not None and not stopped["ShutterMoving"] and 0 < stopped["Shutter"] < 100


def test_H7_the_emergency_stop_stops_dome_and_shutter_and_what_was_on_its_way(house: Rig) -> None:
    house.run(lambda t: t.house.turn(90.0))
    house.run(lambda t: t.house.shutter(True))
    house.advance(3.0)
    held = [house.telescope.call(lambda t: t.house.turn(200.0)) for _ in range(2)]
    house.do(lambda t: t.emergency_stop())
    house.advance(1.0)
    first = house.telescope.house.reading("DOME")
    assert first is not None and not first["Moving"] and not first["ShutterMoving"]
    house.advance(3.0)
    later = house.telescope.house.reading("DOME")
    assert later is not None and later["Azimuth"] == first["Azimuth"] > 0
    assert 0 < later["Shutter"] == first["Shutter"] < 100
    assert not any(future.result(0).running for future in held)


def test_H7_weather_and_supplies_are_read_and_a_relay_is_switched(house: Rig) -> None:
    house.advance(1.5)
    about = house.telescope.house
    assert about.boards(WEATHER) == ["WEATHER_MAST", "WEATHER_DOME"]
    mast = about.reading("WEATHER_MAST")
    assert mast is not None and not mast["Unsafe"]
    room_board, relay = POWER.device("POWER_ROOM"), opcode(POWER, "RELAY")
    house.do(lambda t: t.side.start(Job("off", t.client.ask(room_board, relay, 2, 0), Activity.IDLE)))
    house.advance(4.0)
    room = about.reading(about.boards(POWER)[1])
    assert room is not None and int(room["Relays"]) == 0b11111101
    assert not house.network.board("DISPLAY").on
    display = next(each for each in house.telescope.snapshot.boards if each.device.name == "DISPLAY")
    assert not display.alive


def test_what_cannot_be_meant_is_refused(house: Rig) -> None:
    with pytest.raises(Refused, match=r"not within 0\.\.360"):
        house.do(lambda t: t.house.turn(360.0))


def test_without_a_dome_board_the_command_is_refused(rig: Rig) -> None:
    assert rig.telescope.house.boards(DOME) == []
    assert rig.telescope.house.reading("DOME") is None
    with pytest.raises(Refused, match="DOME is not on this network"):
        rig.do(lambda t: t.house.stop())
