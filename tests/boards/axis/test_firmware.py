"""The axis board: what power-up leaves of before, whom it listens to, what it tells of its effort."""

import pytest

from boards.axis.config import AxisConfig, AxisPeers, AxisPins
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
)
from bus.protocol.scales import rate_q16
from bus.protocol.serial import AxisSample, PacketDecoder
from bus.time import Oscillator
from tests.boards.lab import CENTRE, RA, Lab
from tests.boards.places import place


def state(board: AxisBoard, now_ns: int) -> tuple[object, ...]:
    """What a reset is to leave as it is without any past."""
    tachometers = [each.sample(now_ns) for each in (board.tach_a, board.tach_b, board.auxiliary)]
    motion, output = board.motion, board.output.compensator
    return (
        board.effort, board.effort_command, board.velocity, board.fault, board.pi.effort_q16,
        board.pi.step(0, 0), board.counter.register, board.observer.driving, motion.mode,
        motion.setpoint_q16, motion.fresh(now_ns), board.watch.counts, tachometers,
        output.effort_q16(0, 0, 0), board.state(), board.ticks,
    )  # fmt: skip


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
    board.power_on(lab.queue.now_ns)
    while not board.on:
        lab.run(0.001)
    on_ns = lab.queue.now_ns
    assert state(board, 0) == state(fresh, 0)
    lab.run(0.3)
    assert lab.packets[packets][0] > on_ns + 240_000_000  # 25 samples of now
    assert abs(board.velocity) < 4000  # the counter is read anew: no jump in the first tick


def test_B4_the_auxiliary_encoder_is_listened_to_where_there_is_one() -> None:
    lab = Lab(AxisConfig(kp=1.5, ki=0.25))
    assert (lab.axis.pi.kp_q12, lab.axis.pi.ki_q12) == (1.5 * 4096, 0.25 * 4096)
    plant = lab.plant
    pins = AxisPins(encoder=plant.incremental, drive=plant.drive, current=plant.current)
    peers = AxisPeers(position=0x22, motor_a=0x33, motor_b=0x34, auxiliary=0x25)
    board = AxisBoard(place(Device.AXIS_DEC, lab.wire, Oscillator(0.0, 0)), pins, AxisConfig(), peers)
    board.begin(lab.queue.now_ns)
    for identifier in (0x225, 0x226):
        lab.pc.send(
            Frame(identifier, bytes((identifier & 0x7F, 0, 0x39, 0x30, 0, 0, 0, 0))), lab.queue.now_ns
        )
    lab.run(0.005)
    assert board.auxiliary.sample(board.clock_ns(lab.queue.now_ns)) == 0x3039
    assert lab.axis.auxiliary.sample(0) == 0 and not lab.axis.foreign


@pytest.mark.parametrize(("steps", "told"), [(3000, 900), (1500, 900), (1000, 900)])
def test_B1_effort_is_told_in_3000ths_of_the_supply_whatever_the_pwm_has(steps: int, told: int) -> None:
    lab = Lab(AxisConfig(pwm_steps=steps))
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
    assert lab.plant.duties == pytest.approx((0.3, 0.03), abs=0.6 / steps)


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
