"""The safety chain: hardware beside the firmware that cuts the motors' supply.

Contacts in series hold the contactor between the supply and the power stages of both drives. They are the
emergency stop's button, a limit switch at each end of both axes, and a watchdog of each axis board if wanted.
The boards keep their supply. An open chain is latched: it closes when no cause is left and both axes say OFF.
No source shows a chain on this telescope: all of it is an ASSUMPTION, made as is usual on machines.
"""

from collections.abc import Callable, Iterator, Mapping
from math import ceil
from typing import Final

from boards.core import PeriodicBoard
from bus.can import Frame
from bus.protocol import MEASUREMENT_BASE, AxisMode, unpack_motion
from plant.gears import RATIO
from scenarios.lab.layers import Evidence, Staged
from scenarios.lab.network import Network

NONE, SWITCHES, WATCHDOG = "none", "switches", "watchdog"
"""Chains of `network.chain`: none; button and switches; these and watchdogs."""
FED_NS: Final = 50_000_000
"""A watchdog's time. ASSUMPTION: ten control ticks, as long as an axis board does without positions."""
DROP_NS: Final = 20_000_000
"""The contactor falls this much later. ASSUMPTION: usual for one of 24 V with a diode over its coil."""
_SOONEST_NS: Final = 5_000_000
"""Between two looks at a switch: at 3 deg/s (paper) the axis goes on by 0.015 deg."""
_OPEN_NS: Final = 50_000_000  # Between two looks at an open chain: five MOTION frames of each axis.
_STRONGEST: Final = 1.5  # Most that the fault `weak_supply` makes of the supply.


class _Unsupplied(Staged):
    """Motors without supply, whatever their switches do."""

    last = True

    def duties(self, _wanted: tuple[float, float]) -> tuple[float, float]:
        """None."""
        return 0.0, 0.0


class Chain:
    """ends: of each axis, where its switches stand (low, high), rad. guards: the boards that feed a watchdog.

    told: hears every change, (t_ns, text). Looks again no later than an axis at its no-load rate can be at a
    switch: far from the ends every few seconds.
    """

    def __init__(
        self, network: Network, ends: Mapping[str, tuple[float, float]], guards: Mapping[str, PeriodicBoard]
    ) -> None:
        self._network = network
        self._ends = ends
        self._guards = guards
        model, boards = network.plant.model, network.boards
        most = _STRONGEST * model.supply.voltage.si
        motors = {axis: getattr(model.axes, axis).motor for axis in ends}
        self._fastest = {axis: most / (each.torque_constant.si * RATIO) for axis, each in motors.items()}
        self._pressed = 0
        self._standing: tuple[str, ...] = ()
        self._motion = {name: MEASUREMENT_BASE + boards[name].device_type for name in map(board_of, ends)}
        self._off: set[str] = set()
        self._cut: list[_Unsupplied] = []
        self.open = False
        self.told: Callable[[int, str], None] | None = None
        network.queue.at(network.queue.now_ns, self._look)

    def press(self, t_ns: int) -> bool:
        """One more hand on the button; whether that opened the chain."""
        before = self.open
        self._pressed += 1
        self._now(t_ns)
        return not before

    def release(self, t_ns: int) -> None:
        """One fewer."""
        self._pressed -= 1
        self._now(t_ns)

    def _now(self, t_ns: int) -> None:
        self._network.queue.take_out([self._look].__contains__)
        self._look(t_ns)

    def _look(self, t_ns: int) -> None:
        causes = tuple(self._causes(t_ns))
        for cause in causes:
            if cause not in self._standing:
                self._tell(t_ns, f"{'also' if self.open else 'opens'}: {cause}")
                self._open(t_ns)
        self._standing = causes
        if self.open and not causes and len(self._off) == len(self._ends):
            self._close(t_ns)
        self._off.clear()
        self._network.queue.at(self._next(t_ns), self._look)

    def _causes(self, t_ns: int) -> Iterator[str]:
        """Causes that hold the chain open now."""
        if self._pressed:
            yield "emergency stop"
        for axis, (low, high) in self._ends.items():
            angle = self._angle(axis, t_ns)
            if not low < angle < high:
                yield f"limit switch of {axis}, {'low' if angle <= low else 'high'} end"
        for name, board in self._guards.items():
            if _due(board) <= t_ns:
                yield f"watchdog of {name}, not fed for {FED_NS // 1_000_000} ms"

    def _next(self, t_ns: int) -> int:
        if self.open:
            return t_ns + _OPEN_NS
        times = [_due(board) for board in self._guards.values()]
        for axis, (low, high) in self._ends.items():
            angle = self._angle(axis, t_ns)
            away = min(angle - low, high - angle) / self._fastest[axis]
            times.append(t_ns + max(ceil(away * 1e9), _SOONEST_NS))
        return min(times)

    def _angle(self, axis: str, t_ns: int) -> float:
        angle: float = getattr(self._network.plant, axis).truth(t_ns)[0]
        return angle

    def _open(self, t_ns: int) -> None:
        if not self.open:
            self.open = True
            self._network.wire.tap(self._heard)
            self._network.queue.at(t_ns + DROP_NS, self._drop)

    def _drop(self, t_ns: int) -> None:
        self._cut = [_Unsupplied(self._network, axis, Evidence(""), t_ns) for axis in self._ends]

    def _close(self, t_ns: int) -> None:
        self.open = False
        self._network.wire.untap(self._heard)
        self._network.queue.take_out([self._drop].__contains__)
        for each in self._cut:
            each.clear(t_ns)
        self._cut = []
        self._tell(t_ns, "closes: both axes are OFF")

    def _heard(self, _t_ns: int, frame: Frame, sender: str) -> None:
        """The contact by which an axis board says OFF: its MOTION frames say the same."""
        if self._motion.get(sender) == frame.identifier:
            off = unpack_motion(frame.data).mode == AxisMode.OFF
            (self._off.add if off else self._off.discard)(sender)

    def _tell(self, t_ns: int, text: str) -> None:
        if self.told is not None:
            self.told(t_ns, text)


def _due(board: PeriodicBoard) -> int:
    """When a board's watchdog has not been fed for too long: its timer's routine feeds it, every tick."""
    return board.epoch_ns + board.ticks * board.period_ns + FED_NS


def board_of(axis: str) -> str:
    """The board that drives an axis."""
    return f"AXIS_{axis.upper()}"


def chained(network: Network, soft_rad: Mapping[str, tuple[float, float]], kind: str) -> Chain | None:
    """The chain of a network (`NONE`, `SWITCHES` or `WATCHDOG`); its switches stand halfway between the soft
    limits, rad, and the hard stops.
    """
    ends: dict[str, tuple[float, float]] = {}
    guards: dict[str, PeriodicBoard] = {}
    for axis, (low, high) in soft_rad.items():
        board = network.boards.get(board_of(axis))
        if isinstance(board, PeriodicBoard):  # an AVR has no motors
            stops = getattr(network.plant.model.axes, axis).stops
            ends[axis] = 0.5 * (low + stops.low.si), 0.5 * (high + stops.high.si)
            guards[board.name] = board
    if kind == NONE or not ends:
        return None
    return Chain(network, ends, guards if kind == WATCHDOG else {})
