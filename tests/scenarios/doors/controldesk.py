"""A control door with one client, over a network that only writes down."""

from typing import Any

from scenarios.doors.control import ControlDoor
from tests.scenarios.doors.served import StubClient, StubClients, stub_served

FAR = "192.0.2.7"  # TEST-NET-1: another machine's


class Desk:
    """A control door with a client of this machine."""

    def __init__(self, peer: str = "127.0.0.1", token: str | None = "word") -> None:
        self.served = stub_served()
        door: Any = ControlDoor("7411", token, self.served)
        self.door, self.clients = door, StubClients()
        door._clients = self.clients
        self.client = self.come(peer)

    def come(self, peer: str) -> StubClient:
        client = StubClient(peer)
        self.clients.new.append(client)
        self.door.poll(0)
        return client

    def __call__(self, line: str) -> str:
        self.client.heard.clear()
        self.client.says.append(line.encode() + b"\n")
        self.door.poll(0)
        return b"".join(self.client.heard).decode()
