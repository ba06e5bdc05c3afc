"""The encoder's end of the line, clock edge by clock edge (hardware.md 3.1)."""

from collections.abc import Callable
from enum import Enum, auto

from boards.chips.endat import registers as at
from boards.chips.endat.answer import Answers, value_of
from boards.chips.endat.registers import MODES, Mode, Reply
from boards.silicon.endat import CALCULATION_NS, RECOVERY_NS


class Phase(Enum):
    """Where a transfer is."""

    IDLE = auto()
    COMMAND = auto()
    WAIT = auto()
    SEND = auto()
    SUPPLEMENT = auto()
    DONE = auto()


class ClockedEncoder:
    """A rotary encoder on pin: (t_ns) -> position.

    The clock idles HIGH; its first falling edge latches the position. Mode bits are taken at rising edges,
    data change at rising edges and are taken by the master at the falling one that follows. A command that
    does not exist gets no start bit (ASSUMPTION: error type I of the manuals, whose line level is not
    published).
    """

    def __init__(self, pin: Callable[[int], int]) -> None:
        self.pin = pin
        self.answers = Answers()
        self.output: int | None = None
        self._clock = 1
        self._phase = self._after = Phase.IDLE
        self._mode: Mode | None = None
        self._in: list[int] = []
        self._bits: list[int] = []
        self._edge_ns = self._ready_ns = self._count = self._sent = self._latched = 0

    @property
    def phase(self) -> Phase:
        """Where the transfer is."""
        return self._phase

    def level(self, t_ns: int) -> int:
        """The data line at `t_ns`: LOW at rest, which a transfer ends in once t_m is over. HIGH where the
        encoder lets go of it (ASSUMPTION: the receiver's bias)."""
        over = self._phase is Phase.DONE and t_ns - self._edge_ns >= self.recovery_ns
        if over or self._phase is Phase.IDLE:
            return 0
        return 1 if self.output is None else self.output

    @property
    def recovery_ns(self) -> int:
        """t_m, as selected."""
        return at.SHORT_RECOVERY_NS if self.answers.memory.short_recovery else RECOVERY_NS

    def edge(self, t_ns: int, clock: int, data: int) -> None:
        """The clock goes to `clock` (0, 1) at `t_ns`, while the master has `data` on the line.

        Times must not go back. The same level again is no edge.
        """
        if clock == self._clock:
            return
        held_ns = t_ns - self._edge_ns
        self._clock = clock
        self._edge_ns = t_ns
        if clock:
            if held_ns > at.LOW_RESETS_NS:
                self._phase = Phase.IDLE
            elif self._phase is not Phase.IDLE:
                self._rise(t_ns, data)
            return
        over = self._phase is Phase.DONE and held_ns >= self.recovery_ns
        if over or (self._phase not in (Phase.IDLE, Phase.DONE) and held_ns > at.HIGH_RESETS_NS):
            self._phase = Phase.IDLE
        if self._phase is Phase.IDLE and t_ns >= self.answers.silent_until_ns:
            self._begin(t_ns)

    def _begin(self, t_ns: int) -> None:
        self._latched = self.pin(t_ns)
        self._phase = Phase.COMMAND
        self._mode = None
        self._in = []
        self._count = 0
        self.output = None

    def _rise(self, t_ns: int, data: int) -> None:
        self._count += 1
        if self._phase is Phase.COMMAND:
            self._command(t_ns, data)
        elif self._phase is Phase.WAIT:
            if t_ns >= self._ready_ns:
                self.output = 1
                self._phase = Phase.SEND
        elif self._phase is Phase.SEND:
            self._send()
        elif self._phase is Phase.SUPPLEMENT:
            self._supplement(t_ns, data)

    def _command(self, t_ns: int, data: int) -> None:
        bits = self._count - at.DUMMY_CLOCKS
        needed = at.MODE_BITS + (at.ARGUMENT_BITS if self._mode is not None and self._mode.argument else 0)
        if 0 < bits <= needed:
            self._in.append(data)
        if bits == at.MODE_BITS:
            self._mode = MODES.get(value_of(self._in))
            if self._mode is None:
                self._phase, self.output = Phase.DONE, 0
        elif bits == needed + at.TURN_CLOCKS:
            self._answer(t_ns)

    def _answer(self, t_ns: int) -> None:
        mode = self._mode
        assert mode is not None
        self.output = 0
        self._phase = Phase.WAIT
        self._sent = 0
        code = value_of(self._in[: at.MODE_BITS])
        argument = self._in[at.MODE_BITS :]
        self._bits = self.answers.bits(t_ns, code, mode, self._latched, value_of(argument))
        self._after = Phase.SUPPLEMENT if mode.supplement else Phase.DONE
        busy = mode.reply is Reply.PARAMETER
        self._ready_ns = t_ns + (at.ACCESS_NS if busy else CALCULATION_NS)

    def _send(self) -> None:
        self.output = self._bits[self._sent]
        self._sent += 1
        if self._sent == len(self._bits):
            self._phase = self._after

    def _supplement(self, t_ns: int, data: int) -> None:
        """The master's turn: a start bit, 8 and 16 bits."""
        self.output = None
        if len(self._in) == at.MODE_BITS and not data:
            return
        self._in.append(data)
        if len(self._in) == at.MODE_BITS + 1 + at.ARGUMENT_BITS:
            code = value_of(self._in[: at.MODE_BITS])
            self.answers.supplement(t_ns, code, value_of(self._in[at.MODE_BITS + 1 :]))
            self._phase = Phase.DONE
