"""How far off a telescope is, by an encoder's frame and the moment it was latched."""

from contextlib import suppress
from pathlib import Path
from typing import cast

import pytest

from bus.can.frame import Frame
from bus.protocol import MEASUREMENT_BASE, Device, Opcode, pack_position
from bus.protocol.report import pack_report, slot
from bus.protocol.scales import STEPS_PER_TURN, rate_q16
from host.client import TICK_NS, Client, ClientError
from host.link import HidLink
from host.logs.journal import Journal
from host.procedures.pointing import Pointing
from host.sky.catalogue import Star
from host.sky.mount import Mount
from host.sky.observed import Rates
from host.sky.tracks import StarTrack
from tests.host.test_client import Desk, ok

STEP_ARCSEC = 1_296_000 / STEPS_PER_TURN


class Running(StarTrack):
    """A place that runs a step each microsecond in hour angle and stands in declination."""

    def __init__(self) -> None:
        """Without a star."""

    def steps(self, t_s: float) -> tuple[int, int]:
        return round(t_s * 1e6), 500


@pytest.mark.parametrize("age", [0, 1, 250])
def test_the_star_is_taken_where_it_was_when_the_encoder_was_latched(age: int) -> None:
    client = Client(HidLink(lambda _t, _report: None), Journal())
    pointing = Pointing(client, cast("Mount", None))
    pointing.track = Running()
    for device, steps in ((Device.POSITION_RA, 1_990_000), (Device.POSITION_DEC, 700)):
        frame = Frame(MEASUREMENT_BASE + device, pack_position(device, 0, steps, age, 1))
        client.link.receive(2_000_000_000, pack_report([slot(frame)]))
    client.now_ns = 2_040_000_000
    # its place at 2 s less the age of 4 µs each, less what was read
    assert pointing.errors_arcsec() == pytest.approx(((10_000 - 4 * age) * STEP_ARCSEC, -200 * STEP_ARCSEC))


class Standing(StarTrack):
    """A place that stands at step 100 000 of both axes."""

    def __init__(self) -> None:
        self.star = Star("nowhere", 0.0, 0.0)

    def steps(self, t_s: float) -> tuple[int, int]:
        return 100_000, 100_000

    def rates(self, t_s: float) -> Rates:
        return Rates(0.0, 0.0)


def stands(desk: Desk, off_arcsec: float) -> None:
    """Frames of both encoders, right ascension that far behind the place."""
    off = round(off_arcsec / STEP_ARCSEC)
    for device, steps in ((Device.POSITION_RA, 100_000 - off), (Device.POSITION_DEC, 100_000)):
        frame = Frame(MEASUREMENT_BASE + device, pack_position(device, 0, steps, 0, 1))
        desk.link.receive(desk.t_ns, pack_report([slot(frame)]))


def followed(folder: Path, off_arcsec: float, seconds: float = 4.0) -> Desk:
    """Some time on that place by an axis of right ascension that is so far behind."""
    desk = Desk(folder, ok)
    pointing = Pointing(desk.client, cast("Mount", None))
    pointing.track = Standing()
    stands(desk, off_arcsec)
    desk.run(pointing.follow(seconds))
    return desk


@pytest.mark.parametrize("off_arcsec", [20.0, -20.0, 4.0])
def test_beyond_five_arcsec_the_target_is_nudged_by_what_is_missing(
    tmp_path: Path, off_arcsec: float
) -> None:
    desk = followed(tmp_path, off_arcsec)
    nudges = [frame.data[2:6] for frame in desk.sent if frame.data[1] == Opcode.NUDGE]
    found = [int.from_bytes(each, "little", signed=True) * STEP_ARCSEC for each in nudges]
    assert found == ([] if abs(off_arcsec) < 5.0 else [pytest.approx(off_arcsec, abs=STEP_ARCSEC)])


@pytest.mark.parametrize("off_arcsec", [61.0, -61.0])
def test_an_axis_a_minute_of_arc_away_does_not_follow(tmp_path: Path, off_arcsec: float) -> None:
    with pytest.raises(ClientError, match=f"AXIS_RA: does not follow nowhere, {off_arcsec:.0f}″ off"):
        followed(tmp_path, off_arcsec)


@pytest.mark.parametrize(
    ("off_arcsec", "trim_arcsec_s"), [(1.0, 0.05), (-1.0, -0.05), (4.0, 0.1), (-4.0, -0.1)]
)
def test_a_mean_error_is_taken_out_over_twenty_seconds_by_the_rate(
    tmp_path: Path, off_arcsec: float, trim_arcsec_s: float
) -> None:
    desk = followed(tmp_path, off_arcsec, seconds=6.0)
    told = [frame.data for frame in desk.sent if frame.data[:2] == bytes([0x11, Opcode.TRACK_RATE])]
    rates = [int.from_bytes(each[2:6], "little", signed=True) for each in told]
    assert rates == [0, pytest.approx(rate_q16(trim_arcsec_s), rel=1e-3)]


def test_on_target_is_a_second_without_a_break(tmp_path: Path) -> None:
    desk = Desk(tmp_path, ok)
    pointing = Pointing(desk.client, cast("Mount", None))
    going = pointing.goto(Standing(), ("fine",))
    came_s = 0.0
    while not pointing.on_target:
        now_s = desk.t_ns * 1e-9
        inside = 1.0 <= now_s < 1.8 or now_s >= 2.0
        stands(desk, 2.0 if inside else 4.0)  # 3″ is what the fine class has to reach
        with suppress(StopIteration):
            next(going)
        desk.t_ns += TICK_NS
        desk.client.tick(desk.t_ns)
        came_s = now_s
        assert came_s < 10.0
    assert 3.0 <= came_s < 3.2


def test_rates_wait_while_a_pulse_has_them(tmp_path: Path) -> None:
    desk = Desk(tmp_path, ok)
    pointing = Pointing(desk.client, cast("Mount", None))
    pointing.track = Standing()
    stands(desk, 0.0)
    following = pointing.follow(60.0)

    def told(seconds: float) -> int:
        for _ in range(round(seconds * 1e9 / TICK_NS)):
            next(following)
            desk.t_ns += TICK_NS
            desk.client.tick(desk.t_ns)
        return sum(frame.data[1] == Opcode.TRACK_RATE for frame in desk.sent)

    assert told(1.0) == 2  # both axes
    pointing.guided = 1
    assert told(12.0) == 2
    pointing.guided = 0
    assert told(1.0) == 4
