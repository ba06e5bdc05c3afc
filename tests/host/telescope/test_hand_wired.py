"""Paddle, guider and focus on wired boards: which commands, and what is refused."""

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import pytest

from bus.protocol import Device, FocusFlag, Opcode, SpeedClass
from bus.protocol.scales import rate_q16
from host.sky.tracks import GUIDE_ARCSEC_S, Pulse
from host.telescope import Reason, Refused, Telescope
from host.telescope.jobs import Activity
from tests.host.telescope.wired import AXES, Wired, awake

RA, DEC = AXES
SIDEREAL = 15.041067


def refusal(made: Wired, act: Callable[[Telescope], Any]) -> Refused:
    with pytest.raises(Refused) as found:
        made.do(act)
    return found.value


def move(rate: float, telescope: Telescope) -> None:
    telescope.paddle.move("ra", rate)


def pulsed(way: str, seconds: float, telescope: Telescope) -> None:
    telescope.paddle.pulse(way, seconds)


def run(outward: bool, slow: bool, telescope: Telescope) -> Any:
    return telescope.focuser.run(outward, slow)


@pytest.mark.parametrize(("way", "speed", "axis", "rate"), [
    ("n", SpeedClass.SLEW, DEC, 7200.0), ("s", SpeedClass.SET, DEC, -600.0),
    ("e", SpeedClass.GUIDE, RA, -100.0), ("w", SpeedClass.FINE, RA, 15.0),
])  # fmt: skip
def test_a_key_is_a_rate_of_its_axis(way: str, speed: SpeedClass, axis: Device, rate: float) -> None:
    """Beyond 1000″/s by the velocity loop, below it by the position loop."""
    made = awake()
    made.do(lambda t: t.paddle.press(way, speed))
    made.tick(6)
    opcode = Opcode.SET_RATE if abs(rate) > 1000 else Opcode.TRACK_RATE
    other = DEC if axis == RA else RA
    assert {*made.since()} == {(axis, opcode, rate_q16(rate)), (other, Opcode.TRACK_RATE, 0)}
    assert made.telescope.paddle.held == {"dec" if axis == DEC else "ra"}


def test_keys_are_over_the_sky_while_it_tracks_and_others_are_not() -> None:
    made = awake()
    made.telescope.drive.tracking = True
    made.do(lambda t: t.paddle.press("w", SpeedClass.GUIDE))
    made.tick(6)
    assert (RA, Opcode.TRACK_RATE, rate_q16(100 + SIDEREAL)) in made.since()
    made.do(lambda t: t.paddle.move("ra", 100.0))
    made.tick(6)
    assert (RA, Opcode.TRACK_RATE, rate_q16(100.0)) in made.since()
    made.do(lambda t: t.paddle.release())
    made.tick(8)
    made.since()
    made.do(lambda t: t.paddle.move("dec", 1000.0))
    made.tick(6)
    assert {*made.since()} >= {
        (RA, Opcode.TRACK_RATE, rate_q16(SIDEREAL)), (DEC, Opcode.TRACK_RATE, rate_q16(1000.0)),
    }  # fmt: skip
    made.do(lambda t: t.paddle.move("dec", 1000.1))
    made.tick(6)
    assert (DEC, Opcode.SET_RATE, rate_q16(1000.1)) in made.since()


def test_two_keys_are_held_and_let_go_one_by_one() -> None:
    made = awake()
    made.do(lambda t: t.paddle.release())
    made.do(lambda t: t.paddle.press("n", SpeedClass.GUIDE))
    made.do(lambda t: t.paddle.press("w", SpeedClass.GUIDE))
    made.tick(6)
    assert made.telescope.paddle.held == {"ra", "dec"}
    made.since()
    made.do(lambda t: t.paddle.release("dec"))
    made.tick(6)
    assert {*made.since()} == {(RA, Opcode.TRACK_RATE, rate_q16(100.0)), (DEC, Opcode.TRACK_RATE, 0)}
    assert made.telescope.paddle.held == {"ra"}
    made.do(lambda t: t.paddle.release("dec"))
    made.tick(3)
    assert made.telescope.snapshot.activity == "moved by hand" and made.since() == []
    made.do(lambda t: t.paddle.release("ra"))
    made.tick(6)
    assert {*made.since()} == {(axis, Opcode.STOP) for axis in AXES}
    assert made.telescope.paddle.held == frozenset() and made.telescope.snapshot.activity == "idle"
    made.do(lambda t: t.paddle.press("s", SpeedClass.GUIDE))
    made.tick(6)
    assert made.telescope.paddle.held == {"dec"}, "what was let go is forgotten"
    made.do(lambda t: t.paddle.release())
    assert made.telescope.drive.activity is Activity.STOPPING


