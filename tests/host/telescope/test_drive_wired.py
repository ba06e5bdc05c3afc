"""The drive's rules on wired boards: what it sends, what it refuses, when it stops by itself."""

import math
from dataclasses import replace

import pytest

from bus.protocol import AxisMode, Device, MotionFlag, Opcode, SpeedClass
from bus.protocol.scales import rate_q16
from host.sky.mount import STEP_ARCSEC
from host.sky.observed import observe, sidereal_time_rad, star_of_apparent
from host.sky.pointmodel import PointingModel, Term
from host.sky.tracks import DriveRate, SkyTrack
from host.telescope import Job, Reason, Refused
from host.telescope.jobs import Activity
from tests.host.telescope.wired import AXES, CENTRE, Wired, awake

ARCSEC = math.pi / 648000
STOPS = [(axis, Opcode.STOP) for axis in AXES]


def steps(arcsec: float) -> int:
    return round(arcsec / STEP_ARCSEC)


def refusal(made: Wired, act: object) -> Refused:
    with pytest.raises(Refused) as found:
        made.do(act)  # type: ignore[arg-type]
    return found.value


@pytest.mark.parametrize(
    ("away_arcsec", "parked"), [(0.0, True), (59.9, True), (-60.1, False), (3600.0, False)]
)
def test_a_telescope_near_its_park_position_without_power_is_parked(away_arcsec: float, parked: bool) -> None:
    for axis in (0, 1):
        made = Wired()
        made.steps[axis] += steps(away_arcsec)
        assert made.telescope.drive.parked is None
        made.tick()
        made.tick()
        assert made.telescope.drive.parked is parked


def test_a_telescope_with_power_is_not_parked_and_one_that_follows_goes_on() -> None:
    made = Wired()
    made.flags = [MotionFlag.POWERED, MotionFlag.POWERED]
    made.tick(2)
    assert made.telescope.drive.parked is False and not made.telescope.drive.tracking
    made = Wired()
    made.flags, made.modes = [MotionFlag.POWERED, MotionFlag.POWERED], [AxisMode.TRACK, AxisMode.OFF]
    made.tick(2)
    assert made.telescope.drive.tracking and made.telescope.drive.activity is Activity.TRACKING
    made = Wired()
    made.flags = [MotionFlag.POWERED, MotionFlag(0)]
    made.tick(2)
    assert made.telescope.drive.parked is True, "one axis without power is none"


def test_before_the_first_readings_nothing_is_known() -> None:
    made = Wired()
    with pytest.raises(Refused, match="no position has been received yet") as found:
        made.telescope.drive.readings()
    assert found.value.reason is Reason.SILENT
    made.tick()
    assert made.telescope.drive.readings() == (*made.steps, pytest.approx(made.client.now_s))


def test_a_parked_telescope_refuses_and_is_woken() -> None:
    made = Wired()
    made.tick()
    refused = refusal(made, lambda t: t.drive.track(True))
    assert refused.reason is Reason.PARKED and str(refused) == "the telescope is parked"
    assert refusal(made, lambda t: t.drive.goto(t.drive.here())).reason is Reason.PARKED
    assert refusal(made, lambda t: t.drive.goto_altaz(0.1, 1.0)).reason is Reason.PARKED
    made.do(lambda t: t.drive.wake())
    made.tick(40)
    assert made.telescope.drive.tracking and made.telescope.drive.activity is Activity.TRACKING
    assert not made.telescope.drive.parked
    made.do(lambda t: t.drive.wake())
    assert made.telescope.drive.activity is Activity.TRACKING


def test_tracking_begins_with_a_stop_of_both_axes_and_the_skys_rates() -> None:
    made = awake()
    made.do(lambda t: t.drive.track(True))
    assert made.telescope.snapshot.activity == "stopping"
    made.tick(8)
    told = made.since()
    assert told[:2] == STOPS
    rates = {device: rate for device, opcode, rate in told[2:] if opcode == Opcode.TRACK_RATE}
    assert rates[Device.AXIS_RA] == pytest.approx(rate_q16(15.04), rel=2e-3)
    assert abs(rates[Device.AXIS_DEC]) < rate_q16(0.02)
    made.tick(30)
    assert made.telescope.drive.pointing.track is not None
    assert made.telescope.drive.pointing.track.star.name == "here"
    made.do(lambda t: t.drive.track(True))
    assert made.telescope.snapshot.activity == "tracking", "it was on already"
    made.since()
    made.do(lambda t: t.drive.track(False))
    made.tick(5)
    assert made.since() == STOPS and made.telescope.drive.activity is Activity.IDLE


