"""Ten thousand frames a second from outside, through a real socket, at a server in a process of its own."""

import os
import re
import time
from itertools import pairwise
from pathlib import Path

import can
import pytest

from bus.protocol import COMMAND_BASE, MEASUREMENT_BASE, REPLY_BASE, Device, Opcode
from tests.doors.process import Serving

RATE = 10_000
CHUNK = 100
WIRE_MOST = 1_000_000 / 111
"""Frames a second that a bus of 1 Mbit/s can carry at most: 8 bytes without a stuff bit are 111 bits."""
FLOOD_ID = 0x6F0
"""Nobody's; every measurement, command and reply goes before it."""


PERIODS_S = {
    Device.POSITION_RA: 0.005, Device.POSITION_DEC: 0.005, Device.AXIS_RA: 0.01, Device.AXIS_DEC: 0.01,
    Device.MOTOR_RA_A: 0.01, Device.MOTOR_DEC_B: 0.01, Device.FOCUS: 0.05,
}  # fmt: skip
"""Measurements of the boards (docs/reference/protocol.md)."""


def flood(bus: can.BusABC, frames: int) -> tuple[float, int]:
    """Send them at RATE; seconds it took and error frames heard meanwhile."""
    start_s = time.perf_counter()
    overflows = 0
    for first in range(0, frames, CHUNK):
        for number in range(first, first + CHUNK):
            bus.send(
                can.Message(arbitration_id=FLOOD_ID, data=number.to_bytes(8, "little"), is_extended_id=False)
            )
        while (message := bus.recv(0)) is not None:
            overflows += message.is_error_frame
        time.sleep(max(0.0, start_s + (first + CHUNK) / RATE - time.perf_counter()))
    return time.perf_counter() - start_s, overflows


def count(said: str, words: str) -> int:
    """The number before these words in what serve says at its end; 0 when it says nothing of it."""
    found = re.search(rf"(\d+) {re.escape(words)}", said)
    return int(found[1]) if found else 0


def times(log: Path, identifier: int) -> list[float]:
    """When frames of an identifier ended on the wire, s, by a candump log."""
    mark = f" {identifier:03X}#"
    with log.open() as lines:
        return [float(line[1 : line.index(")")]) for line in lines if mark in line]


def answered(bus: can.BusABC, device: Device) -> bool:
    """Whether a board answers PING. What came since the last look is read first: in a full buffer of this
    program the answer would be lost, which is no fault of the board."""
    while bus.recv(0) is not None:
        pass
    bus.send(
        can.Message(
            arbitration_id=COMMAND_BASE + device, data=bytes([device, Opcode.PING, *[0] * 6]),
            is_extended_id=False,
        )
    )  # fmt: skip
    end = time.monotonic() + 60
    while time.monotonic() < end:
        message = bus.recv(0.5)
        if message is not None and message.arbitration_id == REPLY_BASE + device:
            return True
    return False


@pytest.mark.slow
@pytest.mark.timeout(400)
def test_a_flood_is_arbitrated_refused_and_said_and_the_boards_go_on(tmp_path: Path) -> None:
    channel = "239.74.163.77"
    port = 20_000 + os.getpid() % 20_000  # another run on this machine has a group of its own
    sent = 3 * RATE
    record = tmp_path / "record"
    with Serving(
        tmp_path, "--can", f"udp_multicast:{channel},port={port}", "--record", str(record)
    ) as server:
        with can.Bus(interface="udp_multicast", channel=channel, port=port) as bus:
            before = server.wait(0.5)
            took_s, overflows = flood(bus, sent)
            after = server.status()
            devices = [Device[name] for name in after["boards"]]
            server.wait(after["simulated_s"] + 2.0)
            silent = [device.name for device in devices if not answered(bus, device)]
        said = server.end()
    carried, refused = count(said, "frames in"), count(said, "refused (the bus was full)")
    dropped = count(said, "dropped by the system's buffer")
    simulated_s = after["simulated_s"] - before["simulated_s"]
    pace = simulated_s / took_s
    print(
        f"{sent / took_s:.0f} frames/s for {took_s:.1f} s: {carried} arbitrated, {refused} refused,"
        f" {dropped} dropped by the system, {overflows} overflow frames; pace {pace:.2f},"
        f" load of the bus {after['bus_load']:.0%}, system load {os.getloadavg()[0]:.1f}"
    )
    pings = len(devices)
    assert silent == []
    assert carried + refused <= sent + pings
    assert carried + refused + dropped >= sent, "every frame was carried, refused or is said to be lost"
    on_the_wire = len(times(record / "can.log", FLOOD_ID))
    assert carried - 1000 - pings <= on_the_wire <= carried, "what was taken went through arbitration"
    assert on_the_wire <= (simulated_s + 2.5) * WIRE_MOST
    if refused > 100:
        assert overflows > 0, "a full controller says so on the bus"
    for device, period_s in PERIODS_S.items():
        seen = times(record / "can.log", MEASUREMENT_BASE + device)
        gaps = [b - a for a, b in pairwise(seen)]
        assert max(gaps) < 1.5 * period_s, f"{device.name} missed a tick"
