"""A served telescope with its Alpaca door, at 30 times real time."""

import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from host.alpaca import discovery
from host.alpaca.server import Alpaca
from scenarios.doors.clients import listen
from tests.host.live import Live

DISCOVERY_PORT = 32227


class AlpacaLive(Live):
    def __init__(self, logs: Path, network: str = "lab", speed: float = 30.0, cameras: bool = False) -> None:
        super().__init__(logs, speed, network=network, cameras=cameras)
        self.logs = logs
        self.alpaca = Alpaca(self.telescope, self.host.pc.cameras)
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = int(probe.getsockname()[1])
        self.outside.keep(self.alpaca.serve(listen("127.0.0.1", self.port)))
        self.outside.keep(discovery.serve(self.port, local_only=True))
        self.address = f"127.0.0.1:{self.port}"


@pytest.fixture(scope="module")
def final(tmp_path_factory: pytest.TempPathFactory) -> Iterator[AlpacaLive]:
    """The network that has dome and weather; slower, so that a client sees the shutter on its way."""
    made = AlpacaLive(tmp_path_factory.mktemp("final"), "final", 5.0)
    yield made
    made.close()


@pytest.fixture(scope="module")
def live(tmp_path_factory: pytest.TempPathFactory) -> Iterator[AlpacaLive]:
    made = AlpacaLive(tmp_path_factory.mktemp("alpaca"), cameras=True)
    yield made
    made.close()
