"""The board's end of the line, clock edge by clock edge: makes the edges, takes the bits."""

from collections.abc import Callable
from typing import NamedTuple

from boards.chips.endat import registers as at
from boards.chips.endat.answer import bits_of, crc_bits, value_of
from boards.chips.endat.encoder import ClockedEncoder
from boards.chips.endat.registers import MODES, Reply
from boards.silicon.endat import CLOCK_HZ, POSITION_BITS

_NS_PER_S = 1_000_000_000
START_TIMEOUT_NS = 2 * at.ACCESS_NS
CRC_BITS, INFO_BITS = 5, 30


class EndatError(ValueError):
    """No answer, or one whose CRC is wrong."""


class Position(NamedTuple):
    """A position transfer: value, alarm (F1, F2), 24 bits of additional information 2 and 1 as they came."""

    value: int
    alarm: bool
    infos: tuple[int, ...]
    end_ns: int


class ClockedMaster:
    """Clocks one encoder at `clock_hz` over a cable whose delay is `delay_ns` (t_D = 200 ns + 10 ns/m).

    line: what the cable does to a received bit, (its number after the start bit, level) -> level; None:
    nothing. Without delay compensation the delay must stay below half a clock.
    """

    def __init__(self, encoder: ClockedEncoder, clock_hz: int = CLOCK_HZ, delay_ns: int = 0) -> None:
        self.encoder = encoder
        self.line: Callable[[int, int], int] | None = None
        self._half_ns = _NS_PER_S // (2 * clock_hz)
        self._delay_ns = delay_ns
        self._t_ns = 0
        self._levels: list[tuple[int, int]] = []

    # --- edges ---------------------------------------------------------------------------------------
    def _clock(self, data: int = 0) -> int:
        """One clock: falling edge, rising edge; the level on the line at the falling edge."""
        encoder = self.encoder
        t_ns = self._t_ns
        sampled = self._seen(t_ns)
        encoder.edge(t_ns, 0, data)
        rise_ns = t_ns + self._half_ns
        encoder.edge(rise_ns, 1, data)
        self._levels = [*self._levels[-2:], (rise_ns, encoder.level(rise_ns))]
        self._t_ns = rise_ns + self._half_ns
        return sampled

    def _seen(self, t_ns: int) -> int:
        """The line at the master's end."""
        return next((level for at_ns, level in reversed(self._levels) if at_ns <= t_ns - self._delay_ns), 0)

    def exchange(
        self, t_ns: int, code: int, argument: int | None, count: int, supplement: int | None = None
    ) -> list[int]:
        """One transfer whose first edge is at `t_ns`: `count` bits after the start bit.

        Raises EndatError when no start bit comes.
        """
        self._t_ns = t_ns
        self._levels = []
        out = bits_of(code, at.MODE_BITS)
        if argument is not None:
            out += bits_of(argument, at.ARGUMENT_BITS)
        for bit in (*[0] * at.DUMMY_CLOCKS, *out, *[0] * at.TURN_CLOCKS):
            self._clock(bit)
        limit_ns = self._t_ns + START_TIMEOUT_NS
        while self._clock() != 1:
            if self._t_ns > limit_ns:
                raise EndatError(f"EnDat command {code:06b}: no start bit within {START_TIMEOUT_NS} ns")
        bits = [self._clock() for _ in range(count - 1)]
        bits.append(self._last(supplement))
        if self.line is not None:
            bits = [self.line(index, bit) for index, bit in enumerate(bits)]
        return bits

    def _last(self, supplement: int | None) -> int:
        """The last bit needs its falling edge only, unless a supplement follows."""
        if supplement is None:
            return self._seen(self._t_ns)
        last = self._clock(1)
        for bit in bits_of(supplement, at.ARGUMENT_BITS):
            self._clock(bit)
        return last

    # --- transfers -----------------------------------------------------------------------------------
    def position(
        self, t_ns: int, code: int = at.SEND_POSITION_INFO, infos: int = 0, supplement: int | None = None
    ) -> Position:
        """Any command that answers with a position, with `infos` additional informations expected.

        Raises EndatError on a missing start bit or a wrong CRC.
        """
        flags = 1 if MODES[code].reply is Reply.POSITION else 2
        head = flags + POSITION_BITS
        bits = self.exchange(t_ns, code, None, head + CRC_BITS + infos * INFO_BITS, supplement)
        data = checked(bits[: head + CRC_BITS])
        alarm = data[0] == 1 if flags == 1 else data[:2] != [0, 1]
        starts = (head + CRC_BITS + number * INFO_BITS for number in range(infos))
        words = tuple(value_of(checked(bits[start + 1 : start + INFO_BITS])) for start in starts)
        return Position(value_of(data[flags:][::-1]), alarm, words, self._t_ns)

    def parameter(self, t_ns: int, code: int, head: int, data: int = 0) -> tuple[int, int]:
        """Any command with an argument: the eight and sixteen bits that come back.

        Raises EndatError on a missing start bit or a wrong CRC.
        """
        bits = checked(self.exchange(t_ns, code, head << 16 | data, at.ARGUMENT_BITS + CRC_BITS))
        value = value_of(bits)
        return value >> 16, value & 0xFFFF

    def test_values(self, t_ns: int) -> tuple[bool, int]:
        """F1 and the 40 bits of test values; raises EndatError as the others do."""
        bits = checked(self.exchange(t_ns, at.SEND_TEST_VALUES, None, 1 + 40 + CRC_BITS))
        return bool(bits[0]), value_of(bits[1:])

    @property
    def t_ns(self) -> int:
        """When the last transfer took its last bit."""
        return self._t_ns


def checked(bits: list[int]) -> list[int]:
    """`bits` without their CRC; raises EndatError when it is wrong."""
    data, crc = bits[:-CRC_BITS], bits[-CRC_BITS:]
    if crc_bits(data) != crc:
        raise EndatError(f"EnDat CRC of {len(data)} bits is wrong")
    return data
