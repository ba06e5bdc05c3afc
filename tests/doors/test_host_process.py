"""The host program in its process beside the emulator: what crosses the pipe, and how either one dies."""

import math
import os
import signal
import socket
import time
from collections.abc import Callable
from multiprocessing import Pipe
from pathlib import Path
from typing import Any

import pytest

from bus.protocol.nodes import DEVICES
from host.console.views import words
from host.lx200 import angles
from scenarios.doors.busview import EmulatedBus
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.doors.options import ServeOptions
from scenarios.doors.pc import dated
from scenarios.doors.pipe_messages import Settings
from scenarios.doors.piped_host import BusMirror, main
from scenarios.lab.prepare import chosen
from tests.doors.process import Serving
from tests.ports import free_ports

PATIENCE_S = 120.0
NEAR_ARCSEC = 20.0
"""LX200 tells right ascension to 15."""


class Both:
    """Both ends of the bus page's view, with a pipe of plain lists between them."""

    def __init__(self, network: str = "lab") -> None:
        self.served = LiveNetwork(*chosen(network_name=network))
        self.bus = EmulatedBus(self.served)
        self.wishes: list[Any] = []
        self.mirror = BusMirror(list(self.served.network.boards), self.bus.fault_kinds(), self.wishes.append)

    def carry(self) -> None:
        """A slice: wishes there, answers and a picture back."""
        for _, number, command in self.wishes:
            self.mirror.done(number, *self.bus.wish(command))
        self.wishes.clear()
        self.served.run_until(self.served.now_ns + 50_000_000)
        self.mirror.state = self.bus.look()


@pytest.mark.parametrize("network", ["lab", "final"])
def test_the_mirror_shows_the_bus_and_its_frames_in_words(network: str) -> None:
    both = Both(network)
    assert not both.mirror.watching
    for _ in range(10):
        both.carry()
    now = both.mirror.look()
    assert {node.name for node in now.nodes} >= set(both.mirror.boards)
    assert 0.0 < now.load < 1.0 and both.mirror.watching
    assert len(now.frames) == 25
    names = {device.name for device in DEVICES}
    assert all(sender in names for _, sender, _, _ in now.frames)
    assert "not in the protocol" not in {words(number, data) for _, _, number, data in now.frames}
    assert words(0x7FF, bytes(8)) == "not in the protocol"


def test_a_wish_is_done_or_refused_with_its_reason() -> None:
    both = Both()
    on = both.mirror.wish("fault start node_off node=FOCUS")
    wrong = both.mirror.wish("fault start nonsense")
    torn = both.mirror.wish("fault start node_off node")
    both.carry()
    assert "is on" in on.result(0) and both.mirror.look().running
    assert not both.served.network.boards["FOCUS"].on
    for refused in (wrong, torn):
        with pytest.raises(ValueError, match=r"\w"):
            refused.result(0)
    both.mirror.wish(f"fault clear {both.mirror.look().running[0][0]}")
    both.mirror.wish("power DISPLAY off")
    for _ in range(40):  # it boots
        both.carry()
    assert both.served.network.boards["FOCUS"].on and not both.served.network.boards["DISPLAY"].on


def host_of(emulator: int) -> int:
    """Process id of the host beside a `schmidt serve`."""
    (child,) = Path(f"/proc/{emulator}/task/{emulator}/children").read_text().split()
    return int(child)


def answered(port: int, asked: bytes = b":GR#") -> bytes:
    """What LX200 says; nothing while nobody listens."""
    try:
        with socket.create_connection(("127.0.0.1", port), 60) as s:
            s.sendall(asked)
            return s.recv(64)
    except OSError:
        return b""


@pytest.mark.slow
@pytest.mark.timeout(300)
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
def test_a_host_that_dies_or_hangs_is_reported_and_comes_back(tmp_path: Path, number: int) -> None:
    port = free_ports()
    with Serving(tmp_path, "--lx200", str(port)) as served:
        assert answered(port).endswith(b"#")
        before = served.status()
        first = host_of(served.process.pid)
        os.kill(first, number)
        after = served.wait(before["simulated_s"] + 2.0)  # the emulation goes on without it
        assert all(after["boards"].values())
        end_s = time.monotonic() + PATIENCE_S
        while "the host: open again" not in served.said or not answered(port).endswith(b"#"):
            assert time.monotonic() < end_s, served.said
            time.sleep(0.2)
        assert host_of(served.process.pid) != first
    assert "the host: broken" in served.said


def told_h(port: int, asked: bytes = b":GR#") -> float:
    """A time or right ascension: the first answer there is."""
    while not (said := answered(port, asked)):
        time.sleep(0.05)
    return angles.parse(said.decode().removesuffix("#"))


def until(what: Callable[[], bool]) -> None:
    end_s = time.monotonic() + PATIENCE_S
    while not what():
        assert time.monotonic() < end_s
        time.sleep(0.1)


@pytest.mark.slow
@pytest.mark.timeout(400)
def test_a_killed_host_comes_back_at_once_and_tells_what_is_the_case(tmp_path: Path) -> None:
    """The boards go on tracking: the first answer is where they are, both doors open at the first try."""
    port, terminal = free_ports(), tmp_path / "lx200"
    with Serving(tmp_path, "--lx200", str(port), "--lx200", f"pty:{terminal}") as served:
        place = angles.hours((told_h(port, b":GS#") + 0.2) * math.pi / 12)
        assert answered(port, f":Sr{place}#:Sd+25*00:00#:MS#".encode()).startswith(b"1")
        until(lambda: abs(told_h(port) - angles.parse(place)) * 54000 < NEAR_ARCSEC)
        until(lambda: answered(port, b":GW#") == b"PT1#" and answered(port, b":D#") == b"#")
        os.kill(host_of(served.process.pid), signal.SIGKILL)
        until(lambda: "the host: broken" in served.said)
        assert abs(told_h(port) - angles.parse(place)) * 54000 < NEAR_ARCSEC
        assert answered(port, b":GW#") == b"PT1#"
        assert served.said.count("broken") == 1 and terminal.is_symlink()
        descriptor = os.open(terminal, os.O_RDWR | os.O_NOCTTY)
        os.write(descriptor, b":GVP#")
        assert os.read(descriptor, 64) == b"schmidt#"
        os.close(descriptor)


@pytest.mark.slow
@pytest.mark.timeout(300)
def test_an_emulator_that_is_killed_takes_its_host_along(tmp_path: Path) -> None:
    served = Serving(tmp_path, "--lx200", str(free_ports()))
    with served:
        host = host_of(served.process.pid)
        served.process.kill()
        served.process.wait()
        end_s = time.monotonic() + PATIENCE_S
        while Path(f"/proc/{host}/cmdline").exists() and Path(f"/proc/{host}/cmdline").read_bytes():
            assert time.monotonic() < end_s
            time.sleep(0.1)


def test_a_host_whose_emulator_has_gone_ends_without_a_word(capfd: pytest.CaptureFixture[str]) -> None:
    """Ctrl-C while it starts: nobody reads what it says."""
    served = LiveNetwork(*chosen())
    options = ServeOptions(asked={"lx200": (f"127.0.0.1:{free_ports()}",)})
    ours, theirs = Pipe()
    ours.send(Settings(dated(served.scenario), options, [], (), {}, []))
    ours.close()
    main(os.dup(theirs.fileno()))
    theirs.close()
    assert capfd.readouterr() == ("", "")
