"""Motor control PWM: time base, duties in half cycles, dead time, special event (FRM section 15)."""

from collections.abc import Callable
from typing import NamedTuple

from boards.chips.dspic30f.registers import DTAPS, PTCKPS, PTPER_MASK, registers

PAIRS = 3
FREE_RUNNING = 0


class Edge(NamedTuple):
    """A switch of pair 0..2 changes at `half_cycles` (half instruction cycles since start)."""

    half_cycles: int
    pair: int
    high_side: bool
    on: bool


class MotorControlPwm:
    """Edge aligned (free running), complementary pairs. registers: PTCON, PTPER, SEVTCMP, PDC1..3, DTCON1,
    PWMCON2.

    PTPER and PDCx are buffered: what is written counts from the next period on. special_event: called with
    the time in half cycles when PTMR meets SEVTCMP, every SEVOPS + 1 times.
    """

    def __init__(self) -> None:
        self.registers = registers(
            PTCON=0, PTPER=0x7FFF, SEVTCMP=0, PDC1=0, PDC2=0, PDC3=0, DTCON1=0, PWMCON2=0
        )
        self.special_event: Callable[[int], None] | None = None
        self._start = 0
        self._events = 0
        self._load()

    def start(self, half_cycles: int) -> None:
        """PTEN goes to 1: the buffers are loaded."""
        self.registers.put("PTEN", 1)
        self._start = half_cycles
        self._load()

    def _load(self) -> None:
        registers = self.registers
        scale = PTCKPS[registers.field("PTCKPS")]
        self._period = 2 * ((registers["PTPER"] & PTPER_MASK) + 1) * scale
        self._loaded = tuple(registers[f"PDC{pair + 1}"] * scale for pair in range(PAIRS))

    @property
    def period(self) -> int:
        """Length of the running period, half cycles."""
        return self._period

    def duty(self, pair: int) -> float:
        """Share of the running period in which the high side is asked for: 0..1."""
        return min(self._loaded[pair] / self._period, 1.0)

    def run(self) -> list[Edge]:
        """One period: its edges in order. Raises ValueError in a mode other than free running."""
        if self.registers.field("PTMOD") != FREE_RUNNING:
            raise ValueError("PWM: only the free running time base (PTMOD = 00) is built")
        if not self.registers.field("PTEN"):
            return []
        dead = 2 * self.registers.field("DTA") * DTAPS[self.registers.field("DTAPS")]
        edges = [edge for pair in range(PAIRS) for edge in self._pair(pair, dead)]
        self._special()
        self._start += self._period
        self._load()
        return sorted(edges)

    def _pair(self, pair: int, dead: int) -> list[Edge]:
        """High side on, then low side on; each comes on after the dead time, and goes off at once."""
        begin, end = self._start, self._start + self._period
        switch = begin + min(self._loaded[pair], self._period)
        edges = []
        for high, since, until in ((True, begin, switch), (False, switch, end)):
            full = until - since == self._period
            on = since if full else since + dead
            if on < until:
                edges.append(Edge(on, pair, high, True))
                if not full:
                    edges.append(Edge(until, pair, high, False))
        return edges

    def _special(self) -> None:
        registers = self.registers
        compare = registers["SEVTCMP"] & PTPER_MASK
        at = 2 * compare * PTCKPS[registers.field("PTCKPS")]
        if at >= self._period:
            return
        self._events += 1
        if self._events > registers.field("SEVOPS"):
            self._events = 0
            if self.special_event is not None:
                self.special_event(self._start + at)
