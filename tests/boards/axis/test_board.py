from itertools import pairwise

import pytest

from bus.protocol import (
    AxisMode,
    Device,
    Health,
    MotionFlag,
    Opcode,
    PositionFlag,
    Result,
    unpack_motion,
    unpack_target,
)
from bus.protocol.scales import rate_q16
from bus.protocol.serial import NO_SETPOINT, AxisSample, PacketDecoder
from tests.boards.lab import CENTRE, RA, STEP_ARCSEC, Lab, axis_config


def steps(arcsec: float) -> int:
    return round(arcsec / STEP_ARCSEC)


def test_B9_power_is_refused_while_the_position_is_unknown() -> None:
    lab = Lab()
    lab.position.power_off(0)
    lab.run(0.2)
    assert lab.command(Opcode.PING).value & Health.STALE
    assert lab.command(Opcode.POWER, 1).result == Result.NOT_ALLOWED


def test_B9_after_a_supply_failure_the_old_position_is_forgotten(lab: Lab) -> None:
    lab.axis.power_off(lab.queue.now_ns)
    lab.position.power_off(lab.queue.now_ns)
    lab.axis.power_on(lab.queue.now_ns)
    lab.run(0.4)
    assert lab.command(Opcode.PING).value & Health.STALE
    assert lab.command(Opcode.POWER, 1).result == Result.NOT_ALLOWED


def test_H2_health_check_is_clean(lab: Lab) -> None:
    assert lab.command(Opcode.PING).value == 0


@pytest.mark.parametrize("rate", [600.0, 3600.0, -1000.0])
def test_B1_closed_loop_reaches_its_rate(lab: Lab, rate: float) -> None:
    lab.command(Opcode.SET_RATE, rate_q16(rate))
    lab.run(8.0)
    start = lab.angle_arcsec
    lab.run(1.0)
    assert lab.angle_arcsec - start == pytest.approx(rate, rel=0.01)


def test_B1_lead_motor_gets_all_and_lag_motor_its_share(lab: Lab) -> None:
    assert lab.command(Opcode.SET_PARAMETER, 1, 25).result == Result.OK
    lab.command(Opcode.OPEN_LOOP, 1000)
    lab.run(0.1)
    assert (lab.axis.pwm.pdc_a, lab.axis.pwm.pdc_b) == (1000, 250)
    lab.command(Opcode.OPEN_LOOP, -1000)
    lab.run(0.1)
    assert (lab.axis.pwm.pdc_a, lab.axis.pwm.pdc_b) == (250, 1000)
    assert lab.command(Opcode.SET_PARAMETER, 1, 26).result == Result.OUT_OF_RANGE


