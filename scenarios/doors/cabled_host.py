"""`schmidt host`: the host program by itself, on real cables or on a served network's."""

from functools import partial
from queue import SimpleQueue
from time import monotonic, sleep

from rich.console import Console

from bus.outside.external import parsed
from bus.protocol import Device
from host.client import TICK_NS
from host.console.heard import HeardBus
from host.console.runs import RecordedRuns
from host.links.ports import CanPort, HidPort, LinkTask, SerialPort
from host.serial_link import SerialLink
from scenarios.doors.options import HostOptions
from scenarios.doors.pc import Host, TelescopePc, dated
from scenarios.lab.networks import devices_in
from scenarios.lab.prepare import chosen
from scenarios.lab.session import log_headers

SERIAL = ("AXIS_RA", "AXIS_DEC", "POSITION_RA", "POSITION_DEC", "FOCUS")
_SERIAL = "serial "


class CabledHost(Host):
    """Links, telescope and doors on the PC's own clock."""

    def __init__(self, options: HostOptions, console: Console) -> None:
        """Raises ValueError for what cannot be meant."""
        ports = _ports(options.serial)
        self.inbox: SimpleQueue[tuple[str, bytes]] = SimpleQueue()
        said: SimpleQueue[str] = SimpleQueue()
        self._said, self._console = said, console
        scenario, model = chosen(options.scenario, network_name=options.network)
        scenario = dated(scenario)
        pc = TelescopePc(scenario, lambda _t, data: self.usb.write(data), devices_in(scenario), options.logs)
        if bus := options.usb.startswith("can:"):
            parsed(options.usb[4:])  # what cannot be meant is said now; a bus that is not there is waited for
        opener = partial(CanPort, options.usb[4:]) if bus else partial(HidPort, options.usb)
        self.usb = LinkTask(options.usb, opener, self.inbox, said.put)
        self.tasks = [self.usb]
        self.serial: dict[str, SerialLink] = {}
        for board, url in ports.items():
            self.tasks.append(LinkTask(_SERIAL + board, partial(SerialPort, url), self.inbox, said.put))
            self.serial[_SERIAL + board] = SerialLink(Device[board], pc.journal, lambda _t, _packet: None)
        self._heard = HeardBus(pc.telescope.client)
        runs = RecordedRuns(options.runs, log_headers(scenario, model), pc.journal, list(ports))
        super().__init__(pc, self._heard, runs, options, console.print)
        self._start_s = monotonic()

    def run(self, duration_s: float | None = None) -> None:
        """Until Ctrl-C, or for a time."""
        period_s = TICK_NS * 1e-9
        try:
            self.open()
            for task in self.tasks:
                task.start()
            doors = ", ".join(keeper.door.name for keeper in self.keepers) or "no door"
            self._console.print(f"host on {self.usb.name} with {doors}; Ctrl-C ends it")
            while duration_s is None or monotonic() - self._start_s < duration_s:
                self.tick()
                sleep(period_s - (monotonic() - self._start_s) % period_s)
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
                self.runs.receive(now_ns, name.removeprefix(_SERIAL), data)
            else:
                self.pc.link.receive(now_ns, data)
                self._heard.take(now_ns, data)
        self.pc.poll(now_ns)
        for link in self.serial.values():
            link.watch(now_ns)
        self.poll(now_ns)
        self._tell(now_ns)

    def close(self) -> None:
        """Links, too."""
        super().close()
        for task in self.tasks:
            task.close()

    def _tell(self, now_ns: int) -> None:
        while not self._said.empty():
            line = self._said.get()
            self._console.print(line)
            self.pc.journal.status(now_ns, "LINK", line)


def _ports(serial: tuple[str, ...]) -> dict[str, str]:
    """Ports of the RS232 lines, by board."""
    ports: dict[str, str] = {}
    for each in serial:
        board, equals, url = each.partition("=")
        if board not in SERIAL or not equals or not url:
            raise ValueError(f'--serial "{each}": expected BOARD=PORT, BOARD one of {", ".join(SERIAL)}')
        ports[board] = url
    return ports
