"""The dome's board: the shorter way round, the shutter's switches, and weather that closes it."""

import pytest

from boards.dome.firmware import DomeBoard
from bus.protocol import Health, Result, State
from bus.protocol.nodes import WEATHER, FrameCodec, messages_of
from tests.boards.alone import MS, Alone

NUMBER = 0x71
MAST, INSIDE = 0x272, 0x274
CODECS = {each.frame_id: FrameCodec(each) for each in messages_of(WEATHER) if each.frame_id in (MAST, INSIDE)}
COST_NS = 150_000


@pytest.fixture
def alone() -> Alone[DomeBoard]:
    return Alone(DomeBoard, NUMBER, encoder=0.0, shutter=0.0)


def station(alone: Alone[DomeBoard], identifier: int, unsafe: bool) -> None:
    """A frame of a weather station."""
    alone.hears(identifier, CODECS[identifier].pack({"Unsafe": unsafe}))


def at(alone: Alone[DomeBoard], **pins: float) -> dict[str, float]:
    """What is said when the pins read so."""
    alone.pins.update(pins)
    alone.run(0.1)
    return alone.said()


def test_routines_take_what_the_table_says(alone: Alone[DomeBoard]) -> None:
    sample, can = (alone.board.cpu.lines[name] for name in ("sample", "can"))
    assert (sample.cost_ns, sample.latency_ns, sample.source.level) == (COST_NS, 1200, False)
    assert (can.cost_ns, can.latency_ns, can.source.level) == (60_000, 1200, True)


def test_after_power_up_nothing_moves(alone: Alone[DomeBoard]) -> None:
    said = at(alone)
    assert said == {
        "Moving": 0, "ShutterMoving": 0, "Opened": 0, "Closed": 1, "BadWeather": 0, "Azimuth": 0, "Target": 0,
        "Shutter": 0,
    }  # fmt: skip
    assert (alone.board.state(), alone.board.health(), alone.writes()) == (State.READY, Health(0), [])


@pytest.mark.parametrize(
    ("encoder", "azimuth"), [(1, 0.1), (900, 90.0), (3599, 359.9), (3600, 0), (-1, 359.9)]
)
def test_the_rail_has_3600_counts(alone: Alone[DomeBoard], encoder: float, azimuth: float) -> None:
    assert at(alone, encoder=encoder)["Azimuth"] == pytest.approx(azimuth)


@pytest.mark.parametrize(("encoder", "target", "direction"), [
    (0, 9000, 1), (0, 27000, -1), (0, 17990, 1), (0, 18010, -1), (3590, 100, 1), (10, 35900, -1),
    (1800, 0, -1), (1801, 0, 1),
])  # fmt: skip
def test_it_turns_the_shorter_way(alone: Alone[DomeBoard], encoder: int, target: int, direction: int) -> None:
    at(alone, encoder=encoder)
    assert alone.command("DOME_GOTO", target) == Result.OK
    assert alone.writes() == []  # the next routine compares
    said = at(alone)
    assert alone.writes() == [("turn", direction)]
    assert (said["Moving"], said["ShutterMoving"]) == (1, 0)
    assert said["Target"] == pytest.approx(target / 100)
    assert alone.board.state() == State.ACTIVE


def test_it_stops_within_its_tolerance(alone: Alone[DomeBoard]) -> None:
    alone.command("DOME_GOTO", 9000)
    for encoder, moving in ((0, 1), (894, 1), (895, 0), (800, 0)):
        assert at(alone, encoder=encoder)["Moving"] == moving
    assert alone.writes() == [("turn", 1), ("turn", 0)]  # and does not seek afterwards
    alone.board.values["tolerance_centidegrees"].value = 10
    alone.command("DOME_GOTO", 9000)
    for encoder, direction in ((895, 1), (902, -1), (901, 0)):
        at(alone, encoder=encoder)
        assert alone.writes() == [("turn", direction)]


@pytest.mark.parametrize(("encoder", "target"), [(3590, 100), (10, 35900)])
def test_a_tolerance_reaches_over_north(alone: Alone[DomeBoard], encoder: int, target: int) -> None:
    """Two degrees from 359 to 1."""
    at(alone, encoder=encoder)
    for tolerance, moving in ((200, 0), (199, 1)):
        alone.board.values["tolerance_centidegrees"].value = tolerance
        alone.command("DOME_GOTO", target)
        assert at(alone)["Moving"] == moving


def test_outputs_change_at_the_end_of_the_routine(alone: Alone[DomeBoard]) -> None:
    alone.command("DOME_GOTO", 9000)
    at(alone)
    (_, t_ns, _), *none = alone.driven
    assert not none and t_ns == 100 * MS + 1200 + COST_NS