def test_B1_the_share_may_fade_with_speed() -> None:
    lab = Lab(axis_config(counter_split=20, split_fade_counts=1000))
    lab.run(0.1)
    lab.command(Opcode.POWER, 1)
    lab.command(Opcode.OPEN_LOOP, 800)
    lab.run(0.25)
    assert 200 < lab.axis.velocity < 900
    expected = max(0, 160 * (1000 - lab.axis.velocity) // 1000)
    assert abs(lab.axis.pwm.pdc_b - expected) <= 2


def test_B1_open_loop_to_closed_loop_is_bumpless(lab: Lab) -> None:
    lab.command(Opcode.OPEN_LOOP, 900)
    lab.run(6.0)
    effort, velocity = lab.axis.effort, lab.axis.velocity
    lab.command(Opcode.SET_RATE, rate_q16(velocity * 2.29592))
    lab.run(0.05)
    assert abs(lab.axis.effort - effort) < 60
    assert lab.axis.motion.mode == AxisMode.RATE


def test_B2_the_set_point_is_acceleration_limited(lab: Lab) -> None:
    lab.command(Opcode.SET_CLASS, 1, 1)
    lab.run(0.5)
    # 2 deg/s2 for half a second
    assert lab.axis.motion.setpoint_q16 == pytest.approx(rate_q16(3600.0), rel=0.03)
    lab.run(4.0)
    assert lab.axis.velocity * 2.29592 == pytest.approx(7200.0, rel=0.02)
    lab.command(Opcode.STOP)
    lab.run(4.0)
    assert abs(lab.axis.velocity) < 10


@pytest.mark.parametrize("arcsec", [18_000.0, -3_600.0, 30.0])
def test_B2_pointing_and_position_locked_tracking(lab: Lab, arcsec: float) -> None:
    lab.command(Opcode.MOVE_TO, CENTRE + steps(arcsec), 1)
    lab.command(Opcode.TRACK_RATE, rate_q16(15.041))
    start_ns = lab.queue.now_ns
    lab.run(15.0)
    for _ in range(20):
        lab.run(0.5)
        wanted = arcsec + 15.041 * (lab.queue.now_ns - start_ns) * 1e-9
        assert abs(lab.angle_arcsec - wanted) < 10.0
    assert lab.axis.motion.settled
    assert lab.axis.motion.mode == AxisMode.TRACK


def test_B2_nudge_shifts_the_target(lab: Lab) -> None:
    assert lab.command(Opcode.NUDGE, 100).result == Result.NOT_ALLOWED
    lab.command(Opcode.TRACK_RATE, rate_q16(15.041))
    lab.run(5.0)
    before = lab.axis.motion.target_steps
    lab.command(Opcode.NUDGE, steps(20.0))
    lab.run(10.0)
    moved = (lab.axis.motion.target_steps - before) * STEP_ARCSEC
    assert moved == pytest.approx(20.0 + 15.041 * 10.005, abs=0.2)
    assert lab.axis.motion.settled


def test_B3_targets_beyond_the_soft_limits_are_refused_and_the_limit_holds() -> None:
    lab = Lab(axis_config(low=CENTRE - steps(3600.0), high=CENTRE + steps(7200.0)))
    lab.run(0.1)
    lab.command(Opcode.POWER, 1)
    assert lab.command(Opcode.MOVE_TO, CENTRE + steps(7300.0), 1).result == Result.OUT_OF_RANGE
    lab.command(Opcode.SET_CLASS, 1, 1)
    lab.run(6.0)
    assert lab.axis.motion.mode == AxisMode.STOP
    assert 6000.0 < lab.angle_arcsec < 7300.0
    assert lab.command(Opcode.SET_CLASS, 1, -1).result == Result.OK
    lab.run(1.0)
    assert lab.axis.motion.mode == AxisMode.CLASS


@pytest.mark.parametrize(("flag", "sign"), [(PositionFlag.LIMIT_HIGH, 1), (PositionFlag.LIMIT_LOW, -1)])
def test_B3_a_limit_of_the_encoder_board_stops_what_leads_beyond_it(
    lab: Lab, flag: PositionFlag, sign: int
) -> None:
    """Its limits are its own parameters; the axis board heeds them far inside its own."""
    parameter = Opcode.SET_PARAMETER
    lab.command(Opcode.SET_RATE, sign * rate_q16(600.0))
    lab.run(1.0)
    assert lab.axis.motion.mode == AxisMode.RATE and not lab.axis.limits.reached
    if flag is PositionFlag.LIMIT_HIGH:
        lab.command(parameter, 5, CENTRE - steps(3600.0), device=Device.POSITION_RA)
    else:
        lab.command(parameter, 4, CENTRE + steps(3600.0), device=Device.POSITION_RA)
    lab.run(3.0)
    assert lab.axis.motion.mode == AxisMode.STOP and lab.axis.limits.reached
    lab.command(Opcode.SET_RATE, -sign * rate_q16(600.0))
    lab.run(1.0)
    assert lab.axis.motion.mode == AxisMode.RATE  # the way back is free


def test_commands_that_move_need_power() -> None:
    lab = Lab()
    lab.run(0.1)
    for command in (
        (Opcode.SET_RATE, 0),
        (Opcode.SET_CLASS, 1, 1),
        (Opcode.MOVE_TO, CENTRE, 1),
        (Opcode.TRACK_RATE, 0),
        (Opcode.OPEN_LOOP, 100),
        (Opcode.NUDGE, 0),
    ):
        assert lab.command(*command).result == Result.NOT_ALLOWED
    assert lab.command(Opcode.STOP).result == Result.OK


def test_out_of_range_is_refused(lab: Lab) -> None:
    for command in (
        (Opcode.POWER, 2),
        (Opcode.SET_RATE, rate_q16(4 * 3600.0)),
        (Opcode.SET_CLASS, 0, 1),
        (Opcode.SET_CLASS, 1, 2),
        (Opcode.MOVE_TO, 1 << 29, 1),
        (Opcode.MOVE_TO, CENTRE, 6),
        (Opcode.TRACK_RATE, rate_q16(7300.0)),
        (Opcode.OPEN_LOOP, 3001),
        (Opcode.GET_PARAMETER, 69),
        (Opcode.SET_PARAMETER, 6, 0),
    ):
        assert lab.command(*command).result == Result.OUT_OF_RANGE, command


def test_a_position_board_that_falls_silent_stops_pointing(lab: Lab) -> None:
    lab.command(Opcode.TRACK_RATE, rate_q16(15.041))
    lab.run(1.0)
    lab.position.power_off(lab.queue.now_ns)
    lab.run(0.2)
    assert lab.axis.motion.mode == AxisMode.STOP
    assert lab.command(Opcode.PING).value & Health.STALE
    lab.position.power_on(lab.queue.now_ns)
    lab.run(1.0)
    assert lab.command(Opcode.TRACK_RATE, rate_q16(15.041)).result == Result.OK


def test_encoders_that_disagree_take_the_power_off(lab: Lab) -> None:
    lab.command(Opcode.SET_RATE, rate_q16(600.0))
    lab.run(3.0)
    stuck = lab.axis.qei.pin(lab.queue.now_ns)
    lab.axis.qei.pin = lambda _t: stuck
    lab.run(2.0)
    assert lab.axis.fault
    assert (lab.axis.pwm.pdc_a, lab.axis.pwm.pdc_b) == (0, 0)
    frame = [f for _, f in lab.frames if f.identifier == 0x200 + RA][-1]
    assert unpack_motion(frame.data).flags & MotionFlag.FAULT
    assert lab.command(Opcode.PING).value & (Health.FAULT | Health.SENSOR)
    lab.axis.qei.pin = lab.plant.incremental
    lab.run(1.0)
    assert lab.command(Opcode.POWER, 1).result == Result.OK
    assert not lab.axis.fault


def test_L3_packets_hold_25_samples_at_10_ms(lab: Lab) -> None:
    lab.command(Opcode.SET_RATE, rate_q16(1000.0))
    lab.run(6.0)
    decoder = PacketDecoder()
    packets = [packet for _, data in lab.packets for packet in decoder.feed(data)]
    assert decoder.crc_errors == decoder.skipped_bytes == 0
    stamps = [packet.stamp for packet in packets]
    assert {after - before for before, after in pairwise(stamps)} <= {2499, 2500, 2501}
    last = [AxisSample(*row) for row in packets[-1].rows]
    assert len(last) == 25
    # 1000 arcsec/s: 435.6 counts in 5 ms, 4142.5 steps and 11.378 tachometer counts in 10 ms
    moved = (last[-1].position - last[0].position) / 24
    assert moved == pytest.approx(4142.5, rel=0.02)
    assert sum(sample.tach_a for sample in last) / 25 == pytest.approx(11.378, rel=0.05)
    # whole counts at the frame, whole counts at the sample: at most two away from 11.378
    assert all(10 <= sample.tach_a <= 13 for sample in last)
    lab.command(Opcode.OPEN_LOOP, 0)
    lab.run(1.0)
    assert AxisSample(*decoder.feed(lab.packets[-1][1])[0].rows[-1]).setpoint == NO_SETPOINT


def test_every_command_is_answered_exactly_once(lab: Lab) -> None:
    before = len(lab.replies)
    for _ in range(2):
        lab.send(RA, bytes((RA, 0x01, 0, 0, 0, 0, 0, 0)))
    lab.send(RA, bytes((RA, 0x99, 0, 0, 0, 0, 0, 0)))
    lab.run(0.01)
    lab.send(RA, bytes((0x12, 0x01, 0, 0, 0, 0, 0, 0)))
    lab.send(RA, bytes((RA, 0x01, 0)))
    lab.run(0.01)
    results = [reply.result for reply in lab.replies[before:]]
    assert results == [0, 0, Result.UNKNOWN_OPCODE, Result.WRONG_DEVICE_TYPE, Result.WRONG_LENGTH]


def test_periods_of_the_documented_frames(lab: Lab) -> None:
    lab.frames.clear()
    lab.run(4.0)
    for identifier, count in ((0x211, 400), (0x311, 16), (0x711, 4), (0x221, 800), (0x321, 16), (0x231, 400)):
        assert abs(sum(f.identifier == identifier for _, f in lab.frames) - count) <= 1, hex(identifier)
    target = unpack_target(next(f for _, f in lab.frames if f.identifier == 0x311).data)
    assert target.speed_class == 0
    assert all(board.dropped == 0 and board.cpu.overruns == 0 for board in lab.boards)
