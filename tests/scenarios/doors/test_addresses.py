"""Addresses of doors as they are written, and those that cannot be listened on."""

import socket
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenarios.doors.clients import address, is_local, listen


@pytest.mark.parametrize(
    ("text", "found"),
    [("7411", ("127.0.0.1", 7411)), ("host:1", ("host", 1)), ("[::1]:65535", ("::1", 65535)),
     ("0.0.0.0:00080", ("0.0.0.0", 80))],
)  # fmt: skip
def test_an_address_is_a_port_with_or_without_its_host(text: str, found: tuple[str, int]) -> None:
    assert address(text, "--x") == found


@pytest.mark.parametrize("text", ["", "a:b", ":7411", "1234567", "[]:80", "a\0b:80", "²", "-1", "host:"])
def test_what_is_no_address_is_said_with_an_example(text: str) -> None:
    with pytest.raises(ValueError) as caught:
        address(text, "--x")
    assert str(caught.value) == f'--x "{text}": expected [HOST:]PORT, for example 7411'


def test_a_long_text_is_cut() -> None:
    with pytest.raises(ValueError, match='^--x "' + "y" * 80 + '": expected'):
        address("y" * 90, "--x")


@given(st.integers(0, 99999), st.integers(1, 10))
def test_a_port_leaves_room_for_those_behind_it(port: int, ports: int) -> None:
    last = 65535 - ports + 1
    if 1 <= port <= last:
        assert address(str(port), "--x", ports)[1] == port
    else:
        with pytest.raises(ValueError, match=rf"^--x {port}: a port lies within 1\.\.{last}$"):
            address(str(port), "--x", ports)


@pytest.mark.parametrize("host", ["127.0.0.1", "127.9.9.9", "::1", "localhost", "::ffff:127.0.0.1"])
def test_loopback_is_local_and_nothing_else(host: str) -> None:
    assert is_local(host)
    assert not is_local("1" + host) and not is_local("192.0.2.1") and not is_local("")


def test_an_address_that_cannot_be_listened_on_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def none(*_: Any, **__: Any) -> Any:
        raise OSError(98, "Address already in use")

    monkeypatch.setattr(socket.socket, "bind", none)
    with pytest.raises(OSError, match=r"^127\.0\.0\.1:7411 cannot be listened on: Address already in use$"):
        listen("127.0.0.1", 7411)
    monkeypatch.setattr(socket, "getaddrinfo", none)
    with pytest.raises(OSError, match=r"^127\.0\.0\.1:7411 cannot be used: "):
        listen("127.0.0.1", 7411)
