"""Packs and unpacks the frame that a DBC message describes; no cantools once it is built."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from bus.protocol.saturate import Clip, nobody


class _Field(NamedTuple):
    name: str
    start: int
    length: int
    signed: bool
    scale: float
    offset: float
    low: int
    high: int


class FrameCodec:
    """One frame of eight bytes. message: cantools' message of one board; its constants (device type, kind)
    are filled in by themselves."""

    def __init__(self, message: Any) -> None:
        self.identifier: int = message.frame_id
        self.name: str = message.name
        self.period_ns: int = message.cycle_time * 1_000_000
        self._constant = 0
        self._fields: list[_Field] = []
        for signal in message.signals:
            if signal.byte_order != "little_endian":
                raise ValueError(f"{message.name}.{signal.name}: the protocol is little endian")
            if signal.name in ("Device", "Kind") and signal.minimum == signal.maximum:
                self._constant |= int(signal.minimum) << signal.start
            else:
                self._fields.append(_field(signal))

    def pack(self, values: Mapping[str, float], clip: Clip = nobody) -> bytes:
        """Eight bytes; values in their units by name (missing: 0). What is out of its range is cut, and
        `clip` told."""
        word = self._constant
        for name, start, length, _, scale, offset, low, high in self._fields:
            raw = round((values.get(name, 0) - offset) / scale)
            if not low <= raw <= high:
                clip()
                raw = min(max(raw, low), high)
            word |= (raw & ((1 << length) - 1)) << start
        return word.to_bytes(8, "little")

    def unpack(self, data: bytes) -> dict[str, float]:
        """Values in their units by name."""
        word = int.from_bytes(data, "little")
        values: dict[str, float] = {}
        for name, start, length, signed, scale, offset, _, _ in self._fields:
            raw = word >> start & ((1 << length) - 1)
            if signed and raw >> (length - 1):
                raw -= 1 << length
            values[name] = raw * scale + offset
        return values


def _field(signal: Any) -> _Field:
    least = -(1 << (signal.length - 1)) if signal.is_signed else 0
    most = least + (1 << signal.length) - 1
    low, high = (
        bound if limit is None else round((limit - signal.offset) / signal.scale)
        for limit, bound in ((signal.minimum, least), (signal.maximum, most))
    )
    return _Field(
        signal.name, signal.start, signal.length, signal.is_signed, signal.scale, signal.offset,
        max(low, least), min(high, most),
    )  # fmt: skip
