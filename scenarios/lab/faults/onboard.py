"""Faults of whole boards."""

from collections.abc import Callable, Mapping
from typing import Any

from boards.core import Board, PeriodicBoard
from boards.core.halt import Halt
from bus.can import Frame, Port
from scenarios.lab.faults.place import Place
from scenarios.lab.layers import Evidence, Laid, Stacks, words


class Hears(Laid):
    """In the place of a port's receiver: misses some frames, or (None) all."""

    def __init__(self, place: Place, port: Port, misses: Callable[[Frame], bool] | None = None) -> None:
        self._misses, self._evidence = misses, place.evidence
        super().__init__(place.layers, port, "on_receive")

    def __call__(self, t_ns: int, frame: Frame) -> None:
        """Lost, or passed on."""
        if self._misses is None or self._misses(frame):
            self._evidence.act(t_ns, words(frame))
        else:
            self.below(t_ns, frame)


class Deaf(Hears):
    """A board's controller passes nothing on."""

    def __init__(self, place: Place, given: Mapping[str, Any], _t_ns: int) -> None:
        super().__init__(place, place.board(given["node"]).port)


def took_down(board: Board, t_ns: int, evidence: Evidence) -> None:
    """A board is about to lose its supply, or its processor's reset is: it acts unless that is so already."""
    if board.on or board._boot_ns > t_ns:
        evidence.act(t_ns, f"supply of {board.name}")


class NoSupply:
    """The board has no supply; with the last such fault gone it boots."""

    def __init__(self, place: Place, given: Mapping[str, Any], t_ns: int) -> None:
        self._place, self._name = place, given["node"]
        self.board, self._evidence = place.board(self._name), place.evidence
        self._first = place.hold(self._name)
        if self._first:
            took_down(self.board, t_ns, self._evidence)
            self.fail(t_ns)

    def fail(self, t_ns: int) -> None:
        """Off."""
        self.board.power_off(t_ns)

    def clear(self, t_ns: int) -> None:
        """Boots afresh."""
        if self._place.let_go(self._name):
            if not self._first:  # until now, as the others have long been over
                self._evidence.act(t_ns, f"supply of {self._name}")
            self.board.power_on(t_ns)


class BrownOut(NoSupply):
    """Too little for the processor, enough for its CAN controller, which acknowledges and fills up."""

    def __init__(self, place: Place, given: Mapping[str, Any], t_ns: int) -> None:
        super().__init__(place, given, t_ns)
        self._deaf = Hears(place, self.board.port)

    def fail(self, t_ns: int) -> None:
        """Held in reset."""
        self.board.hold_in_reset(t_ns)

    def clear(self, t_ns: int) -> None:
        """The supply is back: boots."""
        self._deaf.clear(t_ns)
        super().clear(t_ns)


class Resets:
    """The board restarts now, and again every so often while the fault is on."""

    def __init__(self, place: Place, given: Mapping[str, Any], t_ns: int) -> None:
        self._board, self._queue = place.board(given["node"]), place.network.queue
        self._place, self._name = place, given["node"]
        self._every_ns = round(given["every"] * 1e9) if "every" in given else 0
        self._over = False
        self._evidence = place.evidence
        self._reset(t_ns)

    def _reset(self, t_ns: int) -> None:
        if self._over:
            return
        if self._place.hold(self._name):
            took_down(self._board, t_ns, self._evidence)
            self._board.power_off(t_ns)
        if self._place.let_go(self._name):
            self._board.power_on(t_ns)
        if self._every_ns:
            self._queue.at(t_ns + self._every_ns, self._reset)

    def clear(self, _t_ns: int) -> None:
        """No more of them."""
        self._over = True
        self._queue.take_out([self._reset].__contains__)


class _Halted(Laid):
    """A processor that stands still; its port is received by the controller's two buffers, then nothing."""

    def __init__(self, layers: Stacks, board: PeriodicBoard, t_ns: int, evidence: Evidence) -> None:
        self._halt, self._board, self._evidence = Halt(board, t_ns), board, evidence
        super().__init__(layers, board.port, "on_receive")
        due_ns = self._halt.due_ns
        if due_ns is not None and evidence.first_ns is None:
            board.queue.at(max(due_ns, t_ns), self._missed)

    def _missed(self, t_ns: int) -> None:
        if self._board.on:
            self._evidence.act(t_ns, f"interrupt of {self._board.name}")

    def __call__(self, t_ns: int, frame: Frame) -> None:
        """Into the buffers."""
        self._evidence.act(t_ns, words(frame))
        self._halt.hear(t_ns, frame)

    def clear(self, t_ns: int) -> None:
        """It goes on."""
        super().clear(t_ns)
        self._board.queue.take_out([self._missed].__contains__)
        self._halt.resume(t_ns)


class Hang:
    """The processor stands still, for as long as any such fault holds it."""

    def __init__(self, place: Place, given: Mapping[str, Any], t_ns: int) -> None:
        self._place, self._board = place, place.board(given["node"])
        self._reason = f"processor of {given['node']}"
        self._evidence = place.evidence
        self._holds = False
        self.halt(t_ns)

    def halt(self, t_ns: int) -> None:
        """Stop."""
        if self._place.hold(self._reason):
            halted = _Halted(self._place.layers, self._board, t_ns, self._evidence)
            self._place.halted[self._reason] = halted, self._evidence
        self._holds = True

    def clear(self, t_ns: int) -> None:
        """On from where it stood."""
        if self._holds and self._place.let_go(self._reason):
            halted, evidence = self._place.halted.pop(self._reason)
            if evidence.first_ns is not None:
                self._evidence.act(t_ns, evidence.on)
            halted.clear(t_ns)
        self._holds = False


class LateInterrupts(Hang):
    """Interrupts are masked again and again: what is requested meanwhile piles up and is served late."""

    def __init__(self, place: Place, given: Mapping[str, Any], t_ns: int) -> None:
        self._masked_ns, self._every_ns = round(given["masked"] * 1e9), round(given["every"] * 1e9)
        if self._masked_ns >= self._every_ns:
            raise ValueError("late_interrupts: masked has to be shorter than every")
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
        self._evidence, self._queue = place.evidence, place.network.queue
        self._pull(t_ns, self._ppm)
        if self._ppm:
            self._queue.at(t_ns + 2 * self._board.period_ns, self._timed)

    def _timed(self, t_ns: int) -> None:
        """The period that was under way is over, and one of the other rate."""
        if self._board.on:
            self._evidence.act(t_ns, f"timer interrupt of {self._board.name}")
        else:
            self._queue.at(t_ns + 2 * self._board.period_ns, self._timed)

    def _pull(self, t_ns: int, ppm: float) -> None:
        self._board.oscillator.pull(t_ns, ppm)
        self._board.timer.retime()

    def clear(self, t_ns: int) -> None:
        """Its own rate again."""
        self._queue.take_out([self._timed].__contains__)
        self._pull(t_ns, -self._ppm)
