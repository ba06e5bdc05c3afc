"""Faults of single chips and of the lines between them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from bus.can import Frame, Port
from bus.protocol import COMMAND_BASE, REPLY_BASE, device_named
from scenarios.faults.kind import FaultError
from scenarios.faults.onboard import Deaf
from scenarios.faults.place import Place

_ENDAT_BITS = 36
"""F1, F2, 29 bits of position, CRC-5 (hardware.md 3.1)."""


class _Hears:
    """In the place of one port's receiver: misses some frames."""

    below: Callable[..., Any]

    def __init__(self, port: Port, misses: Callable[[Frame], bool]) -> None:
        self.port, self._misses = port, misses

    def __call__(self, t_ns: int, frame: Frame) -> None:
        if not self._misses(frame):
            self.below(t_ns, frame)


class FrameLoss:
    """Every receiver misses the frames that are meant, each for itself: its buffer was overwritten."""

    def __init__(self, place: Place, given: Mapping[str, Any], _t_ns: int) -> None:
        self._layers, self._random = place.layers, place.random
        self._identifier: int | None = given.get("identifier")
        self._device = device_named(given["node"]) if "node" in given else None
        self._probability = given["probability"]
        self._ears = [
            _Hears(port, self._misses) for port in place.network.wire.ports if port.on_receive is not None
        ]
        for ear in self._ears:
            self._layers.add(ear.port, "on_receive", ear)

    def _misses(self, frame: Frame) -> bool:
        identifier = frame.identifier
        if self._identifier is not None:
            meant = identifier == self._identifier
        else:
            meant = identifier & 0x7F == self._device and not COMMAND_BASE <= identifier < REPLY_BASE
        return bool(meant and self._random.random() < self._probability)

    def clear(self, _t_ns: int) -> None:
        """Heard again."""
        for ear in self._ears:
            self._layers.remove(ear.port, "on_receive", ear)


class DeafController:
    """A controller gives nothing of what it receives to the processor; it still acknowledges and sends."""

    def __init__(self, place: Place, given: Mapping[str, Any], _t_ns: int) -> None:
        self._layers, self._deaf = place.layers, Deaf()
        self._port = place.board(given["node"]).port
        self._layers.add(self._port, "on_receive", self._deaf)

    def clear(self, _t_ns: int) -> None:
        """Hears again."""
        self._layers.remove(self._port, "on_receive", self._deaf)


class EndatLine:
    """In a share of the transfers one bit is inverted on the line: the CRC finds it."""

    below: Callable[..., Any]

    def __init__(self, place: Place, given: Mapping[str, Any], _t_ns: int) -> None:
        self._master = place.board(f"POSITION_{given['axis'].upper()}").endat
        self._random, self._probability = place.random, given["probability"]
        self._layers = place.layers
        self._layers.add(self._master, "line", self)

    def __call__(self, frame: int) -> int:
        """What arrives of a transfer."""
        if self.below is not None:
            frame = self.below(frame)
        if self._random.random() < self._probability:
            frame ^= 1 << int(self._random.integers(_ENDAT_BITS))
        return frame

    def clear(self, _t_ns: int) -> None:
        """Undisturbed."""
        self._layers.remove(self._master, "line", self)


class SerialNoise:
    """In a share of the packets one bit is inverted on a board's RS232 line."""

    below: Callable[..., Any]

    def __init__(self, place: Place, given: Mapping[str, Any], _t_ns: int) -> None:
        uarts = place.network.uarts
        if given["node"] not in uarts:
            raise FaultError(f"serial_noise: node: no RS232; use one of {', '.join(uarts)}")
        self._uart, self._layers = uarts[given["node"]], place.layers
        self._random, self._probability = place.random, given["probability"]
        self._layers.add(self._uart, "sink", self)

    def __call__(self, t_ns: int, packet: bytes) -> None:
        """In the place of who listens."""
        if self.below is None:
            return
        if self._random.random() < self._probability:
            bit = int(self._random.integers(8 * len(packet)))
            broken = bytearray(packet)
            broken[bit // 8] ^= 1 << bit % 8
            packet = bytes(broken)
        self.below(t_ns, packet)

    def clear(self, _t_ns: int) -> None:
        """Clean again."""
        self._layers.remove(self._uart, "sink", self)


class PwmStuck:
    """The PWM keeps its duties whatever is written."""

    def __init__(self, place: Place, given: Mapping[str, Any], t_ns: int) -> None:
        self._drives, self._axis = place.drives, given["axis"]
        self._held: tuple[float, float] | None = None
        self._drives.add(self._axis, self, t_ns)

    def duties(self, wanted: tuple[float, float]) -> tuple[float, float]:
        """Those of the beginning."""
        self._held = self._held or wanted
        return self._held

    def clear(self, t_ns: int) -> None:
        """What was written last counts again."""
        self._drives.remove(self._axis, self, t_ns)
