"""Protocol conformance of the lab network, written once, run in process and against `schmidt serve`
elsewhere."""

import os
import subprocess
import sys
from collections.abc import Iterator
from time import monotonic

import can
import pytest

from bus.conformance import Settings, run, summary
from bus.outside.external import SpecError, open_bus
from bus.outside.pythoncan import SchmidtBus
from bus.protocol import Device
from bus.protocol.database import database

_START_S = 600.0
"""The server may have to compile first, with a twentieth of a processor."""


@pytest.fixture
def in_process() -> Iterator[tuple[can.BusABC, Settings]]:
    from scenarios.lab.wiring import network

    with SchmidtBus(network().wire) as bus:
        # The wire's own time stamps: what is left of the tolerance is for the crystals (50 ppm) and the
        # arbitration.
        yield bus, Settings(motion=True, period_tolerance=0.002, stamps_s=0.0)


@pytest.fixture
def served() -> Iterator[tuple[can.BusABC, Settings]]:
    spec = f"udp_multicast:239.74.163.11,port={20_000 + os.getpid() % 20_000}"
    try:
        bus = open_bus(spec)
    except SpecError as error:
        pytest.skip(f"no multicast here: {error}")
    code = "from scenarios.cli import main; main()"
    command = [sys.executable, "-c", code, "serve", "--can", spec]
    with bus, subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as server:
        try:
            end_s = monotonic() + _START_S
            while bus.recv(timeout=0.5) is None:
                assert server.poll() is None, f"the server ended: {server.communicate()}"
                assert monotonic() < end_s, "the server never spoke"
            # A loaded machine delays whole slices of the server, not its crystals: generous, but it
            # tells 5 from 10 ms.
            yield bus, Settings(motion=True, period_tolerance=0.2, reply_s=5.0, stamps_s=60.0)
        finally:
            server.terminate()
            output, errors = server.communicate(timeout=30)
    assert server.returncode == 0
    assert errors == ""
    assert "11 boards" in output


@pytest.mark.parametrize("where", ["in_process", pytest.param("served", marks=pytest.mark.slow)])
def test_L1_L2_B9_every_board_keeps_the_protocol(where: str, request: pytest.FixtureRequest) -> None:
    bus, settings = request.getfixturevalue(where)
    results = run(bus, settings=settings)
    assert [str(result) for result in results if not result.passed] == []
    checked = {(result.check, result.subject) for result in results}
    for message in database().messages:
        if message.cycle_time:
            for check in ("identifier", "length", "device type", "contents", "period", "jitter", "gap"):
                assert (check, message.name) in checked
    for device in Device:
        for check in (
            "command",
            "wrong length",
            "wrong device type",
            "unknown opcode",
            "out of range",
            "extended frame",
            "remote frame",
            "response time",
            "flooding",
            "still there",
        ):
            assert any(c == check and s.startswith(device.name) for c, s in checked), (check, device.name)
    assert summary(results)["passed"]
