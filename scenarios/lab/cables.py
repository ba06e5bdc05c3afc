"""A network without a gateway: the host reaches every board by its serial line (H1, L3)."""

from boards.core.debug import DebugPort, frame_of, line_of
from bus.can import Frame
from bus.protocol import COMMAND_BASE
from bus.protocol.report import ReportError, pack_report, slot, unpack_commands
from host.link import HidLink


class Cables:
    """Joins the debug ports of a network to a host's link. Reports of commands go out line by line; frames
    come back in reports of one slot.

    ports: by device type.
    """

    def __init__(self, ports: dict[int, DebugPort]) -> None:
        self.ports = ports
        self.links = {device: _Ear(self) for device in ports}
        self.link: HidLink | None = None

    def plug(self, link: HidLink, t_ns: int) -> None:
        """Open all ports and listen."""
        self.link = link
        for device, port in self.ports.items():
            port.sink = self.links[device].hear
            port.write(t_ns, b"O\r")

    def write(self, t_ns: int, report: bytes) -> None:
        """A 64-byte OUT report: each command goes to its own board; one for nobody is lost."""
        for frame in unpack_commands(report):
            port = self.ports.get(frame.identifier - COMMAND_BASE)
            if port is not None:
                port.write(t_ns, line_of(frame))


class _Ear:
    """One cable's listener; bytes may come cut anywhere."""

    def __init__(self, cables: Cables) -> None:
        self.cables = cables
        self.partial = b""

    def hear(self, t_ns: int, data: bytes) -> None:
        *lines, self.partial = (self.partial + data).split(b"\r")
        for line in lines:
            frame = frame_of(line)
            if frame is not None:
                self._deliver(t_ns, frame)

    def _deliver(self, t_ns: int, frame: Frame) -> None:
        if self.cables.link is None:
            return
        try:
            self.cables.link.receive(t_ns, pack_report([slot(frame)]))
        except ReportError:
            return
