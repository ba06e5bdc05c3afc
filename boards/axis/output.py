"""From the loop's effort to the duty registers when they are finer than a PWM step.

The paper's firmware rounds effort and counter torque to whole steps (firmware.py, `routine`); this is what
parameters 12 and 13 put in its place. Here are the rows of parameters 12 to 68, too.
"""

from collections.abc import Callable
from typing import Final

from boards.axis.compensator import Compensator
from boards.axis.config import (
    BIAS_CYCLES,
    BLEND_CYCLES,
    FRICTION_CYCLES,
    HARMONIC_CYCLES,
    LOCK_CYCLES,
    OBSERVER_CYCLES,
    PWM_ROUTINE,
    SHARE_CYCLES,
)
from boards.axis.motion import Motion
from boards.axis.observer import Observer
from boards.axis.pi import CounterTorque, IncrementalPi
from boards.core import InterruptController, Parameter
from boards.core.commands import kept
from boards.core.widths import saturate
from boards.silicon.pwm import MotorPwm
from bus.protocol import HARMONICS, OBSERVER_CELLS, AxisParameter
from bus.protocol.scales import COUNTS_PER_TURN

_HALF: Final = 1 << 15


class FineOutput:
    """Parameters 12 to 68 of the axis board.

    bias_q8: duty both motors always get, PWM steps in Q8. It cancels at the axis. It keeps the lagging
        motor's teeth together where that motor's share of a small effort would drown in dead band and
        cogging.
    """

    def __init__(
        self,
        cpu: InterruptController,
        pwm: MotorPwm,
        pi: IncrementalPi,
        counter: CounterTorque,
        motion: Motion,
    ) -> None:
        self._cpu, self._pwm, self._pi, self._counter, self._motion = cpu, pwm, pi, counter, motion
        self.changed: Callable[[], None] = _nobody
        """Told when the routines cost something else."""
        self.spread = 0
        self.bias_q8 = 0
        self.observed = False
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

    def set_lock(self, on: int) -> None:
        """Sum of the set point in RATE and CLASS, and a sense of wind."""
        self._motion.set_lock(on)
        self.refresh()

    def set_blend(self, shift: int) -> None:
        """Position from both encoders."""
        self._motion.set_blend(shift)
        self.refresh()

    def refresh(self) -> None:
        """Book what the routines now cost."""
        cpu, motion = self._cpu, self._motion
        extra = SHARE_CYCLES if self.spread else 0
        extra += BIAS_CYCLES if self.bias_q8 else 0
        extra += LOCK_CYCLES if motion.gusts else 0
        extra += BLEND_CYCLES if motion.blend else 0
        extra += OBSERVER_CYCLES if self.observed else 0
        if self.compensator.on:
            self.compensator.refresh()
            extra += self.compensator.lines * HARMONIC_CYCLES + FRICTION_CYCLES
        cpu.top.own_ns = cpu.cycles_ns(cpu.top.source.cost_cycles + extra)
        cpu.steal(PWM_ROUTINE if self.spread else None, self._pwm.period_ns)
        self.changed()

    def drive(self, end_ns: int, now_ns: int, velocity: int, setpoint_q16: int, command: int | None) -> int:
        """Write the duties at `end_ns`, `now_ns` of the board's own clock; returns the effort that went out.

        command: a fixed effort; None: the loop's. Efforts in whole PWM steps.
        """
        pwm, counter, motion = self._pwm, self._counter, self._motion
        if command is None:
            effort_q16 = self._pi.effort_q16
            if self.compensator.on and motion.fresh(now_ns):
                effort_q16 += self.compensator.effort_q16(motion.position, velocity, setpoint_q16)
                effort_q16 = saturate(effort_q16, pwm.steps << 16)
        else:
            effort_q16 = command << 16
        size = abs(effort_q16)
        if self.spread:
            lag = counter.share_q16(size, velocity)
        else:
            size = (size + _HALF) >> 16 << 16
            counter.follow(size >> 16, velocity)
            lag = counter.register << 16
        bias = self.bias_q8 << 8 if motion.mode else 0
        if effort_q16 >= 0:
            pwm.write_spread(end_ns, size + bias, lag + bias)
        else:
            pwm.write_spread(end_ns, lag + bias, size + bias)
        return (effort_q16 + _HALF) >> 16


