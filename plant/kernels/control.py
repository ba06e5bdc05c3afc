"""The axis board's velocity loop around one axis, in one compiled loop.

The arithmetic is the firmware's. Gains are in Q12, errors and effort in Q16. The effort is limited where it
accumulates. A counter torque stays until it is a whole step off. The current is read before the new duty. A
test compares the loop with the emulator.
"""

from math import floor

from plant.compiled import Floats, inner, kernel
from plant.kernels import layout as at
from plant.kernels.advance import advance_axis
from plant.kernels.readings import fill_truth

# columns of a log row
T, SETPOINT, EFFORT, POSITION, VELOCITY, ADC_A, ADC_B, TACH_A, TACH_B, AUX, LOG_SIZE = range(11)
# columns of a truth row: those of the plant without the time, and these
DUTY_A, DUTY_B, TRUTH_SIZE = range(at.TRUTH_SIZE - 1, at.TRUTH_SIZE + 2)
# settings of a run: at DELAYS that of the effort, which is not read, and those of readings, s
(
    KP,
    KI,
    STEPS,
    SPLIT,
    TICK_STEPS,
    LATENCY,
    AMPERE,
    DELAYS,
    LATE_POSITION,
    LATE_VELOCITY,
    LATE_CURRENT,
    LATE_TACH,
    SETTINGS,
) = range(13)
HALF = 1 << 15
ADC_TOP = 1023  # 10 bit
EFFORT_SCALE = 3000  # log: effort in 1/3000 of the supply


@inner
def reading(w: Floats, place: int, delay: float) -> float:
    """Return a reading now, or as it was `delay` s ago."""
    if delay <= 0.0:
        return w[at.OUT + place]
    back = w[at.STEP] - delay / w[at.GRID]
    step = max(0, floor(back))
    row = at.DELAYS + (step % at.DELAY_ROWS) * at.OUT_SIZE
    if place >= at.OUT_CURRENT_A:
        return w[row + place]
    return w[row + place] + w[row + place + 1] * max(0.0, back - step) * w[at.GRID] * 1e9


@inner
def counter_steps(size: int, split: int, register: int) -> int:
    """Return the lagging motor's duty register for an effort of `size` steps, `split` percent."""
    share = size * split
    if -100 < share - register * 100 < 100:
        return register
    return (share + 50) // 100


@inner
def apply_effort(w: Floats, effort: int, counter: int, s: Floats) -> None:
    """Write both duty registers; they count after the latency of interrupt and PWM period."""
    steps = int(s[STEPS])
    lead = abs(effort) / steps
    lag = counter / steps
    rest = 1.0 - s[LATENCY] / w[at.GRID]
    for m in range(2):
        duty = lead if (effort >= 0) == (m == 0) else lag
        w[at.MEAN_DUTY + m] += (duty - w[at.DUTY + m]) * rest
        w[at.DUTY + m] = duty


@kernel
def control_loop(w: Floats, s: Floats, setpoint: Floats, effort: Floats, log: Floats, truth: Floats) -> None:
    """Run one axis: two control ticks per log row.

    w: the axis' row of the world. s: settings. setpoint, effort: per tick; Q16 counts per tick (a whole
    number, or NaN: open loop) and PWM steps (used in open loop). log, truth: one row per two ticks, filled
    here.
    """
    tick_steps = int(s[TICK_STEPS])
    steps = int(s[STEPS])
    limit = steps << 16
    kp = int(s[KP])
    ki = int(s[KI])
    held = 0  # Q16 PWM steps
    counter = 0
    split = int(s[SPLIT])
    last_error = 0
    last_count = floor(reading(w, at.OUT_INCREMENTAL, s[LATE_VELOCITY]))
    last_a = floor(reading(w, at.OUT_TACH_A, s[LATE_TACH]))
    last_b = floor(reading(w, at.OUT_TACH_B, s[LATE_TACH]))
    for tick in range(2 * log.shape[0]):
        count = floor(reading(w, at.OUT_INCREMENTAL, s[LATE_VELOCITY]))
        velocity = count - last_count
        last_count = count
        wanted = setpoint[tick]
        if wanted == wanted:
            error = int(wanted) - (velocity << 16)
            held += (kp * (error - last_error) + ki * error) >> 12
            held = max(-limit, min(limit, held))
            last_error = error
        else:
            # bumpless when the loop closes: the set point follows the axis
            held = floor(effort[tick] + 0.5) << 16
            held = max(-limit, min(limit, held))
            last_error = 0
        output = (held + HALF) >> 16
        counter = counter_steps(abs(output), split, counter)
        if tick % 2 == 0:
            row = log[tick // 2]
            row[T] = w[at.STEP] * w[at.GRID]
            row[SETPOINT] = wanted
            row[EFFORT] = output * EFFORT_SCALE // steps
            row[POSITION] = floor(reading(w, at.OUT_ABSOLUTE, s[LATE_POSITION]))
            row[VELOCITY] = velocity
            for m in range(2):
                ampere = reading(w, at.OUT_CURRENT_A + m, s[LATE_CURRENT])
                row[ADC_A + m] = max(0.0, min(ADC_TOP, floor(ampere * s[AMPERE])))
            now_a = floor(reading(w, at.OUT_TACH_A, s[LATE_TACH]))
            now_b = floor(reading(w, at.OUT_TACH_B, s[LATE_TACH]))
            row[TACH_A] = now_a - last_a
            row[TACH_B] = now_b - last_b
            last_a = now_a
            last_b = now_b
            row[AUX] = floor(reading(w, at.OUT_AUXILIARY, s[LATE_POSITION]))
            fill_truth(w, truth[tick // 2])
            truth[tick // 2, DUTY_A] = w[at.DUTY]
            truth[tick // 2, DUTY_B] = w[at.DUTY + 1]
        apply_effort(w, output, counter, s)
        advance_axis(w, tick_steps)
