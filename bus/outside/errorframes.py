"""Error frames as SocketCAN drivers send them (`linux/can/error.h`), and what the system drops."""

import os
import socket
import struct
from collections.abc import Callable
from contextlib import suppress
from typing import Final

import can

from bus.can.port import BusError, Port

# Classes, in the identifier (include/uapi/linux/can/error.h).
CAN_ERR_CRTL: Final = 0x004
CAN_ERR_PROT: Final = 0x008
CAN_ERR_ACK: Final = 0x020
CAN_ERR_BUSOFF: Final = 0x040
CAN_ERR_BUSERROR: Final = 0x080
CAN_ERR_RESTARTED: Final = 0x100
CAN_ERR_CNT: Final = 0x200
# Byte 1: the controller.
CRTL_RX_OVERFLOW: Final = 0x01
CRTL_RX_WARNING: Final = 0x04
CRTL_TX_WARNING: Final = 0x08
CRTL_RX_PASSIVE: Final = 0x10
CRTL_TX_PASSIVE: Final = 0x20
CRTL_ACTIVE: Final = 0x40
# Byte 2: the kind of a protocol violation, byte 3: where.
PROT_TX: Final = 0x80
PROT_KINDS: Final = {"bit": 0x01, "form": 0x02, "stuff": 0x04, "crc": 0x00, "ack": 0x00}
PROT_PLACES: Final = {"crc": 0x08, "ack": 0x19}
OF_A_SENDER: Final = {"stuff": "bit", "crc": "form"}
OF_A_RECEIVER: Final = {"bit": "stuff"}
"""What one node calls an error that the other side has found first: the six dominant bits of its flag. They
are a bit error to who sends a recessive one, a stuff error to who listens. Behind a wrong CRC they fall
into the recessive end of frame, a form error (ISO 11898-1, error detection)."""
WARNING: Final = 96
"""Counts from which a controller warns (ISO 11898-1; MCP2515 EFLG.EWARN)."""
_QUIET_NS: Final = 10_000_000
"""Simulated time between two messages of single errors: a driver that reported each would flood its reader.
ASSUMPTION; changes of state are always told."""
_LEVELS: Final = ("active", "warning", "passive", "bus_off")


def error_message(t_ns: int, classes: int, data: bytes, channel: str | None = None) -> can.Message:
    """An error frame: classes in its identifier, eight bytes of details."""
    return can.Message(
        timestamp=t_ns * 1e-9,
        arbitration_id=classes,
        is_error_frame=True,
        is_extended_id=False,
        dlc=len(data),
        data=data,
        channel=channel,
    )


class ErrorFrames:
    """Tells `emit` what befalls `port`: single errors (some of them), and every change of the error state.

    TEC and REC are in bytes 6 and 7.
    """

    def __init__(self, port: Port, emit: Callable[[can.Message], None], channel: str | None = None) -> None:
        self._port = port
        self._emit = emit
        self._channel = channel
        self._level = self._now()
        self._next_ns = 0
        port.on_error = self.take

    def _now(self) -> int:
        port = self._port
        if port.state != "active":
            return _LEVELS.index(port.state)
        return int(max(port.tec, port.rec) >= WARNING)

    def take(self, t_ns: int, error: BusError) -> None:
        """Called by the wire."""
        if error.kind and t_ns >= self._next_ns:
            self._next_ns = t_ns + _QUIET_NS
            self._single(t_ns, error)
        before, self._level = self._level, self._now()
        if self._level != before:
            self._changed(t_ns, before)

    def _single(self, t_ns: int, error: BusError) -> None:
        if error.kind == "ack" and error.sending:
            self._send(t_ns, CAN_ERR_ACK)
        else:
            name = (OF_A_SENDER if error.sending else OF_A_RECEIVER).get(error.kind, error.kind)
            kind = PROT_KINDS[name] | (PROT_TX if error.sending else 0)
            place = PROT_PLACES.get(name, 0)
            self._send(t_ns, CAN_ERR_PROT | CAN_ERR_BUSERROR, kind=kind, place=place)

    def _changed(self, t_ns: int, before: int) -> None:
        level = _LEVELS[self._level]
        if level == "bus_off":
            self._send(t_ns, CAN_ERR_BUSOFF)
        elif _LEVELS[before] == "bus_off":
            self._send(t_ns, CAN_ERR_RESTARTED | CAN_ERR_CRTL, CRTL_ACTIVE)
        else:
            self._send(t_ns, CAN_ERR_CRTL, self._controller(level))

    def _controller(self, level: str) -> int:
        if level == "active":
            return CRTL_ACTIVE
        tec, rec = self._port.tec, self._port.rec
        limit = WARNING if level == "warning" else 128
        sending, receiving = (
            (CRTL_TX_WARNING, CRTL_RX_WARNING) if level == "warning" else (CRTL_TX_PASSIVE, CRTL_RX_PASSIVE)
        )
        return (sending if tec >= limit else 0) | (receiving if rec >= limit else 0)

    def _send(self, t_ns: int, classes: int, controller: int = 0, kind: int = 0, place: int = 0) -> None:
        tec, rec = min(self._port.tec, 255), min(self._port.rec, 255)
        data = bytes((0, controller, kind, place, 0, 0, tec, rec))
        self._emit(error_message(t_ns, classes | CAN_ERR_CNT, data, self._channel))

    def close(self) -> None:
        """Nobody listens any more."""
        self._port.on_error = None


_SO_MEMINFO = 55
_DROPS = 8
"""Index of the drop counter among the nine numbers (SK_MEMINFO_DROPS, include/uapi/linux/sock_diag.h)."""


def overflow_message(t_ns: int) -> can.Message:
    """The error frame "receive buffer overflow", as SocketCAN drivers send it."""
    return error_message(t_ns, CAN_ERR_CRTL, bytes((0, CRTL_RX_OVERFLOW, 0, 0, 0, 0, 0, 0)))


def kernel_drops(bus: can.BusABC) -> int:
    """Messages the kernel dropped from the bus' socket because nobody read them in time; 0 if unknown."""
    with suppress(OSError, AttributeError, NotImplementedError, can.CanError, struct.error, ValueError):
        with socket.socket(fileno=os.dup(bus.fileno())) as copy:
            numbers = copy.getsockopt(socket.SOL_SOCKET, _SO_MEMINFO, 4 * (_DROPS + 1))
        return int(struct.unpack_from("=I", numbers, 4 * _DROPS)[0])
    return 0
