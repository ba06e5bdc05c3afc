"""Doors that only join a server or a bus to the host or the network: over stand-ins of both."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from host.sky.listed import VARIABLE
from scenarios.doors import alpaca, can, console, serial_tcp
from scenarios.doors.alpaca import AlpacaDoor
from scenarios.doors.can import CanDoor
from scenarios.doors.console import ConsoleDoor
from scenarios.doors.control import TOKEN_VARIABLE
from scenarios.doors.lx200 import Lx200Door
from scenarios.doors.serial_tcp import TcpDoor
from tests.scenarios.doors.served import StubClient, StubClients, stub


class Fence:
    """Where a bus meets the wire."""

    def __init__(self, *made: Any) -> None:
        self.made = made
        self.told: list[str] = []
        self.frames_in, self.frames_out, self.system_lost = 3, 4, 2
        self.refused = self.rejected = self.lost_out = 0

    def poll(self) -> None:
        self.told.append("poll")

    def close(self) -> None:
        self.told.append("close")
        self.system_lost = 5


def test_a_bus_outside_is_joined_for_as_long_as_it_is_open(monkeypatch: pytest.MonkeyPatch) -> None:
    """What was lost before it was opened again counts, too."""
    down: list[str] = []
    entered: list[Any] = []
    monkeypatch.setattr(can, "open_bus", lambda spec: stub(shutdown=lambda: down.append(spec)))
    monkeypatch.setattr(can, "Fence", Fence)
    network = stub(queue="queue", wire="wire")
    node, frame = "node {}".format, lambda *given: entered.append(given)
    door: Any = CanDoor("virtual:x", 2, stub(network=network, node=node, frame=frame))
    door.poll(0)
    door.close()
    assert door.state() == "" and door.name == "--can virtual:x" and down == []
    door.open()
    first = door.fence
    assert first.made[:2] == ("queue", "wire") and first.made[3] == door.node == "node 2"
    first.made[4]("frame")
    assert entered == [(2, "frame")]
    door.poll(0)
    assert first.told == ["poll"]
    assert door.state() == "3 frames in, 4 frames out, 2 dropped by the system's buffer"
    door.close()
    assert first.told == ["poll", "close"] and down == ["virtual:x"] and door.fence is None
    door.poll(0)
    door.close()
    assert door.state() == "3 frames in, 4 frames out, 5 dropped by the system's buffer" and len(down) == 1
    door.open()
    assert door.state() == "6 frames in, 8 frames out, 7 dropped by the system's buffer"
    door.close()
    assert door.state() == "6 frames in, 8 frames out, 10 dropped by the system's buffer"


class Kept:
    """A host whose servers are only written down."""

    def __init__(self, folder: Path = Path()) -> None:
        self.served: list[Any] = []
        self.polled: list[str] = []
        self.pc = stub(telescope="telescope", cameras=("camera",), lx200=self)
        self.runs = stub(folder=folder, poll=lambda: self.polled.append("runs"),
                         close=lambda: self.polled.append("closed"))  # fmt: skip
        self.bus = "bus"
        self.outside = stub(keep=self.keep, run=lambda work: stub(serve_forever=lambda: ("forever", work)))
        self.come: Callable[[], None] | None = None
        self.error: OSError | None = None

    def keep(self, work: Any) -> Any:
        if self.error is not None:
            raise self.error
        self.served.append(work)
        return stub(check=lambda: self.polled.append("check"), cancel=lambda: self.polled.append("cancel"))

    def serve_pty(self, path: Path, come: Any) -> Any:
        self.come = come
        return "pty", path

    def serve_tcp(self, host: str, port: int, come: Any) -> Any:
        self.come = come
        return "tcp", host, port


def test_alpaca_serves_with_or_without_discovery(monkeypatch: pytest.MonkeyPatch) -> None:
    def discover(port: int, local: bool) -> Any:
        if error:
            raise error.pop()
        return "discovery", port, local

    server = stub(serve=lambda listener: ("alpaca", listener), requests=3)
    monkeypatch.setattr(alpaca, "Alpaca", lambda telescope, cameras: server)
    monkeypatch.setattr(alpaca, "listen", lambda host, port: (host, port))
    monkeypatch.setattr(alpaca, "discover", discover)
    error: list[OSError] = []
    host: Any = Kept()
    door = AlpacaDoor("11111", host)
    assert door.name == "--alpaca 11111" and door.state() == "3 requests"
    door.open()
    local = "127.0.0.1"
    assert host.served == [("alpaca", (local, 11111)), ("discovery", 11111, True)]
    door.poll(0)
    door.close()
    assert host.polled == ["check", "check", "cancel", "cancel"]
    error.append(OSError(98, "in use"))
    door.open()
    assert door.name == "--alpaca 11111 (no discovery: in use)"
    door.open()
    assert door.name == "--alpaca 11111"


@pytest.mark.parametrize(("where", "token", "variable", "made", "said"), [
    ("8080", None, None, "made of 16", ""), ("8080", "word", "other", "word", ""),
    ("0.0.0.0:8080", "word", None, "word", ""),
    ("0.0.0.0:8080", None, None, "made of 16", " (open it with ?token=made of 16)"),
    ("0.0.0.0:8080", None, "other", "other", " (open it with ?token=other)"),
])  # fmt: skip
def test_a_console_has_a_token_for_other_machines(
    where: str, token: str | None, variable: str | None, made: str, said: str, tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """One that is given, else the environment's, else one that is made up. The first is not told again."""
    monkeypatch.delenv(TOKEN_VARIABLE, raising=False)
    if variable is not None:
        monkeypatch.setenv(TOKEN_VARIABLE, variable)
    monkeypatch.setattr(console, "listed", lambda: None)
    monkeypatch.setattr(console, "secrets", stub(token_urlsafe=lambda count: f"made of {count}"))
    tokens: list[str] = []
    pages = stub(serve=lambda listener: ("console", listener), pages=4, refused=0)

    def consoles(telescope: str, bus: str, runs: Any, token: str) -> Any:
        tokens.append(token)
        return pages

    monkeypatch.setattr(console, "Consoles", consoles)
    monkeypatch.setattr(console, "listen", lambda host, port: port)
    host: Any = Kept(tmp_path / "a" / "b")
    for _ in range(2):  # the folder may be there
        door = ConsoleDoor(where, token, host)
    assert tokens == [made] * 2 and door.name == f"--console {where}{said}" and host.runs.folder.is_dir()
    door.open()
    door.poll(0)
    assert host.served == [("console", 8080)] and host.polled == ["runs", "check"]
    door.close()
    assert host.polled[2:] == ["cancel", "closed"] and door.state() == "4 pages shown"
    host.error = OSError(98, "in use")
    with pytest.raises(OSError, match=r": in use$"):
        door.open()


