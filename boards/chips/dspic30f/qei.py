"""Quadrature encoder interface (DS70141F p. 93, DS70135G p. 92)."""

from boards.chips.dspic30f.registers import Qeim, registers
from boards.chips.quadrature import Decoder, Filter

_X2 = (Qeim.X2_INDEX, Qeim.X2_MATCH)
_BY_INDEX = (Qeim.X2_INDEX, Qeim.X4_INDEX)


class QeiModule:
    """registers: QEICON, DFLTCON, POSCNT, MAXCNT. interrupt: QEIIF, for firmware to clear."""

    def __init__(self) -> None:
        self.registers = registers(QEICON=0, DFLTCON=0, POSCNT=0, MAXCNT=0xFFFF)
        self.interrupt = False
        self._decoder = Decoder()
        self._filters = (Filter(), Filter(), Filter())
        self._index = 0

    def sample(self, a: int, b: int, index: int = 0) -> None:
        """One clock of the input filter (without the filter: levels count at once)."""
        registers = self.registers
        mode = registers.field("QEIM")
        if registers.field("QEOUT"):
            of_a, of_b, of_index = self._filters
            a, b, index = of_a.sample(a), of_b.sample(b), of_index.sample(index)
        if registers.field("SWPAB"):
            a, b = b, a
        if mode not in tuple(Qeim):
            return
        step = self._decoder.edge(a, b, x2=mode in _X2)
        if step:
            registers.put("UPDN", int(step == 1))
            self._count(mode, step)
        # The index counts where it coincides with A = B = low.
        pulse = int(bool(index) and not a and not b)
        registers.put("INDX", int(bool(index)))
        if pulse and not self._index and mode in _BY_INDEX:
            registers["POSCNT"] = 0 if registers.field("UPDN") else registers["MAXCNT"]
            self.interrupt = True
        self._index = pulse

    def _count(self, mode: int, step: int) -> None:
        registers = self.registers
        position, top, up = registers["POSCNT"], registers["MAXCNT"], step == 1
        if mode not in _BY_INDEX and position == (top if up else 0):
            registers["POSCNT"] = 0 if up else top
            self.interrupt = True
            return
        registers["POSCNT"] = position + step
        if mode in _BY_INDEX and registers["POSCNT"] == (top + 1 & 0xFFFF if up else 0xFFFF):
            registers.put("CNTERR", 1)  # an index pulse was missed
