"""Faults of single chips and of the lines between them."""

from collections.abc import Mapping
from typing import Any

from bus.can import Frame
from bus.protocol import COMMAND_BASE, REPLY_BASE
from scenarios.lab.faults.onboard import Hears
from scenarios.lab.faults.place import Place
from scenarios.lab.layers import Laid, Staged

_ENDAT_BITS = 36  # F1, F2, 29 bits of position, CRC-5 (hardware.md 3.1).


class FrameLoss:
    """Every receiver misses the frames that are meant, each for itself: its buffer was overwritten."""

    def __init__(self, place: Place, given: Mapping[str, Any], _t_ns: int) -> None:
        self._random = place.random
        self._identifier: int | None = given.get("identifier")
        self._device = place.board(given["node"]).device_type if "node" in given else None
        self._probability = given["probability"]
        listening = [port for port in place.network.wire.ports if port.on_receive is not None]
        self._ears = [Hears(place, port, self._misses) for port in listening]

    def _misses(self, frame: Frame) -> bool:
        identifier = frame.identifier
        if self._identifier is not None:
            meant = identifier == self._identifier
        else:
            meant = identifier & 0x7F == self._device and not COMMAND_BASE <= identifier < REPLY_BASE
        return bool(meant and self._random.random() < self._probability)

    def clear(self, t_ns: int) -> None:
        """Heard again."""
        for ear in self._ears:
            ear.clear(t_ns)


class EndatLine(Laid):
    """In a share of the transfers one bit is inverted on the line: the CRC finds it."""

    def __init__(self, place: Place, given: Mapping[str, Any], _t_ns: int) -> None:
        self._random, self._probability = place.random, given["probability"]
        self._queue, self._evidence = place.network.queue, place.evidence
        self._board = place.board(f"POSITION_{given['axis'].upper()}")
        super().__init__(place.layers, self._board.endat, "line")

    def __call__(self, frame: int) -> int:
        """What arrives of a transfer."""
        if self.below is not None:
            frame = self.below(frame)
        if self._random.random() < self._probability:
            frame ^= 1 << int(self._random.integers(_ENDAT_BITS))
            self._evidence.act(self._queue.now_ns, f"transfer of {self._board.name}")
        return frame


class SerialNoise(Laid):
    """In a share of the packets one bit is inverted on a board's RS232 line."""

    def __init__(self, place: Place, given: Mapping[str, Any], _t_ns: int) -> None:
        uarts = place.network.uarts
        if given["node"] not in uarts:
            raise ValueError(f"serial_noise: node: no RS232; use one of {', '.join(uarts)}")
        self._random, self._probability = place.random, given["probability"]
        self._evidence, self._node = place.evidence, given["node"]
        super().__init__(place.layers, uarts[given["node"]], "sink")

    def __call__(self, t_ns: int, packet: bytes) -> None:
        """In the place of who listens."""
        if self.below is None:
            return
        if self._random.random() < self._probability:
            bit = int(self._random.integers(8 * len(packet)))
            broken = bytearray(packet)
            broken[bit // 8] ^= 1 << bit % 8
            packet = bytes(broken)
            self._evidence.act(t_ns, f"RS232 packet of {self._node}")
        self.below(t_ns, packet)


class PwmStuck(Staged):
    """The PWM keeps its duties whatever is written."""

    def __init__(self, place: Place, given: Mapping[str, Any], t_ns: int) -> None:
        self._held: tuple[float, float] | None = None
        super().__init__(place.network, given["axis"], place.evidence, t_ns)

    def duties(self, wanted: tuple[float, float]) -> tuple[float, float]:
        """Those of the beginning."""
        self._held = self._held or wanted
        return self._held