@pytest.mark.parametrize(("distance_arcsec", "ticks"), [(0.9, 14), (1.1, 174)])
def test_following_waits_until_the_axes_have_settled(distance_arcsec: float, ticks: int) -> None:
    """By hand: rates, 0.6 s, and 8 s more where a board says that it is an arcsecond off."""
    made = awake()
    made.distance = [0, steps(-distance_arcsec)]
    made.do(lambda t: t.drive.track(True))
    count = 0
    while made.telescope.drive.pointing.track is None:
        made.tick()
        count += 1
        assert count < 300
    assert count == pytest.approx(ticks + 6, abs=5)


def test_a_stop_waits_for_rest() -> None:
    """Two counts in 5 ms are rest, three are not; after 15 s it is an error."""
    made = awake()
    made.velocity = [2, -2]
    made.ended(made.do(lambda t: t.drive.stop()), 5)
    made.velocity = [0, -3]
    job = made.do(lambda t: t.drive.stop())
    made.tick(290)
    assert job.running
    with pytest.raises(Refused, match="stop: both axes at rest: not within 15 s"):
        made.ended(job, 20)
    assert made.said("error") == ["stop: stop: both axes at rest: not within 15 s"]
    assert made.telescope.drive.activity is Activity.IDLE


def test_power_off_stops_first_and_parks_where_it_is_near() -> None:
    made = awake()
    made.telescope.drive.tracking = True
    made.ended(made.do(lambda t: t.drive.power_off()))
    assert made.since() == [*STOPS, *((axis, Opcode.POWER, 0) for axis in AXES)]
    assert made.telescope.drive.parked and not made.telescope.drive.tracking
    made = awake()
    made.steps[0] += steps(600.0)
    made.ended(made.do(lambda t: t.drive.power_off()))
    assert made.telescope.drive.parked is False


def test_parking_goes_by_three_classes_to_the_park_position() -> None:
    made = awake()
    park = made.observatory.mount.park_steps
    made.steps[0] += steps(3600.0)
    made.steps[1] -= steps(20.0)
    job = made.do(lambda t: t.drive.park())
    made.tick(10)
    told = made.since()
    assert told[:4] == [
        (Device.AXIS_RA, Opcode.TRACK_RATE, 0), (Device.AXIS_DEC, Opcode.TRACK_RATE, 0),
        (Device.AXIS_RA, Opcode.MOVE_TO, park[0], SpeedClass.SLEW),
        (Device.AXIS_DEC, Opcode.MOVE_TO, park[1], SpeedClass.SLEW),
    ]  # fmt: skip
    assert len(told) == 4 and job.running and made.telescope.snapshot.slewing
    made.steps[0] = park[0] + steps(31.0)
    made.tick(10)
    assert [each[3] for each in made.since()] == [SpeedClass.SET] * 2
    made.steps[0] = park[0] + steps(-7.9)
    made.tick(10)
    assert [each[3] for each in made.since()] == [SpeedClass.GUIDE] * 2
    made.steps[1] = park[1] + steps(7.9)
    made.ended(job)
    assert made.since() == [(axis, Opcode.POWER, 0) for axis in AXES]
    assert made.telescope.drive.parked and made.telescope.drive.activity is Activity.IDLE
    again = made.do(lambda t: t.drive.park())
    made.ended(again)
    assert made.since() == [], "it is parked already"


def test_a_park_position_is_where_the_telescope_points() -> None:
    made = awake()
    made.steps = [CENTRE + steps(7200.0), CENTRE - steps(3600.0)]
    made.tick()
    made.do(lambda t: t.drive.set_park())
    assert made.observatory.mount.park_hour_angle_rad == pytest.approx(7200 * ARCSEC, abs=1e-8)
    assert made.observatory.mount.park_declination_rad == pytest.approx(-3600 * ARCSEC, abs=1e-8)


