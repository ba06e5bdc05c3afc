"""A bus held dominant: nobody starts, error counters run up (ISO 11898-1, fault confinement)."""

from collections.abc import Sequence
from typing import Final

from bus.can import confinement
from bus.can.bits import INTERMISSION_BITS
from bus.can.disturbance import ERROR_DELIMITER_BITS, ERROR_FLAG_BITS
from bus.can.port import Port
from bus.can.wire import Wire

_SEEN_BITS: Final = 6
"""Six equal bits are a stuff error."""
_REPEAT_BITS: Final = 8
"""Every eight dominant bits after the flag count once more."""


class StuckDominant:
    """Holds `wire` dominant from the moment it is made until `release`.

    What was being sent stays in its buffer. After six bits everybody sees an error: REC + 1 (the sender
    TEC + 8). At the first bit after the error flag receivers count 8 more. From fourteen bits after the
    flag's start on, each node counts 8 more for every eight bits. So a sender goes off the bus after some
    270 bits, and receivers end passive: REC alone takes nobody off.
    """

    def __init__(self, wire: Wire, t_ns: int) -> None:
        self._wire = wire
        self._sender = wire._trouble.block(t_ns)
        self._held = True
        wire.queue.at(t_ns + _SEEN_BITS * wire.bit_ns, self._seen)

    def _seen(self, t_ns: int) -> None:
        if not self._held:
            return
        self._wire._trouble.errors["stuff" if self._sender is None else "bit"] += 1
        confinement.receive_failed(self._receivers())
        sender = self._sender
        self._send_failed()
        self._tell(t_ns, "bit" if sender is not None else "stuff", [sender] if sender is not None else [])
        self._wire.queue.at(t_ns + (ERROR_FLAG_BITS + 1) * self._wire.bit_ns, self._flagged)

    def _flagged(self, t_ns: int) -> None:
        if not self._held:
            return
        confinement.still_dominant(self._receivers())
        self._tell(t_ns)
        self._wire.queue.at(t_ns + _REPEAT_BITS * self._wire.bit_ns, self._again)

    def _again(self, t_ns: int) -> None:
        if not self._held:
            return
        receivers = self._receivers()
        confinement.still_dominant(receivers)
        self._send_failed()
        self._tell(t_ns)
        if self._sender is not None or not all(confinement.saturated(port) for port in receivers):
            self._wire.queue.at(t_ns + _REPEAT_BITS * self._wire.bit_ns, self._again)

    def _receivers(self) -> list[Port]:
        live = [port for port in self._wire.ports if port.online and not port._bus_off]
        return [port for port in live if port is not self._sender]

    def _send_failed(self) -> None:
        sender = self._sender
        if sender is not None:
            self._wire._trouble.sender_failed(sender, "bit")
            if sender._bus_off or not sender.online:
                self._sender = None

    def _tell(self, t_ns: int, kind: str = "", senders: Sequence[Port] = ()) -> None:
        self._wire._trouble.report(t_ns, kind, self._wire.ports, senders)
        for port in self._wire.ports:
            if port.watcher is not None:
                port.watcher.counted(t_ns)

    def release(self, t_ns: int) -> None:
        """The bus is recessive again: after an error delimiter and intermission somebody may start."""
        self._held = False
        bits = ERROR_DELIMITER_BITS + INTERMISSION_BITS
        self._wire._trouble.unblock(t_ns, t_ns + bits * self._wire.bit_ns)
