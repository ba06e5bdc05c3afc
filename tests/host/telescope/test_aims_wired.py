"""Where the slit has to be, what weather says, and what the drive goes back to, on wired boards."""

import math
from types import SimpleNamespace as Some
from typing import Any

import pytest

from bus.protocol import Device, Opcode, SpeedClass
from bus.protocol.nodes import DOME, WEATHER
from host.client import ClientError, CommandRefused
from host.sky.mount import STEP_ARCSEC
from host.sky.tracks import SkyTrack
from host.telescope import Reason, Refused
from host.telescope import house as house_module
from host.telescope.house import House
from host.telescope.jobs import Activity, Job, Side
from tests.host.telescope.wired import AXES, CENTRE, Wired, awake

MAST, STATION = "WEATHER_MAST", "WEATHER_DOME"


def steps(arcsec: float) -> int:
    return round(arcsec / STEP_ARCSEC)


def test_a_slew_aims_at_its_end_and_anything_else_where_the_tube_points() -> None:
    bare = Wired()
    assert bare.telescope.aim() is None and bare.telescope.target() is None
    made = awake()
    made.steps = [CENTRE, CENTRE]
    made.tick()
    here = made.telescope.aim()
    assert here is not None and math.degrees(here.altitude_rad) == pytest.approx(60.633, abs=1e-3)
    assert made.telescope.target() is None
    made.do(lambda t: t.drive.goto_altaz(math.radians(90), math.radians(50)))
    made.tick()
    for found in (made.telescope.aim(), made.telescope.target()):
        assert found is not None and math.degrees(found.altitude_rad) == pytest.approx(50.0, abs=1e-3)
    made.do(lambda t: t.drive.stop())
    made.tick(5)
    still = made.telescope.aim()
    assert still is not None and still.altitude_rad == pytest.approx(here.altitude_rad)
    assert made.telescope.target() is None, "it goes nowhere"
    made.do(lambda t: t.drive.track(True))
    made.tick(60)
    followed = made.telescope.target()
    assert followed is not None and followed.altitude_rad == pytest.approx(here.altitude_rad, abs=1e-3)
    for encoder in (Device.POSITION_RA, Device.POSITION_DEC):
        made.tick()
        kept = made.link.measurements.pop(encoder)
        made.telescope.tick(made.client.now_ns + 1)
        assert made.telescope.aim() is None
        made.link.measurements[encoder] = kept


def test_a_telescope_begins_unlocked_and_without_haste() -> None:
    made = Wired()
    assert not made.telescope.locked and not made.telescope.urgent
    made.telescope.call(lambda t: None)
    assert not made.telescope.urgent


def test_an_emergency_stop_asks_both_axes_at_once_and_the_dome() -> None:
    made = awake()
    stopped: list[str] = []
    made.telescope.house.boards = lambda kind: ["DOME"] if kind is DOME else []  # type: ignore[method-assign]
    made.telescope.house.stop = lambda: stopped.append("dome")  # type: ignore[method-assign, assignment, return-value]
    made.silent = {Device.AXIS_RA}
    made.do(lambda t: t.emergency_stop())
    assert (AXES[1], Opcode.STOP) in made.since() and stopped == ["dome"]


def test_the_house_is_ticked() -> None:
    made = awake()
    ticked: list[int] = []
    made.telescope.house.tick = lambda: ticked.append(1)  # type: ignore[method-assign]
    made.tick(3)
    assert ticked == [1, 1, 1]


def test_a_sync_while_tracking_follows_that_star_and_a_model_goes_on() -> None:
    made = awake()
    made.steps = [CENTRE, CENTRE]
    made.do(lambda t: t.drive.track(True))
    made.tick(60)
    star = made.do(lambda t: t.drive.here())
    other = star.__class__("other", star.right_ascension_rad, star.declination_rad)
    made.do(lambda t: t.drive.sync(other))
    track = made.telescope.drive.pointing.track
    assert track is not None and track.star.name == "other"
    assert made.telescope.drive.activity is Activity.TRACKING
    job = made.telescope.drive.job
    made.do(lambda t: t.drive.apply_model(None))
    assert made.telescope.drive.job is not job and made.telescope.drive.activity is Activity.TRACKING
    idle = awake()
    there = idle.do(lambda t: t.drive.here())
    idle.do(lambda t: t.drive.sync(there))
    assert idle.telescope.drive.activity is Activity.IDLE


def test_a_slew_is_told_and_tracking_is_not() -> None:
    made = awake()
    made.do(lambda t: t.drive.track(True))
    made.tick(60)
    assert [each for each in made.said("status") if each.startswith("track")] == ["track"]
    made.do(lambda t: t.drive.abort())
    made.do(lambda t: t.drive.stop())
    assert made.said("status")[-1] == "stop"


def test_a_new_command_forgets_what_the_boards_still_wait_for() -> None:
    made = awake()
    made.silent = {*AXES}
    made.do(lambda t: t.paddle.move("ra", 50.0))
    made.tick()
    made.silent = set()
    made.do(lambda t: t.drive.stop())
    made.tick(6)
    told = [each[1] for each in made.since() if each[0] == AXES[0]]
    assert told == [Opcode.TRACK_RATE, Opcode.STOP]


