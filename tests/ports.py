"""TCP ports for tests that run side by side: reserved on the machine, not only found free."""

from __future__ import annotations

import itertools
import socket

_FIRST, _END = 20000, 32768
"""Below Linux' ephemeral ports, which outgoing connections take at any moment."""

_reserved: list[socket.socket] = []
"""One abstract Unix socket per port; the kernel frees them when this process ends."""

_next = itertools.count(_FIRST)


def _reserve(port: int) -> bool:
    mark = socket.socket(socket.AF_UNIX)
    try:
        mark.bind(f"\0schmidt-tests-{port}")
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", port))
    except OSError:
        mark.close()
        return False
    _reserved.append(mark)
    return True


def free_ports(count: int = 1) -> int:
    """First of `count` ports in a row that nobody listens on and no other test gets."""
    row = 0
    for port in _next:
        assert port < _END, "no free ports"
        row = row + 1 if _reserve(port) else 0
        if row == count:
            return port - count + 1
    raise AssertionError
