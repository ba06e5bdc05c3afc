"""The telescope client against the emulated boards: every command does what it says, or says why not."""

import math
from pathlib import Path

import pytest

from bus.protocol import AxisMode, Device, FocusFlag, Health, SpeedClass
from bus.units import ARCSEC_PER_RAD
from host.telescope import DriveRate, Reason, Refused
from tests.host.inprocess import HostInProcess
from tests.host.sky.places import apparent_of_star
from tests.host.telescope.conftest import Rig

ARCSEC = 1 / ARCSEC_PER_RAD


def pointing(rig: Rig) -> tuple[float, float]:
    now = rig.telescope.snapshot
    assert now.ra.steps is not None and now.dec.steps is not None
    place = rig.pc.observatory.apparent(now.ra.steps, now.dec.steps, now.ra.latched_s)
    return place.right_ascension_rad, place.declination_rad


def true_hour_angle_rad(rig: Rig) -> float:
    """From the plant, not from the encoder."""
    return float(rig.network.plant.ra.truth(rig.network.queue.now_ns)[0])


@pytest.mark.slow
def test_H2_power_up_slew_track_park(rig: Rig) -> None:
    assert rig.telescope.snapshot.parked and not rig.telescope.snapshot.powered
    with pytest.raises(Refused) as refused:
        rig.do(lambda t: t.drive.goto(rig.up()))
    assert refused.value.reason is Reason.PARKED

    rig.run(lambda t: t.drive.power_on())
    assert rig.telescope.snapshot.powered and not rig.telescope.snapshot.parked
    star = rig.up("target", hour_angle_h=-0.2, dec_deg=25.0)
    job = rig.do(lambda t: t.drive.goto(star))
    assert rig.telescope.snapshot.slewing and job.running
    rig.run(lambda t: job)
    assert not rig.telescope.snapshot.slewing and rig.telescope.snapshot.tracking

    rig.advance(30.0)
    wanted = apparent_of_star(star, rig.scenario.clock, rig.telescope.snapshot.t_s)
    found = pointing(rig)
    assert abs(found[0] - wanted[0]) * math.cos(wanted[1]) < 3 * ARCSEC
    assert abs(found[1] - wanted[1]) < 3 * ARCSEC

    rig.run(lambda t: t.drive.park())
    assert rig.telescope.snapshot.parked and not rig.telescope.snapshot.powered


def test_refusals_leave_the_telescope_where_it_is(rig: Rig) -> None:
    rig.run(lambda t: t.drive.power_on())
    before = pointing(rig)[1]
    for hour_angle_h, dec_deg, reason in ((5.8, -10.0, Reason.BELOW_HORIZON), (-7.5, 75.0, Reason.LIMIT)):
        with pytest.raises(Refused) as refused:
            rig.do(lambda t, h=hour_angle_h, d=dec_deg: t.drive.goto(rig.up(hour_angle_h=h, dec_deg=d)))
        assert refused.value.reason is reason
    with pytest.raises(Refused):
        rig.do(lambda t: t.drive.goto_altaz(0.0, math.radians(5.0)))
    assert pointing(rig)[1] == pytest.approx(before, abs=5 * ARCSEC)


def test_altitude_and_azimuth_are_reached_and_held(rig: Rig) -> None:
    azimuth, altitude = math.radians(185.0), math.radians(65.0)
    rig.run(lambda t: t.drive.goto_altaz(azimuth, altitude, wake=True))
    rig.advance(20.0)
    now = rig.telescope.snapshot
    assert now.ra.steps and now.dec.steps and not now.tracking
    place = rig.pc.observatory.observed(now.ra.steps, now.dec.steps)
    assert abs(place.altitude_rad - altitude) < 10 * ARCSEC
    assert abs(place.azimuth_rad - azimuth) * math.cos(altitude) < 10 * ARCSEC


@pytest.mark.slow
def test_abort_goes_on_tracking_and_the_stop_does_not(rig: Rig) -> None:
    rig.do(lambda t: t.drive.goto(rig.up(dec_deg=10.0), wake=True))
    rig.advance(4.0)
    assert abs(rig.telescope.snapshot.dec.rate_arcsec_s) > 600
    rig.do(lambda t: t.drive.abort())
    rig.advance(10.0)
    start = pointing(rig)
    rig.advance(20.0)
    assert rig.telescope.snapshot.activity == "tracking"
    assert pointing(rig)[0] == pytest.approx(start[0], abs=5 * ARCSEC)

    rig.do(lambda t: t.drive.goto(rig.up(dec_deg=40.0)))
    rig.advance(3.0)
    rig.do(lambda t: t.emergency_stop())  # 0.1 s later it is in force
    assert rig.telescope.snapshot.ra.mode is AxisMode.STOP
    assert rig.telescope.snapshot.dec.mode is AxisMode.STOP
    rig.advance(5.0)
    rest = true_hour_angle_rad(rig)
    rig.advance(5.0)
    assert true_hour_angle_rad(rig) == pytest.approx(rest, abs=1 * ARCSEC)
    assert not rig.telescope.snapshot.tracking