def test_a_drift_of_before_is_not_in_a_slew() -> None:
    made = awake()
    made.telescope.drive.set_rates(drift_arcsec_s=(5.0, 5.0))
    star = made.do(lambda t: t.drive.here())
    made.do(lambda t: t.drive.goto(star))
    made.tick(2)
    track: Any = made.telescope.drive.pointing.track
    assert isinstance(track, SkyTrack) and track._drift == (0.0, 0.0)
    assert made.telescope.drive.pointing.on_target is False


def test_the_horizon_is_looked_at_once_a_second() -> None:
    made = awake()
    made.do(lambda t: t.paddle.move("ra", 10.0))
    looked: list[int] = []
    real = made.observatory.observed
    made.observatory.observed = lambda *at: looked.append(1) or real(*at)  # type: ignore[method-assign, func-returns-value]
    made.tick(41)
    assert 2 <= len(looked) <= 4


def test_a_paddle_and_a_trim_go_with_a_pulse() -> None:
    made = awake()
    made.do(lambda t: t.paddle.press("n", SpeedClass.GUIDE))
    with pytest.raises(Refused, match="guiding needs"):
        made.do(lambda t: t.paddle.pulse("n", 1.0))
    ground = awake()
    ground.telescope.drive.begin("x", ground.client.wait(10.0), Activity.TRACKING)
    with pytest.raises(Refused, match="guiding needs"):
        ground.do(lambda t: t.paddle.pulse("n", 1.0))


class Quiet:
    """A client that has heard what a test wants."""

    def __init__(self) -> None:
        self.link = Some(measurements={}, measured_ns={})
        self.now_s = 100.0
        self.devices = [*WEATHER.devices()]


@pytest.fixture
def weather(monkeypatch: pytest.MonkeyPatch) -> tuple[House, Quiet]:
    numbers = dict(WEATHER.nodes)
    codec = {
        name: Some(identifier=0x200 + number, period_ns=1_000_000_000) for name, number in numbers.items()
    }
    monkeypatch.setattr(house_module, "codecs", lambda: codec)
    client = Quiet()
    return House(client, Side(), lambda: None), client  # type: ignore[arg-type]


def test_a_measurement_is_old_after_five_periods_and_a_tick(weather: tuple[House, Quiet]) -> None:
    made, client = weather
    assert made.heard_s(MAST) == -math.inf == made.heard_s("nobody") and made.stale(MAST)
    client.link.measured_ns[WEATHER.nodes[MAST]] = 94_950_000_001
    assert made.heard_s(MAST) == pytest.approx(94.95) and not made.stale(MAST)
    client.link.measured_ns[WEATHER.nodes[MAST]] = 94_949_000_000
    assert made.stale(MAST) and made.fresh(MAST) is None


def test_stations_say_what_speaks_against_an_open_dome(weather: tuple[House, Quiet]) -> None:
    made, client = weather
    dry = {"Unsafe": 0.0, "Rain": 0.0, "Windy": 0.0, "Humid": 0.0}
    said: dict[str, Any] = {MAST: dry, STATION: None}
    made.fresh = said.get  # type: ignore[method-assign, assignment]
    assert made.expected(WEATHER) == [MAST, STATION] and made.unsafe() == [f"{STATION} is silent"]
    said[STATION] = dry | {"Unsafe": 1.0}
    said[MAST] = dry | {"Unsafe": 1.0, "Rain": 1.0, "Humid": 1.0}
    assert made.unsafe() == [f"{MAST}: rain, humid", f"{STATION}: bad a moment ago"]
    client.devices = client.devices[:1]
    assert len(made.expected(WEATHER)) == 1
    client.link.measurements = {WEATHER.nodes[STATION]: b""}
    assert made.boards(WEATHER) == [STATION] and made.boards(DOME) == []


@pytest.mark.parametrize(("error", "reason"), [
    (Refused(Reason.PARKED, "no"), Reason.PARKED), (CommandRefused("no"), Reason.STATE),
    (ClientError("no"), Reason.SILENT),
])  # fmt: skip
def test_a_job_ends_with_what_its_procedure_raised(error: Exception, reason: Reason) -> None:
    def procedure() -> Any:
        yield
        raise error

    job: Job[None] = Job("x", procedure(), Activity.IDLE)
    job.advance()
    assert job.running and job.failed == ""
    job.advance()
    assert not job.running and job.failed == "no"
    with pytest.raises(Refused) as found:
        job.finished.result(0)
    assert found.value.reason is reason


def test_a_job_that_is_cancelled_is_closed_and_did_not_fail() -> None:
    closed: list[bool] = []

    def procedure() -> Any:
        try:
            while True:
                yield
        finally:
            closed.append(True)

    job: Job[None] = Job("x", procedure(), Activity.IDLE)
    job.advance()
    job.cancel("enough")
    job.cancel("again")
    job.advance()
    assert closed == [True] and job.failed == ""
    with pytest.raises(Refused, match="x: enough"):
        job.finished.result(0)
