"""The telescope's PC on a live network's USB, ticked by the test and not in a process of its own."""

from pathlib import Path

from host.outside import Outside
from scenarios.doors.busview import Looks
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.doors.options import ServeOptions
from scenarios.doors.pc import TelescopePc
from scenarios.doors.piped_host import cameras


class HostInProcess:
    """It commands through a `UsbPlug` like any host program."""

    def __init__(self, served: LiveNetwork, logs: Path | None = None) -> None:
        self._plug = served.usb.plug("the host")
        self.pc = TelescopePc(served.scenario, self._plug.write, served.network.devices, logs)
        self.outside = Outside()
        self.looks = Looks(served)
        self._scenario = served.scenario

    def open_cameras(self, options: ServeOptions) -> None:
        self.pc.cameras = cameras(self._scenario, options, self.pc.guiding)

    def poll(self, now_ns: int) -> None:
        self.looks.wanted = any(camera.looking for camera in self.pc.cameras)
        self.looks.poll(now_ns)
        for look in self.looks.taken():
            for camera in self.pc.cameras:
                camera.take(look)
        for t_ns, report in self._plug.reports():
            self.pc.link.receive(t_ns, report)
        self.pc.poll(now_ns)

    def close(self) -> None:
        self.outside.close()
        self._plug.unplug()
        self.pc.close()
