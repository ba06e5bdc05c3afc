"""What a user writes for a bus: what reaches python-can, and what is refused in one line."""

import errno
import os
import socket
import sys
from collections.abc import Iterator
from typing import Any

import can
import pytest

from bus.outside import external
from bus.outside.external import SpecError, open_bus


class Opened:
    """In place of a bus: notes how it was opened. number: its descriptor."""

    def __init__(self, number: int, given: dict[str, Any]) -> None:
        self.number, self.given = number, given

    def fileno(self) -> int:
        if self.number < 0:
            raise NotImplementedError
        return self.number


@pytest.fixture
def pair() -> Iterator[tuple[socket.socket, socket.socket]]:
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as four,
        socket.socket(socket.AF_INET6, socket.SOCK_DGRAM) as six,
    ):
        yield four, six


def opened(monkeypatch: pytest.MonkeyPatch, spec: str, number: int = -1) -> dict[str, Any]:
    """What `can.Bus` is given."""
    monkeypatch.setattr(can, "Bus", lambda **given: Opened(number, given))
    bus: Any = open_bus(spec)
    assert isinstance(bus, Opened)
    return bus.given


def test_a_channel_and_its_options_reach_python_can(monkeypatch: pytest.MonkeyPatch) -> None:
    assert opened(monkeypatch, "socketcan:vcan0") == {
        "interface": "socketcan", "channel": "vcan0", "ignore_config": True,
    }  # fmt: skip
    given = opened(monkeypatch, "slcan:/dev/ttyACM0:9,bitrate=1000000,mode=a=b,empty=,id=0x11")
    assert given.pop("ignore_config") is True
    assert given == {
        "interface": "slcan", "channel": "/dev/ttyACM0:9", "bitrate": 1_000_000, "mode": "a=b", "empty": "",
        "id": "0x11",
    }  # fmt: skip


@pytest.mark.parametrize(("digits", "kind"), [(18, int), (19, str), (5000, str)])
def test_a_number_of_any_length_is_no_trouble(
    digits: int, kind: type, monkeypatch: pytest.MonkeyPatch
) -> None:
    given = opened(monkeypatch, f"virtual:a,n={'9' * digits}")
    assert type(given["n"]) is kind and int(str(given["n"])[:18]) == 10**18 - 1


@pytest.mark.parametrize(("spec", "words"), [
    ("", "expected INTERFACE:CHANNEL"), ("virtual", "expected INTERFACE:CHANNEL"),
    (":a", "expected INTERFACE:CHANNEL"), ("virtual:", "expected INTERFACE:CHANNEL"),
    ("virtual:,a=1", "expected INTERFACE:CHANNEL"),
    ("virtuel:a", 'no interface "virtuel"; it has .*, virtual'),
    ("virtual:a,b", 'option "b" is not key=value'), ("virtual:a,=1", 'option "=1" is not key=value'),
    ("virtual:a,", 'option "" is not key=value'),
])  # fmt: skip
def test_a_text_that_names_no_bus_is_refused(spec: str, words: str, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(SpecError, match=f'^"{spec}": .*{words}'):
        opened(monkeypatch, spec)


class Odd(Exception):
    """An error without a word."""


@pytest.mark.parametrize(("error", "spec", "line"), [
    (ValueError("two\n lines"), "virtual:a", "two lines"),
    (OSError(errno.ENODEV, "No such device"), "virtual:a", "No such device"),
    (OSError(errno.ENODEV, "No such device"), "socketcan:can7",
     "No such device; try: sudo ip link add dev can7 type vcan && sudo ip link set can7 up"),
    (OSError(errno.EPERM, "Not permitted"), "socketcan:can7", "Not permitted"),
    (Odd(), "virtual:a", "Odd"),
])  # fmt: skip
def test_why_a_bus_cannot_be_opened_is_one_line(
    error: Exception, spec: str, line: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(**_: object) -> None:
        raise error

    monkeypatch.setattr(can, "Bus", refused)
    with pytest.raises(SpecError) as caught:
        open_bus(spec)
    assert str(caught.value) == f'"{spec}" cannot be opened: {line}'


def test_a_remedy_is_found_behind_whatever_was_raised_meanwhile() -> None:
    """By cause, or by what was being handled."""
    last = OSError(errno.ENETDOWN, "down")
    middle, first = ValueError("odd"), can.CanError("no")
    middle.__context__, first.__cause__ = last, middle
    assert external._remedy(first) == "sudo ip link set {0} up"
    assert external._remedy(ValueError("odd")) == ""
    assert external._remedy(None) == ""


def test_a_socket_gets_a_large_buffer_and_stays_open(
    pair: tuple[socket.socket, socket.socket], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[tuple[int, ...]] = []
    real = socket.socket

    class Noting(real):  # type: ignore[misc, valid-type]
        def setsockopt(self, *given: int) -> None:
            asked.append(given)
            super().setsockopt(*given)

    monkeypatch.setattr(socket, "socket", Noting)
    opened(monkeypatch, "socketcan:vcan0", pair[0].fileno())
    assert asked == [(socket.SOL_SOCKET, socket.SO_RCVBUF, 8 * 1024 * 1024)]
    assert os.fstat(pair[0].fileno())


@pytest.mark.skipif(sys.platform != "linux", reason="Linux' option")
@pytest.mark.parametrize(("interface", "heard"), [("udp_multicast", 0), ("socketcan", 1)])
def test_a_multicast_socket_hears_its_own_group_alone(
    interface: str, heard: int, pair: tuple[socket.socket, socket.socket], monkeypatch: pytest.MonkeyPatch
) -> None:
    """IP_MULTICAST_ALL is 49 (linux/in.h), IPV6_MULTICAST_ALL 29 (linux/in6.h); both are on by default."""
    four, six = pair
    for each in pair:
        opened(monkeypatch, f"{interface}:239.74.163.2", each.fileno())
    assert four.getsockopt(socket.IPPROTO_IP, 49) == heard
    assert six.getsockopt(socket.IPPROTO_IPV6, 29) == heard


def test_what_is_no_socket_is_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    with open(os.devnull, encoding="ascii") as file:
        assert opened(monkeypatch, "slcan:a", file.fileno())["channel"] == "a"
        external._prepare(file.fileno(), "slcan")
        assert not file.closed
