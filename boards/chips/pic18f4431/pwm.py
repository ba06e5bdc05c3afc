"""Power control PWM of the PIC18F4431: time base, buffered duties, dead time, override, special event.

One PDC step is one Q clock (1/Fosc) without prescaler: the upper 12 bits meet PTMR, the lower two name the Q
clock (DS39616D 18.6). With a prescaler the match is at Q1, the lower two do nothing. Times: Q clocks.
Registers are tables (DS39616D section 18; field positions K): field -> (register, shift, bits).
"""

from collections.abc import Callable
from typing import NamedTuple

from boards.chips.registers import Registers

FIELDS: dict[str, tuple[str, int, int]] = {
    "PTOPS": ("PTCON0", 4, 4), "PTCKPS": ("PTCON0", 2, 2), "PTMOD": ("PTCON0", 0, 2),
    "PTEN": ("PTCON1", 7, 1),
    "PWMEN": ("PWMCON0", 4, 3), "PMOD": ("PWMCON0", 0, 4),
    "SEVOPS": ("PWMCON1", 4, 4), "UDIS": ("PWMCON1", 1, 1),
    "DTPS": ("DTCON", 6, 2), "DT": ("DTCON", 0, 6),
}  # fmt: skip
WIDTHS: dict[str, int] = {
    "PTCON0": 8, "PTCON1": 8, "PWMCON0": 8, "PWMCON1": 8, "DTCON": 8, "OVDCOND": 8, "OVDCONS": 8,
    "PTPER": 12, "SEVTCMP": 12, "PDC0": 14, "PDC1": 14, "PDC2": 14, "PDC3": 14,
}  # fmt: skip
"""Bits of each; the pairs H and L of the 12 and 14 bit ones are written as one here."""
AT_RESET: dict[str, int] = dict.fromkeys(WIDTHS, 0) | {"PTPER": 0xFFF, "OVDCOND": 0xFF, "PWMCON0": 0x50}
"""PWMPIN not programmed: the outputs are enabled."""
PTCKPS = (1, 4, 16, 64)
"""Prescaler of the time base; its clock is Fosc/4."""
DTPS = (2, 4, 8, 16)
"""Dead time clock: Fosc over this."""
PAIRS, CHANNELS = 4, 8
ENABLED: tuple[tuple[int, ...], ...] = (
    (), (1,), (0, 1), (0, 1, 2, 3), (0, 1, 2, 3, 4, 5), (0, 1, 2, 3, 4, 5, 6, 7), (1, 3), (1, 3, 5, 7),
)  # fmt: skip
"""Channels that PWMEN makes PWM outputs; the others are ordinary pins."""
FREE_RUNNING = 0
"""PTMOD; single shot and up/down counting are not built."""
PTIF = 0x10
"""PIR3: the time base's interrupt."""


class Edge(NamedTuple):
    """Output 0..7 changes at `q_clocks` since the start."""

    q_clocks: int
    channel: int
    on: bool


class Pwm4431(Registers):
    """Edge aligned, pairs complementary or independent. PTPER and PDCx are double buffered: what is written
    counts from the next period on, unless UDIS holds it back. pir3: PTIF, for firmware to clear.

    special_event: called with the Q clock when PTMR meets SEVTCMP, every SEVOPS + 1 times.
    """

    def __init__(self) -> None:
        super().__init__(FIELDS, WIDTHS, AT_RESET)
        self.pir3 = 0
        self.special_event: Callable[[int], None] | None = None
        self.outputs = [False] * CHANNELS
        self._start = self._events = self._matches = 0
        self._load()

    def __setitem__(self, register: str, value: int) -> None:
        """Write a register as above."""
        super().__setitem__(register, value)
        if not self.field("PTEN"):
            self._load()  # a stopped time base takes the buffers at once

    def _load(self) -> None:
        scale = PTCKPS[self.field("PTCKPS")]
        self._period = 4 * (self["PTPER"] + 1) * scale
        # with a prescaler a match is at Q1: the two lowest bits do nothing
        keep = 0x3FFF if scale == 1 else 0x3FFC
        self._loaded = tuple((self[f"PDC{pair}"] & keep) * scale for pair in range(PAIRS))

    @property
    def period(self) -> int:
        """Length of the running period, Q clocks."""
        return self._period

    def duty(self, pair: int) -> float:
        """Share of the running period in which the odd channel of a pair is asked for: 0..1."""
        return min(self._loaded[pair] / self._period, 1.0)

    def run(self) -> list[Edge]:
        """One period: its edges in order; `outputs` is what it leaves. Raises ValueError in a mode other than
        free running."""
        if self.field("PTMOD") != FREE_RUNNING:
            raise ValueError("PWM: only the free running time base (PTMOD = 00) is built")
        if not self.field("PTEN"):
            return []
        wanted = [edge for channel in range(CHANNELS) for edge in self._channel(channel)]
        edges = []
        for edge in sorted(wanted, key=lambda each: (each.q_clocks, each.on, each.channel)):
            if self.outputs[edge.channel] != edge.on:
                self.outputs[edge.channel] = edge.on
                edges.append(edge)
        self._end()
        return edges

    def _channel(self, channel: int) -> list[Edge]:
        """Levels of one output from the start of the period on."""
        begin, end = self._start, self._start + self._period
        if channel not in ENABLED[self.field("PWMEN")]:
            return [Edge(begin, channel, False)]
        if not self["OVDCOND"] >> channel & 1:  # overridden: OVDCONS says what
            return [Edge(begin, channel, bool(self["OVDCONS"] >> channel & 1))]
        pair = channel // 2
        switch = begin + min(self._loaded[pair], self._period)
        independent = self.field("PMOD") >> pair & 1
        first = channel & 1 or independent  # the odd channel is active first, the even one is its complement
        since, until = (begin, switch) if first else (switch, end)
        full = until - since == self._period
        on = since if full or independent else since + self._dead()
        if on >= until:
            return [Edge(begin, channel, False)]
        edges = [Edge(on, channel, True)]
        if on > begin:
            edges.append(Edge(begin, channel, False))
        if until < end:
            edges.append(Edge(until, channel, False))
        return edges

    def _dead(self) -> int:
        """Dead time, Q clocks."""
        return self.field("DT") * DTPS[self.field("DTPS")]

    def _end(self) -> None:
        """The period is over: special event, time base interrupt, buffers."""
        at = 4 * self["SEVTCMP"] * PTCKPS[self.field("PTCKPS")]
        if at < self._period:
            self._events += 1
            if self._events > self.field("SEVOPS"):
                self._events = 0
                if self.special_event is not None:
                    self.special_event(self._start + at)
        self._matches += 1
        if self._matches > self.field("PTOPS"):
            self._matches = 0
            self.pir3 |= PTIF
        self._start += self._period
        if not self.field("UDIS"):
            self._load()
