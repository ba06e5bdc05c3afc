"""Three bytes to bit rate and sample point (DS20001801 section 5; BRGCON1-3 of the PIC18 agree)."""

from typing import NamedTuple

from bus.can.sampling import BitTiming

MAX_BITRATE = 1_000_000


class BitTimes(NamedTuple):
    """Bit timing in time quanta (TQ).

    brp: prescaler as in the register; the segments in TQ, the synchronisation segment of 1 TQ comes on top.
    problems: what the data sheet forbids and the registers have all the same; the controller works with it.
    """

    fosc_hz: int
    brp: int
    propagation: int
    phase1: int
    phase2: int
    jump: int
    triple: bool
    problems: tuple[str, ...]

    @property
    def quanta(self) -> int:
        """TQ per bit."""
        return 1 + self.propagation + self.phase1 + self.phase2

    @property
    def bitrate(self) -> float:
        """bit/s: Fosc / (2 (BRP + 1) TQ per bit)."""
        return self.fosc_hz / (2 * (self.brp + 1) * self.quanta)

    @property
    def sample_point(self) -> float:
        """Share of the bit that lies before the sample point."""
        return (1 + self.propagation + self.phase1) / self.quanta

    def wire_timing(self) -> BitTiming:
        """The same for the bus. Two nodes may differ by twice what each oscillator may. The bounds are those
        of Bosch CAN 2.0, part A, section 9. df <= min(phase 1, phase 2) / 2 (13 bit - phase 2), df <= SJW /
        20 bit."""
        bit = self.quanta
        shortest = min(self.phase1, self.phase2)
        each = min(shortest / (2 * (13 * bit - self.phase2)), self.jump / (20 * bit))
        return BitTiming(1e9 / self.bitrate, self.sample_point, self.jump / bit, 2 * each)


def decode(fosc_hz: int, cnf1: int, cnf2: int, cnf3: int) -> BitTimes:
    """Bit timing of a crystal of `fosc_hz` and registers CNF1, CNF2, CNF3."""
    jump, brp = (cnf1 >> 6) + 1, cnf1 & 0x3F
    phase1, propagation = (cnf2 >> 3 & 7) + 1, (cnf2 & 7) + 1
    phase2 = (cnf3 & 7) + 1 if cnf2 & 0x80 else max(phase1, 2)
    times = BitTimes(fosc_hz, brp, propagation, phase1, phase2, jump, bool(cnf2 & 0x40), ())
    return times._replace(problems=tuple(_problems(times)))


def _problems(times: BitTimes) -> list[str]:
    found = []
    if times.propagation + times.phase1 < times.phase2:
        found.append("PropSeg + PS1 is shorter than PS2")
    if times.phase2 <= times.jump:
        found.append("PS2 is not longer than SJW")
    if times.phase2 < 2:
        found.append("PS2 is shorter than the information processing time of 2 TQ")
    if times.quanta < 8:  # three segments of at most 8 make no more than CAN's 25
        found.append(f"{times.quanta} TQ per bit, CAN has 8 to 25")
    if times.bitrate > MAX_BITRATE:
        found.append(f"{times.bitrate:.0f} bit/s, CAN has at most {MAX_BITRATE}")
    return found
