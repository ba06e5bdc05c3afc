"""The host's telescope client for a scenario: link, logs, telescope, ticked by whoever owns the time."""

import datetime as dt
from collections.abc import Callable, Coroutine, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path

from bus.protocol import Device
from host.camera.camera import Camera
from host.client import TICK_NS, Client
from host.console.runs import RecordedRuns
from host.console.views import BusView
from host.link import HidLink
from host.logs.clientguiding import ClientGuiding
from host.logs.journal import AsciiLogs, Journal, RotatingFile
from host.logs.sensors import readings
from host.lx200.server import Lx200
from host.outside import Outside, Service
from host.sky.observed import Clock
from host.telescope import Observatory, Telescope
from plant.deadzone import bias_steps
from scenarios.doors.door import Keeper
from scenarios.doors.options import DoorOptions
from scenarios.doors.table import ON_HOST, doors_on
from scenarios.lab.networks import in_order
from scenarios.lab.prepare import UNDATED
from scenarios.language.model import Scenario
from scenarios.language.plants import plant_model


def dated(scenario: Scenario) -> Scenario:
    """The scenario, with today's sky when it has no date."""
    if scenario.clock is not UNDATED:
        return scenario
    return replace(scenario, clock=Clock(dt.datetime.now(dt.UTC).replace(microsecond=0)))


class TelescopePc:
    """send: takes (t_ns, report), 64-byte OUT reports. devices: the boards that should live.
    logs: folder of the four ASCII logs, or None.

    A scenario without a date (the lab network) gets today's sky.
    """

    def __init__(
        self,
        scenario: Scenario,
        send: Callable[[int, bytes], None],
        devices: Sequence[Device],
        logs: Path | None = None,
    ) -> None:
        scenario = dated(scenario)
        self.clock = scenario.clock
        if logs is not None:
            logs.mkdir(parents=True, exist_ok=True)
        self.files = None if logs is None else AsciiLogs(logs, self.clock.iso, RotatingFile)
        self.journal = Journal(self.files)
        self.observatory = Observatory(scenario.site, self.clock, scenario.mount, scenario.horizon_rad)
        self.link = HidLink(send)
        client = Client(self.link, self.journal, in_order(devices))
        self.telescope = Telescope(client, self.observatory, self.journal)
        model = plant_model(scenario.plant, scenario.file.parent)
        self.telescope.drive.dec_bias_q8 = bias_steps(model, model.axes.dec.motor) << 8
        self.guiding = None if logs is None else ClientGuiding(logs / "guiding.txt", self.telescope)
        """Of clients that guide by an emulated camera."""
        self.cameras: tuple[Camera, ...] = ()
        """Of an emulated sky; a real telescope's cameras have programs of their own."""
        self._log_ns = round(scenario.status_period_s * 1e9)
        self._next_log_ns = 0
        self._next_ns = 0

    @cached_property
    def lx200(self) -> Lx200:
        """The handbox that all LX200 doors share."""
        return Lx200(self.telescope)

    def poll(self, t_ns: int) -> None:
        """Tick, when one is due, or at once for an emergency stop."""
        if t_ns >= self._next_ns:
            self._next_ns = max(self._next_ns + TICK_NS, t_ns + 1)
        elif not self.telescope.urgent:
            return
        self.telescope.tick(t_ns)
        if self.guiding is not None:
            self.guiding.tick()
        if self.files is not None and t_ns >= self._next_log_ns:
            self._next_log_ns = t_ns + self._log_ns
            self.journal.sensors(t_ns, readings(self.telescope.client, self.observatory.mount))
            self.files.flush()  # who follows a log reads it now, and a host that is killed has left it

    def close(self) -> None:
        """Bring the logs to disk; whoever still waits for the telescope is told that it is gone."""
        self.telescope.close()
        if self.guiding is not None:
            self.guiding.write()
        if self.files is not None:
            self.files.close()


class Host:
    """What doors for other programs stand on: the host program beside `schmidt serve`, or by itself.

    bus: the wire, for the bus page. runs: axis logs that a console records. outside: where servers run.
    say: takes lines for the user.
    """

    def __init__(
        self,
        pc: TelescopePc,
        bus: BusView,
        runs: RecordedRuns,
        options: DoorOptions,
        say: Callable[[str], None],
    ) -> None:
        self.pc = pc
        self.bus = bus
        self.runs = runs
        self.outside = Outside()
        self.keepers = [Keeper(door, say) for door in doors_on(ON_HOST, options, self)]

    def open(self) -> None:
        """Open the doors; raises OSError, ValueError."""
        for keeper in self.keepers:
            keeper.open()

    def poll(self, now_ns: int) -> None:
        """Look at the doors."""
        for keeper in self.keepers:
            keeper.poll(now_ns)

    def close(self) -> None:
        """Doors, servers, logs."""
        for keeper in self.keepers:
            keeper.close()
        self.outside.close()
        self.pc.close()


class ServerDoor:
    """A door on the host: servers in the host's own thread, one loop for all, until it is closed."""

    def __init__(self, name: str, host: Host) -> None:
        self.name = name
        self._host = host
        self._services: list[Service] = []

    def keep(self, work: Coroutine[object, object, object]) -> None:
        """Serve until the door closes; raises what that raises at once, OSError for a port that is taken."""
        self._services.append(self._host.outside.keep(work))

    def poll(self, _now_ns: int) -> None:
        """Servers run by themselves; only a broken one is noticed here."""
        for service in self._services:
            service.check()

    def close(self) -> None:
        """Hang up."""
        for service in self._services:
            service.cancel()
        self._services = []
