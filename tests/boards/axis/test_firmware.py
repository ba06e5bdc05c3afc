"""The axis board: what power-up leaves of before, whom it listens to, what it tells of its effort."""

import pytest

from boards.axis.config import AxisPeers, AxisPins
from boards.axis.firmware import AxisBoard
from bus.can import Frame
from bus.protocol import (
    AxisMode,
    AxisParameter,
    Device,
    Health,
    MotionFlag,
    Opcode,
    Result,
    State,
    unpack_motion,
    unpack_target,
)
from bus.protocol.scales import rate_q16
from bus.protocol.serial import STAMP_UNIT_NS, AxisSample, PacketDecoder
from bus.time import Oscillator
from tests.boards.lab import CENTRE, RA, STEP_ARCSEC, Lab, axis_config
from tests.boards.places import place


def state(board: AxisBoard, now_ns: int) -> tuple[object, ...]:
    """What a reset is to leave as it is without any past."""
    tachometers = [each.sample(now_ns) for each in (board.tach_a, board.tach_b, board.auxiliary)]
    motion, output = board.motion, board.output.compensator
    return (
        board.effort, board.effort_command, board.velocity, board.fault, board.counter.register,
        board.observer.driving, motion.mode, motion.setpoint_q16, motion.fresh(now_ns), board.watch.counts,
        tachometers, output.effort_q16(0, 0, 0), board.state(), board.ticks,
    )  # fmt: skip


def rebooted(lab: Lab) -> None:
    """Its supply has failed and come again; no tick since."""
    lab.axis.power_off(lab.queue.now_ns)
    lab.axis.power_on(lab.queue.now_ns)
    while not lab.axis.on:
        lab.run(0.001)
    assert not lab.axis.ticks


@pytest.mark.parametrize("opcode", [Opcode.SET_RATE, Opcode.OPEN_LOOP])
def test_B9_power_up_leaves_nothing_of_before(opcode: Opcode) -> None:
    fresh = Lab().axis
    lab = Lab()
    lab.run(0.1)
    lab.command(Opcode.POWER, 1)
    lab.command(opcode, rate_q16(1000.0) if opcode is Opcode.SET_RATE else 900)
    lab.run(2.0)
    board = lab.axis
    assert board.effort > 100 and board.velocity > 50 and board.counter.register > 9
    board.fault = True
    packets = len(lab.packets)
    board.power_off(lab.queue.now_ns)
    assert lab.plant.pending[-1][1:] == (0.0, 0.0)
    for silent in lab.boards[1:]:
        silent.power_off(lab.queue.now_ns)
    rebooted(lab)
    on_ns = lab.queue.now_ns
    assert state(board, 0) == state(fresh, 0)
    assert (board.effort, board.effort_command, board.velocity) == (0, 0, 0)
    lab.run(0.3)
    assert lab.plant.duties == (0.0, 0.0)
    assert lab.packets[packets][0] > on_ns + 240_000_000  # 25 samples of now
    assert abs(board.velocity) < 4000  # the counter is read anew: no jump in the first tick


def test_B4_the_auxiliary_encoder_is_listened_to_where_there_is_one() -> None:
    lab = Lab(axis_config(kp=1.5, ki=2.5))
    assert (lab.axis.pi.kp_q12, lab.axis.pi.ki_q12) == (1.5 * 4096, 2.5 * 4096)
    plant = lab.plant
    pins = AxisPins(encoder=plant.incremental, drive=plant.drive, current=plant.current)
    peers = AxisPeers(position=0x22, motor_a=0x33, motor_b=0x34, auxiliary=0x25)
    board = AxisBoard(place(Device.AXIS_DEC, lab.wire, Oscillator(0.0, 0)), pins, axis_config(), peers)
    assert (board.state(), board.effort) == (State.READY, 0)  # without a supply, too
    board.begin(lab.queue.now_ns)
    for identifier in (0x225, 0x226):
        lab.pc.send(
            Frame(identifier, bytes((identifier & 0x7F, 0, 0x39, 0x30, 0, 0, 0, 0))), lab.queue.now_ns
        )
    lab.run(0.005)
    assert board.auxiliary.sample(board.clock_ns(lab.queue.now_ns)) == 0x3039
    assert lab.axis.auxiliary.sample(0) == 0 and not lab.axis.foreign
    board.reset()
    assert board.auxiliary.sample(board.clock_ns(lab.queue.now_ns)) == 0


