"""Every accumulator of the axis board at the extremes of what it accepts: nothing needs more than 64 bits."""

from math import isqrt

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from boards.axis.commands import RATE_LIMIT
from boards.axis.compensator import Compensator
from boards.axis.hold import LOCK_LIMIT_Q16, Blend, RateLock
from boards.axis.limits import SoftLimits
from boards.axis.motion import Motion
from boards.axis.pi import GAIN_SHIFT, CounterTorque, IncrementalPi
from boards.axis.profile import UNIT_SHIFT, UNITS_PER_STEP, Profile
from boards.axis.tachometer import RemoteTachometer
from boards.axis.watch import EncoderWatch
from bus.protocol import HARMONICS, AxisMode, AxisParameter, PositionFlag
from bus.protocol.motion import pack_tach
from bus.protocol.position import pack_position
from bus.protocol.scales import COUNTS_PER_TURN, STEPS_PER_TURN, rate_q16
from bus.units import ARCSEC_PER_TURN
from tests.boards.checked import Checked, checked
from tests.boards.lab import Lab, axis_config

INT16 = (-(1 << 15), (1 << 15) - 1)
ACCELERATION = (1, rate_q16(7200.0) // 20)
GAIN = 1 << 20
INT32 = (1 << 31) - 1


def extremes(low: int, high: int) -> st.SearchStrategy[int]:
    """Mostly the ends of a range, and what lies between."""
    return st.one_of(st.sampled_from((low, low + 1, high - 1, high)), st.integers(low, high))


positions = extremes(0, STEPS_PER_TURN - 1)
rates = extremes(-RATE_LIMIT, RATE_LIMIT)
velocities = extremes(*INT16)
accelerations = extremes(*ACCELERATION)
ages = st.one_of(st.integers(0, 1 << 26), st.just(1 << 62))  # ns since the last position, also "never again"


@given(
    extremes(0, GAIN),
    extremes(0, GAIN),
    st.integers(2, 65536),
    st.lists(st.tuples(rates, velocities), max_size=6),
)
@example(GAIN, GAIN, 65536, [(RATE_LIMIT, INT16[0]), (-RATE_LIMIT, INT16[1])])
def test_B1_pi_products_and_effort(kp: int, ki: int, steps: int, ticks: list[tuple[int, int]]) -> None:
    pi = IncrementalPi(kp, ki, steps)
    checked(pi, "kp_q12", "ki_q12", "effort_q16", "_error", "_limit")
    for setpoint, velocity in ticks:
        effort = pi.step(Checked(setpoint), Checked(velocity))
        assert abs(effort) <= steps
        assert abs(pi._error) <= INT32
        assert abs(pi.effort_q16) <= INT32
    pi.start(Checked(steps), Checked(RATE_LIMIT), Checked(INT16[0]))
    assert abs(pi._error) <= INT32
    assert abs(pi.effort_q16) <= INT32


def test_B1_a_difference_of_errors_wider_than_32_bits_saturates() -> None:
    """From the largest error to the smallest in one tick, Kp = 1 step per count: 32 bits of it take the
    effort from its upper end to zero, 33 would take it to the lower end."""
    pi = IncrementalPi(1 << GAIN_SHIFT, 0, 65536)
    pi.start(65536, RATE_LIMIT, INT16[0])
    assert (pi.effort_q16, pi._error) == (INT32, INT32)
    pi.step(-RATE_LIMIT, INT16[1])
    assert (pi.effort_q16, pi._error) == (0, -INT32)


def make(acceleration: int, top: int) -> Profile:
    profile = Profile(Checked(acceleration << 2))
    checked(profile, "target", "rate", "remaining", "speed")
    profile.top = Checked(top << 2)
    return profile


@settings(deadline=None)
@given(positions, positions, rates, rates, accelerations, extremes(0, RATE_LIMIT))
@example(0, STEPS_PER_TURN - 1, 0, 0, ACCELERATION[1], RATE_LIMIT)
@example(0, STEPS_PER_TURN - 1, RATE_LIMIT, -RATE_LIMIT, 1, RATE_LIMIT)
@example(
    0, STEPS_PER_TURN // 4, 0, 0, rate_q16(36.0), rate_q16(7200.0)
)  # 90 degrees at the default acceleration
def test_B1_a_profile_over_any_distance_at_any_acceleration(
    start: int, goal: int, velocity: int, rate: int, acceleration: int, top: int
) -> None:
    profile = make(acceleration, top)
    profile.rate = Checked(rate << 2)
    profile.take_over(Checked(start * UNITS_PER_STEP), Checked(velocity << 2))
    profile.aim(Checked(goal * UNITS_PER_STEP))
    for _ in range(50):
        profile.step()
    # and nearer to the target, where the square root is taken
    profile.remaining, profile.speed = Checked(profile.remaining % (1 << 34)), Checked(min(top, 1 << 28))
    for _ in range(50):
        profile.step()


@given(st.integers(0, 1 << 45), accelerations, extremes(0, RATE_LIMIT))
def test_B1_the_speed_is_that_of_the_braking_law_in_unbounded_integers(gap: int, a: int, top: int) -> None:
    """v (v + a) <= 2 a d: the same figure as where nothing overflows (integers without a bound)."""
    profile = make(a, top)
    profile.remaining = Checked(gap)
    profile.speed = Checked(min(top << 2, gap))
    a, top = a << 2, top << 2
    wanted = min(isqrt(a * a // 4 + 2 * a * gap) - a // 2, top, gap)
    speed = int(profile.speed)
    profile.step()
    assert profile.speed == min(max(wanted, speed - a), speed + a)


@given(velocities, rates, accelerations)
@example(INT16[0], RATE_LIMIT, 1)
def test_B1_taking_over_from_anything_the_encoder_can_say(
    velocity: int, rate: int, acceleration: int
) -> None:
    """In open loop the set point follows the counts, 16 bits of them."""
    profile = make(acceleration, RATE_LIMIT)
    profile.rate = Checked(rate << 2)
    profile.take_over(Checked((STEPS_PER_TURN - 1) * UNITS_PER_STEP), Checked(velocity << 18))


def motion(position: int) -> Motion:
    made = Motion(axis_config(), IncrementalPi(GAIN, GAIN, 3000))
    made.position = Checked(position)
    made.latch_ns = Checked(0)
    return made


@given(positions, velocities, ages)
def test_B1_a_position_is_carried_on_over_any_age(position: int, velocity: int, age: int) -> None:
    found = motion(position).measured(Checked(age), Checked(velocity))
    # a tenth of a second, 20 ticks, at the 16 bits that one tick can count
    assert abs(found - position * UNITS_PER_STEP) <= (20 * (1 << 15) << 18) * (1 + 1e-5)


@given(positions, positions, velocities, rates, st.integers(0, 60_000_000))
def test_B1_the_position_loop(position: int, target: int, velocity: int, rate: int, age: int) -> None:
    axis = motion(position)
    axis.move(Checked(age), Checked(velocity), Checked(target), RATE_LIMIT)
    axis.track(Checked(age), Checked(velocity), Checked(rate))
    checked(axis.profile, "target", "remaining", "speed", "top", "rate", "acceleration")
    for _ in range(5):
        setpoint = axis.setpoint(Checked(age), Checked(velocity))
        assert abs(setpoint) <= INT32
    axis.nudge(Checked(INT32))
    axis.nudge(Checked(-INT32))


@given(velocities, positions, accelerations, positions, positions)
@example(INT16[0], 0, 1, 0, STEPS_PER_TURN - 1)
def test_B3_braking_distances_of_the_soft_limits(
    velocity: int, position: int, acceleration: int, low: int, high: int
) -> None:
    axis = motion(position)
    axis.mode = AxisMode.RATE
    axis.set_acceleration(Checked(acceleration))
    axis.low, axis.high = Checked(low), Checked(high)
    axis.classes[0] = Checked(RATE_LIMIT)
    guard = SoftLimits(axis)
    guard.hit(Checked(velocity))


@given(st.lists(velocities, min_size=50, max_size=50), positions, positions)
def test_B2_the_encoder_watch_counts_in_32_bits(counts: list[int], before: int, after: int) -> None:
    watch = EncoderWatch()
    watch.disagree(Checked(before * UNITS_PER_STEP))
    for count in counts:
        watch.counts = Checked(watch.counts + count)
    assert abs(watch.counts) <= INT32
    watch.disagree(Checked(after * UNITS_PER_STEP))
    assert watch.counts == 0


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("arcsec", "parted"), [(39.5, False), (40.5, True)])
def test_B2_encoders_have_parted_beyond_40_arcsec(arcsec: float, parted: bool, sign: int) -> None:
    counts = round(arcsec / ARCSEC_PER_TURN * COUNTS_PER_TURN) * sign
    watch = EncoderWatch()
    assert watch.counts == 0 and not watch.disagree(0)  # there is no look before
    assert watch.disagree(counts << UNIT_SHIFT) is parted
    watch.counts = 1000 + counts
    assert watch.disagree((counts + 1000) << UNIT_SHIFT) is parted
    watch.forget()
    assert watch.counts == 0 and not watch.disagree(1 << 40)
    assert not watch.disagree((1 << 40) + sign * (3484 << UNIT_SHIFT))  # just 40 arcsec
    assert watch.disagree(1 << 40) is False


@pytest.mark.parametrize("flag", [PositionFlag.ALARM, PositionFlag.CRC_ERROR])
def test_B2_a_worthless_position_is_not_taken(flag: PositionFlag) -> None:
    axis = motion(1000)
    good_ns = axis.good_ns
    axis.take_position(good_ns + 10_000_000, pack_position(0x21, flag, 5000, 0, 7))
    assert (axis.position, axis.good_ns) == (1000, good_ns)
    axis.take_position(good_ns + 20_000_000, pack_position(0x21, 0, 5000, 0, 8))
    assert (axis.position, axis.good_ns) == (5000, good_ns + 20_000_000)


@given(st.lists(st.tuples(extremes(-INT32, INT32), velocities, st.integers(0, 25_000_000)), max_size=8))
def test_B4_a_motors_counts_on_their_way(frames: list[tuple[int, int, int]]) -> None:
    tach = RemoteTachometer(120_000)
    checked(tach, "_rate_q8", "_age_ns")
    for number, (count, delta, age) in enumerate(frames):
        now = Checked(number * 10_000_000)
        tach.take(now, pack_tach(0x31, 0, count, delta))
        assert abs(tach.sample(now + age)) <= 1 << 31


@given(
    extremes(10, 25),
    st.lists(extremes(-65536, 65536), min_size=1, max_size=20),
    st.sampled_from((0, 1, 4000)),
)
def test_B2_the_counter_register_stays_within_a_step_of_its_share(
    split: int, efforts: list[int], fade: int
) -> None:
    counter = CounterTorque(Checked(split), fade)
    for effort in efforts:
        counter.follow(Checked(effort), 0)
        assert abs(counter.register * 100 - abs(effort) * split) < 100


efforts_q8 = extremes(-(3000 << 8), 3000 << 8)
orders = extremes(0, (1 << 31) - 1)


@given(
    st.lists(st.tuples(orders, efforts_q8, efforts_q8), min_size=HARMONICS, max_size=HARMONICS),
    positions,
    velocities,
)
@example([((1 << 31) - 1, 3000 << 8, 3000 << 8)] * HARMONICS, STEPS_PER_TURN - 1, INT16[1])
@example([((1 << 31) - 1, -(3000 << 8), 3000 << 8)] * HARMONICS, 0, INT16[0])
def test_B1_every_line_of_the_table_at_its_largest(
    lines: list[tuple[int, int, int]], position: int, velocity: int
) -> None:
    compensator = Compensator()
    for k, (order, cosine, sine) in enumerate(lines):
        compensator.orders_q16[k] = Checked(order)
        compensator.cosines_q8[k], compensator.sines_q8[k] = Checked(cosine), Checked(sine)
    compensator.refresh()
    found = compensator.effort_q16(Checked(position), Checked(velocity), Checked(0))
    most = sum(abs(cosine) + abs(sine) for _, cosine, sine in lines)
    assert abs(found) <= (most << 8) + 1


@given(
    extremes(0, 3000 << 8),
    extremes(1, COUNTS_PER_TURN),
    st.lists(extremes(-INT32, INT32), min_size=1, max_size=20),
)
@example(3000 << 8, 1, [INT32, -INT32, INT32])
def test_B1_friction_ahead_of_the_loop_never_exceeds_its_level(
    level: int, travel: int, setpoints: list[int]
) -> None:
    """Whatever the set point is that a mode can ask for: 32 bits."""
    compensator = Compensator()
    compensator.level_q8, compensator.travel = Checked(level), Checked(travel)
    checked(compensator, "_level_q16", "_reciprocal_q32", "_friction_q16")
    for setpoint in setpoints:
        assert abs(compensator.effort_q16(Checked(0), Checked(0), Checked(setpoint))) <= level << 8


@given(extremes(0, 65536), st.lists(st.tuples(rates, velocities), min_size=1, max_size=20))
@example(65536, [(RATE_LIMIT, INT16[0])] * 20)
def test_B1_the_lock_sums_in_32_bits(gain: int, ticks: list[tuple[int, int]]) -> None:
    lock = RateLock(Checked(gain))
    checked(lock, "_error_q16")
    for setpoint, velocity in ticks:
        assert abs(lock.step(Checked(setpoint), Checked(velocity))) <= LOCK_LIMIT_Q16
        assert abs(lock._error_q16) <= LOCK_LIMIT_Q16 <= INT32


@given(
    extremes(1, 15),
    st.lists(st.tuples(positions, velocities, st.booleans()), min_size=1, max_size=30),
)
@example(15, [(0, INT16[1], True)] * 30)
def test_B1_the_blend_keeps_a_position_of_64_bits(shift: int, ticks: list[tuple[int, int, bool]]) -> None:
    blend = Blend(Checked(shift))
    for position, velocity, creeping in ticks:
        blend.step(Checked(position * UNITS_PER_STEP), Checked(velocity), creeping)


def test_B1_the_blend_stays_in_48_bits_of_its_encoder_however_long_the_counts_run_away() -> None:
    """The encoders contradict each other at the largest rate, for ever: the gap settles at 2^shift ticks."""
    blend = Blend(15)
    for _ in range(400_000):  # twelve time constants, 33 minutes
        found = blend.step(0, INT16[1], True)
    assert found == pytest.approx((1 << 15) * (INT16[1] << 18), rel=1e-4)
    assert found < 1 << 48


@given(
    extremes(-(3000 << 16), 3000 << 16),
    st.lists(st.tuples(efforts_q8, efforts_q8), min_size=HARMONICS, max_size=HARMONICS),
    extremes(10, 25),
    extremes(0, 300 << 8),
    st.booleans(),
)
@example(3000 << 16, [(3000 << 8, 3000 << 8)] * HARMONICS, 25, 300 << 8, True)
def test_B1_whatever_is_added_the_duty_registers_get_what_they_hold(
    effort: int, lines: list[tuple[int, int]], split: int, bias: int, spread: bool
) -> None:
    """Loop, table, counter torque and bias at once: 0 to 3000 steps, 16 bits and their fraction."""
    lab = Lab()
    board = lab.axis
    for k, (cosine, sine) in enumerate(lines):
        board.parameters.set(AxisParameter.HARMONIC_FIRST + 3 * k + 1, Checked(cosine))
        board.parameters.set(AxisParameter.HARMONIC_FIRST + 3 * k + 2, Checked(sine))
    board.parameters.set(AxisParameter.COUNTER_BIAS_Q8, Checked(bias))
    board.parameters.set(AxisParameter.DUTY_FRACTION, int(spread))
    board.parameters.set(AxisParameter.COMPENSATION, 1)
    board.counter.split = Checked(split)
    lab.run(0.02)
    board.motion.mode = AxisMode.RATE
    board.command_effort(None)
    board.pi.effort_q16 = Checked(effort)
    assert board.fine is not None
    board.fine.drive(lab.queue.now_ns, board.clock_ns(lab.queue.now_ns), 0, Checked(0), board.effort_command)
    assert all(0.0 <= duty <= 1.0 for duty in lab.plant.duties)


def test_B1_an_axis_that_holds_its_target_all_night_stays_settled() -> None:
    """The count of ticks near the target is 16 bits on a dsPIC: 32768 ticks are 164 s."""
    axis = motion(1 << 28)
    axis.move(0, 0, 1 << 28, RATE_LIMIT)
    for _ in range(40_000):
        axis.setpoint(0, 0)
    assert axis.settled
    assert axis.near_ticks <= 0x7FFF
