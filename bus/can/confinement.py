"""Error counters by ISO 11898-1 (fault confinement): what every outcome adds and takes."""

from collections.abc import Iterable
from typing import Final

from bus.can.port import Port

BUS_OFF_ABOVE: Final = 255
RECOVERY_RUNS: Final = 128
"""Bus-off recovery: this many runs of eleven recessive bits."""
RECOVERY_RUN_BITS: Final = 11
SUSPEND_BITS: Final = 8
"""A passive node waits this long after its own frame before it may send again."""
_REC_AFTER_PASSIVE_OK: Final = 127
"""A good reception takes a passive REC back to 119..127; the standard leaves which (ASSUMPTION: 127)."""
_REC_MAX: Final = 255
"""REC registers are 8 bits wide and do not wrap (MCP2515 register 1Dh)."""


def sent(port: Port) -> None:
    """A frame went out well."""
    if port.tec:
        port.tec -= 1


def received(ports: Iterable[Port]) -> None:
    """A frame came in well."""
    for port in ports:
        if port.rec and not port.listen_only:
            port.rec = min(port.rec - 1, _REC_AFTER_PASSIVE_OK)


def send_failed(port: Port, *, acknowledge: bool) -> bool:
    """The sender saw an error; True when that takes it off the bus.

    A passive sender that misses only the acknowledge does not count: a lone node stays at 128 for ever.
    """
    if not (acknowledge and port.state == "passive"):
        port.tec += 8
    return port.tec > BUS_OFF_ABOVE


def receive_failed(ports: Iterable[Port], first: Port | None = None) -> None:
    """Receivers saw an error; `first` alone saw it, and then sees the others' flags after its own."""
    for port in ports:
        if port.listen_only:
            continue
        port.rec = min(port.rec + (9 if port is first and port.state == "active" else 1), _REC_MAX)


def still_dominant(ports: Iterable[Port]) -> None:
    """Receivers see dominant bits where the error delimiter should be: 8 each time."""
    for port in ports:
        if not port.listen_only:
            port.rec = min(port.rec + 8, _REC_MAX)


def saturated(port: Port) -> bool:
    """Whether a receiver's counter goes no higher."""
    return port.listen_only or port.rec >= _REC_MAX