def test_a_shutter_runs_to_its_switches(alone: Alone[DomeBoard]) -> None:
    assert alone.command("DOME_SHUTTER", 1) == Result.OK
    assert alone.writes() == [("slide", 1)]
    assert alone.board.state() == State.ACTIVE
    for share, moving, opened, closed in ((0.0, 1, 0, 1), (0.25, 1, 0, 0), (0.995, 1, 0, 0), (1.0, 0, 1, 0)):
        said = at(alone, shutter=share)
        assert (said["ShutterMoving"], said["Opened"], said["Closed"]) == (moving, opened, closed)
        assert said["Shutter"] == pytest.approx(100 * share, abs=0.25)
    assert alone.writes() == [("slide", 0)]
    assert alone.command("DOME_SHUTTER", 0) == Result.OK
    for share, moving in ((1.0, 1), (0.01, 1), (0.0, 0)):
        assert at(alone, shutter=share)["ShutterMoving"] == moving
    assert alone.writes() == [("slide", -1), ("slide", 0)]
    assert alone.board.state() == State.READY


def test_a_stop_stops_both(alone: Alone[DomeBoard]) -> None:
    alone.command("DOME_GOTO", 9000)
    alone.command("DOME_SHUTTER", 1)
    at(alone, shutter=0.5)
    alone.writes()
    assert alone.command("DOME_STOP") == Result.OK
    assert alone.writes() == [("turn", 0), ("slide", 0)]
    assert (at(alone)["Moving"], alone.writes()) == (0, [])


def test_contactors_drop_out_without_supply(alone: Alone[DomeBoard]) -> None:
    alone.command("DOME_GOTO", 9000)
    alone.command("DOME_SHUTTER", 1)
    at(alone, shutter=0.5)
    station(alone, MAST, False)
    alone.board.values["tolerance_centidegrees"].value = 70
    alone.writes()
    alone.board.power_off(alone.queue.now_ns)
    assert alone.writes() == [("turn", 0), ("slide", 0)]
    alone.board.power_on(alone.queue.now_ns)
    alone.run(0.45)
    said = alone.said()
    assert (said["Moving"], said["ShutterMoving"], said["Target"]) == (0, 0, 0)
    assert alone.board.heard == {} and not alone.board.seeking
    assert alone.board.values["tolerance_centidegrees"].value == 50


@pytest.mark.parametrize("identifier", [MAST, INSIDE])
def test_unsafe_weather_closes_the_shutter_and_keeps_it_so(alone: Alone[DomeBoard], identifier: int) -> None:
    at(alone, shutter=1.0)
    station(alone, MAST + INSIDE - identifier, False)
    station(alone, identifier, True)
    assert at(alone)["BadWeather"] == 1
    assert alone.writes() == [("slide", -1)]
    at(alone, shutter=0.0)
    assert alone.writes() == [("slide", 0)]
    assert alone.command("DOME_SHUTTER", 1) == Result.NOT_ALLOWED
    assert alone.command("DOME_SHUTTER", 0) == Result.OK
    at(alone)
    alone.writes()
    at(alone)
    assert alone.writes() == []  # it is closed
    station(alone, identifier, False)
    assert at(alone)["BadWeather"] == 0
    assert alone.command("DOME_SHUTTER", 1) == Result.OK
    assert alone.writes() == [("slide", 1)]
    assert Health.STALE not in alone.board.health()


def test_whoever_looks_after_the_weather_himself_may_open(alone: Alone[DomeBoard]) -> None:
    alone.board.values["close_in_bad_weather"].value = 0
    station(alone, MAST, True)
    assert alone.command("DOME_SHUTTER", 1) == Result.OK
    assert at(alone, shutter=0.5)["BadWeather"] == 1
    assert alone.writes() == [("slide", 1)]


@pytest.mark.parametrize(("silent_s", "bad"), [(9.8, 0), (10.2, 1)])
def test_a_station_that_falls_silent_for_ten_seconds_is_bad_weather(
    alone: Alone[DomeBoard], silent_s: float, bad: int
) -> None:
    at(alone, shutter=1.0)
    station(alone, MAST, False)
    alone.run(silent_s)
    assert alone.said()["BadWeather"] == bad
    assert (Health.STALE in alone.board.health()) is bool(bad)
    assert alone.writes() == [("slide", -1)] * bad
    station(alone, MAST, False)
    assert at(alone)["BadWeather"] == 0


def test_of_a_station_only_its_weather_counts(alone: Alone[DomeBoard]) -> None:
    """Its heartbeat and its replies are no weather."""
    assert set(alone.board.stations) == {MAST, INSIDE}
    assert alone.board.port.passes(MAST) and not alone.board.port.passes(0x772)
