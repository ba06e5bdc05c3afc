"""A client that steps time, over a stub connection: its lines, the answers, and what cannot be."""

import socket
from typing import Any

import pytest

from bus.can import Frame
from scenarios.doors.stepped import Stepped, tell


class Server:
    """A connection of which the answers are known; heard: the lines it was told."""

    def __init__(self) -> None:
        self.asked: list[tuple[Any, ...]] = []
        self.answers: list[str] = []
        self.heard: list[str] = []
        self.waits: list[float | None] = []
        self.closed = 0

    def connect(self, *each: Any) -> "Server":
        self.asked.append(each)
        return self

    def settimeout(self, seconds: float | None) -> None:
        self.waits.append(seconds)

    def makefile(self, mode: str, encoding: str, newline: str) -> "Server":
        assert (mode, encoding, newline) == ("rw", "utf-8", "\n")
        return self

    def write(self, text: str) -> None:
        self.heard.append(text)

    def flush(self) -> None:
        self.heard[-1] = self.heard[-1].removesuffix("\n")

    def readline(self) -> str:
        return f"{self.answers.pop(0)}\n" if self.answers else ""

    def close(self) -> None:
        self.closed += 1

    def answer(self, *lines: str) -> None:
        self.answers += lines


@pytest.fixture
def server(monkeypatch: pytest.MonkeyPatch) -> Server:
    found = Server()
    monkeypatch.setattr(socket, "create_connection", found.connect)
    return found


def test_it_joins_listens_and_steps(server: Server) -> None:
    server.answer("ok", "ok", "(0.001500) can0 011#05", "ok 5000000", "ok")
    with Stepped("host:7411", "dome", clients=2) as client:
        assert server.asked == [(("host", 7411), 5.0)] and client.now_ns == 0
        assert client.step("5 ms") == [(1_500_000, Frame(0x11, b"\5"))] and client.now_ns == 5_000_000
        client.send(0x22, b"\1\2")
    assert server.heard == ["join 2 dome", "listen", "step 5 ms", "send 022#0102"]
    assert server.closed == 2  # the stream and its socket


def test_one_client_is_waited_for_and_a_token_comes_first(server: Server) -> None:
    server.answer("ok", "ok", "ok")
    with Stepped("7411", token="word"):
        assert server.waits == [None]
        assert server.heard == ["token word", "join 1 ", "listen"]


def test_who_only_talks_does_not_join_and_a_refusal_is_an_error(server: Server) -> None:
    server.answer("ok speed 2", "error: no such thing")
    with Stepped("7411", clients=0) as client:
        assert client.ask("speed 2") == "speed 2"
        with pytest.raises(ValueError, match=r"^no such thing$"):
            client.ask("dance")
        with pytest.raises(ValueError, match=r"^the server has gone$"):
            client.ask("status")


@pytest.mark.parametrize(("command", "seconds"), [("status", 60.0), ("step 5ms", None), ("join 2", None)])
def test_a_command_is_told_and_answered(server: Server, command: str, seconds: float | None) -> None:
    server.answer("ok  yes ")
    assert tell(f"{command} ", "7411", token="") == "yes"
    assert server.heard == [command] and server.waits == [None, seconds]


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (
            ConnectionRefusedError(),
            "127.0.0.1:7411: nobody listens; start schmidt serve --control 7411 first",
        ),
        (TimeoutError("timed out"), "127.0.0.1:7411: no answer: timed out"),
        (ValueError("no such command"), "127.0.0.1:7411: no such command"),
    ],
)
def test_what_went_wrong_is_one_line(error: Exception, said: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any, **__: Any) -> Any:
        raise error

    monkeypatch.setattr(socket, "create_connection", refuse)
    with pytest.raises(ValueError) as caught:
        tell("status", "7411")
    assert str(caught.value) == said
