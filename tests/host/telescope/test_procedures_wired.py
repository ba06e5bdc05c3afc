"""Procedures on wired boards: following with trims and nudges, guiding by an eye, buttons, health."""

import math
from typing import Any

import pytest

from bus.protocol import AxisParameter, Device, MotionFlag, Opcode, SpeedClass
from bus.protocol.scales import rate_q16
from host.client import ClientError, Procedure
from host.procedures import manual
from host.procedures.autoguide import Guided, Guiding, _pulse_s, autoguide
from host.procedures.pointing import Pointing, Reach
from host.procedures.pointing_run import _look
from host.sky.catalogue import STARS
from host.sky.mount import STEP_ARCSEC
from host.sky.observed import observe
from host.sky.tracks import GUIDE_ARCSEC_S, StarTrack
from tests.host.telescope.wired import AXES, Wired

RA, DEC = AXES
STAR = STARS["Pollux"]
ARCSEC = math.pi / 648000


def steps(arcsec: float) -> int:
    return round(arcsec / STEP_ARCSEC)


def run(made: Wired, procedure: Procedure, ticks: int = 1000) -> int:
    """Ticks until it ends."""
    for count in range(ticks):
        try:
            next(procedure)
        except StopIteration:
            return count
        made.tick()
    raise AssertionError("it does not end")


def pointed(off: tuple[float, float] = (0.0, 0.0)) -> tuple[Wired, Pointing]:
    """On Pollux, with the axes that many arcseconds behind."""
    made = Wired()
    about = made.observatory
    track = StarTrack(STAR, about.site, about.clock, about.mount)

    def follow() -> None:
        there = track.steps(made.client.now_s + 0.05)
        made.steps = [there[0] - steps(off[0]), there[1] - steps(off[1])]

    made.follows = follow
    made.tick()
    pointing = Pointing(made.client, about.mount)
    pointing.track = track
    return made, pointing


def rates(made: Wired) -> list[list[float]]:
    """Of either axis, less the star's own: what was sent, arcseconds a second."""
    plain = StarTrack(STAR, made.observatory.site, made.observatory.clock, made.observatory.mount).rates(5.0)
    told = made.since()
    return [
        [each[2] / rate_q16(1.0) - plain[k] for each in told if each[:2] == (axis, Opcode.TRACK_RATE)]
        for k, axis in enumerate(AXES)
    ]


def test_errors_are_the_stars_less_the_encoders() -> None:
    made, pointing = pointed((3.0, -2.0))
    assert pointing.errors_arcsec() == pytest.approx((3.0, -2.0), abs=0.01)
    pointing.track = None
    assert pointing.errors_arcsec() is None
    made, pointing = pointed()
    del made.link.measurements[Device.POSITION_DEC]
    pointing._errors_ns = -1
    assert pointing.errors_arcsec() is None


@pytest.mark.parametrize(("off", "trims", "nudges"), [
    ((1.0, -1.0), (0.05, -0.05), []), ((4.0, -4.9), (0.1, -0.1), []),
    ((5.1, -59.0), (0.1, -0.1), [(RA, 5.1), (DEC, -59.0)]),
])  # fmt: skip
def test_following_trims_over_20_seconds_and_nudges_beyond_5_arcseconds(
    off: tuple[float, float], trims: tuple[float, float], nudges: list[tuple[Device, float]]
) -> None:
    made, pointing = pointed(off)
    assert run(made, pointing.follow(6.0)) == pytest.approx(6.0 / 0.05, abs=6)
    told = made.told
    found = [(each[0], each[2] * STEP_ARCSEC) for each in told if each[1] == Opcode.NUDGE]
    assert [each[0] for each in found] == [each[0] for each in nudges] or len(found) == 2 * len(nudges)
    for device, arcsec in found:
        assert arcsec == pytest.approx(dict(nudges)[device], abs=0.05)
    for axis, trim in zip(rates(made), trims, strict=True):
        assert axis[0] == pytest.approx(0.0, abs=2e-3) and axis[-1] == pytest.approx(trim, abs=2e-3)
    assert not pointing.tracking and not pointing.commanding


def test_an_axis_that_does_not_follow_is_told() -> None:
    made, pointing = pointed((0.0, -61.0))
    with pytest.raises(ClientError, match="AXIS_DEC: does not follow Pollux, -61″ off"):
        run(made, pointing.follow(20.0))
    made, pointing = pointed()
    pointing.track = None
    with pytest.raises(ClientError, match="track: there is no target yet; go to one first"):
        run(made, pointing.follow(1.0))