def test_a_console_says_what_it_cannot_make_or_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken() -> None:
        raise ValueError("no list")

    monkeypatch.setattr(console, "listed", broken)
    host: Any = Kept(tmp_path)
    with pytest.raises(OSError, match=rf"^{VARIABLE}: no list$"):
        ConsoleDoor("8080", None, host)
    (tmp_path / "file").touch()
    host.runs.folder = tmp_path / "file"
    with pytest.raises(OSError, match=r"^--runs .*file: cannot be made: File exists$"):
        ConsoleDoor("8080", None, host)


@pytest.mark.parametrize(("spec", "served"), [
    ("4030", ("forever", ("tcp", "127.0.0.1", 4030))), ("pty:lx", ("pty", Path("lx"))),
])  # fmt: skip
def test_lx200_is_a_port_or_a_pseudo_terminal(spec: str, served: Any) -> None:
    host: Any = Kept()
    door = Lx200Door(spec, host)
    door.open()
    assert host.served == [served] and door.state() == "" and door.name == f"--lx200 {spec}"
    host.come()
    host.come()
    assert door.state() == "2 clients"
    host.error = OSError(98, "in use")
    with pytest.raises(OSError, match=rf"^--lx200 {spec}: in use$"):
        door.open()
    with pytest.raises(ValueError, match="--lx200"):
        Lx200Door("pty:", host)


class LineClients(StubClients):
    """Of one line; those before are listening at `port`."""

    lost = 0

    def listen(self, port: int) -> None:
        if port == 7001 and BUSY:
            raise OSError("in use")
        self.port = port


BUSY: list[bool] = []


def test_lines_are_ports_in_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    """A port that is taken closes those before it."""
    dropped: list[str] = []
    feeds = {"AXIS_RA": b"ra", "FOCUS": b"focus"}
    lines = stub(
        uarts=feeds, feed=lambda name: stub(until=lambda now_ns: feeds[name] + b"%d" % now_ns),
        drop=lambda name, feed: dropped.append(name),
    )  # fmt: skip
    monkeypatch.setattr(serial_tcp, "Clients", LineClients)
    monkeypatch.setattr(serial_tcp, "listen", lambda host, port: port)
    door: Any = TcpDoor("7000", stub(lines=lines))
    BUSY.append(True)
    with pytest.raises(OSError, match="in use"):
        door.open()
    assert dropped == ["AXIS_RA"]
    BUSY.clear()
    dropped.clear()
    door.open()
    assert [clients.port for clients in door._clients.values()] == [7000, 7001]
    client, gone = StubClient("127.0.0.1", b"unheard"), StubClient()
    gone.gone = True
    door._clients["FOCUS"].new += [client, gone]
    door._clients["AXIS_RA"].lost = 8
    door.poll(5)
    assert client.heard == [b"focus5"] and client.says == [] and door._clients["FOCUS"].all == [client]
    assert door.state() == "2 at FOCUS, 8 bytes lost by slow readers"
    door.close()
    assert dropped == ["AXIS_RA", "FOCUS"] and door._clients["FOCUS"].all == []
    door.close()
    assert len(dropped) == 2
