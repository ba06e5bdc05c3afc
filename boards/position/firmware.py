"""Firmware of the position board: an EnDat poll and a POSITION frame every 5 ms."""

from typing import Final

from boards.core import Parameter, PeriodicBoard
from boards.position.interrupts import FCY_HZ, TABLE
from boards.position.pins import PositionPins
from boards.silicon.endat import POSITION_BITS, EndatEncoder, EndatMaster
from boards.silicon.uart import Uart
from bus.can import Frame, Wire
from bus.protocol import (
    AGE_UNIT_NS,
    MEASUREMENT_BASE,
    SUMMARY_BASE,
    Health,
    PositionFlag,
    pack_summary,
)
from bus.protocol.serial import SAMPLES, STAMP_UNIT_NS, pack_packet
from bus.time import EventQueue, Oscillator

TICK_NS: Final = 5_000_000
_SUMMARY_TICKS: Final = 50
_HEARTBEAT_TICKS: Final = 200
_LAST_STEP: Final = (1 << POSITION_BITS) - 1
_BAD: Final = int(PositionFlag.ALARM | PositionFlag.CRC_ERROR)
_ALARM, _CRC_ERROR, _LOW, _HIGH = map(
    int, (PositionFlag.ALARM, PositionFlag.CRC_ERROR, PositionFlag.LIMIT_LOW, PositionFlag.LIMIT_HIGH)
)


class PositionBoard(PeriodicBoard):
    """low, high: soft limits in steps, as flags for whoever listens.

    A reading whose CRC fails is not used: the frame repeats the last good position and says so.
    """

    __slots__ = (
        "_age",
        "_identifier",
        "endat",
        "flags",
        "high",
        "low",
        "packets",
        "position",
        "samples",
        "stamp_ns",
        "uart",
    )

    def __init__(
        self,
        name: str,
        device_type: int,
        queue: EventQueue,
        wire: Wire,
        pins: PositionPins,
        oscillator: Oscillator,
        low: int = 0,
        high: int = _LAST_STEP,
    ) -> None:
        super().__init__(name, device_type, queue, wire, oscillator, FCY_HZ, TABLE, TICK_NS)
        self.endat = EndatMaster(EndatEncoder(pins.encoder))
        self.uart = Uart(queue)
        self.low = low
        self.high = high
        self.flags = 0
        self.position = 0
        self.packets = 0
        self.samples: list[tuple[int]] = []
        self.stamp_ns = 0
        # The first instruction of the routine starts the clock, and the first edge latches the position.
        self._age = min(255, self.cost_ns // AGE_UNIT_NS) << 48 | device_type
        self._identifier = MEASUREMENT_BASE + device_type
        self.set_parameters(
            (
                Parameter(4, "soft_limit_low_steps", 0, _LAST_STEP, lambda: self.low, self._set_low),
                Parameter(5, "soft_limit_high_steps", 0, _LAST_STEP, lambda: self.high, self._set_high),
            )
        )

    def _set_low(self, value: int) -> None:
        self.low = value

    def _set_high(self, value: int) -> None:
        self.high = value

    def reset(self) -> None:
        """After power-up."""
        self.flags = 0
        self.samples = []

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
        data = (self._age | flags << 8 | position << 16 | (ticks & 0xFF) << 56).to_bytes(8, "little")
        if not self.send(Frame(self._identifier, data), end):
            self.drop()
        if ticks & 1:
            self._slow(ticks, end)
            return
        samples = self.samples
        if not samples:
            self.stamp_ns = t_ns
        samples.append((position,))
        if len(samples) == SAMPLES:
            self._packet(end)

    def _slow(self, ticks: int, end_ns: int) -> None:
        """SUMMARY every 250 ms, heartbeat every second, never in one tick."""
        if ticks % _SUMMARY_TICKS == 1:
            data = pack_summary(self.device_type, self.flags, self.position)
            self.refresh(SUMMARY_BASE + self.device_type, data, end_ns)
        elif ticks % _HEARTBEAT_TICKS == 3:
            self.heartbeat(end_ns)

    def _packet(self, end_ns: int) -> None:
        stamp = self.oscillator.local_ns(self.stamp_ns) // STAMP_UNIT_NS
        self.uart.send(end_ns, pack_packet(self.device_type, self.packets, stamp, self.samples))
        self.packets = self.packets + 1 & 0xFF
        self.samples = []

    def health(self) -> Health:
        """Adds the encoder's alarm and a bad transfer to the common bits."""
        bits = super().health()
        if self.flags & _BAD:
            bits |= Health.SENSOR
        return bits
