"""Firmware of the motor velocity board: one TACH frame every 10 ms.

ASSUMPTION: a PIC18F4431 at 10 MIPS like the focus board, since the paper names no part and this one has a
QEI. Cycles are estimated from instruction counts.
"""

from collections.abc import Callable
from typing import Final

from boards.core import PeriodicBoard, Place, Source
from boards.silicon.qei import Qei, difference
from bus.protocol import MEASUREMENT_BASE, pack_tach

FCY_HZ: Final = 10_000_000

TABLE: Final = (
    # 40 us: QEI, difference, SPI load of a frame
    Source("sample", priority=2, latency_cycles=12, cost_cycles=400),
    # 60 us: SPI read, dispatch, SPI load
    Source("can", priority=1, latency_cycles=12, cost_cycles=600, level=True),
)


TICK_NS: Final = 10_000_000
_HEARTBEAT_TICKS: Final = 100


class MotorVelocityBoard(PeriodicBoard):
    """One per motor. The count runs free in 32 bits; only differences of it mean something.

    encoder: quadrature inputs, (t_ns) -> counts, 4096 a motor turn (1024 lines, ASSUMPTION).
    """

    def __init__(self, place: Place, encoder: Callable[[int], int]) -> None:
        super().__init__(place, FCY_HZ, TABLE, TICK_NS)
        self.qei = Qei(encoder)
        self._identifier = MEASUREMENT_BASE + self.device_type
        self.reset()

    def reset(self) -> None:
        """The count starts at zero, wherever the motor stands."""
        self.count = 0
        self.poscnt = self.qei.poscnt(self.queue.now_ns)

    def routine(self, t_ns: int) -> None:
        """Timer interrupt, every 10 ms."""
        end = self.enter(t_ns)
        if not end:
            return
        poscnt = self.qei.poscnt(t_ns)
        delta = difference(poscnt, self.poscnt)
        self.poscnt = poscnt
        self.count = count = (self.count + delta) & 0xFFFF_FFFF
        self.transmit(self._identifier, pack_tach(self.device_type, 0, count, delta), end)
        if self.ticks % _HEARTBEAT_TICKS == 1:
            self.heartbeat(end)
