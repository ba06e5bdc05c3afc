"""Ten-bit ADC with its triggers (FRM section 17)."""

from collections.abc import Callable

from boards.chips.dspic30f.registers import CHANNELS, CONVERSION_TAD, Ssrc, registers
from boards.silicon.adc import convert

BUFFERS = 16


class Adc:
    """pin: (t_ns, channel 0..3) -> V. registers: ADCON1..3. buffers: ADCBUF0..F. interrupt: ADIF,
    for firmware to clear.

    tcy_ns: an instruction cycle; TAD = Tcy (ADCS + 1) / 2. All channels are held at the trigger (SIMSAM).
    """

    def __init__(self, pin: Callable[[int, int], float], tcy_ns: float) -> None:
        self.pin = pin
        self.registers = registers(ADCON1=0, ADCON2=0, ADCON3=0)
        self.buffers = [0] * BUFFERS
        self.interrupt = False
        self._tcy_ns = tcy_ns
        self._fill = 0
        self._samples = 0
        self._ready_ns = 0.0

    @property
    def tad_ns(self) -> float:
        """Conversion clock."""
        return self._tcy_ns * (self.registers.field("ADCS") + 1) / 2

    def clear_samp(self, t_ns: int) -> bool:
        """Firmware clears SAMP (SSRC = 000): conversion starts."""
        return self.trigger(t_ns, Ssrc.MANUAL)

    def trigger(self, t_ns: int, source: Ssrc) -> bool:
        """A trigger; False when it is not the selected one, nothing samples, or a conversion runs."""
        registers = self.registers
        if not registers.field("ADON") or registers.field("SSRC") != source or t_ns < self._ready_ns:
            return False
        if not (registers.field("ASAM") or registers.field("SAMP")):
            return False
        channels = CHANNELS[registers.field("CHPS")]
        for channel in range(channels):
            self.buffers[self._fill] = convert(self.pin(t_ns, channel))
            self._fill = (self._fill + 1) % BUFFERS
        self._ready_ns = t_ns + channels * CONVERSION_TAD * self.tad_ns
        registers.put("DONE", 1)
        registers.put("SAMP", registers.field("ASAM"))
        self._samples += 1
        if self._samples > registers.field("SMPI"):
            self._samples = self._fill = 0
            self.interrupt = True
        return True

    @property
    def ready_ns(self) -> float:
        """When the last conversion is through and its buffers hold."""
        return self._ready_ns