def test_what_is_no_key_or_too_quick_is_refused() -> None:
    made = awake()
    found = refusal(made, lambda t: t.paddle.press("x", SpeedClass.GUIDE))
    assert found.reason is Reason.VALUE and str(found) == "direction 'x'; there are n, s, e and w"
    found = refusal(made, lambda t: t.paddle.press("n", SpeedClass.TRACK))
    assert found.reason is Reason.VALUE and "there are slew, set, guide and fine" in str(found)
    for rate in (7200.1, -7200.1, math.nan):
        assert refusal(made, partial(move, rate)).reason is Reason.VALUE
    made.do(lambda t: t.paddle.move("ra", -7200.0))
    parked = Wired()
    parked.tick()
    assert refusal(parked, lambda t: t.paddle.move("ra", 10.0)).reason is Reason.PARKED
    assert refusal(parked, lambda t: t.paddle.press("n", SpeedClass.GUIDE)).reason is Reason.PARKED
    parked.do(lambda t: t.paddle.press("n", SpeedClass.GUIDE, wake=True))
    parked.tick(20)
    assert parked.telescope.drive.parked is False


@pytest.mark.parametrize(("rates", "taken"), [
    ((GUIDE_ARCSEC_S, 1.0), True), ((1.0, GUIDE_ARCSEC_S * 1.00005), True), ((0.0, 1.0), False),
    ((1.0, 0.0), False), ((GUIDE_ARCSEC_S * 1.0002, 1.0), False),
    ((math.nan, 1.0), False), ((-1.0, 1.0), False),
])  # fmt: skip
def test_guide_rates_are_above_nought_and_half_the_skys_at_most(
    rates: tuple[float, float], taken: bool
) -> None:
    made = awake()
    if taken:
        made.do(lambda t: t.paddle.set_guide_rates(*rates))
        assert made.telescope.paddle.guide_arcsec_s == rates
        return
    found = refusal(made, lambda t: t.paddle.set_guide_rates(*rates))
    assert found.reason is Reason.VALUE and "is outside 0 to 7.521" in str(found)
    assert made.telescope.paddle.guide_arcsec_s == (GUIDE_ARCSEC_S, GUIDE_ARCSEC_S)


def tracking() -> Wired:
    made = awake()
    made.do(lambda t: t.drive.track(True))
    made.tick(60)
    assert made.telescope.drive.activity is Activity.TRACKING
    track = made.telescope.drive.pointing.track
    assert track is not None

    def follow() -> None:
        made.steps = list(track.steps(made.client.now_s + 0.05))

    made.follows = follow
    made.since()
    return made


def test_a_pulse_needs_tracking_and_its_bounds() -> None:
    made = awake()
    found = refusal(made, lambda t: t.paddle.pulse("n", 1.0))
    assert found.reason is Reason.STATE and "guiding needs a telescope that tracks" in str(found)
    for way, seconds in (("x", 1.0), ("n", -0.001), ("n", 60.001), ("n", math.nan)):
        found = refusal(made, partial(pulsed, way, seconds))
        assert found.reason is Reason.VALUE and "lasts 0 to 60 s" in str(found)


@pytest.mark.parametrize(("way", "axis", "sign"), [("n", 1, 1), ("s", 1, -1), ("w", 0, 1), ("e", 0, -1)])
def test_a_pulse_shifts_the_target_and_the_rates_add_up_to_it(way: str, axis: int, sign: int) -> None:
    made = tracking()
    made.telescope.paddle.set_guide_rates(5.0, 3.0)
    told: list[Pulse] = []
    made.telescope.paddle.guider.told = told.append
    base = made.telescope.drive.pointing.track
    assert base is not None
    plain = base.rates(made.client.now_s)[axis]
    made.do(lambda t: t.paddle.pulse(way, 2.0))
    rate = sign * (5.0, 3.0)[axis]
    assert [each._replace(begin_s=0.0) for each in told] == [Pulse(axis, rate, 0.0, 2.0)]
    assert told[0].begin_s == pytest.approx(made.client.now_s, abs=1e-6)
    assert made.telescope.paddle.guider.pulsing and made.telescope.snapshot.pulse_guiding
    begin, last, gone = made.client.now_s, 0.0, 0.0
    for _ in range(60):
        sent = [each[2] for each in made.since() if each[:2] == (AXES[axis], Opcode.TRACK_RATE)]
        last = sent[-1] / rate_q16(1.0) - plain if sent else last
        made.tick()
        gone += last * 0.05
        age = made.client.now_s - begin
        assert made.telescope.paddle.guider.pulsing == (age < 2.3 - 1e-6), age
    assert gone == pytest.approx(2.0 * rate, abs=0.4)
    assert abs(last) < 0.02 and made.telescope.drive.pointing.guided == 0


