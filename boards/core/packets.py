"""The RS232 line of a board: 25 samples as a packet (`bus/protocol/serial.py`).

A sample leaves when it is taken, so the board keeps no packet: its chip has no room for one. The whole is
packed when the last sample is taken. Only who listens to single bytes (`Uart.line`) hears the parts before.
"""

from collections.abc import Sequence

from boards.core.place import Place
from boards.silicon.uart import Uart
from bus.protocol.saturate import Clip
from bus.protocol.serial import SAMPLES, STAMP_UNIT_NS, ahead_bytes, pack_head, pack_packet, pack_rows


class PacketLine:
    """clip: told when a sample did not fit its field. sequence: of the next packet."""

    def __init__(self, place: Place, clip: Clip) -> None:
        self.uart = Uart(place.queue)
        self.sequence = 0
        self._device_type = place.device_type
        self._oscillator = place.oscillator
        self._clip = clip
        self._ahead = ahead_bytes(place.device_type)
        self._stamp = 0
        self._samples: list[Sequence[int]] = []

    def clear(self) -> None:
        """After power-up: the packet begins afresh."""
        self._samples = []

    def take(self, t_ns: int, end_ns: int, sample: Sequence[int]) -> None:
        """A sample of `t_ns`, which leaves at `end_ns`."""
        samples = self._samples
        if not samples:
            self._stamp = self._oscillator.local_ns(t_ns) // STAMP_UNIT_NS
        samples.append(sample)
        if len(samples) == SAMPLES:
            packet = pack_packet(self._device_type, self.sequence, self._stamp, samples, self._clip)
            self.uart.send(end_ns, packet, len(packet) - self._ahead)
            self.sequence = self.sequence + 1 & 0xFF
            self._samples = []
        elif self.uart.line is not None:
            head = b"" if samples[1:] else pack_head(self._device_type, self.sequence, self._stamp)
            self.uart.part(end_ns, head + pack_rows(self._device_type, samples[-1:]))