def test_rates_are_left_to_a_pulse_while_it_lasts() -> None:
    made, pointing = pointed((2.0, 0.0))
    procedure = pointing.follow(100.0)
    pointing.guided = 1
    for _ in range(200):
        next(procedure)
        made.tick()
    assert [len(each) for each in rates(made)] == [1, 1]
    pointing.guided = 0
    for _ in range(10):
        next(procedure)
        made.tick()
    assert rates(made)[0][-1] == pytest.approx(0.0, abs=0.11)


def test_a_star_that_does_not_stay_is_told() -> None:
    made, pointing = pointed((4.0, 0.0))
    with pytest.raises(ClientError, match="Pollux: does not stay within 3″"):
        run(made, pointing._settle(Reach(3.0, 2.0)))
    made, pointing = pointed((2.9, -2.9))
    assert run(made, pointing._settle(Reach(3.0, 2.0))) == 20


def test_parking_may_fail_by_its_time() -> None:
    made, pointing = pointed()
    with pytest.raises(ClientError, match="park: within 300″ at slew speed: not within 240 s"):
        run(made, pointing.park(), 6000)


class Sky:
    """An eye that sees the telescope off by so much, radians; what it was asked."""

    def __init__(self, offs: list[tuple[float, float]]) -> None:
        self.offs, self.asked = offs, list[int]()

    def __call__(self, _star: Any, t_ns: int) -> tuple[float, float]:
        self.asked.append(t_ns)
        return self.offs[min(len(self.asked), len(self.offs)) - 1]


@pytest.mark.parametrize("by_rate", [False, True])
def test_guiding_sends_a_pulse_of_the_error_after_every_exposure(by_rate: bool) -> None:
    made, pointing = pointed()
    west = math.cos(STAR.declination_rad)
    eye = Sky([(1e-5, 2e-5), (1e-5 + 4.0 * ARCSEC / west, 2e-5 - 2.0 * ARCSEC), (1e-5, 2e-5)])
    told: list[Guided] = []
    how = Guiding(seconds=6.0, exposure_s=1.0, aggressiveness=0.5, by_rate=by_rate)
    begin = made.client.now_s
    run(made, autoguide(pointing, made.observatory, eye, how, told.append))
    assert [each * 1e-9 - begin for each in eye.asked[:2]] == pytest.approx([0.5, 1.5], abs=0.06)
    assert [each.t_s - begin for each in told[:2]] == pytest.approx([1.0, 2.0], abs=0.11)
    assert told[0].off == told[0].sent == told[0].pulses_s == (0.0, 0.0)
    assert told[1].off == pytest.approx((4.0, -2.0))
    ra_s, dec_s = 0.5 * 4.0 / (GUIDE_ARCSEC_S * west), -0.5 * 2.0 / GUIDE_ARCSEC_S
    assert told[1].pulses_s == pytest.approx((ra_s, dec_s), abs=6e-4)
    assert told[1].sent == pytest.approx((2.0, -1.0), abs=0.01)
    assert told[2].t_s == pytest.approx(told[1].t_s + ra_s + 0.3 + 1.0, abs=0.16)
    ra = [each for each in made.told if each[0] == RA]
    assert {each[1] for each in ra} == {Opcode.SET_RATE if by_rate else Opcode.TRACK_RATE}
    assert {each[1] for each in made.told if each[0] == DEC} == {Opcode.TRACK_RATE}
    fastest = max(each[2] for each in ra) / rate_q16(1.0)
    assert 15.04 + 0.8 * GUIDE_ARCSEC_S < fastest < 15.1 + GUIDE_ARCSEC_S
    track: Any = pointing.track
    assert track.shifted(made.client.now_s)[1] == pytest.approx(dec_s * GUIDE_ARCSEC_S, abs=0.01)
    assert track.shifted(made.client.now_s)[0] == pytest.approx(
        0.0 if by_rate else ra_s * GUIDE_ARCSEC_S, abs=0.01
    )
    assert not pointing.tracking


def test_guiding_needs_a_target() -> None:
    made, pointing = pointed()
    pointing.track = None
    how = Guiding(seconds=1.0, exposure_s=1.0, aggressiveness=0.5, by_rate=False)
    with pytest.raises(ClientError, match="autoguide: there is no target yet; go to one first"):
        run(made, autoguide(pointing, made.observatory, Sky([(0.0, 0.0)]), how, lambda _: None))


