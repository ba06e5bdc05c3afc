"""Kinds of ports: the gateway as hidraw device or local socket, the bus by python-can, a serial port."""

import os
import select
import socket
import threading
from collections.abc import Callable
from dataclasses import dataclass
from queue import SimpleQueue

import can
import serial

from bus.can.frame import Frame
from bus.outside.external import open_bus
from bus.protocol.report import REPORT_BYTES, ReportError, pack_report, slot, unpack_commands
from host.logs.files import reason as reason_of

READ_S = 0.2
"""Longest wait within a read; how soon a task notices that it shall end."""
RETRY_S = 1.0


@dataclass(eq=False)
class LinkTask:
    """A thread that reads one port into `inbox` as (name, bytes).

    say: called with one line when the port opens or breaks; from the task, so it has to be thread-safe.
    lost: writes that found it broken.
    """

    name: str
    opener: Callable[[], "HidPort | CanPort | SerialPort"]
    inbox: SimpleQueue[tuple[str, bytes]]
    say: Callable[[str], None]
    lost: int = 0
    breaks: int = 0

    def __post_init__(self) -> None:
        self._port: HidPort | CanPort | SerialPort | None = None
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._run, name=self.name, daemon=True)

    def start(self) -> None:
        """Begin; a port that is not there is tried again every second."""
        self._thread.start()

    @property
    def is_open(self) -> bool:
        """Whether the port is there."""
        return self._port is not None

    def write(self, data: bytes) -> None:
        """Send, or count it lost."""
        port = self._port
        try:
            if port is None:
                raise OSError("closed")
            port.write(data)
        except Exception:  # the reading side reports what broke
            self.lost += 1

    def close(self) -> None:
        """End the task."""
        self._end.set()
        if self._thread.is_alive():
            self._thread.join(2 * READ_S + RETRY_S)

    def _run(self) -> None:
        reason = ""
        while not self._end.is_set():
            try:
                self._port = self.opener()
                self.say(f"{self.name}: open")
                reason = ""
                while not self._end.is_set():
                    data = self._port.read()
                    if data:
                        self.inbox.put((self.name, data))
            except Exception as error:  # whatever a driver raises, it breaks this link only
                self.breaks += 1
                words = reason_of(error)
                if words != reason:
                    self.say(f"{self.name}: broken: {words}; tried again every second")
                    reason = words
            finally:
                port, self._port = self._port, None
                if port is not None:
                    port.close()
            self._end.wait(RETRY_S)


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
        try:
            return pack_report([slot(Frame(message.arbitration_id, bytes(message.data)))])
        except ReportError:  # of nobody in the protocol
            return b""

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
