"""Faults of boards, each while it is on and after."""

import numpy as np
import pytest

from bus.protocol import Device, Opcode
from plant.kernels import layout as at
from tests.scenarios.lab.faults.lab import Lab

BOOT_S = 0.31


@pytest.mark.parametrize(("kind", "hears"), [("node_off", False), ("brown_out", True)])
def test_a_board_without_supply_is_silent_and_boots(kind: str, hears: bool) -> None:
    lab = Lab().pull()
    assert lab.world(at.DUTY) > 0.4
    number = lab.faults.start(kind, node="AXIS_RA")
    start = lab.now_ns
    lab.run(0.1)
    board = lab.network.boards["AXIS_RA"]
    assert board.port.online == hears  # too little for the processor, enough for the controller
    assert lab.world(at.DUTY) == 0.0
    assert "AXIS_RA" not in lab.senders(start + 500_000)  # what lay in a buffer may still go
    heard_ns = board.motion.good_ns
    lab.faults.clear(number)
    lab.run(0.1)
    assert board.motion.good_ns == heard_ns  # it boots, and takes nothing that its controller hears
    lab.run(BOOT_S - 0.1)
    assert board.on
    assert "AXIS_RA" in lab.senders(start + 500_000)
    assert lab.world(at.DUTY) == 0.0  # nobody has switched it on again


def test_two_reasons_to_be_off_are_two() -> None:
    lab = Lab().run(0.05)
    one = lab.faults.start("node_off", node="DISPLAY")
    other = lab.faults.start("node_off", node="DISPLAY")
    lab.faults.clear(one)
    lab.run(BOOT_S)
    assert not lab.network.boards["DISPLAY"].on
    lab.faults.clear(other)
    lab.run(BOOT_S)
    assert lab.network.boards["DISPLAY"].on


def test_a_supply_that_fails_during_the_boot_ends_it() -> None:
    lab = Lab().run(0.05)
    board = lab.network.boards["DISPLAY"]
    board.power_off(lab.now_ns)
    board.power_on(lab.now_ns)
    board.power_on(lab.now_ns)
    lab.run(0.1)
    board.power_off(lab.now_ns)
    lab.run(BOOT_S)
    assert not board.on
    board.power_on(lab.now_ns)
    lab.run(BOOT_S)
    assert (board.on, board.boots) == (True, 2)


def test_resets_come_again_until_cleared() -> None:
    lab = Lab().run(0.05)
    board = lab.network.boards["POSITION_RA"]
    number = lab.faults.start("reset", node="POSITION_RA", every="400 ms")
    lab.run(1.0)  # resets at 0, 0.4, 0.8 s; boots at 0.3 and 0.7 s
    assert board.boots == 3
    lab.faults.clear(number)
    lab.run(0.6)
    assert (board.on, board.boots) == (True, 4)


def test_a_hang_keeps_outputs_and_loses_interrupts() -> None:
    lab = Lab().pull()
    board = lab.network.boards["AXIS_RA"]
    duty, ticks = lab.world(at.DUTY), board.ticks
    number = lab.faults.start("hang", node="AXIS_RA")
    lab.run(0.001)
    start = lab.now_ns
    lab.command(Device.AXIS_RA, Opcode.PING)
    lab.run(0.1)
    assert "AXIS_RA" not in lab.senders(start)
    assert lab.world(at.DUTY) == duty > 0.4
    assert board.port.online
    assert board.ticks == ticks
    lab.faults.clear(number)
    cleared = lab.now_ns
    lab.run(0.1)
    # 101 ms are 20 fires: one is remembered by its flag, the others are lost
    assert board.cpu.overruns in (19, 20)
    assert 20 <= board.ticks - ticks <= 22
    assert "AXIS_RA" in lab.senders(cleared)
    assert not lab.network.wire.errors


def test_a_command_waits_out_a_hang() -> None:
    lab = Lab().run(0.1)
    lab.faults.start("hang", node="POSITION_RA")  # hears no measurements: the buffers are free
    lab.command(Device.POSITION_RA, Opcode.PING)
    lab.run(0.05)
    reply = 0x100 + Device.POSITION_RA
    assert not [frame for _, frame, _ in lab.frames if frame.identifier == reply]
    lab.faults.clear(0)
    lab.run(0.01)
    assert len([frame for _, frame, _ in lab.frames if frame.identifier == reply]) == 1


def test_a_crystal_that_drifts_shortens_the_period() -> None:
    lab = Lab().run(0.2)

    def period_ns(start: int) -> float:
        times = [t for t, frame, _ in lab.since(start) if frame.identifier == 0x200 + Device.POSITION_RA]
        return float(
            np.polyfit(range(len(times)), times, 1)[0]
        )  # of frames that now and then wait for the bus

    before = period_ns(0)
    number = lab.faults.start("crystal_drift", node="POSITION_RA", ppm=5000)
    start = lab.now_ns + 5_000_000
    lab.run(0.5)
    assert period_ns(start) == pytest.approx(before / 1.005, rel=3e-4)
    lab.faults.clear(number)
    start = lab.now_ns + 5_000_000
    lab.run(0.5)
    assert period_ns(start) == pytest.approx(before, rel=3e-4)


def test_masked_interrupts_pile_up_and_are_served_late() -> None:
    lab = Lab().run(0.1)
    board = lab.network.boards["POSITION_RA"]
    number = lab.faults.start("late_interrupts", node="POSITION_RA", masked="12 ms", every="17 ms")
    start = lab.now_ns
    lab.run(0.2)
    times = [t for t, frame, _ in lab.since(start) if frame.identifier == 0x200 + Device.POSITION_RA]
    gaps = np.diff(times)
    assert gaps.max() > 10e6  # nothing for 12 ms, and then at once what waited
    assert gaps.min() < 4.9e6
    assert board.cpu.overruns >= 10  # two or three fires in 12 ms, one is remembered
    lab.faults.clear(number)
    lost, start = board.cpu.overruns, lab.now_ns + 5_000_000
    lab.run(0.1)
    assert board.cpu.overruns == lost
    times = [t for t, frame, _ in lab.since(start) if frame.identifier == 0x200 + Device.POSITION_RA]
    assert np.diff(times).max() < 5.3e6
