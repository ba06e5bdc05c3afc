"""From the loop's effort to the duty registers when they are finer than a PWM step.

The paper's firmware rounds effort and counter torque to whole steps (firmware.py, `routine`); this is what
parameters 12 and 13 put in its place.
"""

from typing import TYPE_CHECKING, Final

from boards.axis.compensator import Compensator
from boards.axis.interrupts import FRICTION_CYCLES, HARMONIC_CYCLES, PWM_ROUTINE

if TYPE_CHECKING:
    from boards.axis.firmware import AxisBoard

_HALF: Final = 1 << 15


class FineOutput:
    """Parameters 12 to 42 of the axis board.

    bias_q8: duty both motors always get, PWM steps in Q8. It cancels at the axis, and keeps the lagging one's
        teeth together where its share of a small effort would drown in dead band and cogging.
    """

    __slots__ = ("_board", "bias_q8", "compensator", "spread")

    def __init__(self, board: "AxisBoard") -> None:
        self._board = board
        self.spread = 0
        self.bias_q8 = 0
        self.compensator = Compensator()

    @property
    def active(self) -> bool:
        """Whether the plain way of the paper's firmware will not do."""
        return bool(self.spread or self.compensator.on or self.bias_q8)

    def set_spread(self, on: int) -> None:
        """Switch the PWM interrupt on or off."""
        self.spread = on
        self.refresh()

    def set_compensation(self, on: int) -> None:
        """Add the compensation from the next tick on, with the friction model unloaded."""
        self.compensator.on = on
        self.compensator.start()
        self.refresh()

    def set_bias(self, value_q8: int) -> None:
        """Duty that both motors always get while the axis is powered."""
        self.bias_q8 = value_q8
        self.refresh()

    def refresh(self) -> None:
        """Book what the routines now cost."""
        board = self._board
        cpu, pwm = board.cpu, board.pwm
        extra = 0
        if self.compensator.on:
            self.compensator.refresh()
            extra = self.compensator.lines * HARMONIC_CYCLES + FRICTION_CYCLES
        cpu.top.own_ns = cpu.cycles_ns(cpu.top.source.cost_cycles + extra)
        cpu.steal(PWM_ROUTINE if self.spread else None, pwm.period_ns)
        board.cost_ns = cpu.top.cost_ns
        board.fine = self if self.active else None

    def drive(self, end_ns: int, velocity: int, setpoint_q16: int) -> int:
        """Write the duties for the loop's effort; returns the effort that went out, whole PWM steps."""
        board = self._board
        pwm = board.pwm
        command = board.effort_command
        if command is None:
            effort_q16 = board.pi.effort_q16
            if self.compensator.on and board.motion.fresh(board.clock_ns(end_ns)):
                effort_q16 += self.compensator.effort_q16(board.motion.position, velocity, setpoint_q16)
                limit = pwm.steps << 16
                effort_q16 = max(-limit, min(limit, effort_q16))
        else:
            effort_q16 = command << 16
        size = effort_q16 if effort_q16 >= 0 else -effort_q16
        if self.spread:
            lag = board.counter.share_q16(size, velocity)
        else:
            size = (size + _HALF) >> 16 << 16
            board.counter.follow(size >> 16, velocity)
            lag = board.counter.register << 16
        bias = self.bias_q8 << 8 if board.motion.mode else 0
        if effort_q16 >= 0:
            pwm.write_spread(end_ns, size + bias, lag + bias)
        else:
            pwm.write_spread(end_ns, lag + bias, size + bias)
        return (effort_q16 + _HALF) >> 16
