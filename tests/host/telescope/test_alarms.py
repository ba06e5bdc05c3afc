"""Alarms: what is wrong is told with how badly and since when, and stays until somebody has seen it."""

import pytest

from bus.protocol import Device
from host.console.shell import alarm_line
from host.telescope.alarms import Alarm, Alarms, Severity, of_bus
from host.telescope.state import Snapshot
from tests.host.telescope.conftest import Rig

WARNING, ALARM = Severity


def test_an_alarm_stays_until_it_is_acknowledged() -> None:
    alarms = Alarms()
    alarms.take(1.0, {"fire": ALARM})
    alarms.take(2.0, {"fire": ALARM})
    assert alarms.standing == (Alarm("fire", ALARM, 1.0),)
    alarms.take(3.0, {})
    assert alarms.standing == (Alarm("fire", ALARM, 1.0, 3.0),)
    alarms.acknowledge()
    assert alarms.standing == ()


def test_one_that_was_acknowledged_goes_with_its_cause_and_comes_back_new() -> None:
    alarms = Alarms()
    alarms.take(1.0, {"fire": ALARM})
    alarms.acknowledge()
    assert alarms.standing == (Alarm("fire", ALARM, 1.0, None, True),)
    alarms.take(2.0, {})
    assert alarms.standing == ()
    alarms.take(3.0, {"fire": ALARM})
    assert alarms.standing == (Alarm("fire", ALARM, 3.0),)


def test_one_that_returns_before_it_was_seen_is_of_the_later_time() -> None:
    alarms = Alarms()
    for t_s, found in ((1.0, {"fire": ALARM}), (2.0, {}), (3.0, {"fire": ALARM})):
        alarms.take(t_s, found)
    assert alarms.standing == (Alarm("fire", ALARM, 3.0),)


def test_what_gets_worse_is_news_and_what_gets_better_is_not() -> None:
    alarms = Alarms()
    alarms.take(1.0, {"load": WARNING})
    alarms.acknowledge()
    alarms.take(2.0, {"load": ALARM})
    assert alarms.standing == (Alarm("load", ALARM, 1.0),)
    alarms.acknowledge()
    alarms.take(3.0, {"load": WARNING})
    assert alarms.standing == (Alarm("load", WARNING, 1.0, None, True),)


def test_the_worst_is_first_then_the_newest() -> None:
    alarms = Alarms()
    alarms.take(1.0, {"old": WARNING, "bad": ALARM})
    alarms.take(2.0, {"old": WARNING, "bad": ALARM, "new": WARNING})
    assert [alarm.what for alarm in alarms.standing] == ["bad", "new", "old"]


@pytest.mark.parametrize(("load", "severity"), [(0.49, None), (0.5, WARNING), (0.89, WARNING), (0.9, ALARM)])
def test_a_loaded_bus_and_a_running_fault_are_shown(load: float, severity: Severity | None) -> None:
    found = of_bus(load, [(3, "babbler, load=0.5 for 2.0 s")])
    assert found.get("the bus is loaded") == severity
    assert found["fault 3 runs: babbler"] == WARNING


def test_the_line_says_how_bad_what_since_when_and_whether_it_is_over() -> None:
    since = "2026-02-10T14:00:20.000Z"
    assert alarm_line(Alarm("a < b", ALARM, 20.0), since) == (
        '<div class="alarm new"><b>ALARM</b> a &lt; b, since 14:00:20 UTC</div>'
    )
    assert alarm_line(Alarm("x", WARNING, 20.0, 21.0), since).endswith("UTC (over)</div>")
    seen = alarm_line(Alarm("x", WARNING, 20.0, None, True), since)
    assert seen == '<div class="warning"><b>WARNING</b> x, since 14:00:20 UTC (acknowledged)</div>'


def wrong(rig: Rig, alarms: Alarms) -> dict[str, Severity]:
    now: Snapshot = rig.telescope.snapshot
    return alarms.of_telescope(now)


def test_a_board_that_goes_is_an_alarm_and_its_values_are_old(rig: Rig) -> None:
    alarms = Alarms()
    rig.advance(3.0)
    assert wrong(rig, alarms) == {}
    assert rig.telescope.snapshot.stale == frozenset()
    rig.served.switch("POSITION_RA", False)
    rig.advance(0.3)
    assert rig.telescope.snapshot.stale == {Device.POSITION_RA}
    assert wrong(rig, alarms)["POSITION_RA: no measurement"] == ALARM
    rig.advance(4.0)
    assert wrong(rig, alarms)["POSITION_RA is silent"] == ALARM
    rig.served.switch("POSITION_RA", True)
    rig.advance(2.0)
    assert not {"POSITION_RA is silent", "POSITION_RA: no measurement"} & set(wrong(rig, alarms))
