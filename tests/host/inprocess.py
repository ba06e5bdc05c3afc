"""The telescope's PC on a live network's USB, ticked by the test and not in a process of its own."""

from pathlib import Path

from host.outside import Outside
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.doors.pc import TelescopePc


class HostInProcess:
    """It commands through a `UsbPlug` like any host program."""

    def __init__(self, served: LiveNetwork, logs: Path | None = None) -> None:
        self._plug = served.usb.plug("the host")
        self.pc = TelescopePc(served.scenario, self._plug.write, served.network.devices, logs)
        self.outside = Outside()

    def poll(self, now_ns: int) -> None:
        for t_ns, report in self._plug.reports():
            self.pc.link.receive(t_ns, report)
        self.pc.poll(now_ns)

    def close(self) -> None:
        self.outside.close()
        self._plug.unplug()
        self.pc.close()
