"""Clients over sockets of this process alone: read, written, dropped, turned away."""

import socket
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from scenarios.doors import clients
from scenarios.doors.clients import Client, Clients


@pytest.fixture
def pair() -> Iterator[tuple[Client, socket.socket]]:
    ours, theirs = socket.socketpair()
    with ours, theirs:
        yield Client(ours, "127.0.0.1"), theirs


def test_what_comes_is_read_by_4096_bytes_while_it_may_be_there(pair: tuple[Client, socket.socket]) -> None:
    client, far = pair
    assert client.receive() == b"" and not client.gone
    far.sendall(b"x" * 5000)
    assert [len(client.receive()) for _ in range(3)] == [4096, 904, 0]
    far.sendall(b"y")
    client.ready = False
    assert client.receive() == b""
    client.ready = True
    assert client.receive() == b"y"
    far.close()
    assert client.receive() == b"" and client.gone


@pytest.mark.parametrize("pieces", [[b"GET / HTTP"], [b"G", b"ET /"], [b"OPTI", b"ONS *"]])
def test_a_web_page_is_hung_up_on(pair: tuple[Client, socket.socket], pieces: list[bytes]) -> None:
    client, far = pair
    found = []
    for piece in pieces:
        far.sendall(piece)
        found.append(client.receive())
    assert client.gone and found[-1] == b""


def test_a_line_that_has_a_method_further_on_is_none(pair: tuple[Client, socket.socket]) -> None:
    client, far = pair
    for piece in (b"status\n", b"GET / HTTP/1.1\n"):
        far.sendall(piece)
        assert client.receive() == piece
    assert not client.gone


def test_what_does_not_fit_is_lost_to_a_slow_client(pair: tuple[Client, socket.socket]) -> None:
    client, far = pair
    client.send(b"")
    client.send(b"abc")
    assert far.recv(10) == b"abc" and client.lost == 0
    size = 50_000_000
    client.send(b"z" * size)
    taken = size - client.lost
    assert 0 < taken < size
    client.send(b"zz")
    assert client.lost == size - taken + 2
    far.close()
    client.send(b"z")
    assert client.gone and client.lost == size - taken + 2


def test_who_reads_gets_all_and_who_has_gone_is_forgotten(pair: tuple[Client, socket.socket]) -> None:
    client, far = pair
    client.deliver(b"ok\n")
    assert far.recv(10) == b"ok\n" and not client.gone
    assert client._connection.gettimeout() == 0.0
    far.close()
    client.deliver(b"x" * 10)
    assert client.gone
    client.close()
    assert client._connection.fileno() == -1


def test_it_waits_a_minute_for_who_does_not_read() -> None:
    waited: list[float] = []

    class Slow:
        def __getattr__(self, name: str) -> Any:
            return lambda *each: waited.append(each[0]) if name == "settimeout" else 0

    slow: Any = Slow()
    Client(slow, "x").deliver(b"a")
    assert waited == [60.0]


class Door:
    """A listening Unix socket and those who call."""

    def __init__(self, path: Path) -> None:
        self.path = str(path)
        self.callers: list[socket.socket] = []
        self.listener = socket.socket(socket.AF_UNIX)
        self.listener.bind(self.path)
        self.listener.listen(100)
        self.listener.setblocking(False)

    def call(self) -> socket.socket:
        caller = socket.socket(socket.AF_UNIX)
        caller.connect(self.path)
        self.callers.append(caller)
        return caller


@pytest.fixture
def door(tmp_path: Path) -> Iterator[Door]:
    found = Door(tmp_path / "d")
    yield found
    for each in (*found.callers, found.listener):
        each.close()


def test_a_client_of_a_network_is_called_by_its_host() -> None:
    known = Clients()
    known.listen(clients.listen("127.0.0.1", 0))
    with socket.create_connection(known._listener.getsockname()):
        (found,) = known.accept()
    assert found.peer == "127.0.0.1"
    known.close()


def test_clients_come_are_heard_and_go(door: Door) -> None:
    """Before it listens there is nobody; of two, the one that says something is ready."""
    known = Clients()
    assert known.accept() == []
    known.listen(door.listener)
    one, other = door.call(), door.call()
    first, second = known.accept()
    assert known.came == 2 and known.all == [first, second] and first.peer == ""
    one.sendall(b"a")
    assert known.accept() == []
    assert (first.ready, second.ready) == (True, False)
    first.lost, second.lost = 3, 4
    other.close()
    known.accept()
    assert second.receive() == b"" and second.gone
    assert known.lost == 7
    known.sweep()
    assert known.all == [first] and known.lost == 7 and known.came == 2
    known.close()
    known.close()
    assert door.listener.fileno() == -1
    assert known.all == [] and first.gone and known.lost == 7
    assert known.accept() == []


def test_of_too_many_the_later_ones_are_turned_away(door: Door, monkeypatch: pytest.MonkeyPatch) -> None:
    assert clients.LIMIT == 64
    monkeypatch.setattr(clients, "LIMIT", 2)
    known = Clients()
    known.listen(door.listener)
    callers = [door.call() for _ in range(3)]
    assert len(known.accept()) == 2 == known.came
    assert callers[2].recv(1) == b""
    known.close()


def test_it_waits_until_somebody_says_something_or_seconds_are_over(door: Door) -> None:
    asked: list[float] = []
    known: Any = Clients()
    known._poll = type("Poll", (), {"poll": lambda self, ms: asked.append(ms)})()
    known.wait(0.25)
    assert asked == [250.0]
