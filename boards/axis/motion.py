"""Modes of the axis and where the set point of the velocity loop comes from in each."""

from collections.abc import Callable
from typing import Final

from boards.axis.config import TICK_NS, AxisConfig
from boards.axis.hold import Blend, Gusts, RateLock
from boards.axis.pi import GAIN_SHIFT, IncrementalPi
from boards.axis.profile import UNIT_SHIFT, UNITS_PER_STEP, Profile
from boards.core.widths import saturate
from bus.protocol import AGE_UNIT_NS, AxisMode, PositionFlag
from bus.protocol.scales import TICKS_PER_S

_RATE_TO_UNIT: Final = 2
"""Q16 rate to Q18 unit, as a shift."""
_NS_TO_UNIT: Final = round((1 << UNIT_SHIFT) / TICK_NS * (1 << 20))
"""counts per tick x ns, Q20 -> Q18 counts."""
_POSITION_MASK: Final = 0x1FFFFFFF
STALE_NS: Final = 50_000_000
"""Ten missed position frames: the position is gone. ASSUMPTION."""
_OLDEST_NS: Final = 2 * STALE_NS
"""A reading is carried on no further than this."""
_SETTLE_TICKS: Final = 100
"""The axis is settled when it has been near its target for this long, 0.5 s. ASSUMPTION."""
_BAD_POSITION: Final = int(PositionFlag.ALARM | PositionFlag.CRC_ERROR)
"""Position flags that make a reading worthless: alarm, CRC error."""
_ENDS: Final = int(PositionFlag.LIMIT_LOW | PositionFlag.LIMIT_HIGH)
POINTING: Final = (AxisMode.MOVE, AxisMode.TRACK)
"""Modes with the position loop closed. A finished move without a rate stays in MOVE and holds its target."""