@pytest.mark.parametrize(
    ("direction", "axis", "sign"), [("n", 1, 1), ("s", 1, -1), ("e", 0, 1), ("w", 0, -1)]
)
def test_keys_move_over_the_sky_while_tracking(rig: Rig, direction: str, axis: int, sign: int) -> None:
    rig.run(lambda t: t.drive.goto(rig.up(hour_angle_h=0.0, dec_deg=29.0), wake=True))
    start = pointing(rig)
    rig.do(lambda t: t.paddle.press(direction, SpeedClass.GUIDE))
    rig.advance(10.0)
    assert rig.telescope.snapshot.activity == "moved by hand"
    rig.do(lambda t: t.paddle.release())
    rig.advance(10.0)
    moved = [(now - then) / ARCSEC for now, then in zip(pointing(rig), start, strict=True)]
    assert sign * moved[axis] == pytest.approx(1000, rel=0.1)
    assert abs(moved[1 - axis]) < 20
    assert rig.telescope.snapshot.activity == "tracking"


@pytest.mark.slow
def test_pulses_shift_the_target_by_rate_and_time(rig: Rig) -> None:
    rig.run(lambda t: t.drive.goto(rig.up(hour_angle_h=0.0, dec_deg=29.0), wake=True))
    rig.advance(20.0)
    start = pointing(rig)
    rig.do(lambda t: t.paddle.set_guide_rates(7.0, 5.0))
    rig.do(lambda t: t.paddle.pulse("n", 2.0))
    assert rig.telescope.snapshot.pulse_guiding
    rig.do(lambda t: t.paddle.pulse("e", 3.0))
    rig.advance(20.0)
    assert not rig.telescope.snapshot.pulse_guiding
    end = pointing(rig)
    assert (end[1] - start[1]) / ARCSEC == pytest.approx(10.0, abs=1.0)
    assert (end[0] - start[0]) / ARCSEC == pytest.approx(21.0, abs=1.0)
    rig.do(lambda t: t.drive.track(False))
    with pytest.raises(Refused) as refused:
        rig.do(lambda t: t.paddle.pulse("n", 1.0))
    assert refused.value.reason is Reason.STATE


def test_sync_aligns_and_refuses_another_part_of_the_sky(rig: Rig) -> None:
    star = rig.up("reference", hour_angle_h=0.0, dec_deg=29.0)
    rig.run(lambda t: t.drive.goto(star, wake=True))
    place = apparent_of_star(star, rig.scenario.clock, rig.telescope.snapshot.t_s)
    moved = rig.up("real place", hour_angle_h=0.02, dec_deg=29.1)
    offsets = rig.do(lambda t: t.drive.sync(moved))
    assert offsets[1] == pytest.approx(-(math.radians(29.1) - place[1]) / ARCSEC, abs=30)
    assert pointing(rig)[1] == pytest.approx(math.radians(29.1), abs=3 * ARCSEC)
    with pytest.raises(Refused):
        rig.do(lambda t: t.drive.sync(rig.up(hour_angle_h=1.0, dec_deg=29.0)))


@pytest.mark.slow
def test_the_moon_is_slower_than_the_stars(rig: Rig) -> None:
    rig.run(lambda t: t.drive.goto(rig.up(hour_angle_h=0.0, dec_deg=10.0), wake=True))
    rig.do(lambda t: t.drive.set_rates(DriveRate.LUNAR))
    rig.advance(20.0)
    start, start_s = pointing(rig), rig.telescope.snapshot.ra.latched_s
    rig.advance(100.0)
    elapsed = rig.telescope.snapshot.ra.latched_s - start_s
    assert (pointing(rig)[0] - start[0]) / ARCSEC == pytest.approx((15.041 - 14.685) * elapsed, abs=3.0)


@pytest.mark.slow
def test_tracking_ends_at_the_horizon_limit(rig: Rig) -> None:
    rig.run(lambda t: t.drive.goto(rig.up(hour_angle_h=3.0, dec_deg=10.0), wake=True))
    place = rig.pc.observatory.observed(
        rig.telescope.snapshot.ra.steps or 0, rig.telescope.snapshot.dec.steps or 0
    )
    rig.telescope.observatory.horizon_rad = place.altitude_rad - 60 * ARCSEC
    rig.advance(20.0)
    assert not rig.telescope.snapshot.tracking
    assert any("horizon" in entry.text for entry in rig.pc.journal.entries if entry.kind == "error")


