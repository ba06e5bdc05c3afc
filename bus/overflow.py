"""What a full receiver says, and what the system has dropped before anybody could look."""

import os
import socket
import struct
from contextlib import suppress

import can

_CAN_ERR_CRTL = 0x004
_CAN_ERR_CRTL_RX_OVERFLOW = 0x01
"""Linux' classes of error frames (include/uapi/linux/can/error.h): controller, and in byte 1 what of it."""
_SO_MEMINFO = 55
_DROPS = 8
"""Index of the drop counter among the nine numbers (SK_MEMINFO_DROPS, include/uapi/linux/sock_diag.h)."""


def overflow_message(t_ns: int) -> can.Message:
    """The error frame "receive buffer overflow", as SocketCAN drivers send it."""
    data = bytes((0, _CAN_ERR_CRTL_RX_OVERFLOW, 0, 0, 0, 0, 0, 0))
    return can.Message(
        timestamp=t_ns * 1e-9,
        arbitration_id=_CAN_ERR_CRTL,
        is_error_frame=True,
        is_extended_id=False,
        dlc=len(data),
        data=data,
    )


def kernel_drops(bus: can.BusABC) -> int:
    """Messages the kernel dropped from the bus' socket because nobody read them in time; 0 if unknown."""
    with suppress(OSError, AttributeError, NotImplementedError, can.CanError, struct.error, ValueError):
        with socket.socket(fileno=os.dup(bus.fileno())) as copy:
            numbers = copy.getsockopt(socket.SOL_SOCKET, _SO_MEMINFO, 4 * (_DROPS + 1))
        return int(struct.unpack_from("=I", numbers, 4 * _DROPS)[0])
    return 0
