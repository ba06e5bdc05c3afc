"""Commands and parameters of the axis board, as tables."""

from typing import Final, Protocol

from boards.axis.limits import SoftLimits
from boards.axis.motion import POINTING, Motion
from boards.axis.pi import CounterTorque
from boards.core import NOT_ALLOWED, OK, OUT_OF_RANGE, Answer, Parameter
from boards.core.commands import Handler, commands, kept
from boards.silicon.pwm import MotorPwm
from bus.protocol import AxisMode, Opcode, SpeedClass
from bus.protocol.scales import STEPS_PER_TURN, rate_q16

RATE_LIMIT: Final = rate_q16(3.1 * 3600)
"""Fastest rate that is accepted: the paper reports up to 3 deg/s (Fig. 12)."""
_EFFORT_LIMIT: Final = 3000
_SPLIT_BOUNDS: Final = (10, 25)
"""Percent (paper, section 3.3)."""
_GAIN_BOUND: Final = 1 << 20
"""Q12: gains up to 256 PWM steps per count."""
_CLASS_NAMES: Final = ("slew", "set", "guide", "fine", "track")


class Commanded(Protocol):
    """What the commands need of the board."""

    motion: Motion
    limits: SoftLimits
    pwm: MotorPwm
    velocity: int

    def clock_ns(self, t_ns: int) -> int:
        """Its own clock."""

    def powered(self) -> bool:
        """Whether the motors are under control."""

    def switch(self, on: bool) -> None:
        """Motors on or off."""

    def stop(self) -> None:
        """Brake to rest."""

    def command_effort(self, effort: int | None) -> None:
        """Fixed effort, or None: the loop decides."""


class AxisCommands:
    """Methods: (t_ns, arguments as on the wire) -> reply."""

    def __init__(self, board: Commanded) -> None:
        self._board = board
        self._motion = board.motion

    def power(self, t_ns: int, on: int) -> Answer:
        """POWER: refused while the position is unknown."""
        if on > 1:
            return OUT_OF_RANGE
        if on and not self._motion.fresh(self._board.clock_ns(t_ns)):
            return NOT_ALLOWED
        self._board.switch(bool(on))
        return OK

    def stop(self, _t_ns: int) -> Answer:
        """STOP: always allowed."""
        self._board.stop()
        return OK

    def set_rate(self, _t_ns: int, rate: int) -> Answer:
        """SET_RATE: velocity loop at any rate."""
        if abs(rate) > RATE_LIMIT:
            return OUT_OF_RANGE
        return self._run(AxisMode.RATE, rate, 0)

    def set_class(self, _t_ns: int, number: int, direction: int) -> Answer:
        """SET_CLASS: slew, set, guide, fine or track, forward, backward or at rest."""
        if not 1 <= number <= len(_CLASS_NAMES) or direction not in (-1, 0, 1):
            return OUT_OF_RANGE
        return self._run(AxisMode.CLASS, self._motion.classes[number - 1] * direction, number)

    def _run(self, mode: AxisMode, rate: int, selected: int) -> Answer:
        if not self._board.powered():
            return NOT_ALLOWED
        self._board.command_effort(None)
        self._motion.run(mode, rate)
        self._motion.selected = selected
        return OK

    def move_to(self, t_ns: int, target: int, number: int) -> Answer:
        """MOVE_TO: refused beyond the soft limits, before anything moves."""
        if not 1 <= number <= len(_CLASS_NAMES) or not self._board.limits.inside(target):
            return OUT_OF_RANGE
        if not self._ready(t_ns):
            return NOT_ALLOWED
        self._board.command_effort(None)
        self._motion.move(
            self._board.clock_ns(t_ns), self._board.velocity, target, self._motion.classes[number - 1]
        )
        self._motion.selected = number
        return OK

    def track_rate(self, t_ns: int, rate: int) -> Answer:
        """TRACK_RATE: the target moves at this rate from now on."""
        if abs(rate) > self._motion.classes[0]:
            return OUT_OF_RANGE
        if not self._ready(t_ns):
            return NOT_ALLOWED
        self._board.command_effort(None)
        self._motion.track(self._board.clock_ns(t_ns), self._board.velocity, rate)
        if not self._motion.selected:
            self._motion.selected = SpeedClass.TRACK
        return OK

    def open_loop(self, _t_ns: int, effort: int) -> Answer:
        """OPEN_LOOP: effort in 1/3000 of the supply, as it is."""
        if abs(effort) > _EFFORT_LIMIT:
            return OUT_OF_RANGE
        if not self._board.powered():
            return NOT_ALLOWED
        self._board.command_effort(effort * self._board.pwm.steps // _EFFORT_LIMIT)
        self._motion.open_loop()
        return OK

    def nudge(self, t_ns: int, offset: int) -> Answer:
        """NUDGE: shift the target of a move, of tracking or of holding."""
        motion = self._motion
        if motion.mode not in POINTING or not self._ready(t_ns):
            return NOT_ALLOWED
        if not self._board.limits.inside(motion.target_steps + offset):
            return OUT_OF_RANGE
        motion.nudge(offset)
        return OK

    def _ready(self, t_ns: int) -> bool:
        return self._board.powered() and self._motion.fresh(self._board.clock_ns(t_ns))


def axis_commands(board: Commanded) -> dict[int, Handler]:
    """Opcode to handler."""
    own = AxisCommands(board)
    return commands(
        {
            Opcode.POWER: own.power,
            Opcode.STOP: own.stop,
            Opcode.SET_RATE: own.set_rate,
            Opcode.SET_CLASS: own.set_class,
            Opcode.MOVE_TO: own.move_to,
            Opcode.TRACK_RATE: own.track_rate,
            Opcode.OPEN_LOOP: own.open_loop,
            Opcode.NUDGE: own.nudge,
        }
    )


def axis_parameters(motion: Motion, counter: CounterTorque) -> list[Parameter]:
    """Parameters 1..11."""

    def set_kp(value: int) -> None:
        motion.set_gains(value, motion.ki_q12)

    def set_ki(value: int) -> None:
        motion.set_gains(motion.kp_q12, value)

    def class_row(index: int) -> Parameter:
        def write(value: int) -> None:
            motion.classes[index] = value

        return Parameter(
            7 + index, f"{_CLASS_NAMES[index]}_rate_q16", 1, RATE_LIMIT, lambda: motion.classes[index], write
        )

    return [
        kept(1, "counter_split_percent", _SPLIT_BOUNDS, counter, "split"),
        Parameter(2, "kp_q12", 0, _GAIN_BOUND, lambda: motion.kp_q12, set_kp),
        Parameter(3, "ki_q12", 0, _GAIN_BOUND, lambda: motion.ki_q12, set_ki),
        kept(4, "soft_limit_low_steps", (0, STEPS_PER_TURN - 1), motion, "low"),
        kept(5, "soft_limit_high_steps", (0, STEPS_PER_TURN - 1), motion, "high"),
        Parameter(
            6, "acceleration_q16", 1, rate_q16(7200.0) // 20, lambda: motion.acceleration,
            motion.set_acceleration,
        ),
        *(class_row(index) for index in range(len(_CLASS_NAMES))),
    ]  # fmt: skip
