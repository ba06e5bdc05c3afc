"""A board's PDOs as a master has set them: identifier, transmission type, mapped objects (CiA 301, 7.5.2.35).

As they come, each carries one documented frame, when the firmware sends or takes it.
"""
# mypy: allow-untyped-calls

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from canopen.objectdictionary import ODVariable
from canopen.sdo.exceptions import SdoAbortedError

from boards.canopen.dictionary import FRAMES, MAPPED, SENT
from bus.can import Frame

if TYPE_CHECKING:
    import canopen

RECEIVE: Final = 0x1400
TRANSMIT: Final = tuple(0x1800 + number for number in range(len(SENT)))
RECORDS: Final = (RECEIVE, *TRANSMIT)
_MAPPING: Final = 0x200
"""From a PDO's communication record to its mapping."""
_INVALID: Final = 1 << 31
_EXTENDED: Final = 1 << 29
_IDENTIFIER: Final = 0x7FF
_LAST: Final = 0x580
"""Identifiers beyond belong to SDO and heartbeat (CiA 301, table 41)."""
_CYCLIC: Final = 240
_EVENT: Final = (254, 255)
"""Transmission types: 0 and 1 to 240 synchronous, 254 and 255 by event (table 72)."""
_STATE: Final = 0x08000022
_RANGE: Final = 0x06090030
_UNMAPPABLE: Final = 0x06040041
_TOO_LONG: Final = 0x06040042
"""Abort codes: device state; value range; object cannot be mapped; PDO length exceeded (table 22)."""


@dataclass(frozen=True, slots=True)
class Pdo:
    """identifier: None while it is not valid. kind: transmission type. mapped: (index, sub-index, bytes)."""

    identifier: int | None
    kind: int
    mapped: tuple[tuple[int, int, int], ...]


class Pdos:
    """frames: the documented frames last sent, by sub-index of 0x2000."""

    def __init__(self, node: canopen.LocalNode) -> None:
        self.node = node
        self.frames: dict[int, bytes] = {}
        self.syncs = 0
        self._set: dict[int, Pdo] = {}
        self._due: set[int] = set()
        self._received: bytes | None = None

    def forget(self) -> None:
        """Read what is set again, and begin afresh."""
        self._set.clear()
        self._due.clear()
        self._received = None

    def of(self, record: int) -> Pdo:
        """How the PDO with this communication record is set."""
        found = self._set.get(record)
        if found is None:
            count = self._number(record + _MAPPING, 0)
            entries = [self._number(record + _MAPPING, sub) for sub in range(1, count + 1)]
            identifier = self._number(record, 1)
            found = self._set[record] = Pdo(
                None if identifier & _INVALID else identifier & _IDENTIFIER,
                self._number(record, 2),
                tuple((entry >> 16, entry >> 8 & 0xFF, (entry & 0xFF) // 8) for entry in entries),
            )
        return found

    def _number(self, index: int, sub: int) -> int:
        return int.from_bytes(self.node.get_data(index, sub), "little")

    # --- out ----------------------------------------------------------------------------------------
    def event(self, number: int, data: bytes) -> Frame | None:
        """The firmware sends the frame of TPDO `number`, from 0: what goes out now."""
        self.frames[2 + number] = data
        record = TRANSMIT[number]
        kind = self.of(record).kind
        if kind not in _EVENT:
            if not kind:
                self._due.add(record)
            return None
        return self._frame(record)

    def sync(self) -> tuple[list[Frame], bytes | None]:
        """A SYNC: frames that go out, and a received PDO that waited for it."""
        self.syncs += 1
        sent: list[Frame] = []
        for number, record in enumerate(TRANSMIT):
            kind = self.of(record).kind
            cyclic = 0 < kind <= _CYCLIC and self.syncs % kind == 0 and 2 + number in self.frames
            if (cyclic or record in self._due) and (frame := self._frame(record)) is not None:
                sent.append(frame)
        self._due.clear()
        waiting, self._received = self._received, None
        return sent, waiting

    def _frame(self, record: int) -> Frame | None:
        pdo = self.of(record)
        if pdo.identifier is None or not pdo.mapped:
            return None
        return Frame(pdo.identifier, b"".join(self._value(index, sub) for index, sub, _ in pdo.mapped))

    def _value(self, index: int, sub: int) -> bytes:
        if index == FRAMES:
            return self.frames.get(sub, bytes(8))
        return bytes(self.node.get_data(index, sub))

    # --- in -----------------------------------------------------------------------------------------
    def take(self, data: bytes) -> bytes | None:
        """RPDO1 has come: what there is to carry out now."""
        if self.of(RECEIVE).kind in _EVENT:
            return data
        self._received = data
        return None

    def command(self) -> bool:
        """Whether RPDO1 carries the documented COMMAND."""
        return self.of(RECEIVE).mapped == ((FRAMES, 1, 8),)

    def carry_out(self, data: bytes) -> bool:
        """Write what RPDO1 maps; False when it is too short."""
        at = 0
        for index, sub, size in self.of(RECEIVE).mapped:
            if at + size > len(data):
                return False
            with suppress(SdoAbortedError):  # a value out of bounds changes nothing
                self.node.set_data(index, sub, data[at : at + size])
            at += size
        return True

    # --- setting ------------------------------------------------------------------------------------
    def check(self, index: int, sub: int, value: int) -> None:
        """Raise SdoAbortedError unless `value` may be written; what is set is read again afterwards."""
        record = index if index in RECORDS else index - _MAPPING
        if record not in RECORDS:
            return
        valid = self.of(record).identifier is not None
        if index != record:
            self._check_mapping(record, sub, value, valid)
        elif sub == 1:
            moved = valid and not value & _INVALID and value & _IDENTIFIER != self.of(record).identifier
            if moved or value & _EXTENDED or not 0 < value & ~(3 << 30) <= _LAST:
                raise SdoAbortedError(_RANGE)
        elif not (value <= _CYCLIC or value in _EVENT):
            raise SdoAbortedError(_RANGE)
        self._set.pop(record, None)

    def _check_mapping(self, record: int, sub: int, value: int, valid: bool) -> None:
        if valid or (sub and self.of(record).mapped):
            raise SdoAbortedError(_STATE)
        if not sub:
            entries = [self._number(record + _MAPPING, each) for each in range(1, min(value, MAPPED) + 1)]
            if value > MAPPED or sum(entry & 0xFF for entry in entries) > 8 * MAPPED:
                raise SdoAbortedError(_TOO_LONG)
            for entry in entries:
                self._check_entry(record, entry)
        elif value:
            self._check_entry(record, value)

    def _check_entry(self, record: int, entry: int) -> None:
        try:
            found = self.node._find_object(entry >> 16, entry >> 8 & 0xFF)
        except SdoAbortedError:
            raise SdoAbortedError(_UNMAPPABLE) from None
        fits = isinstance(found, ODVariable) and found.pdo_mappable and len(found) == entry & 0xFF
        fits = fits and found.subindex == entry >> 8 & 0xFF
        if not fits or (record == RECEIVE and not found.writable):
            raise SdoAbortedError(_UNMAPPABLE)