def slewing(made: Wired) -> Job[None]:
    star = made.do(lambda t: t.drive.here())
    job: Job[None] = made.do(lambda t: t.drive.goto(star))
    return job


def test_a_slew_goes_by_four_classes_and_settles_for_a_second() -> None:
    made = awake()
    made.steps[0] += steps(1000.0)
    made.tick()
    star = made.do(lambda t: t.drive.here())
    made.steps[0] -= steps(1000.0)
    job = made.do(lambda t: t.drive.goto(star))
    track = SkyTrack(star, made.observatory.site, made.observatory.clock, made.observatory.mount)

    def away(arcsec: float) -> None:
        def follow() -> None:
            now = track.steps(made.client.now_s + 0.05)
            made.steps = [now[0] + steps(arcsec), now[1]]

        made.follows = follow

    away(-1000.0)
    classes = (SpeedClass.SLEW, SpeedClass.SET, SpeedClass.GUIDE, SpeedClass.FINE)
    for number, (arcsec, inside) in enumerate(((301.0, 299.0), (31.0, 29.0), (8.2, 7.8), (3.2, 2.8))):
        away(arcsec)
        made.tick(12)
        moves = [each for each in made.since() if each[1] == Opcode.MOVE_TO]
        assert [each[3] for each in moves] == [classes[number]] * 2
        assert [each[0] for each in moves] == [*AXES]
        assert moves[0][2] == pytest.approx(track.steps(made.client.now_s)[0], abs=steps(15.0))
        assert job.running and not made.telescope.drive.pointing.on_target
        away(-inside)
        made.tick()
    made.tick(15)
    assert job.running, "a second is not over"
    made.tick(10)
    assert not job.running and made.telescope.drive.pointing.on_target
    assert made.telescope.drive.activity is Activity.TRACKING and made.telescope.drive.tracking
    errors = made.telescope.snapshot.errors_arcsec
    assert errors is not None and errors == pytest.approx((2.8, 0.0), abs=0.1)


@pytest.mark.parametrize(("ha_h", "dec_deg", "reason", "words"), [
    (0.0, -58.0, Reason.BELOW_HORIZON, "below the horizon limit of 15°"),
    (5.5, 60.0, Reason.LIMIT, "beyond the soft limits -80.0°..80.0°"),
    (0.0, 89.0, Reason.LIMIT, "beyond the soft limits -45.0°..85.0°"),
])  # fmt: skip
def test_a_star_out_of_reach_is_refused(ha_h: float, dec_deg: float, reason: Reason, words: str) -> None:
    from host.sky.observed import Place

    made = awake()
    about, t_s = made.observatory, made.client.now_s
    ra = sidereal_time_rad(about.site, about.clock, t_s) - ha_h * math.pi / 12
    star = star_of_apparent(Place(ra % (2 * math.pi), math.radians(dec_deg)), about.clock, t_s, "far")
    found = refusal(made, lambda t: t.drive.goto(star))
    assert found.reason is reason and words in str(found) and not made.telescope.drive.tracking


@pytest.mark.parametrize(("azimuth_deg", "altitude_deg", "reason"), [
    (180.0, 14.9, Reason.BELOW_HORIZON), (0.0, 24.0, Reason.LIMIT), (90.0, 16.0, None), (180.0, 16.0, None),
    (0.0, 29.4, Reason.LIMIT),
])  # fmt: skip
def test_a_place_over_the_ground_is_gone_to_and_stood_at(
    azimuth_deg: float, altitude_deg: float, reason: Reason | None
) -> None:
    made = awake()

    def act(t: object) -> object:
        return made.telescope.drive.goto_altaz(math.radians(azimuth_deg), math.radians(altitude_deg))

    if reason is not None:
        assert refusal(made, act).reason is reason
        return
    made.telescope.drive.tracking = True
    made.do(act)
    made.tick(8)
    told = made.since()
    assert [each for each in told if each[1] == Opcode.TRACK_RATE] == [
        (axis, Opcode.TRACK_RATE, 0) for axis in AXES
    ]
    goal = [each[2] for each in told if each[1] == Opcode.MOVE_TO]
    place = made.observatory.observed(*goal)
    assert math.degrees(place.altitude_rad) == pytest.approx(altitude_deg, abs=1e-3)
    assert math.degrees(place.azimuth_rad) % 360 == pytest.approx(azimuth_deg, abs=1e-3)
    assert not made.telescope.drive.tracking


