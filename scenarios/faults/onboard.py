"""Faults of whole boards."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from bus.can import Frame
from scenarios.faults.kind import FaultError
from scenarios.faults.place import Place


class Deaf:
    """In the place of a port's receiver: nobody listens."""

    below: Callable[..., Any]

    def __call__(self, _t_ns: int, _frame: Frame) -> None:
        """Lost."""


class NoSupply:
    """The board has no supply; with the last such fault gone it boots."""

    def __init__(self, place: Place, given: Mapping[str, Any], t_ns: int) -> None:
        self._place, self._name = place, given["node"]
        self.board = place.board(self._name)
        if place.hold(self._name):
            self.fail(t_ns)

    def fail(self, t_ns: int) -> None:
        """Off."""
        self.board.power_off(t_ns)

    def clear(self, t_ns: int) -> None:
        """Boots afresh."""
        if self._place.let_go(self._name):
            self.board.power_on(t_ns)


class BrownOut(NoSupply):
    """Too little for the processor, enough for its CAN controller, which acknowledges and fills up."""

    def __init__(self, place: Place, given: Mapping[str, Any], t_ns: int) -> None:
        super().__init__(place, given, t_ns)
        self._deaf = Deaf()
        place.layers.add(self.board.port, "on_receive", self._deaf)

    def fail(self, t_ns: int) -> None:
        """Held in reset."""
        self.board.hold_in_reset(t_ns)

    def clear(self, t_ns: int) -> None:
        """The supply is back: boots."""
        self._place.layers.remove(self.board.port, "on_receive", self._deaf)
        super().clear(t_ns)


class Resets:
    """The board restarts now, and again every so often while the fault is on."""

    def __init__(self, place: Place, given: Mapping[str, Any], t_ns: int) -> None:
        self._board, self._queue = place.board(given["node"]), place.network.queue
        self._place, self._name = place, given["node"]
        self._every_ns = round(given["every"] * 1e9) if "every" in given else 0
        self._over = False
        self._reset(t_ns)

    def _reset(self, t_ns: int) -> None:
        if self._over:
            return
        if self._place.hold(self._name):
            self._board.power_off(t_ns)
        if self._place.let_go(self._name):
            self._board.power_on(t_ns)
        if self._every_ns:
            self._queue.at(t_ns + self._every_ns, self._reset)

    def clear(self, _t_ns: int) -> None:
        """No more of them."""
        self._over = True
        self._queue.take_out(self._is_mine)

    def _is_mine(self, call: Callable[[int], None]) -> bool:
        return call == self._reset


class Hang:
    """The processor stands still."""

    def __init__(self, place: Place, given: Mapping[str, Any], t_ns: int) -> None:
        self._halts = place.halts
        self._board = place.board(given["node"])
        self._halted = False
        self.halt(t_ns)

    def halt(self, t_ns: int) -> None:
        """Stop."""
        self._halts.halt(self._board, t_ns)
        self._halted = True

    def clear(self, t_ns: int) -> None:
        """On from where it stood."""
        if self._halted:
            self._halted = False
            self._halts.resume(self._board, t_ns)


class LateInterrupts(Hang):
    """Interrupts are masked again and again: what is requested meanwhile piles up and is served late."""

    def __init__(self, place: Place, given: Mapping[str, Any], t_ns: int) -> None:
        self._masked_ns, self._every_ns = round(given["masked"] * 1e9), round(given["every"] * 1e9)
        if self._masked_ns >= self._every_ns:
            raise FaultError("late_interrupts: masked has to be shorter than every")
        self._queue = place.network.queue
        super().__init__(place, given, t_ns)

    def halt(self, t_ns: int) -> None:
        """Mask them, for a while."""
        super().halt(t_ns)
        self._queue.at(t_ns + self._masked_ns, self._unmask)
        self._queue.at(t_ns + self._every_ns, self.halt)

    def _unmask(self, t_ns: int) -> None:
        super().clear(t_ns)

    def clear(self, t_ns: int) -> None:
        """No more masking."""
        self._queue.take_out([self._unmask, self.halt].__contains__)
        super().clear(t_ns)


class Drift:
    """The crystal runs at another rate; the clock keeps what it has gained."""

    def __init__(self, place: Place, given: Mapping[str, Any], t_ns: int) -> None:
        self._board, self._ppm = place.board(given["node"]), given["ppm"]
        self._pull(t_ns, self._ppm)

    def _pull(self, t_ns: int, ppm: float) -> None:
        try:
            self._board.oscillator.pull(t_ns, ppm)
        except ValueError as error:
            raise FaultError(str(error)) from None
        self._board.timer.retime()

    def clear(self, t_ns: int) -> None:
        """Its own rate again."""
        self._pull(t_ns, -self._ppm)
