"""Firmware of the motor velocity board: one TACH frame every 10 ms."""

from typing import Final

from boards.core import PeriodicBoard
from boards.motor_velocity.interrupts import FCY_HZ, TABLE
from boards.motor_velocity.pins import MotorVelocityPins
from boards.silicon.qei import Qei
from bus.can import Frame, Wire
from bus.protocol import MEASUREMENT_BASE
from bus.time import EventQueue, Oscillator

TICK_NS: Final = 10_000_000
_HEARTBEAT_TICKS: Final = 100


class MotorVelocityBoard(PeriodicBoard):
    """One per motor. The count runs free in 32 bits; only differences of it mean something."""

    __slots__ = ("_identifier", "count", "poscnt", "qei")

    def __init__(
        self,
        name: str,
        device_type: int,
        queue: EventQueue,
        wire: Wire,
        pins: MotorVelocityPins,
        oscillator: Oscillator,
    ) -> None:
        super().__init__(name, device_type, queue, wire, oscillator, FCY_HZ, TABLE, TICK_NS)
        self.qei = Qei(pins.encoder)
        self.poscnt = 0
        self.count = 0
        self._identifier = MEASUREMENT_BASE + device_type

    def reset(self) -> None:
        """The count starts at zero, wherever the motor stands."""
        self.count = 0
        self.poscnt = self.qei.poscnt(self.queue.now_ns)

    def routine(self, t_ns: int) -> None:
        """Timer interrupt, every 10 ms."""
        end = self.enter(t_ns)
        if not end:
            return
        poscnt = self.qei.pin(t_ns) & 0xFFFF
        delta = ((poscnt - self.poscnt + 0x8000) & 0xFFFF) - 0x8000
        self.poscnt = poscnt
        self.count = count = (self.count + delta) & 0xFFFF_FFFF
        # TACH: no flag is defined yet, byte 1 stays zero
        data = (self.device_type | count << 16 | (delta & 0xFFFF) << 48).to_bytes(8, "little")
        if not self.send(Frame(self._identifier, data), end):
            self.drop()
        if self.ticks % _HEARTBEAT_TICKS == 1:
            self.heartbeat(end)
