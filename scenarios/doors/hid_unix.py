"""`--hid unix:PATH`: the gateway's reports over a local socket, where the kernel has no uhid.

SOCK_SEQPACKET: one report of 64 bytes a message, both ways (65 with a leading 0 are taken too).
"""

import os
import socket
import stat
from pathlib import Path

from boards.silicon.hid import REPORT_BYTES
from host.logs.files import reason
from scenarios.doors.clients import Client, Clients
from scenarios.doors.door import counted
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.doors.usb import UsbPlug, out_report

_READS = 16  # Reports taken from one client in one look.


class UnixDoor:
    """Any number of host programs."""

    def __init__(self, path: str, served: LiveNetwork) -> None:
        self.name = f"--hid unix:{path}"
        self._path = Path(path)
        self._served = served
        self._clients = Clients()
        self._plug: UsbPlug | None = None
        self.rejected = 0

    def open(self) -> None:
        """Listen; raises OSError, with one line."""
        listener = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        try:
            self._clear()
            listener.bind(str(self._path))
            os.chmod(self._path, 0o600)
            listener.listen(16)
            listener.setblocking(False)
        except (OSError, ValueError) as error:
            listener.close()
            raise OSError(f"--hid unix: {self._path}: {reason(error)}") from None
        self._clients.listen(listener)
        self._plug = self._served.usb.plug(self.name)

    def _clear(self) -> None:
        """Remove the socket of a server that is no more; raises OSError when it lives."""
        try:
            mode = self._path.stat().st_mode
        except FileNotFoundError:
            return
        if not stat.S_ISSOCK(mode):
            raise OSError("exists and is no socket")
        with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as probe:
            try:
                probe.connect(str(self._path))
            except ConnectionRefusedError:
                self._path.unlink()
                return
        raise OSError("another server listens there")

    def poll(self, _now_ns: int) -> None:
        """Reports both ways; while the gateway is busy nothing is read, so that writers wait."""
        clients, plug = self._clients, self._plug
        if plug is None:
            return
        clients.accept()
        reports = plug.reports()
        for client in clients.all:
            for _, report in reports:
                client.send(report)
            self._take(client, plug)
        clients.sweep()

    def _take(self, client: Client, plug: UsbPlug) -> None:
        for _ in range(_READS):
            if not plug.ready:
                return
            data = client.receive()
            if not data:
                return
            report = out_report(data)
            if report is None:
                self.rejected += 1
            else:
                plug.write(self._served.now_ns, report)

    def close(self) -> None:
        """Hang up and remove the socket."""
        if self._plug is not None:
            self._plug.unplug()
            self._path.unlink(missing_ok=True)
        self._clients.close()
        self._plug = None

    def state(self) -> str:
        """How many came, and what did not pass."""
        return counted(
            (self._clients.came, "programs"),
            (self.rejected, f"were no reports of {REPORT_BYTES} bytes"),
            (self._clients.lost // REPORT_BYTES, "reports lost by slow readers"),
        )
