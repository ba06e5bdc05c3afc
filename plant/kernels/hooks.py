"""Where effects enter the step: rows of numbers; an axis without rows skips all of it.

All rows are evaluated in one place, at the start of a step, into one sum per hook. (One place also keeps the
compiler from unfolding the catalogue a dozen times.) Gear torque, currents and acceleration are those of the
step before.
"""

from plant.compiled import Floats, inner
from plant.effects import signals as sig
from plant.effects.signals import HOOK_COUNT, MOTOR_HOOKS
from plant.kernels import layout as at
from plant.kernels.dispatch import update, value


@inner
def fill_signals(w: Floats, t: float) -> None:
    """Fill the signals of the axis and copy the declared friction behind them."""
    x = at.SIGNALS
    w[x + sig.TIME] = t
    w[x + sig.ANGLE] = w[at.ANGLE]
    w[x + sig.RATE] = w[at.RATE]
    w[x + sig.REVERSAL] = w[at.ANGLE] - w[at.REVERSED_AT]
    w[x + sig.TEMPERATURE] = w[at.TEMPERATURE] + w[at.WARMING] * t
    w[x + sig.SUPPLY_CURRENT] = w[at.SUPPLY_CURRENT]
    w[x + sig.ACCELERATION] = w[at.ACCELERATION]
    w[x + sig.TORQUE] = w[at.MOTORS + at.M_GEAR] + w[at.MOTORS + at.MOTOR_SIZE + at.M_GEAR]
    for k in range(at.FRICTION_SIZE):
        w[at.FRICTION_NOW + k] = w[at.DECLARED_FRICTION + k]
    for k in range(HOOK_COUNT + MOTOR_HOOKS):
        w[at.SUMS + k] = 0.0


@inner
def evaluate(w: Floats, t: float, h: float) -> None:
    """Evaluate all rows for the step whose middle is `t`: sums per hook, friction parameters of this step."""
    fill_signals(w, t)
    x = w[at.SIGNALS : at.SIGNALS_END]
    for m in range(2):
        motor = at.MOTORS + m * at.MOTOR_SIZE
        duty = w[at.MEAN_DUTY + m]
        x[sig.MOTOR] = m
        x[sig.MOTOR_ANGLE] = w[motor + at.M_ANGLE]
        x[sig.MOTOR_RATE] = w[motor + at.M_RATE]
        x[sig.CURRENT] = w[motor + at.M_CURRENT]
        x[sig.COMMAND] = duty
        x[sig.LAGGING] = 1.0 if duty < w[at.MEAN_DUTY + 1 - m] else 0.0
        # motor A comes first and takes the rows of the axis along
        rows = int(w[at.ROWS_ALL]) if m == 0 else int(w[at.ROWS_MOTOR])
        sums = at.SUMS if m == 0 else at.SUMS_OF_B
        for r in range(rows):
            place = at.EFFECTS + r * at.ROW
            kind = int(w[place + at.ROW_KIND])
            p = w[place + at.ROW_MEMORY : place + at.ROW]
            update(kind, x, p, h)
            w[sums + int(w[place])] += value(kind, x, p)
