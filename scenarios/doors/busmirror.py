"""The bus page's view of a wire in another process: the last picture of it, and wishes that go there."""

from collections.abc import Callable
from concurrent.futures import Future
from itertools import count
from time import monotonic
from typing import Any

from host.console.views import BusState, FaultKind
from scenarios.doors.pipe_messages import Done, Wish

_LOOKED_S = 1.0
"""Pages refresh four times a second; when nobody has asked for so long, nobody looks."""


class BusMirror:
    """A `BusView`. boards: whose supply can be switched. send: takes a `Wish`, from any thread."""

    def __init__(self, boards: list[str], kinds: list[FaultKind], send: Callable[[Wish], None]) -> None:
        self.boards = tuple(boards)
        self.kinds = kinds
        self._send = send
        self._numbers = count()
        self._open: dict[int, Future[str]] = {}
        self._asked_s = float("-inf")
        self.state = BusState([], 0.0, {}, [], [])

    @property
    def watching(self) -> bool:
        """Whether somebody looks."""
        return monotonic() - self._asked_s < _LOOKED_S

    def look(self) -> BusState:
        """The last picture."""
        self._asked_s = monotonic()
        return self.state

    def start_fault(self, name: str, arguments: str) -> Future[str]:
        """Wished for; the next slice does it."""
        return self._wish("start_fault", name, arguments)

    def clear_fault(self, number: int) -> Future[str]:
        """Wished for; the next slice does it."""
        return self._wish("clear_fault", number)

    def switch(self, board: str, on: bool) -> None:
        """Wished for; the next slice does it."""
        self._wish("switch", board, on)

    def done(self, answer: Done) -> None:
        """What became of a wish."""
        future = self._open.pop(answer.number, None)
        if future is None or not future.set_running_or_notify_cancel():
            return  # whoever wished has gone
        if answer.bad:
            future.set_exception(ValueError(answer.text))
        else:
            future.set_result(answer.text)

    def _wish(self, name: str, *arguments: Any) -> Future[str]:
        number = next(self._numbers)
        future = self._open[number] = Future()
        self._send(Wish(number, name, arguments))
        return future
