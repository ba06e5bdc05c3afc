"""The control plane: commands, tokens, and clients that break the rules."""

import contextlib
import json
import socket

import pytest

from scenarios.doors.clients import address, is_local
from scenarios.doors.control import ControlDoor
from tests.doors.conftest import Bench
from tests.ports import free_ports


class Caller:
    """One client; every line gets its answer."""

    def __init__(self, bench: Bench, port: int) -> None:
        self.bench = bench
        self.socket = socket.create_connection(("127.0.0.1", port))
        self.socket.setblocking(False)

    def send(self, data: bytes) -> str:
        self.socket.sendall(data)
        self.bench.run(3)
        try:
            return self.socket.recv(65536).decode()
        except BlockingIOError:
            return ""

    def __call__(self, line: str) -> str:
        return self.send(line.encode() + b"\n").rstrip("\n")


@pytest.fixture
def door(bench: Bench) -> ControlDoor:
    door = ControlDoor(str(free_ports()), None, bench.served)
    bench.open(door)
    return door


def test_speed_pause_status_power_and_stop(bench: Bench, door: ControlDoor) -> None:
    ask = Caller(bench, door.port)
    assert ask("speed 5") == "ok speed 5"
    assert bench.served.pacer.speed == 5.0
    assert ask("pause") == "ok paused" and bench.served.pacer.paused
    assert ask("resume") == "ok running" and not bench.served.pacer.paused
    status = json.loads(ask("status").removeprefix("ok "))
    assert status["speed"] == 5.0
    late = json.loads(ask("late").removeprefix("ok "))  # time goes on, and more may be late before we look
    known = [[due_s, late_s * 1e3] for due_s, late_s in bench.served.punctual.late]
    assert late == known[: len(late)]
    assert status["boards"]["FOCUS"] is True
    assert ask("power FOCUS off") == "ok FOCUS off"
    assert not bench.served.network.boards["FOCUS"].on
    assert ask("power FOCUS on") == "ok FOCUS on"
    bench.run(400)
    assert bench.served.network.boards["FOCUS"].on
    assert not bench.served.ending
    assert ask("stop") == "ok ending" and bench.served.ending
    ask.socket.close()


@pytest.mark.parametrize(
    "line",
    ["speed", "speed x", "speed nan", "speed inf", "speed 1e12", "speed 0", "speed 1 2", "power",
     "power X on", "power FOCUS sideways", "nonsense", "", "\0", "token", "\u2028"],
)  # fmt: skip
def test_what_is_no_command_is_one_line_of_error(bench: Bench, door: ControlDoor, line: str) -> None:
    ask = Caller(bench, door.port)
    answer = ask(line)
    assert answer.startswith("error: ")
    assert "\n" not in answer
    assert bench.served.pacer.speed == 1.0
    ask.socket.close()


def test_a_stranger_needs_the_token(bench: Bench, door: ControlDoor, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scenarios.doors.control.is_local", lambda _host: False)
    door.token = "word"
    stranger = Caller(bench, door.port)
    assert stranger("stop") == "error: this needs a token: token WORD"
    assert not bench.served.ending
    assert stranger("token word") == "ok"
    assert stranger("speed 2") == "ok speed 2"
    thief = Caller(bench, door.port)
    assert thief("token guess") == "error: wrong token"
    assert door.refused == 2
    bench.run(3)
    assert thief.socket.recv(10) == b"", "and is hung up on"
    for each in (stranger, thief):
        each.socket.close()


def test_a_line_without_end_is_hung_up_on(bench: Bench, door: ControlDoor) -> None:
    ask = Caller(bench, door.port)
    assert "short line" in ask.send(b"x" * 3000)
    ask.socket.close()


@pytest.mark.parametrize("text", ["", "0", "65536", "-1", "x", "1:2:x", "9" * 30, "host\0:1", ":", "²"])
def test_addresses_that_are_none(text: str) -> None:
    with pytest.raises(ValueError):
        address(text, "--control")


def test_addresses() -> None:
    assert address("7411", "x") == ("127.0.0.1", 7411)
    assert address("0.0.0.0:7411", "x") == ("0.0.0.0", 7411)
    assert address("[::1]:7411", "x") == ("::1", 7411)
    assert is_local("127.0.0.1") and is_local("::1") and not is_local("192.168.0.1")


def test_commands_that_come_faster_than_they_are_taken_wait_and_keep_their_order(
    bench: Bench, door: ControlDoor
) -> None:
    """Eight are taken between two slices, so that a talker cannot make a tick late; the ninth waits."""
    ask = Caller(bench, door.port)
    said = "".join(f"speed {1 + k}\n" for k in range(30))
    answers = ask.send(said.encode())
    while answers.count("\n") < 30:
        more = ask.send(b"")
        assert more, answers
        answers += more
    assert answers.split("\n")[:30] == [f"ok speed {1 + k}" for k in range(30)]
    ask.socket.close()


def test_no_more_than_eight_are_taken_at_once(bench: Bench, door: ControlDoor) -> None:
    ask = Caller(bench, door.port)
    ask.socket.sendall(b"speed 2\n" * 8 + b"stop\n")
    for _ in range(200):
        bench.run(1)
        if bench.served.pacer.speed == 2.0:
            break
    assert bench.served.pacer.speed == 2.0 and not bench.served.ending
    bench.run(1)
    assert bench.served.ending
    ask.socket.close()


def test_a_web_page_is_hung_up_on(bench: Bench, door: ControlDoor) -> None:
    """A form in any page can post `stop` to a port of this machine."""
    page = Caller(bench, door.port)
    assert page.send(b"POST / HTTP/1.1\r\nHost: x\r\n\r\nstop\n") == ""
    torn = Caller(bench, door.port)
    assert torn.send(b"PO") == ""
    assert torn.send(b"ST / HTTP/1.1\r\n\r\nstop\n") == ""
    assert not bench.served.ending
    for caller in (page, torn):
        with contextlib.suppress(ConnectionResetError):  # what it had not read was thrown away
            assert caller.socket.recv(1) == b""
        caller.socket.close()
