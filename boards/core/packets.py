"""The RS232 line of a board: its last 25 samples as a packet (`bus/protocol/serial.py`)."""

from collections.abc import Sequence

from boards.core.place import Place
from boards.silicon.uart import Uart
from bus.protocol.saturate import Clip
from bus.protocol.serial import SAMPLES, STAMP_UNIT_NS, pack_packet


class PacketLine:
    """clip: told when a sample did not fit its field. sequence: of the next packet."""

    def __init__(self, place: Place, clip: Clip) -> None:
        self.uart = Uart(place.queue)
        self.sequence = 0
        self._device_type = place.device_type
        self._oscillator = place.oscillator
        self._clip = clip
        self._stamp = 0
        self._samples: list[Sequence[int]] = []

    def clear(self) -> None:
        """After power-up: the packet begins afresh."""
        self._samples = []

    def take(self, t_ns: int, end_ns: int, sample: Sequence[int]) -> None:
        """A sample of `t_ns`; the packet that it fills is sent at `end_ns`."""
        samples = self._samples
        if not samples:
            self._stamp = self._oscillator.local_ns(t_ns) // STAMP_UNIT_NS
        samples.append(sample)
        if len(samples) == SAMPLES:
            packet = pack_packet(self._device_type, self.sequence, self._stamp, samples, self._clip)
            self.uart.send(end_ns, packet)
            self.sequence = self.sequence + 1 & 0xFF
            self._samples = []
