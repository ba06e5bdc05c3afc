"""B1: what parameters 12 to 68 change in the axis board, on chips and a rigid axis."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from boards.axis.compensator import Compensator
from boards.axis.config import FRICTION_CYCLES, HARMONIC_CYCLES, PWM_ROUTINE, SHARE_CYCLES, TABLE
from boards.axis.hold import LOCK_LIMIT_Q16, Blend, RateLock
from boards.axis.pi import CounterTorque
from boards.core.interrupts import InterruptController
from bus.protocol import AxisParameter, Opcode, Result
from bus.protocol.scales import rate_q16
from bus.time import EventQueue
from tests.boards.lab import Lab

ONE = 1 << 16


def put(lab: Lab, number: int, value: int) -> None:
    assert lab.command(Opcode.SET_PARAMETER, number, value).result == Result.OK


@given(st.integers(0, 3000 * ONE), st.integers(0, 3000 * ONE), st.integers(10, 25))
def test_B1_more_effort_is_never_less_net_torque(one: int, other: int, split: int) -> None:
    low, high = sorted((one, other))
    lesser, greater = CounterTorque(split, 0), CounterTorque(split, 0)
    for effort in (one, other):  # the same past
        assert lesser.share_q16(effort, 0) == greater.share_q16(effort, 0)
    assert low - lesser.share_q16(low, 0) <= high - greater.share_q16(high, 0)


def test_B1_the_share_settles_at_its_percentage_of_the_effort() -> None:
    counter = CounterTorque(10, 0)
    shares = [counter.share_q16(130 * ONE, 0) for _ in range(400)]
    assert 0.03 < shares[0] / (13 * ONE) < 0.04  # 2**-5 of the way in a tick
    assert abs(shares[-1] - 13 * ONE) <= 32


def test_B1_the_fraction_reaches_the_switches(lab: Lab) -> None:
    put(lab, AxisParameter.DUTY_FRACTION, 1)
    lab.command(Opcode.SET_RATE, rate_q16(200.0))
    lab.run(3.0)
    wanted = lab.axis.pi.effort_q16 / ONE / 3000
    assert wanted * 3000 % 1
    lead, lag = lab.plant.duties
    assert lead == pytest.approx(wanted, abs=1e-6)
    assert lag == pytest.approx(wanted / 10, abs=0.01 * wanted)  # the share is smoothed, the effort moves


def test_B1_off_again_is_the_papers_firmware(lab: Lab) -> None:
    put(lab, AxisParameter.DUTY_FRACTION, 1)
    lab.command(Opcode.SET_RATE, rate_q16(600.0))
    lab.run(1.0)
    put(lab, AxisParameter.DUTY_FRACTION, 0)
    lab.run(0.1)
    assert lab.axis.fine is None
    assert lab.axis.cost_ns == 40_000
    duty_a, duty_b = (round(duty * 3000, 9) for duty in lab.plant.duties)
    assert (duty_a, duty_b) == (lab.axis.pwm.pdc_a, lab.axis.pwm.pdc_b) == (int(duty_a), int(duty_b))


def test_B1_the_bias_is_on_both_motors_and_only_under_power(lab: Lab) -> None:
    put(lab, AxisParameter.COUNTER_BIAS_Q8, 40 * 256)
    lab.command(Opcode.OPEN_LOOP, -1000)
    lab.run(0.1)
    assert lab.plant.duties == pytest.approx((140 / 3000, 1040 / 3000))
    lab.command(Opcode.POWER, 0)
    lab.run(0.1)
    assert lab.plant.duties == (0.0, 0.0)


def test_B1_cycles_of_the_pwm_interrupt_are_booked() -> None:
    cpu = InterruptController(EventQueue(), 30_000_000, TABLE)
    cpu.steal(PWM_ROUTINE, 50_000)
    each = 834  # 25 cycles of 33.3 ns, rounded up
    # by hand: 40 us of control routine meet one PWM interrupt; 30 us of the CAN routine one
    assert cpu.lines["control"].cost_ns == 40_000 + each
    assert cpu.lines["can"].cost_ns == 30_000 + each
    cpu.steal(None)
    assert cpu.lines["control"].cost_ns == 40_000


def test_B1_cycles_of_the_compensation_are_booked(lab: Lab) -> None:
    first = AxisParameter.HARMONIC_FIRST
    for line in range(8):
        put(lab, first + 3 * line + 1, 256)
    put(lab, AxisParameter.COMPENSATION, 1)
    cycles = 1200 + 8 * HARMONIC_CYCLES + FRICTION_CYCLES
    assert lab.axis.cost_ns == math.ceil(cycles * 1e9 / 30e6)
    put(lab, AxisParameter.DUTY_FRACTION, 1)
    cycles += SHARE_CYCLES
    assert lab.axis.cost_ns == math.ceil(cycles * 1e9 / 30e6) + 2 * 834  # 77 us meet two
    lab.run(1.0)
    assert lab.axis.cpu.overruns == 0


@given(
    st.integers(0, (1 << 29) - 1),
    st.floats(0.1, 30_000.0),
    st.floats(-50.0, 50.0),
    st.floats(-50.0, 50.0),
)
def test_B1_a_line_of_the_table_is_a_wave_over_the_position(
    position: int, order: float, cosine: float, sine: float
) -> None:
    compensator = Compensator()
    compensator.orders_q16[3] = round(order * 65536)
    compensator.cosines_q8[3], compensator.sines_q8[3] = round(cosine * 256), round(sine * 256)
    compensator.refresh()
    got = compensator.effort_q16(position, 0, 0) / 65536
    phase = 2 * math.pi * (compensator.orders_q16[3] / 65536 * position / 2**29 % 1.0)
    wanted = cosine * math.cos(phase) + sine * math.sin(phase)
    size = abs(cosine) + abs(sine)
    # a chord of the table is off by (2 pi / 1024)^2 / 8 = 5e-6, its values and the amplitudes by half a
    # unit: 1/65534 and 1/512 step each
    assert abs(got - wanted) <= 6e-5 * size + 2 * 0.00196 + 1e-4


def test_B1_a_wave_is_met_one_and_a_half_ticks_ahead_and_to_its_last_value() -> None:
    """2^29 / 112 896 000 = 4.7555 steps a count; behind the last of 1024 values comes the first."""
    compensator = Compensator()
    compensator.orders_q16[0], compensator.sines_q8[0] = 1000 << 16, 2000 << 8
    compensator.refresh()
    for velocity in (1000, -1000):
        ahead = compensator.effort_q16(100_000, velocity, 0)
        assert ahead == pytest.approx(
            compensator.effort_q16(100_000 + round(velocity * 7.1332), 0, 0), abs=6000
        )
    compensator.orders_q16[0] = 1 << 16
    for cosine, sine, wanted in ((0, 256, 0), (256, 0, ONE)):
        compensator.cosines_q8[0], compensator.sines_q8[0] = cosine, sine
        compensator.refresh()
        assert compensator.effort_q16((1 << 29) - 1, 0, 0) == pytest.approx(wanted, abs=4)


def test_B1_without_table_and_friction_nothing_is_added() -> None:
    compensator = Compensator()
    compensator.refresh()
    assert compensator.effort_q16(1 << 28, 1000, 1000 * ONE) == 0
    compensator.level_q8 = 100 * 256
    assert compensator.effort_q16(0, 0, 0) == 0
    compensator.effort_q16(0, 0, ONE)
    compensator.start()
    assert compensator.effort_q16(0, 0, 0) == 0


def test_B1_friction_turns_within_its_travel() -> None:
    compensator = Compensator()
    compensator.level_q8, compensator.travel = 100 * 256, 1500
    rate = 6 * ONE  # counts per tick
    for _ in range(2000):
        settled = compensator.effort_q16(0, 0, rate)
    assert settled / ONE == pytest.approx(100.0, abs=0.1)
    # Dahl by hand: after x counts the other way F = -F0 + 2 F0 exp(-x / travel)
    for _ in range(250):
        turned = compensator.effort_q16(0, 0, -rate)
    assert turned / ONE == pytest.approx(-100.0 + 200.0 * math.exp(-1.0), abs=0.5)
    assert compensator.effort_q16(0, 0, 0) == turned  # at rest it stays


def test_B1_open_loop_is_not_compensated(lab: Lab) -> None:
    put(lab, AxisParameter.HARMONIC_FIRST + 1, 50 * 256)  # order 0: a constant
    put(lab, AxisParameter.COMPENSATION, 1)
    lab.command(Opcode.OPEN_LOOP, 1000)
    lab.run(0.1)
    assert lab.plant.duties == pytest.approx((1000 / 3000, 100 / 3000))


def test_B1_the_lock_pays_back_and_forgets_beyond_two_arcsec() -> None:
    assert RateLock(ONE).step(0, 0) == 0
    lock = RateLock(ONE // 32)
    for _ in range(8):
        lock.step(4 * ONE, 3)  # eight counts behind
    assert lock.step(4 * ONE, 4) == 8 * ONE // 32
    for _ in range(10_000):
        lock.step(4 * ONE, 0)
    assert lock.step(4 * ONE, 4) == 174 * ONE // 32 == LOCK_LIMIT_Q16 // 32  # 2 x 87.111, whole counts


def test_B1_a_locked_rate_holds_the_sum_of_the_set_point(lab: Lab) -> None:
    put(lab, AxisParameter.DUTY_FRACTION, 1)
    put(lab, AxisParameter.RATE_LOCK, 1)
    lab.command(Opcode.SET_RATE, rate_q16(100.0))
    lab.run(10.0)
    start = lab.angle_arcsec
    lab.run(20.0)
    # the board's crystal is 12 ppm off: 0.024 arcsec; one count is 0.0115
    assert lab.angle_arcsec - start == pytest.approx(2000.0, abs=0.1)


def test_B1_the_blend_passes_a_slow_difference_and_stops_a_fast_one() -> None:
    count, shift = 1 << 18, 6
    blend = Blend(shift)
    blend.step(0, 0, creeping=False)
    out = [blend.step(round(100 * count * math.sin(k / 4)), 0, creeping=True) / count for k in range(2000)]
    # first-order low-pass by hand: time constant 64 ticks, 1/4 rad per tick
    assert max(out[1000:]) == pytest.approx(100 / math.hypot(1, 64 / 4), rel=0.1)
    for _ in range(1000):
        slow = blend.step(500 * count, 0, creeping=True)
    assert slow / count == pytest.approx(500, abs=0.01)
    assert blend.step(700 * count, 0, creeping=False) == 700 * count


@pytest.mark.parametrize("before", ["tracking", "another mode"])
def test_B1_a_blend_begins_where_the_axis_is(lab: Lab, before: str) -> None:
    """Switched on while the axis creeps, or entered after a mode that did not take the counts along: the
    axis goes on as if nothing had happened."""
    number = AxisParameter.POSITION_BLEND
    if before == "another mode":
        put(lab, number, 11)
        lab.command(Opcode.SET_RATE, rate_q16(15.0))
    else:
        lab.command(Opcode.TRACK_RATE, rate_q16(15.0))
    lab.run(5.0)
    start = lab.angle_arcsec
    if before == "another mode":
        lab.command(Opcode.TRACK_RATE, rate_q16(15.0))
    else:
        put(lab, number, 11)
    fastest = 0.0
    for _ in range(400):
        lab.run(0.005)
        fastest = max(fastest, abs(lab.axis.velocity))
    assert fastest < 3 * 15.0 / 2.296  # counts in 5 ms; one is 2.296 arcsec/s
    assert lab.angle_arcsec - start == pytest.approx(30.0, abs=2.0)
