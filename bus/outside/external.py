"""`INTERFACE:CHANNEL[,key=value…]` as users write it on the command line, opened as a python-can bus."""

import errno
import logging
import os
import socket
import sys
from contextlib import suppress
from stat import S_ISSOCK
from typing import Any

import can

logging.getLogger("can").addHandler(logging.NullHandler())
"""What python-can has to say arrives as an exception; its logger would write a second line to the screen."""

_ALL_GROUPS = (
    (socket.AF_INET, socket.IPPROTO_IP, 49),  # IP_MULTICAST_ALL
    (socket.AF_INET6, socket.IPPROTO_IPV6, 29),  # IPV6_MULTICAST_ALL
)
"""Linux' option by which a socket hears every group that anybody on the machine has joined, by default on."""
_BUFFER_BYTES = 1 << 23
"""Asked for at the socket: the default holds 25 ms of a flood, and the machine may be busy for longer."""


_SOCKETCAN = {
    errno.EAFNOSUPPORT: "udp_multicast:239.74.163.2, which needs no CAN in the kernel",
    errno.ENODEV: "sudo ip link add dev {0} type vcan && sudo ip link set {0} up",
    errno.ENETDOWN: "sudo ip link set {0} up",
}
"""A remedy by the error number with which Linux refuses a SocketCAN channel."""


class SpecError(ValueError):
    """A bus that cannot be opened, and why."""


def parsed(spec: str) -> tuple[str, str, dict[str, Any]]:
    """Interface, channel and options of `spec`; raises SpecError where no bus can be meant."""
    interface, colon, rest = spec.partition(":")
    channel, *options = rest.split(",")
    if not (interface and colon and channel):
        raise SpecError(f'"{spec}": expected INTERFACE:CHANNEL, for example socketcan:vcan0')
    if interface not in can.VALID_INTERFACES:
        known = ", ".join(sorted(can.VALID_INTERFACES))
        raise SpecError(f'"{spec}": python-can has no interface "{interface}"; it has {known}')
    settings: dict[str, Any] = {}  # an interface's own, which the signature of `can.Bus` cannot know
    for option in options:
        key, equals, value = option.partition("=")
        if not (key and equals):
            raise SpecError(f'"{spec}": option "{option}" is not key=value')
        settings[key] = int(value) if value.isdecimal() and len(value) < 19 else value
    return interface, channel, settings


def open_bus(spec: str) -> can.BusABC:
    """The python-can bus that `spec` names, e.g. `socketcan:vcan0`, `udp_multicast:239.74.163.2,port=43113`.

    Raises SpecError with one line: what is wrong with the text, or why the interface cannot be opened.
    """
    interface, channel, settings = parsed(spec)
    try:
        bus = can.Bus(interface=interface, channel=channel, ignore_config=True, **settings)
    except Exception as error:  # forty interfaces, each with its own idea of what to raise for a wrong option
        reason = " ".join(str(getattr(error, "strerror", None) or error).split()) or type(error).__name__
        remedy = _remedy(error).format(channel) if interface == "socketcan" else ""
        raise SpecError(f'"{spec}" cannot be opened: {reason}{remedy and f"; try: {remedy}"}') from None
    with suppress(OSError, NotImplementedError, AttributeError, ValueError):  # no socket, or not so much
        _prepare(bus.fileno(), interface)
    return bus


def _prepare(number: int, interface: str) -> None:
    """A large buffer for a socket; of a descriptor that is none nothing is changed."""
    if not S_ISSOCK(os.fstat(number).st_mode):
        return
    with socket.socket(fileno=os.dup(number)) as copy:
        copy.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _BUFFER_BYTES)
        if interface == "udp_multicast" and sys.platform == "linux":
            _hear_one_group(copy)


def _remedy(error: BaseException | None) -> str:
    while error and getattr(error, "errno", None) not in _SOCKETCAN:
        error = error.__cause__ or error.__context__
    return _SOCKETCAN[getattr(error, "errno", 0)] if error else ""


def _hear_one_group(copy: socket.socket) -> None:
    """Let a multicast socket hear its own group alone; the port is shared by all buses of this machine."""
    for family, level, option in _ALL_GROUPS:
        if copy.family == family:
            copy.setsockopt(level, option, 0)
