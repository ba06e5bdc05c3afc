"""What the other boards add up, at the ends of its width: serial sequence, motor counts, focus steps."""

import pytest

from boards.focus.config import FocusConfig
from boards.focus.stepping import Reference, Stepping
from boards.motor_velocity.firmware import MotorVelocityBoard
from bus.protocol.serial import PacketDecoder
from tests.boards.checked import Checked, checked
from tests.boards.lab import Lab

INT32 = (1 << 31) - 1


def test_L3_the_sequence_of_packets_is_eight_bits_in_the_board_too() -> None:
    lab = Lab()
    lab.axis.packets.sequence = lab.position.packets.sequence = 0xFF
    lab.run(0.6)
    assert lab.axis.packets.sequence in (0, 1)
    assert lab.position.packets.sequence in (0, 1)
    decoder = PacketDecoder()
    found = [packet.sequence for _, data in lab.packets for packet in decoder.feed(data)]
    assert found[:2] == [255, 0]


@pytest.mark.parametrize("before", [0, 0x7FFF_FFFF, 0xFFFF_FFFF])
def test_B4_a_motors_count_wraps_at_32_bits(before: int) -> None:
    lab = Lab()
    motor = next(board for board in lab.boards if isinstance(board, MotorVelocityBoard))
    lab.run(0.05)
    stood = motor.qei.pin
    motor.qei.pin = lambda t_ns: stood(0) + t_ns // 1_000_000  # a count a millisecond, ten a routine
    lab.run(0.05)
    motor.count = before
    ticks = motor.ticks
    lab.run(0.2)
    assert motor.count == (before + 10 * (motor.ticks - ticks)) % 2**32


@pytest.mark.parametrize("start", [-INT32, -32768, 0, 32767, INT32])
@pytest.mark.parametrize("lvdt", [0, 511, 1023])
def test_B6_a_search_that_fails_for_ever_stays_within_32_bits(start: int, lvdt: int) -> None:
    """An index that never comes: 440 half steps a search, so 32 bits last for 73 days of searching."""
    config = FocusConfig()
    stepping, reference = Stepping(config), Reference(config)
    stepping.position = stepping.target = Checked(start // 2)
    checked(stepping, "_ramp")
    for _ in range(5):
        stepping.target = Checked(reference.begin(stepping.position, lvdt, False))
        stepping.moving = True
        while stepping.next()[0]:
            assert reference.look(lvdt, False) is None
        reference.give_up()
    moved = abs(stepping.position - start // 2)
    assert moved == 5 * (config.half_steps_per_turn * 11 // 10)