def test_what_rises_below_the_horizon_limit_goes_on(rig: Rig) -> None:
    rig.run(lambda t: t.drive.goto(rig.up(hour_angle_h=-3.0), wake=True))
    rig.advance(2.0)
    rig.telescope.observatory.horizon_rad = math.radians(85.0)
    rig.advance(4.0)
    assert rig.telescope.snapshot.tracking and rig.telescope.snapshot.activity == "tracking"


def test_health_names_every_board_and_a_dead_one(rig: Rig) -> None:
    health = rig.run(lambda t: t.boards.check())
    assert len(health) == 11 and set(health.values()) == {Health(0)}
    rig.network.boards["DISPLAY"].power_off(rig.network.queue.now_ns)
    health = rig.run(lambda t: t.boards.check())
    assert health[Device.DISPLAY] is None
    rig.advance(5.0)
    states = {board.device: board for board in rig.telescope.snapshot.boards}
    assert not states[Device.DISPLAY].alive and states[Device.FOCUS].alive


@pytest.mark.slow
def test_a_dead_encoder_board_ends_tracking_and_says_so(rig: Rig) -> None:
    rig.run(lambda t: t.drive.goto(rig.up(), wake=True))
    rig.network.boards["AXIS_DEC"].power_off(rig.network.queue.now_ns)
    rig.advance(30.0)
    assert not rig.telescope.snapshot.tracking
    assert "AXIS_DEC" in " ".join(entry.text for entry in rig.pc.journal.entries if entry.kind == "error")


def _moving(rig: Rig) -> bool:
    focus = rig.telescope.snapshot.focus
    return focus is not None and bool(focus.flags & FocusFlag.MOVING)


def test_H3_focus_moves_steps_holds_and_frees(rig: Rig) -> None:
    rig.run(lambda t: t.focuser.reference())
    rig.run(lambda t: t.focuser.move_to(100))
    rig.run(lambda t: t.focuser.step(-3))
    focus = rig.telescope.snapshot.focus
    assert focus and focus.position == 97 and focus.flags & FocusFlag.REFERENCED and not _moving(rig)
    rig.do(lambda t: t.focuser.move_to(-700))
    rig.advance(0.5)
    assert _moving(rig)
    rig.run(lambda t: t.focuser.hold())
    rig.advance(1.0)
    focus = rig.telescope.snapshot.focus
    assert focus and not _moving(rig) and -700 < focus.position < 97
    with pytest.raises(Refused):
        rig.do(lambda t: t.focuser.move_to(900))
    rig.run(lambda t: t.focuser.free())
    rig.advance(0.2)
    with pytest.raises(Refused, match="free"):
        rig.do(lambda t: t.focuser.move_to(0))


def test_logs_and_journal_say_the_same(rig: Rig, tmp_path: Path) -> None:
    rig.run(lambda t: t.drive.power_on())
    rig.host.close()
    lines = (tmp_path / "commands.log").read_text().splitlines()
    kept = [entry for entry in rig.pc.journal.since(0) if entry.kind == "command"]
    assert len(lines) - 1 == len(kept) and any("POWER 1" in line for line in lines)
    with pytest.raises(Refused, match="shut down"):
        rig.telescope.call(lambda t: None).result(0)


def test_H6_a_log_can_be_followed_while_it_grows(rig: Rig, tmp_path: Path) -> None:
    """A host that is killed has left what it wrote, and `tail -f` shows what has just been done."""
    rig.run(lambda t: t.drive.power_on())
    rig.advance(0.3)  # the next sensor line brings all four to the disk
    assert "POWER 1  ok" in (tmp_path / "commands.log").read_text()


def test_H2_the_check_at_power_up_is_seen_on_every_boards_line_until_it_falls_silent(rig: Rig) -> None:
    assert all(board.health is None for board in rig.telescope.snapshot.boards)
    rig.run(lambda t: t.drive.power_on())
    assert all(board.health == Health(0) for board in rig.telescope.snapshot.boards)
    rig.network.boards["FOCUS"].power_off(rig.served.now_ns)
    rig.advance(5.0)
    health = {board.device: board.health for board in rig.telescope.snapshot.boards}
    assert health.pop(Device.FOCUS) is None and all(each == Health(0) for each in health.values())


def test_a_host_that_starts_again_goes_on_with_tracking(rig: Rig) -> None:
    """The axes follow the sky whoever commands them."""
    rig.run(lambda t: t.drive.goto(rig.up(hour_angle_h=0.0, dec_deg=29.0), wake=True))
    rig.advance(5.0)
    rig.host.close()
    rig.host = HostInProcess(rig.served)
    rig.pc, rig.telescope = rig.host.pc, rig.host.pc.telescope
    rig.advance(15.0)
    now = rig.telescope.snapshot
    assert now.tracking and now.activity == "tracking" and not now.parked
    assert now.errors_arcsec is not None and max(map(abs, now.errors_arcsec)) < 1.0
