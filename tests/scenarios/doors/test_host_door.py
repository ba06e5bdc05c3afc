"""The emulator's end of the host's pipe: what is sent and when, what is heard, and a host that hangs."""

import pytest

from scenarios.doors import pipe_messages as messages
from tests.scenarios.doors.hostdesk import Desk

TICK = 50_000_000


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch) -> Desk:
    return Desk(monkeypatch)


def test_before_it_is_open_nothing_is_said(desk: Desk) -> None:
    desk.pipe.heard.clear()
    desk.door.poll(9 * TICK)
    assert desk.pipe.heard == []
    desk.pipe.said.append(("opened", [], ""))
    desk.door.open()
    assert desk.pipe.said == []


def test_its_program_starts_at_once_and_is_told_all(desk: Desk) -> None:
    assert desk.started == 1 and desk.door.name == "the host" and desk.door.state() == "not there yet"
    assert desk.pipe.heard == [messages.Settings("dated s", "options", ["A"], ("A",), {}, [])]  # type: ignore[arg-type]
    desk.opened()
    assert desk.started == 1 and desk.door.state() == "ready" and 120.0 in desk.pipe.waits


def test_a_host_that_does_not_start_or_open_is_said(desk: Desk) -> None:
    with pytest.raises(OSError, match=r"^the host did not start within 120 s$"):
        desk.door.open()
    desk.pipe.said.append(("opened", [], "port taken"))
    with pytest.raises(OSError, match=r"^port taken$"):
        desk.door.open()


def test_a_slice_goes_out_every_tick_and_at_once_with_a_report(desk: Desk) -> None:
    desk.opened().door.poll(TICK - 1)
    assert desk.pipe.heard == [] and desk.plug.asked == [256]
    desk.plug.waiting = [(1, b"r")]
    desk.door.poll(TICK - 1)
    assert desk.pipe.heard == [messages.Slice(TICK - 1, [(1, b"r")], [], None, ["look"])]  # type: ignore[list-item]
    desk.take()
    desk.door.poll(2 * TICK - 2)
    assert len(desk.pipe.heard) == 1 and desk.door.state() == "moves"
    desk.door.poll(2 * TICK - 1)
    assert desk.pipe.heard[1].now_ns == 2 * TICK - 1
    desk.door.poll(9 * TICK)
    assert len(desk.pipe.heard) == 2  # the host is not through


def test_a_host_that_hangs_for_ten_seconds_is_ended(desk: Desk) -> None:
    desk.opened().door.poll(TICK)
    desk.clock = 10.0
    desk.door.poll(TICK)
    assert desk.killed == 0
    desk.clock = 10.1
    with pytest.raises(OSError, match=r"^it does not answer$"):
        desk.door.poll(TICK)
    assert desk.killed == 1


def test_one_that_starts_again_has_two_minutes(desk: Desk) -> None:
    desk.opened().door.close()
    desk.door.open()
    assert desk.started == 2
    desk.clock = 120.0
    desk.door.poll(TICK)
    assert desk.killed == 0 and all(not isinstance(each, messages.Slice) for each in desk.pipe.heard)
    desk.clock = 120.1
    with pytest.raises(OSError, match="does not answer"):
        desk.door.poll(TICK)


@pytest.mark.parametrize(
    ("speed", "late_ns", "waits"), [(2.0, 2 * TICK + 1, True), (2.0, 2 * TICK, False), (1.0, 9 * TICK, False)]
)
def test_faster_than_real_time_waits_for_a_host_that_is_behind(
    desk: Desk, speed: float, late_ns: int, waits: bool
) -> None:
    desk.opened().door.poll(TICK)
    desk.pipe.waits.clear()
    desk.served.pacer.speed = speed
    desk.door.poll(TICK + late_ns)
    assert desk.pipe.waits == ([0.25] if waits else [])


def test_where_clients_step_time_it_waits_at_each_tick(desk: Desk) -> None:
    desk.opened()
    desk.served.steps = object()
    desk.plug.waiting = [(1, b"r")]
    desk.door.poll(TICK - 1)
    assert desk.pipe.heard == []
    desk.door.poll(TICK)
    assert desk.pipe.waits[-1] == 10.0 and len(desk.pipe.heard) == 1


def test_lines_are_fed_while_somebody_records(desk: Desk) -> None:
    desk.opened()
    desk.take(False, True, True)
    desk.door.poll(0)
    assert desk.looks.wanted
    desk.door.poll(7)
    assert desk.pipe.heard[-1].lines == [("AXIS_RA", b"line")]
    desk.take(False, False, False)
    desk.door.poll(8)
    assert desk.dropped == ["AXIS_RA"] and not desk.looks.wanted


def test_pictures_of_the_bus_are_a_quarter_of_a_second_apart(desk: Desk) -> None:
    desk.opened()
    for clock, shown in ((1.0, True), (1.24, False), (1.25, True)):
        desk.clock = clock
        desk.take(True, False, False)
        before = len(desk.pipe.heard)
        desk.door.poll(0)
        assert [each.bus for each in desk.pipe.heard[before:]] == (["bus"] if shown else [])


def test_reports_wishes_and_words_of_the_host(desk: Desk) -> None:
    desk.opened().pipe.said += [("report", b"data"), ("wish", 5, "power"), ("said", "hello"), ("unknown", 1)]
    desk.door.poll(0)
    assert desk.plug.written == [(11, b"data")] and desk.said == ["hello"]
    assert desk.pipe.heard == [("done", 5, "POWER", False)]
    desk.plug.full = True
    desk.pipe.said.append(("report", b"lost"))
    desk.door.poll(0)
    assert len(desk.plug.written) == 1


def test_a_process_that_has_ended_is_said(desk: Desk) -> None:
    desk.opened().pipe.broken = True
    with pytest.raises(OSError, match=r"^its process has ended$"):
        desk.door.poll(TICK)
    desk.pipe.said.append("anything")
    with pytest.raises(OSError, match=r"^its process has ended$"):
        desk.door.poll(TICK)


def test_it_hangs_up_hears_the_farewell_and_ends_who_does_not(desk: Desk) -> None:
    desk.opened()
    desk.take()
    desk.slow = True
    desk.door.close()
    assert desk.pipe.heard == [("close",), "closed"] and desk.plug.unplugged and desk.killed == 1
    assert desk.door.state() == "moves" and 2.0 in desk.pipe.waits and desk.waited == 2
    desk.door.close()
    desk.door.poll(9 * TICK)
    assert len(desk.pipe.heard) == 2 and desk.killed == 1
