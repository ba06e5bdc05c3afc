"""What can go wrong on a wire: missing acknowledge, disturbed bits, collisions, nodes going off, bus-off
recovery.

Kept apart from the wire so that a healthy bus pays one flag test per frame.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from heapq import heappush
from typing import TYPE_CHECKING, Final

from bus.can import confinement
from bus.can.bits import INTERMISSION_BITS, wire_bits
from bus.can.disturbance import (
    ERROR_DELIMITER_BITS,
    ERROR_FLAG_BITS,
    OVERLOAD_DELIMITER_BITS,
    OVERLOAD_FLAG_BITS,
    ErrorKind,
    Flip,
    Verdict,
    first_difference,
    overloads,
    seen_by_all,
    seen_by_receiver,
)
from bus.can.frame import Frame
from bus.can.port import BusError, Entry, Offer, Port, Receive
from bus.can.recovery import Recovery
from bus.can.strangers import Strangers

if TYPE_CHECKING:
    from bus.can.wire import Wire

_NEVER: Final = 1 << 61
_RECESSIVE_TAIL_BITS: Final = 1 + 7
"""ACK delimiter and EOF: already recessive when a frame ends."""
_OVERLOAD_BITS: Final = OVERLOAD_FLAG_BITS + 1 + OVERLOAD_DELIMITER_BITS
"""One receiver begins its overload flag in the first bit of intermission; the others see that bit and begin
theirs one bit later."""


def _needs_care(port: Port) -> bool:
    """Whether a node makes its wire decide everything when it happens."""
    return bool(port.watcher or port.timing or port.listen_only)


class Trouble:
    """Error handling of one wire; tells it when trouble is near."""

    def __init__(self, wire: "Wire") -> None:
        self.disturb: Callable[[int, Frame, str], Flip | None] | None = None
        self.errors: Counter[str] = Counter()
        self._wire = wire
        self._excluded: list[Port] = []
        self._twins: list[Offer] = []
        self._recovery = Recovery(wire)
        self._overload = False
        """An overload frame follows what is being sent."""
        self._blocked = False
        """The bus is held dominant."""

    def check(self) -> None:
        """Look again whether trouble is near."""
        wire = self._wire
        live = [port for port in wire.ports if port.online and not port._bus_off]
        near = bool(
            self.disturb
            or self._blocked
            or self._twins
            or (not wire._busy and wire._end_ns != _NEVER)  # an error frame is on the wire
            or len(live) < 2
            or self._recovery.pending
            or any(port.tec or port.rec for port in live)
            or any(_needs_care(port) for port in wire.ports)
        )
        if near and not wire._near:
            wire.trouble_nears()
        wire._near = near

    def listeners(self, sender: Port) -> list[Port]:
        """Nodes that hear (and acknowledge) what `sender` sends."""
        return [
            port
            for port in self._wire.ports
            if port.online and not port._bus_off and port is not sender and port not in self._excluded
        ]

    def decide(self, sof_ns: int) -> None:
        """Arbitration and outcome of the frame that starts at `sof_ns`, with all that can befall it."""
        wire = self._wire
        waiting = [Offer(*entry) for entry in wire._waiting]
        ready = [
            offer
            for offer in waiting
            if max(offer.ready_ns, offer.port._quiet_ns) <= sof_ns + wire.bit_ns and not offer.port._bus_off
        ]
        starts = [max(offer.ready_ns, offer.port._quiet_ns) for offer in waiting if not offer.port._bus_off]
        if not ready or min(starts) > sof_ns:
            if starts:
                wire._call_decide(max(wire._free_ns, min(starts)))
            return
        self._recovery.frame_starts(sof_ns)
        winner = min(ready)
        rivals: dict[Port, Offer] = {}
        for offer in sorted(ready):
            if offer.key == winner.key and offer.port is not winner.port:
                rivals.setdefault(offer.port, offer)
        self._twins, self._excluded, self._overload = [], [], False
        self._wake(sof_ns + wire.bit_ns)
        for rival in rivals.values():
            winner = self._collide(winner, rival, sof_ns)
            if wire._free_ns > sof_ns:
                return  # it ended in an error frame
        self._judge(winner, sof_ns)
        self._tell(winner, ready, sof_ns + wire.bit_ns)

    def _wake(self, t_ns: int) -> None:
        """Nodes asleep wake up at the start of a frame, and miss this one."""
        for port in self._wire.ports:
            if port.asleep and port.watcher is not None:
                self._excluded.append(port)
                port.watcher.activity(t_ns)

    def _tell(self, winner: Offer, ready: list[Offer], t_ns: int) -> None:
        """Tell watchers who has begun and who has lost."""
        told = [winner.port, *(twin.port for twin in self._twins)]
        for port in told:
            if port.watcher is not None:
                port.watcher.began(t_ns)
        for port in dict.fromkeys(offer.port for offer in sorted(ready)):
            if port not in told and port.watcher is not None:
                port.watcher.lost(t_ns)

    def _collide(self, one: Offer, other: Offer, sof_ns: int) -> Offer:
        """Two nodes send one identifier: the first recessive bit that differs is its sender's bit error."""
        parted = first_difference(wire_bits(one.frame), wire_bits(other.frame))
        if parted is None:
            self._twins.append(other)
            self._excluded.append(other.port)
            self._wire._near = True  # until `delivered` has seen to the second sender
            return one
        index, one_is_recessive = parted
        loser, winner = (one, other) if one_is_recessive else (other, one)
        if loser.port.state == "passive":
            # Its recessive flag disturbs nobody: the other frame goes on.
            self.errors["bit"] += 1
            self.sender_failed(loser.port, "bit")
            self.report(sof_ns, "bit", [loser.port], [loser.port])
            if loser.port.watcher is not None:
                loser.port.watcher.failed(sof_ns, sending=True)
            loser.port._quiet_ns = sof_ns + (winner.bits + confinement.SUSPEND_BITS) * self._wire.bit_ns
            return winner
        self._fail(winner, Verdict("bit", index), sof_ns, also=loser.port)
        return winner

    def _judge(self, offer: Offer, sof_ns: int) -> None:
        wire = self._wire
        listeners = self.listeners(offer.port)
        flip = self.disturb(sof_ns, offer.frame, offer.port.name) if self.disturb else None
        if flip is not None:
            everyone = flip.seen_by is None or flip.seen_by == offer.port.name
            verdict = (seen_by_all if everyone else seen_by_receiver)(offer.frame, flip.bit)
            first = next((port for port in listeners if port.name == flip.seen_by), None)
            if first is None and not everyone:
                verdict = None  # that node is off, or not here
            if verdict is not None and first is not None and (first.state == "passive" or first.listen_only):
                self._misses(first, verdict.kind, sof_ns)  # its flag is recessive, or there is none
                verdict = None
            if verdict is not None:
                self._fail(offer, verdict, sof_ns, first=first)
                return
            self._overload = first is not None and overloads(offer.frame, flip.bit)
        heard = Strangers(self._wire, offer, listeners).judge()
        for port in heard.deaf:
            self._misses(port, "stuff", sof_ns)
        if heard.error_bit is not None:
            self._fail(offer, Verdict("bit", heard.error_bit), sof_ns, first=heard.first)
            return
        offer = heard.offer
        if not heard.acknowledged:
            self._fail(
                offer, Verdict("ack", offer.bits - INTERMISSION_BITS - _RECESSIVE_TAIL_BITS - 1), sof_ns
            )
            return
        wire._remove(heard.entry)
        wire._begin(offer, sof_ns)
        if self._overload:
            wire._free_ns += _OVERLOAD_BITS * wire.bit_ns

    def _misses(self, port: Port, kind: ErrorKind, t_ns: int) -> None:
        """A receiver sees an error and disturbs nobody: it just has not got the frame."""
        self.errors[kind] += 1
        confinement.receive_failed([port])
        self._excluded.append(port)
        self._tell_failed([port], t_ns)
        self.report(t_ns, kind, [port])

    def _fail(
        self,
        offer: Offer,
        verdict: Verdict,
        sof_ns: int,
        *,
        first: Port | None = None,
        also: Port | None = None,
    ) -> None:
        """An error frame ends the frame that began at `sof_ns`; it stays in its buffer and is sent again."""
        wire = self._wire
        # Seen by one node only, the flag is answered by the others' flags once six equal bits have gone by.
        flag_bits = ERROR_FLAG_BITS * (2 if first is not None else 1)
        bits = verdict.detected_bit + 1 + flag_bits + ERROR_DELIMITER_BITS + INTERMISSION_BITS
        wire._free_ns = sof_ns + bits * wire.bit_ns
        wire.bits += bits
        wire._end_ns = wire._free_ns - wire._eof_ns
        wire._near = True
        self._recovery.quiet_since_ns = wire._end_ns - ERROR_DELIMITER_BITS * wire.bit_ns
        senders = [port for port in (offer.port, also) if port is not None]

        def end(t_ns: int) -> None:
            if t_ns == wire._end_ns:
                wire._end_ns = _NEVER
                self._account(offer, senders, verdict, first, t_ns)

        wire.queue.at(wire._end_ns, end)

    def _account(
        self, offer: Offer, senders: list[Port], verdict: Verdict, first: Port | None, t_ns: int
    ) -> None:
        wire = self._wire
        self.errors[verdict.kind] += 1
        receivers = [port for port in self.listeners(offer.port) if port not in senders]
        if verdict.received:
            # A dominant last bit of EOF is an overload condition for receivers: the frame counts as received.
            confinement.received(receivers)
        else:
            confinement.receive_failed(receivers, first)
        if verdict.sender == "lost":
            confinement.receive_failed(senders)
        elif verdict.sender == "transmits":
            for port in senders:
                self.sender_failed(port, verdict.kind)
        for port in senders:
            if port.state == "passive":
                port._quiet_ns = wire._free_ns + confinement.SUSPEND_BITS * wire.bit_ns
        for port in senders:
            if port.watcher is not None:
                port.watcher.failed(t_ns, sending=True)
        self._tell_failed(receivers, t_ns)
        self.report(t_ns, verdict.kind, [*senders, *receivers], senders)
        wire._await_ready()
        if verdict.received:
            for call in wire._calls(receivers, offer.frame):
                call(t_ns, offer.frame)

    @staticmethod
    def report(t_ns: int, kind: str, ports: Iterable[Port], senders: Sequence[Port] = ()) -> None:
        """Tell nodes of an error, or (kind "") of counters that have changed, when they listen for it."""
        for port in ports:
            if port.on_error is not None:
                port.on_error(t_ns, BusError(kind, port in senders))

    @staticmethod
    def _tell_failed(ports: list[Port], t_ns: int) -> None:
        """Tell receivers' watchers of an error and of their counters."""
        for port in ports:
            if port.watcher is not None:
                port.watcher.failed(t_ns, sending=False)

    def sender_failed(self, port: Port, kind: ErrorKind) -> None:
        """A sender saw an error: it counts, and may go off the bus."""
        if port.online and confinement.send_failed(port, acknowledge=kind == "ack"):
            port._bus_off = True
            self._recovery.add(port)

    def delivered(self, entry: Entry, t_ns: int) -> tuple[Receive, ...]:
        """A good frame ended: counters go down. Returns who gets it."""
        wire = self._wire
        offer = Offer(*entry)
        self._recovery.quiet_since_ns = t_ns - _RECESSIVE_TAIL_BITS * wire.bit_ns
        if self._overload:
            wire.bits += _OVERLOAD_BITS
            delimiter = (OVERLOAD_DELIMITER_BITS + INTERMISSION_BITS) * wire.bit_ns
            self._recovery.quiet_since_ns = wire._free_ns - delimiter
            self._overload = False
        senders = [offer.port]
        for twin in self._twins:
            wire._remove(twin)
            twin.port._free += 1
            senders.append(twin.port)
            if twin.port.on_sent is not None:
                twin.port.on_sent(t_ns, twin.frame)
        for port in senders:
            confinement.sent(port)
            if port.state == "passive":
                port._quiet_ns = wire._free_ns + confinement.SUSPEND_BITS * wire.bit_ns
        listeners = self.listeners(offer.port)
        confinement.received(listeners)
        for port in (*senders, *listeners):
            if port.watcher is not None:
                port.watcher.counted(t_ns)
        self.report(t_ns, "", [*senders, *listeners])
        self._twins, self._excluded = [], []
        self.check()
        return wire._calls(listeners, offer.frame)

    def cut(self, t_ns: int) -> None:
        """The sender went off in the middle of its frame: six recessive bits later everyone else objects.

        Unless another node is sending the very same frame: nobody notices, and it is that node's.
        """
        wire = self._wire
        assert wire._busy
        if self._twins:
            twin = self._twins.pop(0)
            wire._remove(twin)
            wire._sending = twin
            return
        offer, wire._busy = Offer(*wire._sending), False
        planned = offer.bits + (_OVERLOAD_BITS if self._overload else 0)
        begun_ns = wire._free_ns - planned * wire.bit_ns
        bits = 6 + ERROR_FLAG_BITS + ERROR_DELIMITER_BITS + INTERMISSION_BITS
        wire._free_ns = t_ns + bits * wire.bit_ns
        wire.bits += bits + (t_ns - begun_ns) // wire.bit_ns
        wire._end_ns = _NEVER
        wire._decide_ns = _NEVER
        delimiter = (ERROR_DELIMITER_BITS + INTERMISSION_BITS) * wire.bit_ns
        self._recovery.quiet(wire._free_ns - delimiter)
        self.errors["stuff"] += 1
        listeners = self.listeners(offer.port)
        confinement.receive_failed(listeners)
        self.report(t_ns, "stuff", listeners)
        self._twins, self._excluded = [], []
        wire._await_ready()

    def block(self, t_ns: int) -> Port | None:
        """The bus goes dominant at `t_ns` and stays so; returns who was sending. Its frame stays in its
        buffer."""
        wire = self._wire
        wire._unplan()
        self._recovery.frame_starts(t_ns)
        self._recovery.quiet_since_ns = _NEVER
        sender = None
        if wire._busy:
            sender = wire._sending[3]
            begun_ns = wire._free_ns - wire._sending[5] * wire.bit_ns
            wire.bits += max(0, t_ns - begun_ns) // wire.bit_ns
            heappush(wire._waiting, wire._sending)
        wire._busy = False
        wire._end_ns = wire._decide_ns = wire._free_ns = _NEVER
        self._twins, self._excluded = [], []
        self._blocked = True
        self.check()
        return sender

    def unblock(self, t_ns: int, free_ns: int) -> None:
        """The bus is recessive again at `t_ns`; a frame may start at `free_ns`."""
        wire = self._wire
        self._blocked = False
        wire._free_ns = free_ns
        self._recovery.quiet(t_ns)
        wire._await_ready()

    def leaves(self, port: Port) -> None:
        """`port` is not on this wire any more, or has lost what it had to send."""
        self._twins = [twin for twin in self._twins if twin.port is not port]
        self._recovery.drop(port)

    def comes_off(self, port: Port) -> None:
        """A node that is bus off joins this wire."""
        self._recovery.join(port)

    def restart(self, port: Port) -> None:
        """`port` was switched: counters start from zero."""
        port.tec = port.rec = 0
        port._bus_off = False
        self.leaves(port)
        self.check()
