"""The board around the processor: an MCP2515 on SPI, INT on D2, chip select on B2, as on shields.

The processor runs ahead to the next event of the simulation, when something may change its pins, or to its
own next byte on SPI. So bytes, chip select and INT come at their cycle; a microsecond is the least it runs.
Asleep it stays behind until its timer or INT wakes it.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Final

from boards.avr.core import HIGH, LOW, NOTHING, Core
from boards.c.library import FirmwareError
from boards.chips.mcp2515 import Mcp2515
from boards.core.board import Board
from boards.core.declared import BoardError
from boards.core.interrupts import Source
from boards.core.place import Place

HZ: Final = 16_000_000
"""Crystal of an Arduino Uno or Nano, and of many MCP2515 shields (CNF registers are the program's)."""
SELECT, INTERRUPT = 2, 2
"""Pins of ports B and D: Arduino's 10 and 2, what its MCP2515 libraries take unless told."""
_LEAST_NS: Final = 1_000
_MOST_NS: Final = 100_000
"""Ahead of a simulation in which nothing waits; who drives it from outside may find the pins that late."""
_TABLE: Final = (Source("can", priority=1, latency_cycles=0, cost_cycles=0, level=True),)
_SECOND_NS: Final = 1_000_000_000
_FOR_EVER: Final = 1 << 62
"""Cycles: only a pin ends this sleep."""


class AvrBoard(Board):
    """A board that runs a binary for the ATmega328P. Parameters, commands and heartbeat are the program's."""

    def __init__(self, place: Place, file: Path) -> None:
        super().__init__(place, HZ, _TABLE)
        self.port.accept(None)  # the chip's own filters decide
        self.chip = Mcp2515(place.queue, self.port)
        self.chip.interrupt = self._pin
        self._core = Core(file, HZ, SELECT, INTERRUPT)
        self._base_ns = self._first = self._number = 0
        self._event = NOTHING
        self._asleep = False

    def reset(self) -> None:
        """After power-up."""
        self.chip.reset()
        self._first = self._core.reset()

    def start(self, t_ns: int) -> None:
        """The reset is over."""
        self._base_ns = self.oscillator.local_ns(t_ns)
        self._run(t_ns, self._next())

    def _next(self) -> int:
        """What was booked for the processor is void; the number of what comes in its place."""
        self._number += 1
        self._asleep = False
        return self._number

    def _cycle(self, t_ns: int) -> int:
        return self._first + (self.oscillator.local_ns(t_ns) - self._base_ns) * HZ // _SECOND_NS

    def _book(self, cycle: int, t_ns: int, call: Callable[[int, int], None], number: int) -> None:
        """`call(t_ns, number)` at a cycle, not before `t_ns`."""
        local_ns = (cycle - self._first) * _SECOND_NS // HZ + self._base_ns
        self.queue.at(max(t_ns, self.oscillator.true_ns(local_ns)), lambda now: call(now, number))

    def _pin(self, t_ns: int, asserted: bool) -> None:
        if self._asleep:  # it has stayed behind: nothing has happened to it since
            self._to(self._cycle(t_ns), t_ns)
            self._book(0, t_ns, self._act, self._next())
        self._core.interrupt(not asserted)

    def _to(self, cycle: int, t_ns: int) -> int:
        """Run to a cycle, or to an event, which is kept; returns the cycle."""
        try:
            reached, self._event = self._core.run(cycle)
        except FirmwareError as error:
            self.on = False
            raise BoardError(f"{error}: board {self.name} at {t_ns * 1e-9:.6g} s") from None
        return reached

    def _run(self, t_ns: int, number: int) -> None:
        """Run on from `t_ns`, unless the supply failed meanwhile."""
        if not self.on or number != self._number:
            return
        self._asleep = False
        waiting = self.queue.next_ns()
        horizon = t_ns + _MOST_NS if waiting is None else min(waiting, t_ns + _MOST_NS)
        cycle = self._to(self._cycle(max(horizon, t_ns + _LEAST_NS)), t_ns)
        wakes = self._core.asleep() if self._event == NOTHING else 0
        self._asleep = wakes > 0
        if wakes < _FOR_EVER:
            self._book(max(cycle, wakes), t_ns, self._act, number)

    def _act(self, t_ns: int, number: int) -> None:
        if number == self._number and self.on:
            spi, event = self.chip.spi, self._event
            if event == LOW:
                spi.select()
            elif event == HIGH:
                spi.deselect()
            elif event != NOTHING:
                self._core.answer(spi.exchange(event))
            self._run(t_ns, number)
