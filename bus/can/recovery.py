"""Bus-off recovery: a node returns after 128 runs of eleven recessive bits (ISO 11898-1)."""

from typing import TYPE_CHECKING, Final

from bus.can.confinement import RECOVERY_RUN_BITS, RECOVERY_RUNS
from bus.can.port import Port

if TYPE_CHECKING:
    from bus.can.wire import Wire

_NEVER: Final = 1 << 61
_RECESSIVE_BITS: Final = 8
"""Of what is on the wire when it ends: ACK delimiter and EOF, or an error delimiter."""


class Recovery:
    """Counts recessive runs on one wire while a node is bus off."""

    def __init__(self, wire: "Wire") -> None:
        self.quiet_since_ns = 0
        self._wire = wire
        self._runs = 0
        self._back_at: dict[Port, int] = {}

    @property
    def pending(self) -> bool:
        """Whether any node is bus off."""
        return bool(self._back_at)

    def add(self, port: Port) -> None:
        """`port` has just gone bus off."""
        self._back_at[port] = self._runs + RECOVERY_RUNS
        self._look_again()

    def join(self, port: Port) -> None:
        """`port`, bus off, has come from another wire: its runs begin with the first one that begins here."""
        under_way = 0
        if self._wire._end_ns == _NEVER:
            now_ns = self._wire.queue.now_ns
            runs = self._runs_until(now_ns)
            self._runs += runs
            self.quiet_since_ns += runs * RECOVERY_RUN_BITS * self._wire.bit_ns
            under_way = int(self.quiet_since_ns < now_ns)
        self._back_at[port] = self._runs + under_way + RECOVERY_RUNS
        self._look_again()

    def drop(self, port: Port) -> None:
        """`port` was switched on or off: no recovery is due."""
        self._back_at.pop(port, None)

    def quiet(self, t_ns: int) -> None:
        """The bus is recessive from `t_ns` on, after a time in which it was not."""
        self.quiet_since_ns = t_ns
        if self._back_at:
            self._look_again()

    def frame_starts(self, sof_ns: int) -> None:
        """A quiet stretch ends at `sof_ns`."""
        self._runs += self._runs_until(sof_ns)

    def _runs_until(self, t_ns: int) -> int:
        return max(0, t_ns - self.quiet_since_ns) // (RECOVERY_RUN_BITS * self._wire.bit_ns)

    def _look_again(self) -> None:
        """Call back at the earliest time the next node can be through, if the bus stays quiet."""
        wire = self._wire
        ends_ns = wire._end_ns - _RECESSIVE_BITS * wire.bit_ns
        quiet = self.quiet_since_ns if wire._end_ns == _NEVER else ends_ns
        needed = min(self._back_at.values()) - self._runs
        t_ns = quiet + needed * RECOVERY_RUN_BITS * wire.bit_ns
        wire.queue.at(t_ns, self._recover)

    def _recover(self, t_ns: int) -> None:
        wire = self._wire
        if not self._back_at:
            return
        runs = self._runs + (self._runs_until(t_ns) if wire._end_ns == _NEVER else 0)
        back = [port for port, at in self._back_at.items() if at <= runs]
        for port in back:
            del self._back_at[port]
            port._bus_off = False
            port.tec = port.rec = 0
            if port.watcher is not None:
                port.watcher.counted(t_ns)
        wire._trouble.report(t_ns, "", back)
        if back:  # the first good frame looks whether trouble is near still
            wire._await_ready(not_before_ns=t_ns)
        if self._back_at:
            self._look_again()
