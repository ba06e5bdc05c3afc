"""An attack on the consoles' websocket: a browser's handshake, then messages that no page sends.

The consoles run as they are served, on a socket; NiceGUI keeps its pages in the module, so there is one
server per process and every attack meets the same one.
"""

import json
import re
import select
import socket
import tempfile
import urllib.request
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

from nicegui import Client

from host.console.runs import RecordedRuns
from host.console.server import Consoles
from scenarios.doors.clients import listen
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.doors.piped_host import BusMirror
from scenarios.lab.prepare import chosen
from tests.fuzz import inputs
from tests.fuzz.left import counted
from tests.host.inprocess import HostInProcess

_PATHS = ("/", "/focus", "/alignment", "/maintenance", "/dome", "/bus", "/calibrate")
_NAMES = (
    "event",
    "handshake",
    "ack",
    "log",
    "javascript_response",
    "too_long_message",
    "disconnect",
    "x",
    "",
)
_KEYS = ("client_id", "id", "listener_id", "args", "next_message_id", "tab_id", "old_tab_id", "document_id",
         "request_id", "result", "level")  # fmt: skip
_ODD: tuple[Any, ...] = (None, True, -1, 0, 3, 1e308, 10**30, "", "x", "\0", "é", [], [[]], {}, {"a": 1})
_PACKETS = (
    "0",
    "1",
    "2",
    "3",
    "4",
    "40",
    "41",
    "42",
    "43",
    "44",
    "45",
    "451-",
    "46",
    "5",
    "6",
    "7",
    "42/x,",
    "421",
)


_EACH = 50
"""Messages of one browser: some of them make the server forget it, and it is deaf to the next."""
_FAREWELL = ("41", b"41")
_RETURNS = 8
"""Websockets of one page, as a browser's that lost its connection: a page costs a hundred messages."""


class Server:
    """The consoles of a served network."""

    def __init__(self) -> None:
        self.served = LiveNetwork(*chosen())
        self.host = HostInProcess(self.served)
        runs = RecordedRuns(Path(tempfile.mkdtemp()), {}, self.host.pc.journal)
        bus = BusMirror(list(self.served.network.boards), [], lambda _wish: None)
        self.consoles = Consoles(self.host.pc.telescope, bus, runs, "word")
        listener = listen("127.0.0.1", 0)
        self.port = int(listener.getsockname()[1])
        self.service = self.host.outside.keep(self.consoles.serve(listener))
        self.tick()

    def tick(self) -> None:
        """What serve does."""
        self.host.poll(self.served.now_ns)
        self.served.run_until(self.served.now_ns + 50_000_000)
        self.host.poll(self.served.now_ns)

    def page(self, path: str) -> tuple[str, list[int]]:
        """A page as a browser gets it: its client's id and its elements' ids."""
        with urllib.request.urlopen(f"http://127.0.0.1:{self.port}{path}", timeout=60) as answer:
            text = answer.read().decode()
        (client,) = re.findall(r"client_id[\"']?:\s*[\"']([0-9a-f-]{36})", text)[:1]
        return client, [int(each) for each in re.findall(r"\"(\d+)\":\s*\{", text)] or [1]


@cache
def server() -> Server:
    """The one of this process."""
    return Server()


class Browser:
    """A websocket that has shaken hands (RFC 6455, masked with zeros; Engine.IO 4 inside)."""

    def __init__(self, at: Server, path: str, page: tuple[str, list[int]] | None = None) -> None:
        self.client, self.elements = page or at.page(path)
        self.socket = socket.create_connection(("127.0.0.1", at.port), 60)
        self.socket.sendall(
            b"GET /_nicegui_ws/socket.io/?EIO=4&transport=websocket HTTP/1.1\r\nHost: localhost\r\n"
            b"Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
            b"Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n"
        )
        assert b" 101 " in self.socket.recv(4096)
        self.send("40")
        hello = {"client_id": self.client, "tab_id": "t", "document_id": "d", "next_message_id": 0}
        self.send("421" + json.dumps(["handshake", hello]))

    def send(self, message: str | bytes) -> None:
        """One frame; what the server has said meanwhile is read and forgotten. OSError: hung up."""
        data = message.encode("utf-8", "surrogatepass") if isinstance(message, str) else message
        length = bytes([0x80 | len(data)]) if len(data) < 126 else b"\xfe" + len(data).to_bytes(2, "big")
        self.socket.sendall(bytes([0x81 if isinstance(message, str) else 0x82]) + length + bytes(4) + data)
        while select.select([self.socket], [], [], 0)[0]:
            if not self.socket.recv(1 << 20):
                raise OSError("hung up")

    def close(self) -> None:
        """As a tab that is closed."""
        self.socket.close()


def _message(random: Random, browser: Browser) -> str | bytes:
    """Mostly an event of the page with something wrong; else another packet, or noise."""
    kind = random.random()
    if kind < 0.1:
        return inputs.data(random, 60) if random.random() < 0.5 else random.choice(_PACKETS) + "x" * 3
    said: dict[str, Any] = {
        "client_id": browser.client, "id": random.choice(browser.elements), "args": random.choice(_ODD),
        "listener_id": f"{random.choice(browser.elements)}", "next_message_id": random.choice(_ODD),
        "request_id": "r", "result": 1, "tab_id": "t", "document_id": "d", "level": "info",
    }  # fmt: skip
    for _ in range(random.randrange(3)):
        key = random.choice(_KEYS)
        if random.random() < 0.4:
            said.pop(key, None)
        else:
            said[key] = random.choice(_ODD)
    body: Any = said if random.random() < 0.9 else random.choice(_ODD)
    name = "event" if random.random() < 0.6 else random.choice(_NAMES)
    text = json.dumps([name, body])
    if kind < 0.2:
        text = text[: random.randrange(len(text))]
    return random.choice(_PACKETS) + text if kind < 0.3 else "42" + text


def websocket(count: int, random: Random) -> dict[str, int]:
    """Messages of a browser. Afterwards the server answers, and all boards tick."""
    from tests.fuzz.doors import ticking

    at = server()
    before = at.consoles.refused
    found = {"accepted": 0, "hung up": 0}
    browser, returns = Browser(at, "/"), 0

    def again() -> Browser:
        """The same page on a new websocket, as long as the server knows it; else another page."""
        nonlocal returns
        browser.close()
        returns = returns + 1 if returns < _RETURNS and browser.client in Client.instances else 0
        page = (browser.client, browser.elements) if returns else None
        return Browser(at, random.choice(_PATHS), page)

    for number in counted(count):
        message = _message(random, browser)
        try:
            browser.send(message)
            found["accepted"] += 1
            if number % _EACH == _EACH - 1 or message[:2] in _FAREWELL or message[:1] in ("1", b"1"):
                browser = again()
        except OSError:  # whoever breaks the protocol is hung up on
            found["hung up"] += 1
            browser = again()
        if number % 50 == 0:
            at.tick()
        if number % 2000 == 1999:
            ticking(at.served)
            at.service.check()
    browser.close()
    ticking(at.served)
    at.service.check()
    at.page("/")
    refused = at.consoles.refused - before
    return {**found, "accepted": found["accepted"] - refused, "refused": refused}
