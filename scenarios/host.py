"""`schmidt host`: the host program by itself, on real cables or on a served network's."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from queue import Empty, SimpleQueue
from time import monotonic, sleep
from typing import TYPE_CHECKING

from rich.console import Console

from bus.protocol import Device
from host.client import TICK_NS
from host.links.ports import CanPort, HidrawPort, SerialPort, SocketPort
from host.links.task import LinkTask
from host.outside import Outside
from host.serial_link import SerialLink
from scenarios.doors import Keeper
from scenarios.doors.door import Door
from scenarios.doors.options import DoorOptions, astronomy
from scenarios.hosted import Hosted, dated
from scenarios.model import Scenario
from scenarios.networks import config_from, devices_of
from scenarios.served import chosen
from scenarios.session import log_headers

if TYPE_CHECKING:
    from host.console.heard import HeardBus
    from scenarios.doors.runs import RecordedRuns

SERIAL = ("AXIS_RA", "AXIS_DEC", "POSITION_RA", "POSITION_DEC", "FOCUS")
_SERIAL = "serial "


class HostProgram:
    """Links, telescope and doors on the PC's own clock."""

    def __init__(
        self,
        scenario: Path | None,
        usb: str,
        serial: dict[str, str],
        options: DoorOptions,
        console: Console,
        network: str | None = None,
    ) -> None:
        self.inbox: SimpleQueue[tuple[str, bytes]] = SimpleQueue()
        said: SimpleQueue[str] = SimpleQueue()
        self._said, self._console = said, console
        chosen_scenario, model = chosen(scenario, network_name=network)
        chosen_scenario = dated(chosen_scenario)
        boards = boards_of(chosen_scenario)
        self.hosted = Hosted(chosen_scenario, self._send, boards, options.logs)
        self.outside = Outside()
        self.usb = LinkTask(usb, lambda: _port(usb), self.inbox, said.put)
        self.tasks = [self.usb]
        self.serial: dict[str, SerialLink] = {}
        for board, url in serial.items():
            self.tasks.append(LinkTask(_SERIAL + board, _serial(url), self.inbox, said.put))
            self.serial[_SERIAL + board] = SerialLink(
                Device[board], self.hosted.journal, lambda _t, _packet: None
            )
        doors = astronomy(options, self)
        self._heard: HeardBus | None = None
        self._runs: RecordedRuns | None = None
        if options.console is not None:
            doors.append(self._consoles(options, log_headers(chosen_scenario, model), list(serial)))
        self.keepers = [Keeper(door, console.print) for door in doors]
        self._start_s = monotonic()

    def run(self, duration_s: float | None = None) -> None:
        """Until Ctrl-C, or for a time."""
        try:
            for keeper in self.keepers:
                keeper.open()
            for task in self.tasks:
                task.start()
            doors = ", ".join(keeper.door.name for keeper in self.keepers) or "no door"
            self._console.print(f"host on {self.usb.name} with {doors}; Ctrl-C ends it")
            while duration_s is None or monotonic() - self._start_s < duration_s:
                self.tick()
                sleep(max(0.0, TICK_NS * 1e-9 - (monotonic() - self._start_s) % (TICK_NS * 1e-9)))
        except KeyboardInterrupt:
            pass
        finally:
            self.close()

    def tick(self) -> None:
        """What has come in since the last one, then the telescope."""
        now_ns = round((monotonic() - self._start_s) * 1e9)
        for _ in range(self.inbox.qsize()):
            name, data = self.inbox.get()
            if name in self.serial:
                self.serial[name].receive(now_ns, data)
                if self._runs is not None:
                    self._runs.receive(now_ns, name.removeprefix(_SERIAL), data)
            else:
                self.hosted.link.receive(now_ns, data)
                if self._heard is not None:
                    self._heard.take(now_ns, data)
        self.hosted.poll(now_ns)
        for link in self.serial.values():
            link.watch(now_ns)
        for keeper in self.keepers:
            keeper.poll(now_ns)
        self._tell(now_ns)

    def close(self) -> None:
        """Doors, links, logs."""
        for keeper in self.keepers:
            keeper.close()
        self.outside.close()
        for task in self.tasks:
            task.close()
        self.hosted.close()

    def _consoles(self, options: DoorOptions, headers: dict[str, dict[str, str]], lines: list[str]) -> Door:
        """The consoles, for who asks: a web framework is much to import."""
        from host.console.heard import HeardBus
        from scenarios.doors.console import ConsoleDoor
        from scenarios.doors.runs import RecordedRuns

        assert options.console is not None
        self._heard = HeardBus(self.hosted.telescope.client)
        self._runs = RecordedRuns(options.runs, headers, self.hosted.journal, lines)
        return ConsoleDoor(options.console, options.token, self, self._heard, self._runs)

    def _tell(self, now_ns: int) -> None:
        while True:
            try:
                line = self._said.get_nowait()
            except Empty:
                return
            self._console.print(line)
            self.hosted.journal.status(now_ns, "LINK", line)

    def _send(self, _t_ns: int, report: bytes) -> None:
        self.usb.write(report)


def boards_of(scenario: Scenario) -> list[str]:
    """Names of the boards that a scenario's network has: those that should live."""
    config = config_from(scenario.network, {}, scenario.file.parent)
    return [device.name for device in devices_of(config)]


def _port(spec: str) -> HidrawPort | SocketPort | CanPort:
    kind, _, rest = spec.partition(":")
    if kind == "unix":
        return SocketPort(rest)
    return CanPort(rest) if kind == "can" else HidrawPort(spec)


def _serial(url: str) -> Callable[[], SerialPort]:
    return lambda: SerialPort(url)


def command(
    scenario: Path | None,
    usb: str,
    serial: tuple[str, ...],
    options: DoorOptions,
    duration_s: float | None = None,
    network: str | None = None,
) -> int:
    """Run the host; returns 0. Raises ValueError for what cannot be meant."""
    ports: dict[str, str] = {}
    for each in serial:
        board, equals, url = each.partition("=")
        if board not in SERIAL or not equals or not url:
            raise ValueError(f'--serial "{each}": expected BOARD=PORT, BOARD one of {", ".join(SERIAL)}')
        ports[board] = url
    HostProgram(scenario, usb, ports, options, Console(), network).run(duration_s)
    return 0
