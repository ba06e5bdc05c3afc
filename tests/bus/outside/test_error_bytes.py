"""Bytes of error frames as `linux/can/error.h` has them, for a port that stands as it is told to."""

import os
import socket
import sys
from types import SimpleNamespace
from typing import Any, cast

import can
import pytest

from bus.can.port import BusError
from bus.outside.errorframes import ErrorFrames, kernel_drops, overflow_message

MS = 1_000_000
# include/uapi/linux/can/error.h, written out.
CRTL, PROT, ACK, BUSOFF, BUSERROR, RESTARTED, CNT = 0x04, 0x08, 0x20, 0x40, 0x80, 0x100, 0x200
TX = 0x80
LOC_CRC_SEQ, LOC_ACK = 0x08, 0x19


class Told:
    """Error frames of a port that has no wire."""

    def __init__(self, tec: int = 0, rec: int = 0, state: str = "active") -> None:
        self.port = cast(Any, SimpleNamespace(tec=tec, rec=rec, state=state, on_error=None))
        self.messages: list[can.Message] = []
        self.errors = ErrorFrames(self.port, self.messages.append, "lab")

    def stands(self, t_ns: int, tec: int = 0, rec: int = 0, state: str = "active") -> tuple[int, list[int]]:
        """Class and bytes of what a change of counters tells; nothing: 0."""
        self.port.tec, self.port.rec, self.port.state = tec, rec, state
        return self.befalls(t_ns, BusError(""))

    def befalls(self, t_ns: int, error: BusError) -> tuple[int, list[int]]:
        self.messages.clear()
        self.port.on_error(t_ns, error)
        if not self.messages:
            return 0, []
        (message,) = self.messages
        assert message.is_error_frame and not message.is_extended_id
        assert (message.dlc, message.channel) == (8, "lab")
        assert message.timestamp == pytest.approx(t_ns * 1e-9)
        return message.arbitration_id, list(message.data)


@pytest.mark.parametrize(("kind", "sending", "violation", "place"), [
    ("bit", False, 0x04, 0), ("bit", True, TX | 0x01, 0),
    ("form", False, 0x02, 0), ("form", True, TX | 0x02, 0),
    ("stuff", False, 0x04, 0), ("stuff", True, TX | 0x01, 0),
    ("crc", False, 0x00, LOC_CRC_SEQ), ("crc", True, TX | 0x02, 0),
    ("ack", False, 0x00, LOC_ACK),
])  # fmt: skip
def test_a_single_error_is_a_violation_with_its_kind_and_place(
    kind: str, sending: bool, violation: int, place: int
) -> None:
    told = Told(tec=7, rec=9)
    found = told.befalls(3 * MS, BusError(kind, sending))
    assert found == (PROT | BUSERROR | CNT, [0, 0, violation, place, 0, 0, 7, 9])


def test_a_missing_acknowledge_has_a_class_of_its_own() -> None:
    assert Told(tec=8).befalls(0, BusError("ack", sending=True)) == (ACK | CNT, [0, 0, 0, 0, 0, 0, 8, 0])


def test_single_errors_are_told_every_ten_milliseconds() -> None:
    told, error = Told(), BusError("form")
    heard = [t_ns for t_ns in range(0, 25 * MS, MS // 2) if told.befalls(t_ns, error)[0]]
    assert heard == [0, 10 * MS, 20 * MS]


def test_counters_alone_are_no_news() -> None:
    told = Told()
    assert told.stands(0, tec=95, rec=95) == (0, [])
    assert told.befalls(0, BusError("form"))[0]  # and do not count as a message


@pytest.mark.parametrize(("tec", "rec", "controller"), [
    (96, 0, 0x08), (0, 96, 0x04), (96, 96, 0x0C), (127, 95, 0x08), (95, 127, 0x04),
])  # fmt: skip
def test_a_controller_warns_from_96(tec: int, rec: int, controller: int) -> None:
    told = Told(95, 95)
    assert told.stands(5, tec, rec) == (CRTL | CNT, [0, controller, 0, 0, 0, 0, tec, rec])
    assert told.stands(6, tec, rec) == (0, [])  # once
    assert told.stands(7, 95, 95) == (CRTL | CNT, [0, 0x40, 0, 0, 0, 0, 95, 95])


@pytest.mark.parametrize(("tec", "rec", "controller"), [
    (128, 0, 0x20), (0, 128, 0x10), (128, 128, 0x30), (128, 127, 0x20), (127, 128, 0x10),
])  # fmt: skip
def test_a_passive_controller_says_which_counter_made_it_so(tec: int, rec: int, controller: int) -> None:
    told = Told(127)
    assert told.stands(5, tec, rec, "passive") == (CRTL | CNT, [0, controller, 0, 0, 0, 0, tec, rec])
    assert told.stands(6, 100, 0) == (CRTL | CNT, [0, 0x08, 0, 0, 0, 0, 100, 0])


def test_bus_off_and_back_are_told_and_a_count_has_a_byte() -> None:
    told = Told(250, 0, "passive")
    assert told.stands(5, 256, 0, "bus_off") == (BUSOFF | CNT, [0, 0, 0, 0, 0, 0, 255, 0])
    assert told.stands(6, 0, 300) == (RESTARTED | CRTL | CNT, [0, 0x40, 0, 0, 0, 0, 0, 255])


def test_a_single_error_may_change_the_state_too() -> None:
    told = Told(95)
    told.port.tec = 103
    told.port.on_error(0, BusError("bit", sending=True))
    assert [message.arbitration_id for message in told.messages] == [PROT | BUSERROR | CNT, CRTL | CNT]


def test_nobody_is_told_once_it_is_closed() -> None:
    told = Told()
    told.errors.close()
    assert told.port.on_error is None


def test_an_overflow_is_the_controllers() -> None:
    message = overflow_message(2_500_000_000)
    assert (message.arbitration_id, list(message.data)) == (CRTL, [0, 1, 0, 0, 0, 0, 0, 0])
    assert (message.is_error_frame, message.timestamp) == (True, 2.5)


@pytest.mark.skipif(sys.platform != "linux", reason="SO_MEMINFO is Linux'")
def test_what_the_kernel_drops_is_what_was_sent_and_never_came() -> None:
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as inner,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as outer,
    ):
        inner.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        inner.bind(("127.0.0.1", 0))
        inner.setblocking(False)
        bus: Any = SimpleNamespace(fileno=inner.fileno)
        assert kernel_drops(bus) == 0
        for _ in range(100):
            outer.sendto(bytes(200), inner.getsockname())
        dropped, came = kernel_drops(bus), 0
        while True:
            try:
                came += len(inner.recv(1000)) == 200
            except BlockingIOError:
                break
        assert 0 < dropped == 100 - came


def test_what_has_no_socket_has_dropped_nothing() -> None:
    def none() -> int:
        raise NotImplementedError

    nobody: Any = SimpleNamespace(fileno=none)
    assert kernel_drops(nobody) == 0
    with open(os.devnull, encoding="ascii") as file:
        plain: Any = SimpleNamespace(fileno=file.fileno)
        assert kernel_drops(plain) == 0
