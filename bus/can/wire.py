"""One CAN bus: arbitration by identifier, exact frame times, delivery. What goes wrong is in `trouble.py`."""

from collections.abc import Callable
from heapq import heapify, heappop, heappush
from typing import Any, Final

from bus.can.bits import INTERMISSION_BITS
from bus.can.disturbance import Flip
from bus.can.frame import Frame
from bus.can.port import TX_BUFFERS, Entry, Port, Receive
from bus.can.trouble import Trouble
from bus.time import EventQueue

Tap = Callable[[int, Frame, str], None]
Disturb = Callable[[int, Frame, str], Flip | None]
_NEVER: Final = 1 << 61  # seventy years; the largest power that compiled code keeps in a register
_NS_PER_S: Final = 1_000_000_000
MAX_BITRATE: Final = 1_000_000
"""bit/s; CAN 2.0."""


class BitrateError(ValueError):
    """A bit rate CAN 2.0 does not have."""


class Wire:
    """One CAN bus of `bitrate` bit/s (bit times are whole nanoseconds).

    Whoever is ready by the end of the start-of-frame bit takes part in the arbitration. The lowest
    arbitration field wins, at equal fields the first come; two nodes with one identifier collide
    (`trouble.py`). A frame reaches its receivers at the end of EOF; the next may start after the three bits
    of intermission.
    """

    def __init__(self, queue: EventQueue, bitrate: int = MAX_BITRATE) -> None:
        if not 0 < bitrate <= MAX_BITRATE:
            raise BitrateError(f"bit rate {bitrate} bit/s: CAN 2.0 has 1..{MAX_BITRATE} bit/s")
        self.queue = queue
        self.bitrate = bitrate
        self.bit_ns = round(_NS_PER_S / bitrate)
        self.frames = 0
        self.bits = 0
        self.ports: list[Port] = []
        self._waiting: list[Entry] = []
        self._taps: list[Tap] = []
        self._tickets = 0
        self._free_ns = 0
        self._decide_ns = _NEVER
        self._end_ns = _NEVER
        self._sending: Entry
        self._busy = False
        """Whether `_sending` is meant: as a tuple or None it would be an object in compiled code."""
        self._eof_ns = INTERMISSION_BITS * self.bit_ns
        self._near = True
        """Whether anything but plain sailing is possible; kept by `Trouble`, read for every frame."""
        self._decided_ns = 0
        """When the first bit of what is being sent is over; until then it is a plan."""
        self._idle_ns = 0
        """When the bus falls free before what is being sent."""
        self._decide_call = self._decide
        self._deliver_call = self._deliver
        self._trouble = Trouble(self)

    def attach(self, name: str) -> Port:
        """A new node on this wire, online, accepting every frame."""
        port = Port(self, name)
        self.ports.append(port)
        self._trouble.check()
        return port

    def detach(self, port: Port) -> None:
        """Take a node off this wire for good; twice does nothing."""
        if port in self.ports:
            port.online = False
            self.ports.remove(port)
            self._trouble.check()

    def tap(self, call: Tap) -> None:
        """Have `call(t_end_ns, frame, sender)` made for every good frame; a tap does not acknowledge."""
        self._taps.append(call)

    def untap(self, call: Tap) -> None:
        """Make `call` no more; not from within a tap."""
        self._taps.remove(call)

    def disturb(self, call: Disturb | None) -> None:
        """Ask `call(t_sof_ns, frame, sender)` at the start of each frame for a bit to invert; None: quiet."""
        self._trouble.disturb = call
        self._trouble.check()

    @property
    def disturbance(self) -> Disturb | None:
        """What `disturb` was given last."""
        return self._trouble.disturb

    @disturbance.setter
    def disturbance(self, call: Disturb | None) -> None:
        self.disturb(call)

    @property
    def load(self) -> float:
        """Share of the time so far in which the bus carried frames (and intermission) or error frames."""
        return self.bits * self.bit_ns / self.queue.now_ns if self.queue.now_ns else 0.0

    @property
    def errors(self) -> dict[str, int]:
        """Error frames so far by cause: bit, stuff, form, crc, ack."""
        return dict(self._trouble.errors)

    def _offer(self, key: int, ready_ns: int, port: Port, frame: Frame, bits: int) -> None:
        now = self.queue.now_ns
        if ready_ns < now:
            ready_ns = now
        self._tickets = ticket = self._tickets + 1
        offer = (key, ticket, ready_ns, port, frame, bits)
        if self._near or self._decide_ns != _NEVER:
            heappush(self._waiting, offer)
            self._call_decide(ready_ns if ready_ns > self._free_ns else self._free_ns)
        elif not self._busy:
            self._begin(offer, ready_ns if ready_ns > self._free_ns else self._free_ns)
        else:
            heappush(self._waiting, offer)
            decided_ns = self._decided_ns
            if ready_ns <= decided_ns and (key <= self._sending[0] or ready_ns < decided_ns - self.bit_ns):
                self._unplan()
                self._plan()

    def _plan(self) -> None:
        """Find out who sends next if nobody else comes: somebody waits, and there is no plan yet.

        While all is well the outcome of an arbitration can be told in advance. It can be told again when
        somebody comes before the first bit is over. That costs one event a frame instead of two.
        """
        waiting = self._waiting
        sof_ns = self._free_ns
        if len(waiting) == 1:
            winner = waiting.pop()
            self._begin(winner, winner[2] if winner[2] > sof_ns else sof_ns)
            return
        if waiting[0][2] <= sof_ns:
            winner = heappop(waiting)
            rivals = waiting[:1]
        else:
            # The first in line may come later than the start of frame: look at everyone.
            sof_ns = max(sof_ns, min(offer[2] for offer in waiting))
            rivals = [offer for offer in waiting if offer[2] <= sof_ns + self.bit_ns]
            winner = min(rivals)
            self._remove(winner)
        if any(rival[0] == winner[0] and rival[3] is not winner[3] for rival in rivals):
            heappush(waiting, winner)
            self._call_decide(sof_ns)  # two nodes, one identifier: that is trouble, when the time comes
        else:
            self._begin(winner, sof_ns)

    def _unplan(self) -> bool:
        """Put a plan back whose first bit is not over yet; False: there is none."""
        if not self._busy or self.queue.now_ns > self._decided_ns:
            return False
        heappush(self._waiting, self._sending)
        self._busy = False
        self._end_ns = _NEVER
        self._free_ns = self._idle_ns
        return True

    def trouble_nears(self) -> None:
        """From now on arbitration is decided when it happens."""
        if self._unplan():
            self._await_ready()

    def _call_decide(self, sof_ns: int) -> None:
        """Have the arbitration of a frame that starts at `sof_ns` decided once its first bit is over."""
        t_ns = sof_ns + self.bit_ns
        if t_ns < self._decide_ns:
            self._decide_ns = t_ns
            self.queue.at(t_ns, self._decide_call)

    def _decide(self, t_ns: int) -> None:
        if t_ns != self._decide_ns:
            return  # overtaken by an earlier start
        self._decide_ns = _NEVER
        self._trouble.decide(t_ns - self.bit_ns)
        self._decided_ns = t_ns - 1  # what has begun here is no plan any more

    def _withdraw(self, port: Port, frame: Frame) -> bool:
        unplanned = self._unplan()
        found = next((offer for offer in self._waiting if offer[3] is port and offer[4] == frame), None)
        if found is not None:
            self._remove(found)
            port._free += 1
        if unplanned:
            self._await_ready()
        return found is not None

    def _remove(self, offer: Entry) -> None:
        self._waiting.remove(offer)
        heapify(self._waiting)

    def _await_ready(self, not_before_ns: int = 0) -> None:
        """Have the next start looked at when the first of those waiting is ready."""
        if self._waiting:
            earliest_ns = min(offer[2] for offer in self._waiting)
            # Who is bus off has been ready for long: no start lies more than a bit back.
            earliest_ns = max(earliest_ns, self.queue.now_ns - self.bit_ns)
            self._call_decide(max(self._free_ns, not_before_ns, earliest_ns))

    def _begin(self, winner: Entry, sof_ns: int) -> None:
        self._sending = winner
        self._busy = True
        bit_ns = self.bit_ns
        self._decided_ns = sof_ns + bit_ns
        self._idle_ns = self._free_ns
        self._free_ns = free_ns = sof_ns + winner[5] * bit_ns
        self._end_ns = end_ns = free_ns - self._eof_ns
        self.queue.at(end_ns, self._deliver_call)

    def _deliver(self, t_ns: int) -> None:
        if t_ns != self._end_ns or not self._busy:
            return  # another plan, or the sender went off in the middle
        offer = self._sending
        self._end_ns = _NEVER
        self._busy = False
        key, _, _, port, frame, bits = offer
        self.frames += 1
        self.bits += bits
        port._free += 1
        near = self._near
        if self._waiting:
            if near or self._decide_ns != _NEVER:
                self._call_decide(self._free_ns)
            else:
                self._plan()
        if near:
            calls = self._trouble.delivered(offer, t_ns)
        else:
            found = port._routes.get(key)
            if found is None:  # once, and kept until filters or nodes change
                found = port._routes[key] = self._calls(self._trouble.listeners(port), frame)
            calls = found
        now: Any = t_ns  # compiled code makes an object of it once, not for every call
        for tap in self._taps:
            tap(now, frame, port.name)
        for call in calls:
            call(now, frame)
        if port.on_sent is not None:
            port.on_sent(now, frame)

    def _calls(self, listeners: list[Port], frame: Frame) -> tuple[Receive, ...]:
        """Receivers of one identifier among `listeners`."""
        return tuple(
            port.on_receive
            for port in listeners
            if port.on_receive is not None and port.passes(frame.identifier)
        )

    def _forget_routes(self) -> None:
        for port in self.ports:
            port._routes.clear()

    def _switched(self, port: Port) -> None:
        """`port` was switched on or off."""
        unplanned = self._unplan()
        self._waiting = [offer for offer in self._waiting if offer[3] is not port]
        heapify(self._waiting)
        if self._busy and self._sending[3] is port:
            self._trouble.cut(self.queue.now_ns)
        port._free = TX_BUFFERS if port.online else 0
        self._trouble.restart(port)
        if unplanned:
            self._await_ready()
        self._forget_routes()
