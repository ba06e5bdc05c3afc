"""One run, wired: plant, boards, host and recorder on one event queue."""

from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import partial
from pathlib import Path

import numpy as np

from boards.core.debug import DebugPort, frame_of, line_of
from bus.protocol import COMMAND_BASE, Device
from bus.protocol.report import ReportError, pack_report, slot, unpack_commands
from host.client import TICK_NS, Client
from host.link import HidLink
from host.logs.sensors import readings
from host.procedures.manual import AXES
from plant.model import PlantModel
from scenarios.lab.eye import Eye
from scenarios.lab.faults.live import Faults
from scenarios.lab.network import Network
from scenarios.lab.networks import SERIAL, in_order
from scenarios.lab.recorder import Recorder
from scenarios.lab.wiring import powered
from scenarios.language.model import Scenario
from scenarios.language.programme import Programme


class Cables:
    """Joins the debug ports of a network without a gateway to a host's link (H1, L3). Reports of commands go
    out line by line; frames come back in reports of one slot.

    ports: by device type.
    """

    def __init__(self, ports: dict[int, DebugPort]) -> None:
        self.ports = ports
        self._partial = dict.fromkeys(ports, b"")
        """Of each cable, what has come of a line: bytes may come cut anywhere."""

    def plug(self, link: HidLink, t_ns: int) -> None:
        """Open all ports and listen."""
        for device, port in self.ports.items():
            port.sink = partial(self._hear, link, device)
            port.write(t_ns, b"O\r")

    def write(self, t_ns: int, report: bytes) -> None:
        """A 64-byte OUT report: each command goes to its own board; one for nobody is lost."""
        for frame in unpack_commands(report):
            port = self.ports.get(frame.identifier - COMMAND_BASE)
            if port is not None:
                port.write(t_ns, line_of(frame))

    def _hear(self, link: HidLink, device: int, t_ns: int, data: bytes) -> None:
        *lines, self._partial[device] = (self._partial[device] + data).split(b"\r")
        for line in lines:
            frame = frame_of(line)
            if frame is not None:
                with suppress(ReportError):
                    link.receive(t_ns, pack_report([slot(frame)]))


Rows = tuple[tuple[float, ...], tuple[float, ...]]
"""Of the host's trace and of the focus', at one tick."""


class Session:
    """Everything of one run. Build it, call `advance` until `programme.finished`, then `recorder.close`."""

    def __init__(self, scenario: Scenario, model: PlantModel, folder: Path) -> None:
        self.scenario = scenario
        self.network = powered(scenario, model)
        self.plant = self.network.plant
        self.recorder = Recorder(folder, scenario, self.plant, log_headers(scenario, model))
        self.network.wire.tap(self.recorder.can.take)
        self.link = plugged(self.network)
        self.client = Client(self.link, self.recorder.ascii, in_order(self.network.devices))
        self.serial = [self.recorder.link(device) for device in SERIAL]
        for link in self.serial:
            self.network.uarts[link.device.name].sink = link.receive
        self.eye = Eye(self.plant, scenario)
        if self.network.chain is not None:
            self.network.chain.told = self.chain_says
        self.programme = Programme(scenario, self.client, self.recorder.ascii, self.eye)
        self.faults = Faults(self.network, scenario.seed)
        self.faults.schedule(scenario.faults)
        self.ticked: Callable[[int], None] | None = None
        """Told of every tick, for who records what the host hears."""
        self.rows: list[Rows] = []
        """All so far, while somebody records."""
        self._status_ns = round(scenario.status_period_s * 1e9)
        self._next_status_ns = 0
        self._rows: list[Rows] = []
        self.network.queue.at(TICK_NS, self._tick)

    def advance(self, t_ns: int) -> None:
        """Let simulated time go on to `t_ns`."""
        self.network.queue.run_until(t_ns)
        self.flush_traces()

    def flush_traces(self) -> None:
        """Hand the host's rows to their traces."""
        if self._rows:
            host, focus = zip(*self._rows, strict=True)
            self.recorder.host.append(np.array(host))
            self.recorder.focus.append(np.array(focus))
            if self.ticked is not None:
                self.rows += self._rows
            self._rows.clear()

    def chain_says(self, t_ns: int, text: str) -> None:
        """A contact of the safety chain on the observer's PC (ASSUMPTION): a line in the error log."""
        self.recorder.ascii.error(t_ns, "CHAIN", text)

    def adopt(self, network: Network) -> None:
        """Go on with another network, one that has been where this host is."""
        self.network = network
        self.plant = self.eye.plant = network.plant
        self.recorder.adopt(network.plant)
        self.link._send = network.hid.write

    def begin_traces(self, rows: Iterable[Rows]) -> None:
        """The traces of the host begin with these."""
        self._rows[:] = rows
        self.flush_traces()

    def _tick(self, t_ns: int) -> None:
        if self.ticked is not None:
            self.ticked(t_ns)
        self.work(t_ns)
        self.network.queue.at(t_ns + TICK_NS, self._tick)

    def work(self, t_ns: int) -> None:
        """What the host does every 50 ms."""
        self.client.now_ns = t_ns
        self.programme.tick(t_ns)
        self.client.tick(t_ns)
        self._record(t_ns)
        if t_ns >= self._next_status_ns:
            self._next_status_ns += self._status_ns
            self.recorder.ascii.sensors(t_ns, readings(self.client, self.scenario.mount))
            for link in self.serial:
                link.watch(t_ns)

    def _record(self, t_ns: int) -> None:
        client = self.client
        ra, dec = client.position(Device.POSITION_RA), client.position(Device.POSITION_DEC)
        errors = self.programme.pointing.errors_arcsec()
        focus = client.focus()
        nan = float("nan")
        seen = (
            t_ns * 1e-9,
            ra.position if ra else nan,
            dec.position if dec else nan,
            *(errors or (nan, nan)),
            focus.position if focus else nan,
        )
        port = self.plant.focus
        self._rows.append((seen, (t_ns * 1e-9, port.position(t_ns), float(port.encoder(t_ns)))))


def plugged(network: Network) -> HidLink:
    """The host's link: the gateway's USB, or every board's debug port where there is no gateway."""
    if Device.GATEWAY.name in network.boards:
        link = HidLink(network.hid.write)
        network.hid.to_host = link.receive
        return link
    cables = Cables({board.device_type: network.debug[name] for name, board in network.boards.items()})
    link = HidLink(cables.write)
    cables.plug(link, network.queue.now_ns)
    for voice in network.voices.values():
        voice.start_alone()  # there is nobody who could send NMT
    return link


def log_headers(scenario: Scenario, model: PlantModel) -> dict[str, dict[str, str]]:
    """Header of each axis log; `loop` is open when every step that moves the axis directly is open loop."""
    stamp = scenario.clock.iso(0.0)
    name = model.name.lower()
    headers = {}
    for axis in AXES:
        actions = {step.action for step in scenario.steps if step.arguments.get("axis") == axis}
        closed = {step.action for step in scenario.steps} & {"goto", "park"} or actions & {"move", "set_rate"}
        headers[axis] = {
            "axis": axis,
            "session": f"{scenario.name} seed {scenario.seed}",
            "loop": "open" if "open_loop" in actions and not closed else "closed",
            "start_utc": stamp,
            "counter_torque": f"{model.controller.counter_split.si:.2f}",
            "supply_V": f"{model.supply.voltage.si:g}",
            "temperature_C": f"{scenario.site.temperature_c:g}",
            "note": f"schmidt, plant {model.name}",
        }
        for preload in ("low", "high"):
            if preload in name:
                headers[axis]["preload"] = preload
    return headers
