"""Processors that stand still, each for as long as anything holds it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from boards.core import PeriodicBoard
from boards.core.halt import Halt
from bus.can import Frame
from scenarios.faults.layers import Layers


class _Halted:
    """In the place of a port's receiver: the controller's two buffers, and then nothing."""

    below: Callable[..., Any]

    def __init__(self, board: PeriodicBoard, t_ns: int) -> None:
        self.halt = Halt(board, t_ns)
        self.holders = 1

    def __call__(self, t_ns: int, frame: Frame) -> None:
        self.halt.hear(t_ns, frame)


class Halts:
    """By board."""

    def __init__(self, layers: Layers) -> None:
        self._layers = layers
        self._halted: dict[str, _Halted] = {}

    def halt(self, board: PeriodicBoard, t_ns: int) -> None:
        """Stop a processor, or see to it that it stays stopped."""
        if board.name in self._halted:
            self._halted[board.name].holders += 1
            return
        halted = _Halted(board, t_ns)
        self._layers.add(board.port, "on_receive", halted)
        self._halted[board.name] = halted

    def resume(self, board: PeriodicBoard, t_ns: int) -> None:
        """One reason fewer; with the last gone it goes on."""
        halted = self._halted[board.name]
        halted.holders -= 1
        if not halted.holders:
            del self._halted[board.name]
            self._layers.remove(board.port, "on_receive", halted)
            halted.halt.resume(t_ns)
