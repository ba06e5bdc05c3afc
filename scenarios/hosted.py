"""The host's telescope client on an emulated network: it ticks on the network's own queue."""

from __future__ import annotations

from pathlib import Path

from bus.protocol import Device
from host.client import TICK_NS, Client
from host.link import HidLink
from host.logs.ascii import AsciiLogs
from host.logs.journal import Journal
from host.logs.rotation import rotating
from host.logs.sensors import readings
from host.telescope import Observatory, Telescope
from scenarios.model import Scenario
from scenarios.network import Network


class Hosted:
    """A telescope client at the gateway's USB end of `network`.

    Its commands leave as HID reports at ticks of simulated time, so whoever records what enters the network
    records all of it. logs: folder of the four ASCII logs, or None.
    """

    def __init__(self, network: Network, scenario: Scenario, logs: Path | None = None) -> None:
        self.files = None if logs is None else AsciiLogs(logs, scenario.clock.iso, rotating)
        self.journal = Journal(self.files)
        self.observatory = Observatory(scenario.site, scenario.clock, scenario.mount, scenario.horizon_rad)
        link = HidLink(network.hid.write)
        network.hid.to_host = link.receive
        devices = tuple(device for device in Device if device.name in network.boards)
        self.telescope = Telescope(Client(link, self.journal, devices), self.observatory, self.journal)
        self._queue = network.queue
        self._log_ns = round(scenario.status_period_s * 1e9)
        self._next_log_ns = 0
        self._queue.at(self._queue.now_ns + TICK_NS, self._tick)

    def close(self) -> None:
        """Bring the logs to disk; whoever still waits for the telescope is told that it is gone."""
        self.telescope.close()
        if self.files is not None:
            self.files.close()

    def _tick(self, t_ns: int) -> None:
        self.telescope.tick(t_ns)
        if self.files is not None and t_ns >= self._next_log_ns:
            self._next_log_ns = t_ns + self._log_ns
            self.journal.sensors(t_ns, readings(self.telescope.client, self.observatory.mount))
        self._queue.at(t_ns + TICK_NS, self._tick)