@pytest.mark.parametrize(("off", "share", "speed", "seconds"), [
    (0.199, 1.0, 7.5, 0.0), (0.2, 1.0, 7.5, 0.027), (-0.3, 0.5, 7.5, -0.02), (100.0, 1.0, 7.5, 2.5),
    (-100.0, 1.0, 7.5, -2.5), (1.0, 0.7, 7.0, 0.1),
])  # fmt: skip
def test_a_pulse_is_of_whole_milliseconds(off: float, share: float, speed: float, seconds: float) -> None:
    assert _pulse_s(off, share, speed) == seconds


def test_what_an_eye_sees_is_taken_off_the_star() -> None:
    made, pointing = pointed()
    about = made.observatory
    found = _look(pointing, about, STAR, Sky([(1e-4, -2e-4)]))
    seen = observe(STAR, about.site, about.clock, made.client.now_s)
    assert (found.sighting.ra_steps, found.sighting.dec_steps) == tuple(made.steps)
    assert found.sighting.hour_angle_rad == pytest.approx(seen.hour_angle_rad - 1e-4, abs=1e-9)
    assert found.sighting.declination_rad == pytest.approx(seen.declination_rad + 2e-4, abs=1e-9)
    assert found.t_s == made.client.now_s and found.star is STAR


def test_buttons_are_their_commands() -> None:
    made = Wired()
    made.tick()
    client = made.client
    assert run(made, manual.hold_button(client, "ra", "guide", "-", 1.0)) == pytest.approx(22, abs=1)
    run(made, manual.hold_button(client, "dec", "slew", "+", 0.0))
    assert run(made, manual.set_rate(client, "dec", -12.0, 0.5)) == pytest.approx(11, abs=1)
    assert run(made, manual.open_loop(client, "ra", -0.25, 0.5)) == pytest.approx(11, abs=1)
    run(made, manual.stop(client, "both"))
    run(made, manual.stop(client, "dec"))
    assert made.since() == [
        (RA, Opcode.SET_CLASS, SpeedClass.GUIDE, -1), (RA, Opcode.STOP),
        (DEC, Opcode.SET_CLASS, SpeedClass.SLEW, 1),
        (DEC, Opcode.STOP), (DEC, Opcode.SET_RATE, rate_q16(-12.0)), (RA, Opcode.OPEN_LOOP, -750),
        (RA, Opcode.STOP), (DEC, Opcode.STOP), (DEC, Opcode.STOP),
    ]  # fmt: skip


def test_parameters_are_loaded_and_looked_at() -> None:
    made = Wired()
    made.tick()
    made.results[Opcode.SET_PARAMETER] = (0, 5)
    run(made, manual.load(made.client, RA, [(2, 5), (3, 5)]))
    assert [each[2:] for each in made.since()] == [(2, 5), (3, 5)]
    assert "AXIS_RA: 2 parameters loaded" in made.said("status")
    with pytest.raises(ClientError, match="AXIS_RA: parameter 4 is 5, not 6"):
        run(made, manual.load(made.client, RA, [(4, 6)]))


def test_power_waits_two_seconds_and_the_health_check_five() -> None:
    made = Wired()
    made.tick()
    run(made, manual.power_on(made.client, False, 77))
    assert made.since() == [
        (DEC, Opcode.SET_PARAMETER, int(AxisParameter.COUNTER_BIAS_Q8), 77), (RA, Opcode.POWER, 1),
        (DEC, Opcode.POWER, 1),
    ]  # fmt: skip
    assert manual.powered(made.client, RA)
    made.flags = [MotionFlag(0), MotionFlag(0)]
    made.silent = set()
    procedure = manual.power_on(made.client, False)
    begin = made.client.now_s
    with pytest.raises(ClientError, match="AXIS_RA: powered: not within 2 s"):
        for _ in range(100):
            next(procedure)
            made.tick()
            made.flags = [MotionFlag(0), MotionFlag(0)]
    assert made.client.now_s - begin == pytest.approx(2.15, abs=0.1)
    made.results[Opcode.PING] = (0, 5)
    begin = made.client.now_s
    with pytest.raises(ClientError, match="health check: AXIS_RA reports sensor, bus; AXIS_DEC reports"):
        run(made, manual.health_check(made.client))
    assert made.client.now_s - begin == pytest.approx(5.1, abs=0.4)
    made.results[Opcode.PING] = (0, 0)
    run(made, manual.health_check(made.client))
    assert made.said("status")[-1] == "health check passed, 5 boards"
    assert manual._words(1 << 14) == "0x4000"
