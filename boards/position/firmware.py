"""Firmware of the position board, PIC18F4480 at 10 MIPS: an EnDat poll and a POSITION frame every 5 ms.

Cycles are ASSUMPTIONS. The sample routine waits for the EnDat transfer (some 55 us at 1 MHz), checks the CRC
and loads the ECAN.
"""

from collections.abc import Callable
from typing import Final

from boards.core import PacketLine, PeriodicBoard, Place, Source
from boards.core.commands import kept
from boards.silicon.endat import POSITION_BITS, EndatEncoder, EndatMaster
from bus.protocol import (
    AGE_UNIT_NS,
    MEASUREMENT_BASE,
    SUMMARY_BASE,
    Health,
    PositionFlag,
    pack_position,
    pack_summary,
)

FCY_HZ: Final = 10_000_000

TABLE: Final = (
    Source("sample", priority=2, latency_cycles=12, cost_cycles=1200),  # 120 us
    Source("can", priority=1, latency_cycles=12, cost_cycles=400, level=True),  # 40 us, no SPI
)


TICK_NS: Final = 5_000_000
_SUMMARY_TICKS: Final = 50
_HEARTBEAT_TICKS: Final = 200
_LAST_STEP: Final = (1 << POSITION_BITS) - 1
_BAD: Final = int(PositionFlag.ALARM | PositionFlag.CRC_ERROR)
_ALARM, _CRC_ERROR, _LOW, _HIGH = map(
    int, (PositionFlag.ALARM, PositionFlag.CRC_ERROR, PositionFlag.LIMIT_LOW, PositionFlag.LIMIT_HIGH)
)


class PositionBoard(PeriodicBoard):
    """encoder: what the RCN 829 at the other end of the cable measures, (t_ns) -> steps, 29 bit.
    low, high: soft limits in steps, as flags for whoever listens.

    A reading whose CRC fails is not used: the frame repeats the last good position and says so.
    """

    def __init__(
        self, place: Place, encoder: Callable[[int], int], low: int = 0, high: int = _LAST_STEP
    ) -> None:
        super().__init__(place, FCY_HZ, TABLE, TICK_NS)
        self.endat = EndatMaster(EndatEncoder(encoder))
        self.packets = PacketLine(place, self.clip)
        self.uart = self.packets.uart
        self.low = low
        self.high = high
        self.position = 0
        # The first instruction of the routine starts the clock, and the first edge latches the position.
        self._age = self.cost_ns // AGE_UNIT_NS
        self._identifier = MEASUREMENT_BASE + self.device_type
        self.set_parameters(
            (
                kept(4, "soft_limit_low_steps", (0, _LAST_STEP), self, "low"),
                kept(5, "soft_limit_high_steps", (0, _LAST_STEP), self, "high"),
            )
        )
        self.reset()

    def reset(self) -> None:
        """After power-up."""
        self.flags = 0
        self.packets.clear()

    def routine(self, t_ns: int) -> None:
        """Timer interrupt, every 5 ms."""
        end = self.enter(t_ns)
        if not end:
            return
        position, alarm, good = self.endat.poll(t_ns)
        if good:
            flags = _ALARM if alarm else 0
            self.position = position
        else:
            flags = _CRC_ERROR
            position = self.position
        if position < self.low:
            flags |= _LOW
        elif position > self.high:
            flags |= _HIGH
        self.flags = flags
        ticks = self.ticks
        data = pack_position(self.device_type, flags, position, self._age, ticks & 0xFF)
        self.transmit(self._identifier, data, end)
        if ticks & 1:
            self._slow(ticks, end)
            return
        self.packets.take(t_ns, end, (position,))

    def _slow(self, ticks: int, end_ns: int) -> None:
        """SUMMARY every 250 ms, heartbeat every second, never in one tick."""
        if ticks % _SUMMARY_TICKS == 1:
            data = pack_summary(self.device_type, self.flags, self.position)
            self.refresh(SUMMARY_BASE + self.device_type, data, end_ns)
        elif ticks % _HEARTBEAT_TICKS == 3:
            self.heartbeat(end_ns)

    def health(self) -> Health:
        """Adds the encoder's alarm and a bad transfer to the common bits."""
        bits = super().health()
        if self.flags & _BAD:
            bits |= Health.SENSOR
        return bits
