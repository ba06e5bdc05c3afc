"""What is wrong and how badly: by limits of the bus's standard, of heartbeats and of the weather."""

from types import SimpleNamespace as Some
from typing import Any

import pytest

from bus.protocol import State
from host.telescope.alarms import Alarm, Alarms, Severity, of_bus, of_house

WARNING, ALARM = Severity.WARNING, Severity.ALARM


def snapshot(**fields: Any) -> Any:
    axis = Some(fault=False, soft_limit=False)
    return Some(**{"ra": axis, "dec": axis, "stale": (), "boards": (), "t_s": 100.0} | fields)


def board(name: str = "FOCUS", **fields: Any) -> Any:
    usual = {"device": Some(name=name), "alive": True, "state": State.READY, "tec": 0, "overruns": 0}
    return Some(**usual | fields)


def test_a_sound_telescope_has_no_alarm() -> None:
    assert Alarms().of_telescope(snapshot(boards=(board(),))) == {}


def test_axes_say_their_faults_and_their_limits() -> None:
    ra, dec = Some(fault=True, soft_limit=False), Some(fault=False, soft_limit=True)
    found = Alarms().of_telescope(snapshot(ra=ra, dec=dec, stale=(Some(name="POSITION_RA"),)))
    assert found == {
        "RA: FAULT, the motors are off": ALARM,
        "Dec is at its soft limit": WARNING,
        "POSITION_RA: no measurement": ALARM,
    }


@pytest.mark.parametrize(("tec", "found"), [
    (96, None), (97, WARNING), (127, WARNING), (128, ALARM), (255, ALARM),
])  # fmt: skip
def test_errors_on_the_bus_are_an_alarm_from_error_passive(tec: int, found: Severity | None) -> None:
    """Above 96 a bus is heavily disturbed (CAN 2.0 A, 7); from 128 a node is error passive (ISO 11898-1)."""
    told = Alarms().of_telescope(snapshot(boards=(board(tec=tec),)))
    assert told == ({} if found is None else {"FOCUS: errors on the bus": found})


def test_a_silent_board_is_an_alarm_once_it_could_have_been_heard() -> None:
    silent = board(alive=False, tec=200, state=State.FAULT)
    assert Alarms().of_telescope(snapshot(boards=(silent,), t_s=0.5)) == {}
    assert Alarms().of_telescope(snapshot(boards=(silent,))) == {"FOCUS is silent": ALARM}
    assert Alarms().of_telescope(snapshot(boards=(board(state=State.FAULT),))) == {"FOCUS: FAULT": ALARM}


def test_interrupts_are_lost_where_their_number_grows() -> None:
    alarms = Alarms()
    told = [alarms.of_telescope(snapshot(boards=(board(overruns=n),))) for n in (3, 3, 4, 4)]
    lost = {"FOCUS loses interrupts": WARNING}
    assert told == [{}, {}, lost, {}]


@pytest.mark.parametrize(("load", "found"), [(0.49, None), (0.5, WARNING), (0.89, WARNING), (0.9, ALARM)])
def test_a_loaded_bus_is_an_alarm_when_it_is_all_but_full(load: float, found: Severity | None) -> None:
    assert of_bus(load, []) == ({} if found is None else {"the bus is loaded": found})
    assert of_bus(0.0, [(3, "silent bus, for 5 s")]) == {"fault 3 runs: silent bus": WARNING}


@pytest.mark.parametrize(
    ("dome", "found"), [(None, WARNING), ({"Closed": True}, WARNING), ({"Closed": False}, ALARM)]
)
def test_weather_is_an_alarm_while_the_shutter_is_not_shut(dome: Any, found: Severity) -> None:
    house: Any = Some(reading=lambda _: dome, unsafe=lambda: ("rain",))
    assert of_house(house) == {"rain": found}


def test_an_alarm_stands_until_it_has_gone_and_been_seen() -> None:
    alarms = Alarms()
    alarms.take(1.0, {"a": WARNING, "b": ALARM})
    alarms.take(2.0, {"a": WARNING, "b": ALARM, "c": ALARM})
    assert [each.what for each in alarms.standing] == ["c", "b", "a"]  # the worst, then the newest
    alarms.take(3.0, {"a": WARNING, "c": ALARM})
    assert Alarm("b", ALARM, 1.0, 3.0) in alarms.standing
    alarms.take(4.0, {"a": WARNING, "c": ALARM})
    assert Alarm("b", ALARM, 1.0, 3.0) in alarms.standing  # when it went stays
    alarms.acknowledge()
    assert alarms.standing == (Alarm("c", ALARM, 2.0, None, True), Alarm("a", WARNING, 1.0, None, True))
    alarms.take(5.0, {"a": WARNING})
    assert [each.what for each in alarms.standing] == ["a"]


def test_what_has_gone_and_comes_again_is_new_and_worse_is_news() -> None:
    alarms = Alarms()
    alarms.take(1.0, {"a": WARNING})
    alarms.take(2.0, {})
    alarms.take(3.0, {"a": WARNING})
    assert alarms.standing == (Alarm("a", WARNING, 3.0),)
    alarms.acknowledge()
    alarms.take(4.0, {"a": ALARM})
    assert alarms.standing == (Alarm("a", ALARM, 3.0),)
    alarms.acknowledge()
    alarms.take(5.0, {"a": WARNING})
    assert alarms.standing == (Alarm("a", WARNING, 3.0, None, True),)