@pytest.mark.parametrize(("steps", "told"), [(3000, 900), (1500, 900), (1000, 900), (3000, 3000)])
def test_B1_effort_is_told_in_3000ths_of_the_supply_whatever_the_pwm_has(steps: int, told: int) -> None:
    lab = Lab(axis_config(pwm_steps=steps))
    lab.run(0.1)
    assert lab.command(Opcode.OPEN_LOOP, told).result == Result.NOT_ALLOWED
    lab.command(Opcode.POWER, 1)
    lab.command(Opcode.OPEN_LOOP, told)
    lab.run(0.5)
    assert lab.axis.effort == told * steps // 3000
    motion = unpack_motion([f for _, f in lab.frames if f.identifier == 0x200 + RA][-1].data)
    assert motion.effort == told
    row = AxisSample(*PacketDecoder().feed(lab.packets[-1][1])[0].rows[-1])
    assert row.effort == told
    shares = told / 3000, told / 30000
    assert lab.plant.duties == pytest.approx(shares, abs=0.6 / steps)
    # 24 V over 2.2 ohm; shunt of 0.1 ohm, gain of 8, 1024 counts of 5 V
    counts = [min(24.0 / 2.2 * share * 0.1 * 8 * 1024 / 5, 1023) for share in shares]
    assert (motion.adc_a, motion.adc_b) == pytest.approx(counts, abs=2)
    assert (row.adc_a, row.adc_b) == (motion.adc_a, motion.adc_b)


def test_B9_a_fault_is_told_and_cleared_by_power() -> None:
    lab = Lab()
    lab.run(0.1)
    assert lab.axis.state() is State.READY
    lab.command(Opcode.POWER, 1)
    assert lab.axis.state() is State.ACTIVE
    lab.command(Opcode.SET_RATE, rate_q16(100.0))
    lab.axis.trip()
    assert lab.axis.state() is State.FAULT and lab.axis.motion.mode is AxisMode.OFF
    assert lab.command(Opcode.PING).value == int(Health.FAULT | Health.SENSOR)
    lab.run(0.02)
    assert (lab.axis.effort, lab.axis.pwm.pdc_a, lab.axis.pwm.pdc_b) == (0, 0, 0)
    assert lab.command(Opcode.STOP).result == Result.OK
    assert not lab.axis.powered()
    assert lab.command(Opcode.POWER, 1).result == Result.OK
    assert lab.command(Opcode.PING).value == 0
    lab.command(Opcode.SET_RATE, rate_q16(100.0))
    lab.command(Opcode.POWER, 1)  # again: nothing changes
    assert lab.axis.motion.mode is AxisMode.RATE


def test_B1_the_observer_gets_the_effort_of_open_loop_and_drives_a_rate() -> None:
    """It holds what it has: the effort stays where open loop left it, whatever the PI would do."""
    lab = Lab()
    lab.run(0.1)
    lab.command(Opcode.POWER, 1)
    for number, value in ((AxisParameter.OBSERVER_FIRST + 2, 1 << 28), (AxisParameter.OBSERVER, 1)):
        assert lab.axis.parameters.set(number, value).result == Result.OK
    lab.command(Opcode.OPEN_LOOP, 60)
    lab.run(0.6)
    assert lab.axis.effort == 60 and abs(lab.axis.velocity) <= 1
    lab.command(Opcode.SET_RATE, rate_q16(15.0))
    lab.run(0.05)
    assert lab.axis.observer.driving and lab.axis.effort == 60
    rebooted(lab)
    assert not lab.axis.observer.driving


def test_H4_the_motion_frame_tells_mode_power_motion_and_limit() -> None:
    lab = Lab()

    def told() -> tuple[int, int]:
        motion = unpack_motion([f for _, f in lab.frames if f.identifier == 0x200 + RA][-1].data)
        return motion.mode, motion.flags

    lab.run(0.1)
    assert told() == (AxisMode.OFF, 0)
    lab.command(Opcode.POWER, 1)
    lab.run(0.02)
    assert told() == (AxisMode.STOP, MotionFlag.POWERED)
    lab.command(Opcode.SET_RATE, rate_q16(600.0))
    lab.run(3.0)
    assert told() == (AxisMode.RATE, MotionFlag.POWERED | MotionFlag.MOVING)
    lab.command(Opcode.SET_PARAMETER, 5, CENTRE)  # the upper limit, behind it now
    lab.run(0.02)
    assert told() == (AxisMode.STOP, MotionFlag.POWERED | MotionFlag.MOVING | MotionFlag.SOFT_LIMIT)
    assert lab.command(Opcode.PING).value == int(Health.LIMIT)