def test_nothing_sinks_below_the_horizon_limit() -> None:
    """Looked at once a second: at 14° and falling it stops, at 14° and rising it does not."""
    made = awake()
    low = made.observatory.mount.dec.steps(math.radians(14 - 90) + made.observatory.site.latitude_rad)
    made.steps = [CENTRE, low]
    made.do(lambda t: t.paddle.move("dec", 100.0))
    made.tick(3)
    assert made.telescope.snapshot.activity != "moved by hand", "whence it came is not known yet"
    made.tick(5)
    made.do(lambda t: t.paddle.move("dec", 100.0))
    made.journal.entries.clear()
    made.follows = lambda: made.steps.__setitem__(1, made.steps[1] + steps(5.0))
    made.tick(45)
    assert made.telescope.snapshot.activity == "moved by hand"
    assert "stopped at the horizon limit" not in " ".join(made.said("error"))
    made.follows = lambda: made.steps.__setitem__(1, made.steps[1] - steps(5.0))
    made.tick(45)
    assert made.telescope.drive.activity is Activity.IDLE
    assert [each[:31] for each in made.said("error")] == ["stopped at the horizon limit, +"]


def test_an_abort_ends_what_moves_and_nothing_else() -> None:
    made = awake()
    made.do(lambda t: t.drive.abort())
    made.tick(3)
    assert made.since() == []
    job = slewing(made)
    made.since()
    made.do(lambda t: t.drive.abort())
    made.tick(3)
    assert made.since()[:2] == STOPS and not job.running
    assert made.telescope.drive.tracking
    made.tick(40)
    assert made.telescope.drive.activity is Activity.TRACKING
    made.do(lambda t: t.drive.abort())
    assert made.telescope.drive.activity is Activity.TRACKING


def test_while_the_axes_move_what_would_disturb_is_refused() -> None:
    made = awake()
    slewing(made)
    made.steps[0] += steps(3600)
    made.tick()
    star = made.do(lambda t: t.drive.here())
    for act in (
        lambda t: t.drive.power_on(), lambda t: t.drive.sync(star), lambda t: t.drive.apply_model(None),
    ):  # fmt: skip
        found = refusal(made, act)
        assert found.reason is Reason.STATE and str(found) == "the axes are moving"


def test_a_star_that_is_pointed_at_aligns_the_encoders() -> None:
    made = awake()
    made.tick()
    star = made.do(lambda t: t.drive.here())
    made.steps = [made.steps[0] + steps(100.0), made.steps[1] - steps(50.0)]
    made.tick()
    zero = made.observatory.mount.ra.zero_steps
    found = made.do(lambda t: t.drive.sync(star))
    assert found == pytest.approx((100.0, -50.0), abs=2.0)
    assert (made.observatory.mount.ra.zero_steps - zero) * STEP_ARCSEC == pytest.approx(found[0], abs=0.01)
    kept = made.observatory.stars[0]
    seen = observe(star, made.observatory.site, made.observatory.clock, made.client.now_s)
    assert (kept.ra_steps, kept.dec_steps) == tuple(made.steps)
    assert kept.hour_angle_rad == pytest.approx(seen.hour_angle_rad, abs=1e-5)
    assert kept.declination_rad == pytest.approx(seen.declination_rad, abs=1e-6)
    assert made.said("status")[-1] == f"aligned: hour angle {found[0]:.1f}″, declination {found[1]:.1f}″"
    for axis in (0, 1):
        made.steps[axis] += steps(10.02 * 3600)
        made.tick()
        refused = refusal(made, lambda t: t.drive.sync(star))
        assert refused.reason is Reason.STATE and "not the same star, or the clock is wrong" in str(refused)
        made.steps[axis] -= steps(10.02 * 3600)
        made.tick()
    made.steps[1] += steps(9.98 * 3600)
    made.tick()
    assert made.do(lambda t: t.drive.sync(star))[1] == pytest.approx(9.98 * 3600, abs=30.0)


