"""One serial port of the PC: bytes in, whole packets out; what breaks here stays here (H1)."""

from collections.abc import Callable
from typing import Final

from bus.protocol import Device
from bus.protocol.serial import PACKET_NS, Packet, PacketDecoder
from host.logs.files import LogError
from host.logs.journal import Logs

SILENCE_NS: Final = 4 * PACKET_NS
"""A port is silent when four packets have not come. ASSUMPTION."""


class SerialLink:
    """A port with its decoder. `receive` takes bytes as they arrive; `consume` gets every good packet.

    An error in `consume` is logged once and closes this link only. A disk that is full is everybody's trouble
    and is passed on.
    """

    def __init__(self, device: Device, logs: Logs, consume: Callable[[int, Packet], None]) -> None:
        self.device = device
        self.packets = 0
        self.lost = 0
        self.broken = False
        self.last_ns = 0
        self._logs = logs
        self._consume = consume
        self._decoder = PacketDecoder()
        self._sequence = -1
        self._crc_errors = 0
        self._silent = False

    def receive(self, t_ns: int, data: bytes) -> None:
        """Take bytes that arrived until `t_ns`."""
        if self.broken:
            return
        try:
            self._take(t_ns, data)
        except LogError:
            raise
        except Exception as error:  # the link's thread dies, the others live on (paper, section 5.1)
            self.broken = True
            self._logs.error(
                t_ns, f"{self.device.name} serial", f"link closed: {' '.join(str(error).split())}"
            )

    def watch(self, t_ns: int) -> None:
        """Log a silence once, and its end."""
        silent = t_ns - self.last_ns > SILENCE_NS
        if silent != self._silent:
            self._silent = silent
            if silent:
                self._logs.error(
                    t_ns, f"{self.device.name} serial", f"silent since {self.last_ns / 1e9:.2f} s"
                )
            else:
                self._logs.status(t_ns, f"{self.device.name} serial", "packets are back")

    def _take(self, t_ns: int, data: bytes) -> None:
        for packet in self._decoder.feed(data):
            if packet.device != self.device:
                raise ValueError(f"packets of device {packet.device:#04x} on this port")
            gap = (packet.sequence - self._sequence - 1) & 0xFF if self._sequence >= 0 else 0
            if gap:
                self.lost += gap
                self._logs.error(t_ns, f"{self.device.name} serial", f"{gap} packets missing")
            self._sequence = packet.sequence
            self.packets += 1
            self.last_ns = t_ns
            self._consume(t_ns, packet)
        if self._decoder.crc_errors != self._crc_errors:
            self._crc_errors = self._decoder.crc_errors
            self._logs.error(
                t_ns, f"{self.device.name} serial", f"{self._crc_errors} packets with a wrong CRC so far"
            )
