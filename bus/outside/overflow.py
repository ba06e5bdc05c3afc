"""What a full receiver says, and what the system has dropped before anybody could look."""

import os
import socket
import struct
from contextlib import suppress

import can

from bus.outside.errorframes import CAN_ERR_CRTL, CRTL_RX_OVERFLOW, error_message

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
