"""What the sensors show at a grid point, as (value, change per nanosecond): reads in between extrapolate."""

from plant.compiled import Floats, inner
from plant.effects.signals import Hook
from plant.kernels import layout as at
from plant.kernels.stage import peak_current

# errors of the readings, from the effects of the last step
INCREMENTAL = at.SUMS + int(Hook.INCREMENTAL)
ABSOLUTE = at.SUMS + int(Hook.ABSOLUTE)
AUXILIARY = at.SUMS + int(Hook.AUXILIARY)
CURRENT_A = at.SUMS + int(Hook.CURRENT)
CURRENT_B = at.SUMS_OF_B + int(Hook.CURRENT)
NANO = 1e-9


@inner
def read(w: Floats) -> None:
    """Fill the readings of one axis at the grid point."""
    half = 0.5 * w[at.GRID]
    rate = w[at.RATE]
    angle = w[at.ANGLE] - half * rate
    incremental = angle + w[INCREMENTAL]
    absolute = angle + w[ABSOLUTE]
    auxiliary = angle + w[AUXILIARY]

    o = at.OUT
    w[o + at.OUT_ANGLE] = angle
    w[o + at.OUT_ANGLE + 1] = rate * NANO
    w[o + at.OUT_INCREMENTAL] = (incremental - w[at.INCREMENTAL_ZERO]) * w[at.INCREMENTAL_SCALE]
    w[o + at.OUT_INCREMENTAL + 1] = rate * NANO * w[at.INCREMENTAL_SCALE]
    w[o + at.OUT_ABSOLUTE] = absolute * w[at.ABSOLUTE_SCALE]
    w[o + at.OUT_ABSOLUTE + 1] = rate * NANO * w[at.ABSOLUTE_SCALE]
    w[o + at.OUT_AUXILIARY] = auxiliary * w[at.AUXILIARY_SCALE]
    w[o + at.OUT_AUXILIARY + 1] = rate * NANO * w[at.AUXILIARY_SCALE]
    for m in range(2):
        motor = at.MOTORS + m * at.MOTOR_SIZE
        speed = w[motor + at.M_RATE]
        turned = w[motor + at.M_ANGLE] - half * speed - w[at.TACH_ZERO + m]
        w[o + at.OUT_TACH_A + 2 * m] = turned * w[at.TACH_SCALE]
        w[o + at.OUT_TACH_A + 2 * m + 1] = speed * NANO * w[at.TACH_SCALE]
        # sampled at the PWM's falling edge, where the ripple peaks
        if w[at.PULSE] > 0.0:
            current = peak_current(w, m, w[at.TORQUE_CONSTANT] * speed * (1.0 - 2.0 * m))
        else:
            duty = w[at.DUTY + m]
            current = w[motor + at.M_CURRENT]
            if current > 0.0:
                current += w[at.RIPPLE] * duty * (1.0 - duty)
        w[o + at.OUT_CURRENT_A + m] = current + (w[CURRENT_A] if m == 0 else w[CURRENT_B])


@inner
def keep(w: Floats) -> None:
    """Copy the readings into the ring of delayed ones; the place follows from the step count."""
    row = at.DELAYS + (int(w[at.STEP]) % at.DELAY_ROWS) * at.OUT_SIZE
    for k in range(at.OUT_SIZE):
        w[row + k] = w[at.OUT + k]


@inner
def fill_truth(w: Floats, row: Floats) -> None:
    """Fill one row of truth at the grid point (columns: layout.TRUTH_COLUMNS behind the time)."""
    half = 0.5 * w[at.GRID]
    a = at.MOTORS
    b = at.MOTORS + at.MOTOR_SIZE
    row[0] = w[at.ANGLE] - half * w[at.RATE]
    row[1] = w[at.RATE]
    row[2] = w[a + at.M_CURRENT]
    row[3] = w[b + at.M_CURRENT]
    row[4] = w[a + at.M_ANGLE] - half * w[a + at.M_RATE]
    row[5] = w[b + at.M_ANGLE] - half * w[b + at.M_RATE]
    row[6] = w[a + at.M_GEAR]
    row[7] = w[b + at.M_GEAR]
    row[8] = w[at.FRICTION]
    row[9] = w[at.BRISTLE]


@inner
def record(w: Floats, t: float) -> None:
    """Append one row of truth to the ring."""
    row = at.TRUTH + (int(w[at.RECORDED]) % at.TRUTH_ROWS) * at.TRUTH_SIZE
    w[row] = t
    fill_truth(w, w[row + 1 : row + at.TRUTH_SIZE])
    w[at.RECORDED] += 1.0
