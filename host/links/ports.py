"""Kinds of ports: the gateway as hidraw device or local socket, the bus by python-can, a serial port."""

import os
import select
import socket

import can
import serial

from bus.can.frame import Frame
from bus.outside.external import open_bus
from bus.protocol.report import REPORT_BYTES, pack_report, slot, unpack_commands
from host.links.task import READ_S


class HidPort:
    """The gateway's reports: /dev/hidrawN, or `unix:PATH`, one to a message (`serve --hid unix:PATH`)."""

    def __init__(self, spec: str) -> None:
        kind, _, path = spec.partition(":")
        self._number = b""
        if kind == "unix":
            with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as connection:
                connection.connect(path)
                self._file = connection.detach()
        else:
            self._file = os.open(spec, os.O_RDWR | os.O_CLOEXEC)
            self._number = b"\0"  # reports have none

    def read(self) -> bytes:
        """One IN report."""
        ready, _, _ = select.select([self._file], [], [], READ_S)
        if not ready:
            return b""
        data = os.read(self._file, REPORT_BYTES)
        if not data:
            raise OSError("the other end has gone")
        return data

    def write(self, data: bytes) -> None:
        """One OUT report."""
        os.write(self._file, self._number + data)

    def close(self) -> None:
        """Hang up."""
        os.close(self._file)


class CanPort:
    """The bus itself, without the gateway: frames are put into reports and commands taken out of them."""

    def __init__(self, spec: str) -> None:
        self._bus = open_bus(spec)

    def read(self) -> bytes:
        """One frame, as a report of one slot; frames of others are passed over."""
        message = self._bus.recv(READ_S)
        if message is None or message.is_extended_id or message.is_error_frame or len(message.data) != 8:
            return b""
        frame = Frame(message.arbitration_id, bytes(message.data))
        return pack_report([slot(frame)]) if _from_a_board(frame.identifier) else b""

    def write(self, data: bytes) -> None:
        """The commands of one OUT report."""
        for frame in unpack_commands(data):
            self._bus.send(
                can.Message(arbitration_id=frame.identifier, data=frame.data, is_extended_id=False)
            )

    def close(self) -> None:
        """Leave the bus."""
        self._bus.shutdown()


class SerialPort:
    """A board's RS232 by pyserial: a device, `socket://`, `rfc2217://`. 115 200 baud, ASSUMPTION (boards)."""

    def __init__(self, url: str) -> None:
        self._port = serial.serial_for_url(url, 115200, timeout=READ_S)

    def read(self) -> bytes:
        """What has come."""
        data: bytes = self._port.read(max(1, self._port.in_waiting))
        return data

    def write(self, data: bytes) -> None:
        """Nothing is ever sent to a board here, but a port can."""
        self._port.write(data)

    def close(self) -> None:
        """Close it."""
        self._port.close()


def _from_a_board(identifier: int) -> bool:
    return 0x100 <= identifier < 0x400 or 0x700 <= identifier < 0x780