def test_pulses_of_an_axis_wait_for_each_other_a_minute_at_most() -> None:
    made = tracking()
    told: list[Pulse] = []
    made.telescope.paddle.guider.told = told.append
    begin = made.client.now_s
    made.do(lambda t: t.paddle.pulse("n", 30.0))
    made.do(lambda t: t.paddle.pulse("w", 1.0))
    made.do(lambda t: t.paddle.pulse("n", 29.0))
    made.do(lambda t: t.paddle.pulse("n", 60.0))
    found = refusal(made, lambda t: t.paddle.pulse("n", 1.0))
    assert found.reason is Reason.STATE and "pulses of this axis for 60 s wait already" in str(found)
    track: Any = made.telescope.drive.pointing.track
    begins = [each.begin_s - begin for each in track._pulses if each.axis == 1]
    assert begins == pytest.approx([30.35, 59.65], abs=0.06)
    assert [each.begin_s for each in told] == sorted(each.begin_s for each in told)
    assert told[-1].begin_s - begin < 1.0
    made.do(lambda t: t.paddle.pulse("e", 1.0))
    assert track._pulses[-1].axis == 0


def test_a_guider_stops_with_tracking() -> None:
    made = tracking()
    made.do(lambda t: t.paddle.pulse("n", 10.0))
    made.tick(5)
    assert made.telescope.drive.pointing.guided == 1
    made.do(lambda t: t.drive.stop())
    made.tick(5)
    assert made.telescope.drive.pointing.guided == 0 and not made.telescope.paddle.guider.pulsing


@pytest.mark.parametrize(("half_steps", "taken"), [(800, True), (-800, True), (801, False), (-801, False)])
def test_a_focus_goes_within_its_travel(half_steps: int, taken: bool) -> None:
    made = awake()
    made.focus(0, int(FocusFlag.REFERENCED | FocusFlag.HOLD))
    if not taken:
        found = refusal(made, lambda t: t.focuser.move_to(half_steps))
        assert found.reason is Reason.VALUE and str(found) == f"{half_steps} half steps is outside ±800"
        return
    job = made.do(lambda t: t.focuser.move_to(half_steps))
    made.tick(3)
    assert [each[:3] for each in made.since()] == [(Device.FOCUS, Opcode.FOCUS_MOVE_TO, half_steps)]
    assert made.telescope.focuser.moving and job.name == f"focus to {half_steps}"
    made.focus(half_steps, int(FocusFlag.REFERENCED | FocusFlag.HOLD))
    made.ended(job)
    assert not made.telescope.focuser.moving


def test_a_slow_key_creeps_ten_half_steps_a_second_and_a_quick_one_goes_to_the_end() -> None:
    made = awake()
    made.focus(0, int(FocusFlag.REFERENCED | FocusFlag.HOLD))
    for outward, sign, name in ((True, 1, "focus out"), (False, -1, "focus in")):
        job = made.do(partial(run, outward, False))
        made.tick(3)
        assert made.since() == [(Device.FOCUS, Opcode.FOCUS_MOVE_TO, 800 * sign)] and job.name == name
        made.do(partial(run, outward, True))
        made.tick(40)
        steps = made.since()
        assert {*steps} == {(Device.FOCUS, Opcode.FOCUS_STEP, sign)} and len(steps) in range(10, 21)
        assert not job.running
        made.do(lambda t: t.focuser.hold())
        made.tick(3)
        made.since()


def test_a_free_focus_is_held_first() -> None:
    made = awake()
    made.focus(0, int(FocusFlag.FREE))
    for act in (
        lambda t: t.focuser.move_to(1), lambda t: t.focuser.step(1), lambda t: t.focuser.run(True),
        lambda t: t.focuser.reference(),
    ):  # fmt: skip
        found = refusal(made, act)
        assert found.reason is Reason.STATE and "hold it first" in str(found)
    made.do(lambda t: t.focuser.free())
    made.focus(0, int(FocusFlag.MOVING))
    assert made.telescope.focuser.moving


def test_a_focus_that_does_not_answer_is_an_error() -> None:
    made = awake()
    made.focus(0, int(FocusFlag.REFERENCED))
    made.silent = {Device.FOCUS}
    job = made.do(lambda t: t.focuser.step(3))
    made.tick(30)
    assert not job.running
    errors = [each for each in made.said("error") if each.startswith("focus by +3")]
    assert errors == ["focus by +3: FOCUS: FOCUS_STEP 1: no answer after 3 tries"]
