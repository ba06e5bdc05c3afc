"""What commands and parameters of the axis board accept, to the last value, and what follows at once."""

import pytest

from bus.protocol import AxisMode, AxisParameter, Opcode, Result, pack_command, unpack_target
from bus.protocol.scales import rate_q16
from tests.boards.lab import CENTRE, RA, Lab, axis_config

TURN = 1 << 29
FASTEST = 318_557_389
"""3.1 deg/s (Fig. 12 of the paper: up to 3): 11160 arcsec/s, 87.111 counts each, in 5 ms, Q16."""
SLEW = 205_520_896
"""2 deg/s: 3136 counts in 5 ms, Q16."""
EFFORT_Q8 = 3000 * 256
WORD = (1 << 31) - 1
BOUNDS = {
    1: (10, 25),  # percent (paper, section 3.3)
    **dict.fromkeys((2, 3), (0, 256 * 4096)),  # 256 steps per count
    **dict.fromkeys((4, 5), (0, TURN - 1)),
    6: (1, SLEW // 20),  # ten times Table 1's
    **dict.fromkeys(range(7, 12), (1, FASTEST)),
    12: (0, 1), 13: (0, 1), 14: (0, EFFORT_Q8), 15: (1, 112_896_000),
    **{16 + 3 * k: (0, WORD) for k in range(8)},
    **{16 + 3 * k + place: (-EFFORT_Q8, EFFORT_Q8) for k in range(8) for place in (1, 2)},
    40: (0, EFFORT_Q8 // 10), 41: (0, 1), 42: (0, 15),
    **dict.fromkeys(range(44, 69), (-WORD, WORD)),
}  # fmt: skip


def test_B1_what_the_papers_firmware_lacks_is_off_at_first() -> None:
    table = Lab().axis.parameters
    assert [table.get(number).value for number in range(12, 69)] == [0, 0, 0, 1] + [0] * 53


def test_B1_a_parameter_takes_its_bounds_and_nothing_beyond() -> None:
    table = Lab().axis.parameters
    assert {row.number for row in table.rows()} == {*BOUNDS, AxisParameter.OBSERVER}
    for number, bounds in BOUNDS.items():
        for value, beyond in zip(bounds, (-1, 1), strict=True):
            assert table.set(number, value) == (Result.OK, number, value)
            assert table.set(number, value + beyond) == (Result.OUT_OF_RANGE, number, value)
            assert table.get(number) == (Result.OK, number, value)


@pytest.mark.parametrize("sign", [1, -1])
def test_B1_a_command_takes_its_bounds_and_nothing_beyond(lab: Lab, sign: int) -> None:
    config = lab.axis.config
    for opcode, most in (
        (Opcode.SET_RATE, FASTEST), (Opcode.TRACK_RATE, SLEW), (Opcode.OPEN_LOOP, 3000),
    ):  # fmt: skip
        assert lab.command(opcode, sign * most).result == Result.OK
        assert lab.command(opcode, sign * (most + 1)).result == Result.OUT_OF_RANGE
        lab.command(Opcode.STOP)
    for number in range(1, 6):
        assert lab.command(Opcode.SET_CLASS, number, sign).result == Result.OK
        lab.run(0.01)
        assert lab.axis.motion.wanted_q16 == sign * config.classes[number - 1]
    assert lab.command(Opcode.POWER, 2).result == Result.OUT_OF_RANGE
    for number, direction in ((0, sign), (6, sign), (1, 2 * sign)):
        assert lab.command(Opcode.SET_CLASS, number, direction).result == Result.OUT_OF_RANGE
    assert lab.command(Opcode.SET_CLASS, 1, 0).result == Result.OK
    assert lab.axis.motion.wanted_q16 == 0
    assert lab.command(Opcode.POWER, 0).result == Result.OK
    assert not lab.axis.powered()


def test_B9_without_a_position_nothing_is_pointed() -> None:
    """Refused from the last frame on that is older than 50 ms, though the axis has still its power."""
    lab = Lab()
    lab.run(0.1)
    lab.command(Opcode.POWER, 1)
    lab.command(Opcode.TRACK_RATE, 0)
    lab.axis.motion.forget()
    for opcode, arguments in (
        (Opcode.NUDGE, (1,)), (Opcode.MOVE_TO, (CENTRE, 1)), (Opcode.TRACK_RATE, (0,)),
    ):  # fmt: skip
        handler = lab.axis.commands[opcode]
        data = pack_command(RA, opcode, *arguments)[2:]
        assert handler(lab.queue.now_ns, data).result == Result.NOT_ALLOWED


@pytest.mark.parametrize("number", [0, 1, 5, 6])
def test_B3_a_target_may_be_a_limit_itself(number: int) -> None:
    lab = Lab(axis_config(low=CENTRE - 500, high=CENTRE + 500))
    lab.run(0.1)
    lab.command(Opcode.POWER, 1)
    for offset, inside in ((-501, False), (-500, True), (500, True), (501, False)):
        result = lab.command(Opcode.MOVE_TO, CENTRE + offset, number).result
        assert (result == Result.OK) == (inside and 1 <= number <= 5)
    if not 1 <= number <= 5:
        return
    lab.command(Opcode.MOVE_TO, CENTRE, number)
    there = 0
    for offset, inside in ((501, False), (500, True), (1, False), (-1000, True), (-1, False)):
        there += offset * inside
        assert (lab.command(Opcode.NUDGE, offset).result == Result.OK) is inside
        assert lab.axis.motion.target_steps == CENTRE + there


def selected(lab: Lab) -> int:
    """The class that TARGET tells."""
    lab.run(0.3)
    return unpack_target(
        [frame for _, frame in lab.frames if frame.identifier == 0x300 + RA][-1].data
    ).speed_class


def test_H4_the_class_in_force_is_told(lab: Lab) -> None:
    """Tracking is the fifth, unless a move that is under way has one of its own."""
    for opcode, arguments, told in (
        (Opcode.SET_CLASS, (3, 1), 3), (Opcode.SET_RATE, (0,), 0), (Opcode.TRACK_RATE, (0,), 5),
        (Opcode.STOP, (), 0), (Opcode.MOVE_TO, (CENTRE + 1000, 4), 4), (Opcode.TRACK_RATE, (0,), 4),
        (Opcode.POWER, (0,), 0),
    ):  # fmt: skip
        assert lab.command(opcode, *arguments).result == Result.OK
        assert selected(lab) == told


@pytest.mark.parametrize(("opcode", "arguments"), [
    (Opcode.SET_RATE, (0,)), (Opcode.SET_CLASS, (1, 0)), (Opcode.MOVE_TO, (CENTRE, 1)),
    (Opcode.TRACK_RATE, (0,)), (Opcode.STOP, ()),
])  # fmt: skip
def test_B1_behind_open_loop_the_loop_decides_again(
    lab: Lab, opcode: Opcode, arguments: tuple[int, ...]
) -> None:
    lab.command(Opcode.OPEN_LOOP, 700)
    lab.run(0.5)
    assert lab.axis.velocity > 20 and lab.axis.effort == 700
    assert lab.axis.motion.mode is AxisMode.OPEN_LOOP
    lab.command(opcode, *arguments)
    lab.run(0.5)
    assert lab.axis.effort < 650


def test_B1_gains_are_in_force_at_once_where_they_drive(lab: Lab) -> None:
    lab.command(Opcode.SET_PARAMETER, 2, 5000)
    assert lab.axis.pi.kp_q12 != 5000  # it stands: STOP has gains of its own
    lab.command(Opcode.SET_CLASS, 1, 0)
    for number, value in ((2, 8192), (3, 77)):
        lab.command(Opcode.SET_PARAMETER, number, value)
        assert value in (lab.axis.pi.kp_q12, lab.axis.pi.ki_q12)
    assert (lab.axis.pi.kp_q12, lab.axis.pi.ki_q12) == (8192, 77)


@pytest.mark.parametrize("mode", [AxisMode.RATE, AxisMode.MOVE])
def test_B2_another_acceleration_is_in_force_at_once(lab: Lab, mode: AxisMode) -> None:
    """3600 arcsec/s at 7.2 arcsec/s in a tick, a fifth of Table 1's: a fifth of it after half a second."""
    lab.command(Opcode.SET_PARAMETER, 6, rate_q16(7.2))
    if mode is AxisMode.RATE:
        lab.command(Opcode.SET_RATE, rate_q16(3600.0))
    else:
        lab.command(Opcode.MOVE_TO, CENTRE + (1 << 27), 1)
    lab.run(0.5)
    assert lab.axis.motion.mode is mode
    assert lab.axis.motion.steady[0] == pytest.approx(rate_q16(720.0), rel=0.03)