def test_B9_a_board_that_runs_late_steers_and_tells_by_its_own_clock() -> None:
    """Tracking at 600 arcsec/s, 100 ms of another age would be 60 arcsec."""
    lab = Lab()
    lab.run(1.0)
    rebooted(lab)
    lab.run(0.1)
    for number, value in ((AxisParameter.FRICTION_LEVEL_Q8, 100 << 8), (AxisParameter.COMPENSATION, 1)):
        assert lab.axis.parameters.set(number, value).result == Result.OK
    lab.command(Opcode.POWER, 1)
    begun_ns = lab.queue.now_ns
    lab.command(Opcode.TRACK_RATE, rate_q16(600.0))
    lab.run(8.0)
    now_ns, here = lab.queue.now_ns, lab.angle_arcsec
    ahead = 600.0 * (now_ns - begun_ns) * 1e-9 - 600.0**2 / (2 * 7200.0)  # from rest, at 2 deg/s2
    assert here == pytest.approx(ahead, abs=5.0)
    assert lab.axis.motion.mode is AxisMode.TRACK and lab.axis.motion.settled
    assert lab.axis.effort - lab.axis.pi.steps == pytest.approx(100, abs=1)
    target = unpack_target([f for _, f in lab.frames if f.identifier == 0x300 + RA][-1].data)
    assert target.settled and abs(target.distance) < 5.0 / STEP_ARCSEC
    packet = PacketDecoder().feed(lab.packets[-1][1])[0]
    taken_ns = lab.axis.oscillator.true_ns(packet.stamp * STAMP_UNIT_NS)
    rows = [AxisSample(*row) for row in packet.rows]
    assert (rows[0].position - CENTRE) * STEP_ARCSEC == pytest.approx(
        here - 600.0 * (now_ns - taken_ns) * 1e-9, abs=1.0
    )
    # 360.48864 turns of 4096 counts for a turn of the axis, 10 ms
    turned = 25 * 6.0 / 1_296_000 * 360.48864 * 4096
    tachometers = sum(row.tach_a for row in rows), sum(row.tach_b for row in rows)
    assert tachometers == pytest.approx((turned, turned), rel=0.02)


def test_an_encoder_set_anew_while_its_board_was_off_is_no_fault() -> None:
    """The look before the gap says nothing of the one behind it."""
    lab = Lab()
    lab.run(0.6)
    lab.command(Opcode.POWER, 1)
    lab.position.power_off(lab.queue.now_ns)
    lab.run(0.5)
    lab.plant.start_steps += round(3600.0 / STEP_ARCSEC)
    lab.position.power_on(lab.queue.now_ns)
    lab.run(1.0)
    assert lab.axis.powered() and not lab.axis.fault
    lab.plant.start_steps += round(50.0 / STEP_ARCSEC)  # 40 arcsec may build up between two looks
    lab.run(0.5)
    assert lab.axis.fault and not lab.axis.powered()


def test_B1_at_rest_the_set_point_is_nothing_and_a_push_is_opposed() -> None:
    lab = Lab()

    def setpoint() -> int:
        return AxisSample(*PacketDecoder().feed(lab.packets[-1][1])[0].rows[-1]).setpoint

    lab.run(0.1)
    lab.command(Opcode.POWER, 1)
    lab.run(0.5)
    assert (setpoint(), lab.axis.effort) == (0, 0)
    lab.plant.rate = 1e-3
    lab.run(0.02)
    assert lab.axis.effort < 0 and lab.axis.pwm.pdc_b > lab.axis.pwm.pdc_a
    lab.command(Opcode.SET_RATE, rate_q16(600.0))
    lab.run(1.0)
    assert setpoint() == rate_q16(600.0)
    lab.command(Opcode.STOP)
    lab.run(1.0)
    assert setpoint() == 0
