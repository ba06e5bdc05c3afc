"""Nodes of different bit rates on one wire: who understands whom, and who destroys what."""

from typing import TYPE_CHECKING, Final

from bus.can.bits import INTERMISSION_BITS, wire_bits
from bus.can.port import Offer, Port
from bus.can.sampling import BitTiming, error_ns

if TYPE_CHECKING:
    from bus.can.wire import Wire

_ACK_FROM_END: Final = 9
"""The ACK slot's place counted from the end of EOF: delimiter 1, EOF 7, and itself."""


class Strangers:
    """What the listeners make of one frame.

    offer: as it lies on this wire (its bits counted in the wire's). entry: as it stands in the buffer.
    acknowledged: somebody understands it and may say so. error_bit: the bit, of this wire, at which an error
    flag comes in; None: none does. first: the one node that raises it. deaf: nodes that miss the frame and
    can do nothing about it.
    """

    def __init__(self, wire: "Wire", offer: Offer, listeners: list[Port]) -> None:
        self.entry = self.offer = offer
        self.error_bit: int | None = None
        self.first: Port | None = None
        self.deaf: list[Port] = []
        self._wire = wire
        self._listeners = listeners
        sender = offer.port.timing
        self._sent_ns = float(wire.bit_ns) if sender is None else sender.bit_ns
        own = BitTiming(wire.bit_ns)
        self._strangers = [port for port in listeners if not (port.timing or own).fits(self._sent_ns)]
        self.acknowledged = any(not port.listen_only and port not in self._strangers for port in listeners)

    def judge(self) -> "Strangers":
        """Find out what happens; returns itself."""
        wire = self._wire
        if self._sent_ns != wire.bit_ns:
            bits = round(self.offer.bits * self._sent_ns / wire.bit_ns)
            self.offer = self.offer._replace(bits=bits)
        for port in self._strangers:
            self._hears(port)
        return self

    def _hears(self, port: Port) -> None:
        levels = wire_bits(self.offer.frame)
        if self.acknowledged:
            levels[-_ACK_FROM_END] = 0
        wire = self._wire
        seen_ns = error_ns(levels, self._sent_ns, port.timing or BitTiming(wire.bit_ns))
        if seen_ns is None:
            return
        bit = int(seen_ns / wire.bit_ns)
        if port.listen_only or port.state == "passive" or bit >= self.offer.bits - INTERMISSION_BITS:
            self.deaf.append(port)
        elif self.error_bit is None or bit < self.error_bit:
            self.error_bit, self.first = bit, port
        elif bit == self.error_bit:
            self.first = None
