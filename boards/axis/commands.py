"""Commands and parameters of the axis board, as tables."""

from typing import TYPE_CHECKING, Final

from boards.axis.config import STEPS_PER_TURN, rate_q16
from boards.axis.motion import POINTING
from boards.core import NOT_ALLOWED, OK, OUT_OF_RANGE, Answer, Parameter
from boards.core.commands import Handler, i8, i16, i32, u8, u32
from bus.protocol import AxisMode, Opcode, SpeedClass

if TYPE_CHECKING:
    from boards.axis.firmware import AxisBoard

RATE_LIMIT: Final = rate_q16(3.1 * 3600)
"""Fastest rate that is accepted: the paper reports up to 3 deg/s (Fig. 12)."""
_EFFORT_LIMIT: Final = 3000
_SPLIT_BOUNDS: Final = (10, 25)
"""Percent (paper, section 3.3)."""
_GAIN_BOUND: Final = 1 << 20
"""Q12: gains up to 256 PWM steps per count."""
_CLASS_NAMES: Final = ("slew", "set", "guide", "fine", "track")


class AxisCommands:
    """Handlers: (t_ns, arguments) -> reply."""

    def __init__(self, board: "AxisBoard") -> None:
        self._board = board
        self._motion = board.motion

    def power(self, t_ns: int, data: bytes) -> Answer:
        """POWER: refused while the position is unknown."""
        on = u8(data)
        if on > 1:
            return OUT_OF_RANGE
        if on and not self._motion.fresh(self._board.clock_ns(t_ns)):
            return NOT_ALLOWED
        self._board.switch(bool(on))
        return OK

    def stop(self, _t_ns: int, _data: bytes) -> Answer:
        """STOP: always allowed."""
        self._board.stop()
        return OK

    def set_rate(self, _t_ns: int, data: bytes) -> Answer:
        """SET_RATE: velocity loop at any rate."""
        rate = i32(data)
        if abs(rate) > RATE_LIMIT:
            return OUT_OF_RANGE
        return self._run(AxisMode.RATE, rate, 0)

    def set_class(self, _t_ns: int, data: bytes) -> Answer:
        """SET_CLASS: slew, set, guide, fine or track, forward, backward or at rest."""
        number, direction = u8(data), i8(data, 1)
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

    def move_to(self, t_ns: int, data: bytes) -> Answer:
        """MOVE_TO: refused beyond the soft limits, before anything moves."""
        target, number = u32(data), u8(data, 4)
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

    def track_rate(self, t_ns: int, data: bytes) -> Answer:
        """TRACK_RATE: the target moves at this rate from now on."""
        rate = i32(data)
        if abs(rate) > self._motion.classes[0]:
            return OUT_OF_RANGE
        if not self._ready(t_ns):
            return NOT_ALLOWED
        self._board.command_effort(None)
        self._motion.track(self._board.clock_ns(t_ns), self._board.velocity, rate)
        if not self._motion.selected:
            self._motion.selected = SpeedClass.TRACK
        return OK

    def open_loop(self, _t_ns: int, data: bytes) -> Answer:
        """OPEN_LOOP: effort in 1/3000 of the supply, as it is."""
        effort = i16(data)
        if abs(effort) > _EFFORT_LIMIT:
            return OUT_OF_RANGE
        if not self._board.powered():
            return NOT_ALLOWED
        self._board.command_effort(effort * self._board.pwm.steps // _EFFORT_LIMIT)
        self._motion.open_loop()
        return OK

    def nudge(self, t_ns: int, data: bytes) -> Answer:
        """NUDGE: shift the target of a move, of tracking or of holding."""
        offset = i32(data)
        motion = self._motion
        if motion.mode not in POINTING or not self._ready(t_ns):
            return NOT_ALLOWED
        if not self._board.limits.inside(motion.target_steps + offset):
            return OUT_OF_RANGE
        motion.nudge(offset)
        return OK

    def _ready(self, t_ns: int) -> bool:
        return self._board.powered() and self._motion.fresh(self._board.clock_ns(t_ns))


def axis_commands(board: "AxisBoard") -> dict[int, Handler]:
    """Opcode to handler."""
    commands = AxisCommands(board)
    return {
        Opcode.POWER: commands.power,
        Opcode.STOP: commands.stop,
        Opcode.SET_RATE: commands.set_rate,
        Opcode.SET_CLASS: commands.set_class,
        Opcode.MOVE_TO: commands.move_to,
        Opcode.TRACK_RATE: commands.track_rate,
        Opcode.OPEN_LOOP: commands.open_loop,
        Opcode.NUDGE: commands.nudge,
    }


def axis_parameters(board: "AxisBoard") -> list[Parameter]:
    """Parameters 1..11; what depends on one is worked out again when it changes."""
    motion, limits = board.motion, board.limits

    def set_split(value: int) -> None:
        board.counter.split = value

    def set_kp(value: int) -> None:
        motion.set_gains(value, motion.ki_q12)

    def set_ki(value: int) -> None:
        motion.set_gains(motion.kp_q12, value)

    def set_low(value: int) -> None:
        motion.low = value
        limits.refresh()

    def set_high(value: int) -> None:
        motion.high = value
        limits.refresh()

    def set_acceleration(value: int) -> None:
        motion.set_acceleration(value)
        limits.refresh()

    def class_row(index: int) -> Parameter:
        def write(value: int) -> None:
            motion.classes[index] = value
            limits.refresh()

        return Parameter(
            7 + index, f"{_CLASS_NAMES[index]}_rate_q16", 1, RATE_LIMIT, lambda: motion.classes[index], write
        )

    return [
        Parameter(1, "counter_split_percent", *_SPLIT_BOUNDS, lambda: board.counter.split, set_split),
        Parameter(2, "kp_q12", 0, _GAIN_BOUND, lambda: motion.kp_q12, set_kp),
        Parameter(3, "ki_q12", 0, _GAIN_BOUND, lambda: motion.ki_q12, set_ki),
        Parameter(4, "soft_limit_low_steps", 0, STEPS_PER_TURN - 1, lambda: motion.low, set_low),
        Parameter(5, "soft_limit_high_steps", 0, STEPS_PER_TURN - 1, lambda: motion.high, set_high),
        Parameter(
            6, "acceleration_q16", 1, rate_q16(7200.0) // 20, lambda: motion.acceleration, set_acceleration
        ),
        *(class_row(index) for index in range(len(_CLASS_NAMES))),
    ]