def test_models_need_stars_and_are_told() -> None:
    made = awake()
    found = refusal(made, lambda t: t.drive.fit_model())
    assert found.reason is Reason.STATE and "needs 6 stars, there are 0" in str(found)
    terms = (
        Term(name="IH", arcsec=12.34, within_arcsec=0.0),
        Term(name="TF", arcsec=-3.0, within_arcsec=0.0),
    )
    model = PointingModel(
        latitude_rad=0.5, terms=terms, stars=9, before_arcsec=1.0, after_arcsec=1.0, held_out_arcsec=1.0
    )
    made.do(lambda t: t.drive.apply_model(model))
    assert made.observatory.mount.model is model and made.telescope.drive.activity is Activity.IDLE
    assert made.said("status")[-1] == "pointing model: IH=12.3″ TF=-3.0″"
    made.do(lambda t: t.drive.apply_model(None))
    assert made.observatory.mount.model is None and made.said("status")[-1] == "pointing model: none"


def test_other_rates_and_drifts_are_the_skys_plus_their_difference() -> None:
    made = awake()
    made.do(lambda t: t.drive.track(True))
    made.tick(60)
    made.since()

    def sent() -> list[float]:
        made.tick(8)
        told = [each[2] for each in made.since() if each[1] == Opcode.TRACK_RATE]
        return [told[-2] / rate_q16(1.0), told[-1] / rate_q16(1.0)]

    made.tick(120)
    sidereal = sent()
    made.do(lambda t: t.drive.set_rates(DriveRate.LUNAR))
    made.tick(30)
    assert sent() == pytest.approx([sidereal[0] + 14.685 - 15.041067, sidereal[1]], abs=0.12)
    made.do(lambda t: t.drive.set_rates(drift_arcsec_s=(1.0, -2.0)))
    assert made.telescope.drive.drive_rate is DriveRate.LUNAR
    made.tick(30)
    assert sent() == pytest.approx([sidereal[0] + 0.644, sidereal[1] - 2.0], abs=0.12)
    made.do(lambda t: t.drive.set_rates(DriveRate.SIDEREAL))
    assert made.telescope.drive.drift_arcsec_s == (1.0, -2.0)


def test_what_fails_stops_the_axes_and_is_told() -> None:
    made = awake()
    made.telescope.drive.tracking = True
    job = slewing(made)
    made.silent = {Device.AXIS_RA}
    made.tick(40)
    assert not job.running and not made.telescope.drive.tracking
    assert any(each.startswith("slew to here: AXIS_RA") for each in made.said("error"))
    told = made.since()
    assert {*STOPS} <= {*told}, "an axis whose board answers stops, whatever the other does"
    assert any(each.startswith("stop: AXIS_RA: STOP") for each in made.said("error"))


def test_a_power_up_may_skip_the_check_and_sets_a_bias() -> None:
    made = Wired()
    made.telescope.drive.dec_bias_q8 = 700
    made.tick()
    made.ended(made.do(lambda t: t.drive.power_on(check=False)))
    assert [each[:2] for each in made.since()] == [
        (Device.AXIS_DEC, Opcode.SET_PARAMETER), *((axis, Opcode.POWER) for axis in AXES),
    ]  # fmt: skip
    assert made.telescope.drive.parked is False
    made.ended(made.do(lambda t: t.drive.power_on()))
    assert made.since() == [], "powered already"


def test_an_old_mount_is_not_kept() -> None:
    made = awake()
    made.observatory.mount = replace(made.observatory.mount, park_hour_angle_rad=0.1)
    made.do(lambda t: t.drive.park())
    made.tick(5)
    goal = next(each[2] for each in made.since() if each[1] == Opcode.MOVE_TO)
    assert goal == made.observatory.mount.ra.steps(0.1)
