"""Faults of the bus, each while it is on and after."""

import numpy as np
import pytest

import schmidt
from bus.protocol import COMMAND_BASE, MEASUREMENT_BASE, Device, Opcode, pack_command
from tests.scenarios.lab.faults.lab import EXAMPLES, Lab


def test_bit_errors_end_frames_and_are_repeated() -> None:
    lab = Lab().run(0.1)
    number = lab.faults.start("bit_errors", **EXAMPLES["bit_errors"])
    lab.run(0.2)
    errors = sum(lab.network.wire.errors.values())
    share = errors / (errors + len(lab.since(100_000_000)))
    assert 0.1 < share < 0.3  # 20 % were asked for, of some 200 attempts: three standard deviations are 9 %
    lab.faults.clear(number)
    lab.run(0.5)
    assert sum(lab.network.wire.errors.values()) == errors
    assert all(port.rec == 0 for port in lab.network.wire.ports)
    assert all(
        lab.network.boards[name].port.tec == 0 for name in ("POSITION_RA", "AXIS_RA")
    )  # who talks a lot


def test_a_babbler_of_identifier_0_leaves_nothing_to_anybody() -> None:
    lab = Lab().run(0.1)
    number = lab.faults.start("babbler")
    lab.run(0.1)
    assert lab.senders(101_000_000) == {"babbler"}
    assert lab.network.wire.errors == {}
    lab.faults.clear(number)
    start = lab.now_ns + 1_000_000
    lab.run(0.1)
    assert "babbler" not in lab.senders(start)
    assert {"POSITION_RA", "AXIS_RA", "MOTOR_RA_A"} <= lab.senders(start)


def test_a_forged_position_is_believed_until_it_ends() -> None:
    """Nothing in a CAN frame proves its sender."""
    lab = Lab().run(0.1)
    true = lab.network.boards["AXIS_RA"].motion.position
    device = int(Device.POSITION_RA)
    data = bytes((device, 0)) + (true + 1000).to_bytes(4, "little") + b"\0\0"
    identifier = MEASUREMENT_BASE + device
    number = lab.faults.start(
        "forged_sender", identifier=identifier, data=int.from_bytes(data, "big"), period="1 ms"
    )
    lab.run(0.1)
    assert "forger" in lab.senders(lab.now_ns - 50_000_000)
    heard = {lab.network.boards["AXIS_RA"].motion.position - true for _ in range(20) if lab.run(0.001)}
    assert 1000 in heard
    lab.faults.clear(number)
    lab.run(0.1)
    assert abs(lab.network.boards["AXIS_RA"].motion.position - true) < 100


def test_one_forged_open_loop_turns_the_axis_as_far_as_fidelity_says() -> None:
    lab = schmidt.Lab("lab", seed=1).run("0.5 s")
    lab.ask("AXIS_RA", "POWER", 1)
    frame = pack_command(Device.AXIS_RA, Opcode.OPEN_LOOP, 1500)
    identifier = COMMAND_BASE + Device.AXIS_RA
    lab.faults.start("forged_sender", identifier=identifier, data=int.from_bytes(frame, "big"), period="9 s")
    angle = lab.run("8 s").truth("ra")["angle"]
    assert np.degrees(angle[-1] - angle[0]) == pytest.approx(13, abs=0.5)


def test_a_babbler_takes_the_share_it_is_given() -> None:
    lab = Lab().run(0.1)
    lab.faults.start("babbler", identifier=0x7FF, load="20 %")
    bits, start = lab.network.wire.bits, lab.now_ns
    lab.run(0.5)
    taken = sum(sender == "babbler" for _, _, sender in lab.since(start))
    frame_ns = 1e9 * 0.2 / (taken / 0.5) if taken else 0
    assert 100_000 < frame_ns < 160_000  # 8 bytes are 111 to 135 us; others now and then make it wait
    assert lab.network.wire.bits > bits


def test_a_partition_keeps_both_pieces_going() -> None:
    lab = Lab().run(0.1)
    number = lab.faults.start("partition", nodes=["AXIS_RA", "POSITION_RA"])
    start = lab.now_ns
    heard = lab.network.boards["AXIS_RA"].port
    lab.run(0.2)
    piece = heard._wire
    assert {port.name for port in piece.ports} == {"AXIS_RA", "POSITION_RA"}
    assert not {"AXIS_RA", "POSITION_RA"} & lab.senders(start)
    assert {"POSITION_DEC", "MOTOR_RA_A"} <= lab.senders(start)
    assert piece.frames > 40  # POSITION every 5 ms, MOTION every 10 ms
    assert heard.tec == 0
    lab.faults.clear(number)
    healed = lab.now_ns
    lab.run(0.1)
    assert {"AXIS_RA", "POSITION_RA"} <= lab.senders(healed)
    assert not piece.ports


def test_a_node_cut_off_alone_gets_no_acknowledge() -> None:
    lab = Lab().run(0.1)
    number = lab.faults.start("partition", nodes="POSITION_DEC")
    lab.run(0.1)
    port = lab.network.boards["POSITION_DEC"].port
    assert (port.tec, port.state) == (128, "passive")  # ISO 11898-1: a lone node stays at 128
    lab.faults.clear(number)
    lab.run(1.0)
    assert port.state == "active"


def test_a_wrong_bit_rate_destroys_frames_until_the_node_is_passive() -> None:
    lab = Lab().run(0.1)
    number = lab.faults.start("wrong_bitrate", node="DISPLAY", bitrate="125 kbit/s")
    lab.run(0.3)
    port = lab.network.boards["DISPLAY"].port
    assert lab.network.wire.errors["stuff"] > 10
    assert port.state == "passive"
    lab.command(Device.DISPLAY, Opcode.PING)
    lab.run(0.02)
    assert not [frame for _, frame, _ in lab.frames if frame.identifier == 0x100 + Device.DISPLAY]
    lab.faults.clear(number)
    lab.command(Device.DISPLAY, Opcode.PING)
    lab.run(0.1)
    assert [frame for _, frame, _ in lab.frames if frame.identifier == 0x100 + Device.DISPLAY]


def test_two_nodes_with_one_identifier_collide() -> None:
    lab = Lab().run(0.1)
    number = lab.faults.start("duplicate_node", node="POSITION_RA", period="5 ms")
    lab.command(Device.POSITION_RA, Opcode.PING)
    start = lab.now_ns
    lab.run(0.1)
    answers = [
        sender for _, frame, sender in lab.since(start) if frame.identifier == 0x100 + Device.POSITION_RA
    ]
    assert lab.network.wire.errors["bit"] >= 1  # both answered at once, and differed
    assert sorted(answers) == ["POSITION_RA", "second POSITION_RA"]
    lab.faults.clear(number)
    cleared = lab.now_ns + 1_000_000
    lab.run(0.1)
    assert "second POSITION_RA" not in lab.senders(cleared)
    assert [port.name for port in lab.network.wire.ports][-1] == "outside"


def test_a_bus_held_dominant_carries_nothing_and_makes_everybody_passive() -> None:
    lab = Lab().run(0.1)
    number = lab.faults.start("stuck_dominant")
    start = lab.now_ns
    lab.run(0.05)
    assert not lab.since(start)
    assert all(port.state == "passive" for port in lab.network.wire.ports)
    lab.faults.clear(number)
    lab.run(0.5)
    assert {"AXIS_RA", "POSITION_DEC", "MOTOR_RA_A"} <= lab.senders(start)
    assert all(port.state == "active" for port in lab.network.wire.ports)
