"""The yardstick: the same ticks and frames by a bare heapq loop, an arbitrating bus and the compiled plant.

No boards, no firmware, no logs, no host: what any event simulation of this network in Python has to do. A
tick reads its pins and offers its frames; the bus sends the lowest identifier first, for its exact length.
"""

from collections.abc import Callable
from heapq import heappop, heappush
from itertools import count

from bus.can.length import plain_bits
from plant.axis import AxisPort
from plant.plant import Plant

_BIT_NS = 1_000
Pin = Callable[[int], int]


class BareLoop:
    """Eleven nodes' ticks: (period ns, pins read, identifiers sent every tick) each, phases apart."""

    def __init__(self, plant: Plant) -> None:
        self.now_ns = 0
        self.frames = 0
        self.ticks = 0
        self._heap: list[tuple[int, int, Callable[[int], None]]] = []
        self._ticket = count().__next__
        self._waiting: list[tuple[int, int, bytes]] = []
        self._busy = False
        for number, (period_ns, pins, identifiers) in enumerate(nodes(plant)):
            phase_ns = (number + 1) * 311_000
            self._arm(phase_ns, period_ns, pins, identifiers)

    def advance(self, until_ns: int) -> None:
        """Let simulated time go on to `until_ns`."""
        heap = self._heap
        while heap[0][0] <= until_ns:
            t_ns, _, call = heappop(heap)
            self.now_ns = t_ns
            call(t_ns)
        self.now_ns = until_ns

    def _arm(self, phase_ns: int, period_ns: int, pins: list[Pin], identifiers: list[int]) -> None:
        heap, ticket, waiting = self._heap, self._ticket, self._waiting

        def tick(t_ns: int) -> None:
            self.ticks += 1
            heappush(heap, (t_ns + period_ns, ticket(), tick))
            value = 0
            for pin in pins:
                value = pin(t_ns)
            for identifier in identifiers:
                data = (identifier & 0xFF | (value & 0xFFFF_FFFF) << 16).to_bytes(8, "little")
                heappush(waiting, (identifier, ticket(), data))
            if waiting and not self._busy:
                self._start(t_ns)

        heappush(heap, (phase_ns, ticket(), tick))

    def _start(self, t_ns: int) -> None:
        identifier, _, data = heappop(self._waiting)
        self._busy = True
        end_ns = t_ns + plain_bits(identifier, data) * _BIT_NS
        heappush(self._heap, (end_ns, self._ticket(), self._end))

    def _end(self, t_ns: int) -> None:
        self.frames += 1
        self._busy = False
        if self._waiting:
            self._start(t_ns)


def nodes(plant: Plant) -> list[tuple[int, list[Pin], list[int]]]:
    """The lab network: axis and position boards at 5 ms, motors at 10 ms, focus at 50 ms."""
    found: list[tuple[int, list[Pin], list[int]]] = []
    for side, port in enumerate((plant.ra, plant.dec)):
        found.append((5_000_000, [port.incremental], []))
        found.append((10_000_000, _currents(port), [0x211 + side]))
        found.append((5_000_000, [port.absolute], [0x221 + side]))
        found.append((10_000_000, [port.tachometer_a], [0x231 + 2 * side]))
        found.append((10_000_000, [port.tachometer_b], [0x232 + 2 * side]))
    found.append((50_000_000, [plant.focus.encoder], [0x241]))
    found.append((1_000_000_000, [], [0x700 + device for device in range(0x11, 0x1C)]))
    found.append((250_000_000, [], [0x311, 0x312, 0x321, 0x322]))
    return found


def _currents(port: AxisPort) -> list[Pin]:
    """Both motors' currents and new duties, as an axis board's telemetry tick takes them."""

    def current(t_ns: int) -> int:
        both = port.current(t_ns, 0) + port.current(t_ns, 1)
        port.drive(t_ns, 0.1, 0.1)
        return int(both * 1000.0)

    return [current]