class Motion:
    """Set point generator. `setpoint(now_ns, velocity)` is replaced when the mode changes; Q16 counts/tick.

    Times are those of the board's own clock (`Board.clock_ns`).
    """

    def __init__(self, config: AxisConfig, pi: IncrementalPi) -> None:
        self._pi = pi
        self._creep_rate = config.creep_rate
        gains = (config.kp_pointing, config.ki_pointing, config.ki_creep, config.kp_gust, config.ki_gust)
        self._kp_pointing, self._ki_pointing, self._ki_creep, self._kp_gust, self._ki_gust = (
            round(gain * (1 << GAIN_SHIFT)) for gain in gains
        )
        self.kp_q12 = pi.kp_q12
        self.ki_q12 = pi.ki_q12
        self.acceleration = config.acceleration
        self.classes = list(config.classes)
        self.low = config.low
        self.high = config.high
        self.profile = Profile(config.acceleration << _RATE_TO_UNIT)
        # Q18 counts of error to Q16 counts/tick, gain in Q16
        self._gain = round(config.position_gain / TICKS_PER_S * 65536)
        self._correction = config.correction
        self._lag = config.lag_steps * UNITS_PER_STEP
        self._settle = config.settle_steps * UNITS_PER_STEP
        self._frame_ns = config.frame_ns
        self.position = 0
        self.ends = 0
        """Limit bits of the last POSITION."""
        self.near_ticks = 0
        self._lock = RateLock(self._gain)
        self.gusts: Gusts | None = None
        """While the rate is locked."""
        self.blend: Blend | None = None
        self.forget()
        self.off()

    # --- measurements -----------------------------------------------------------------------------
    def take_position(self, now_ns: int, data: bytes) -> None:
        """A POSITION frame from this axis' encoder board."""
        if data[1] & _BAD_POSITION:
            return
        self.good_ns = now_ns
        self.ends = data[1] & _ENDS
        self.position = (data[2] | data[3] << 8 | data[4] << 16 | data[5] << 24) & _POSITION_MASK
        self.latch_ns = now_ns - data[6] * AGE_UNIT_NS - self._frame_ns

    def fresh(self, now_ns: int) -> bool:
        """Whether the position is recent enough to act on."""
        return now_ns - self.good_ns < STALE_NS

    def measured(self, now_ns: int, velocity: int) -> int:
        """Position now, Q18 counts: the last reading carried on at the current velocity."""
        age = min(now_ns - self.latch_ns, _OLDEST_NS)
        return self.position * UNITS_PER_STEP + (velocity * age * _NS_TO_UNIT >> 20)

    def forget(self) -> None:
        """After power-up: no position is known."""
        self.good_ns = self.latch_ns = -STALE_NS

    def set_acceleration(self, acceleration_q16: int) -> None:
        """Limit of the set point's change, Q16 counts/5 ms per tick."""
        self.acceleration = acceleration_q16
        self.profile.acceleration = acceleration_q16 << _RATE_TO_UNIT

    @property
    def target_steps(self) -> int:
        """Where the pointing modes are heading, steps."""
        return self.profile.target // UNITS_PER_STEP

    # --- modes ------------------------------------------------------------------------------------
    def off(self) -> None:
        """No set point."""
        self.mode = AxisMode.OFF
        self.setpoint: Callable[[int, int], int] = self._idle
        self.setpoint_q16 = self.wanted_q16 = self.rate = 0
        self.steady = (0, 0)
        """The rate that is to be held, 0: none, and the position loop's correction of it."""
        self.selected = 0

    def open_loop(self) -> None:
        """The effort is commanded: the set point follows the axis, so closing the loop again is bumpless."""
        self.mode = AxisMode.OPEN_LOOP
        self.setpoint = self._follow
        self.rate = 0
        self.steady = (0, 0)

    def run(self, mode: AxisMode, rate_q16: int) -> None:
        """Velocity modes: go to `rate_q16` with the set acceleration and stay there."""
        self.mode = mode
        if mode is AxisMode.STOP:
            self._pi.kp_q12, self._pi.ki_q12 = self._kp_pointing, self._ki_pointing
        else:
            self._lock.start()
            if self.gusts is not None:
                self.gusts.start()
            self._velocity_gains()
        self.wanted_q16 = rate_q16
        self.rate = 0
        self.setpoint = self._ramp

    def move(self, now_ns: int, velocity: int, target_steps: int, top_q16: int) -> None:
        """Position loop: to `target_steps`, which moves on with the tracking rate from now."""
        self._enter_pointing(now_ns, velocity)
        self.profile.top = top_q16 << _RATE_TO_UNIT
        self.profile.aim(target_steps * UNITS_PER_STEP)
        self.mode = AxisMode.MOVE

    def track(self, now_ns: int, velocity: int, rate_q16: int) -> None:
        """Position-locked tracking; while a move is under way its target gets the rate."""
        if self.mode in POINTING:
            # the relative speed keeps the velocity continuous
            self.profile.speed += (self.rate - rate_q16) << _RATE_TO_UNIT
            self.profile.rate = rate_q16 << _RATE_TO_UNIT
            self.rate = rate_q16
        else:
            self.rate = rate_q16
            self._enter_pointing(now_ns, velocity)
        self.profile.top = self.profile.top or self.classes[1] << _RATE_TO_UNIT
        self.mode = AxisMode.MOVE

    def nudge(self, offset_steps: int) -> None:
        """Shift the target."""
        self.profile.aim(self.profile.target + offset_steps * UNITS_PER_STEP)
        self.profile.top = max(self.profile.top, self.classes[2] << _RATE_TO_UNIT)
        self.mode = AxisMode.MOVE

    def _enter_pointing(self, now_ns: int, velocity: int) -> None:
        if self.mode in POINTING:
            return
        self.profile.rate = self.rate << _RATE_TO_UNIT
        self.profile.take_over(self.measured(now_ns, velocity), self.setpoint_q16 << _RATE_TO_UNIT)
        self.near_ticks = 0
        if self.blend is not None:
            self.blend.start()
        if self.gusts is not None:
            self.gusts.start()
        self._pi.kp_q12 = self._kp_pointing
        self.setpoint = self._point

    def _velocity_gains(self) -> None:
        if self.gusts is None:
            self._pi.kp_q12, self._pi.ki_q12 = self.kp_q12, self.ki_q12
        elif self.gusts.blowing:
            self._pi.kp_q12, self._pi.ki_q12 = self._kp_gust, self._ki_gust
        else:
            self._pi.kp_q12, self._pi.ki_q12 = self._kp_pointing, self._ki_creep

    def set_lock(self, on: int) -> None:
        """RATE and CLASS hold the sum of the set point, with the gains of the pointing loop; they and TRACK
        notice gusts."""
        self._lock.start()
        self.gusts = Gusts() if on else None
        if self.mode in (AxisMode.RATE, AxisMode.CLASS):
            self._velocity_gains()
        elif self.mode in POINTING:
            self._pi.kp_q12 = self._kp_pointing

    def set_blend(self, shift: int) -> None:
        """Time constant of the blend of both encoders, 2**shift ticks; 0: the absolute encoder alone."""
        self.blend = Blend(shift) if shift else None

    def set_gains(self, kp_q12: int, ki_q12: int) -> None:
        """Gains of RATE and CLASS; in force at once there, with the next change of mode elsewhere."""
        self.kp_q12 = kp_q12
        self.ki_q12 = ki_q12
        if self.mode in (AxisMode.RATE, AxisMode.CLASS):
            self._velocity_gains()

    # --- set points -------------------------------------------------------------------------------
    def _idle(self, _now_ns: int, _velocity: int) -> int:
        return 0

    def _follow(self, _now_ns: int, velocity: int) -> int:
        self.setpoint_q16 = velocity << 16
        return self.setpoint_q16

    def _ramp(self, _now_ns: int, velocity: int) -> int:
        setpoint = self.setpoint_q16
        wanted = self.wanted_q16
        if setpoint != wanted:
            self.setpoint_q16 = setpoint = setpoint + saturate(wanted - setpoint, self.acceleration)
        elif self.gusts is not None and self.mode is not AxisMode.STOP:
            setpoint += self._lock.step(setpoint, velocity)
            if abs(wanted) < self._creep_rate:
                self.gusts.step(setpoint - (velocity << 16))
                self._velocity_gains()
        self.steady = (0 if self.mode is AxisMode.STOP else self.setpoint_q16, 0)
        return setpoint

    def _point(self, now_ns: int, velocity: int) -> int:
        profile = self.profile
        feed = profile.step()
        measured = self.measured(now_ns, velocity)
        creeping = abs(feed) >> _RATE_TO_UNIT < self._creep_rate
        if self.blend is not None:
            measured = self.blend.step(measured, velocity, creeping)
        ahead = profile.target - profile.remaining - measured
        error = saturate(ahead, self._lag)
        profile.remaining += ahead - error  # the axis cannot follow: the reference waits for it
        correction = saturate(error * self._gain >> UNIT_SHIFT, self._correction)
        if abs(error) < self._settle and not profile.remaining:
            if self.near_ticks < _SETTLE_TICKS:  # 16 bits: held for six minutes it would wrap
                self.near_ticks += 1
            if self.rate:
                self.mode = AxisMode.TRACK
        else:
            self.near_ticks = 0
        self.steady = (feed >> _RATE_TO_UNIT, correction)
        self.setpoint_q16 = setpoint = sum(self.steady)
        self._pi.ki_q12 = self._ki_creep if creeping else self._ki_pointing
        gusts = self.gusts
        if gusts is not None:
            if creeping and not profile.remaining:
                gusts.step(setpoint - (velocity << 16))
            self._pi.kp_q12 = self._kp_pointing
            if creeping and gusts.blowing:
                self._pi.kp_q12, self._pi.ki_q12 = self._kp_gust, self._ki_gust
        return setpoint

    # --- what the rest of the firmware asks -------------------------------------------------------
    @property
    def settled(self) -> bool:
        """In a pointing mode and near the target for long enough."""
        return self.mode in POINTING and self.near_ticks >= _SETTLE_TICKS

    def distance_steps(self, now_ns: int, velocity: int) -> int:
        """Target minus position, steps; 0 outside the pointing modes."""
        if self.mode not in POINTING:
            return 0
        return (self.profile.target - self.measured(now_ns, velocity)) // UNITS_PER_STEP