def _nobody() -> None:
    """Nobody is told."""


_EFFORT_Q8: Final = 3000 << 8
"""All of the supply."""
_BIAS_Q8: Final = 300 << 8
"""A tenth of the supply."""
_ORDER_Q16: Final = (1 << 31) - 1
"""32767 cycles per turn of the axis: motor orders up to 90."""


def fine_parameters(output: FineOutput, motion: Motion) -> list[Parameter]:
    """Rows of the parameter table; the interrupt table is booked again when one changes."""
    compensator = output.compensator

    def cell(number: int, name: str, bound: int, column: list[int], line: int) -> Parameter:
        def write(value: int) -> None:
            column[line] = value
            output.refresh()

        low = 0 if column is compensator.orders_q16 else -bound
        return Parameter(number, f"{name}_{line}", low, bound, lambda: column[line], write)

    columns: tuple[tuple[str, int, list[int]], ...] = (
        ("harmonic_order_q16", _ORDER_Q16, compensator.orders_q16),
        ("harmonic_cosine_q8", _EFFORT_Q8, compensator.cosines_q8),
        ("harmonic_sine_q8", _EFFORT_Q8, compensator.sines_q8),
    )
    first = AxisParameter.HARMONIC_FIRST
    return [
        Parameter(
            AxisParameter.DUTY_FRACTION, "duty_fraction", 0, 1,
            lambda: output.spread, output.set_spread,
        ),
        Parameter(
            AxisParameter.COMPENSATION, "compensation", 0, 1,
            lambda: compensator.on, output.set_compensation,
        ),
        kept(
            AxisParameter.FRICTION_LEVEL_Q8, "friction_level_q8", (0, _EFFORT_Q8), compensator, "level_q8",
        ),
        kept(
            AxisParameter.FRICTION_TRAVEL_COUNTS, "friction_travel_counts", (1, COUNTS_PER_TURN), compensator,
            "travel",
        ),
        *(
            cell(first + 3 * line + place, name, bound, column, line)
            for line in range(HARMONICS)
            for place, (name, bound, column) in enumerate(columns)
        ),
        Parameter(
            AxisParameter.COUNTER_BIAS_Q8, "counter_bias_q8", 0, _BIAS_Q8,
            lambda: output.bias_q8, output.set_bias,
        ),
        Parameter(
            AxisParameter.RATE_LOCK, "rate_lock", 0, 1,
            lambda: int(motion.gusts is not None), output.set_lock,
        ),
        Parameter(
            AxisParameter.POSITION_BLEND, "position_blend", 0, 15,
            lambda: motion.blend.shift if motion.blend else 0, output.set_blend,
        ),
    ]  # fmt: skip


_WORD: Final = (1 << 31) - 1


def observer_parameters(observer: Observer, output: FineOutput) -> list[Parameter]:
    """Rows of the parameter table: the switch, and the coefficients. One that changes switches it off."""

    def switch(on: int) -> None:
        observer.switch(on)
        output.observed = bool(observer.on)
        output.refresh()

    def cell(place: int) -> Parameter:
        def write(value: int) -> None:
            observer.coefficients[place] = value
            switch(0)

        number = AxisParameter.OBSERVER_FIRST + place
        return Parameter(
            number, f"observer_{place}", -_WORD, _WORD, lambda: observer.coefficients[place], write
        )

    on = Parameter(AxisParameter.OBSERVER, "observer", 0, 1, lambda: observer.on, switch)
    return [on, *map(cell, range(OBSERVER_CELLS))]
