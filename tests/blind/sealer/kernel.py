"""One run of one axis: 5 ms controller around the Runge-Kutta drive, a row every 10 ms."""

import math

import numpy as np

from tests.blind.sealer import held as h_
from tests.blind.sealer import rates as r_
from tests.blind.sealer import shadow as f_
from tests.blind.sealer import slots as p_
from tests.blind.sealer.compiled import compiled
from tests.blind.sealer.slots import Array

SUBSTEPS = 10  # 500 us inside a 5 ms tick
RING = 128  # 64 ms of the past for late channels
EFFORT_TOP = 3000
EARLY = 1  # substeps until a new effort reaches the PWM register (end of the interrupt routine)


@compiled
def past(ring: Array, row: int, newest: int, back: float) -> float:
    """Value `back` substeps ago (linear between samples)."""
    whole = math.floor(back)
    part = back - whole
    a = ring[row, (newest - whole) % RING]
    b = ring[row, (newest - whole - 1) % RING]
    value: float = a + (b - a) * part
    return value


@compiled
def simulate(
    p: Array,
    closed: Array,
    command: Array,
    hidden: Array,
    torque: Array,
    upset: Array,
    burst: Array,
    noise: Array,
    state: Array,
    memory: Array,
) -> Array:
    """Rows of one run.

    Per tick of 5 ms: closed (1/0), command (counts per tick, or effort when open), hidden (added to the
    executed command only), torque (N m on the axis), upset (added to the effort), burst (0/1), noise
    (counts).
    state and memory are advanced in place.
    """
    ticks = command.shape[0]
    rows = np.zeros(((ticks + 1) // 2, len(p_.OUT_NAMES)))
    ring = np.zeros((6, RING))
    held = np.zeros(r_.HELD)
    scratch = np.zeros((4, r_.STATES))
    work = np.zeros(r_.STATES)
    own = np.zeros(4)
    own_sum = np.zeros(5)
    bristles = np.zeros(f_.SHADOWS)
    figures = np.zeros(4)
    figures_sum = np.zeros(4)
    rubs = h_.friction_effects(p)
    duty = np.zeros(2)
    next_duty = np.zeros(2)
    step = p[p_.TICK] / SUBSTEPS
    roller = state[0] * p[p_.ROLLER_SCALE] + p[p_.ROLLER_PHASE]
    for i in range(RING):
        ring[0, i], ring[1, i], ring[2, i] = state[0], state[2], state[4]
        ring[3, i], ring[4, i], ring[5, i] = state[6], state[7], roller
    newest = 0
    count_before = math.floor(roller)
    accumulator = 0
    error_before = 0
    late = 1.0 / step
    omega_before = state[1]
    for tick in range(ticks):
        # the interrupt: velocity, PI, effort
        count = math.floor(roller + p[p_.ROLLER_NOISE] * noise[tick])
        velocity = count - count_before
        count_before = count
        if closed[tick] > 0.5:
            wanted = command[tick] + hidden[tick]
            error = round(wanted * 256.0) - int(velocity) * 256
            kp = p[p_.KP_Q12]
            if p[p_.BUG_V] > 0.0 and abs(wanted) > p[p_.BUG_V]:
                kp *= p[p_.BUG_F]
            accumulator += int(kp) * (error - error_before) + int(p[p_.KI_Q12]) * error
            error_before = error
        else:
            accumulator = round(command[tick] + hidden[tick]) << 20
            error_before = 0
        accumulator = min(max(accumulator, -EFFORT_TOP << 20), EFFORT_TOP << 20)
        effort = (accumulator >> 20) + round(upset[tick])
        effort = min(max(effort, -EFFORT_TOP), EFFORT_TOP)
        level = abs(effort) / EFFORT_TOP
        lag = level * p[p_.COUNTER] * (1.0 - p[p_.COUNTER_LOSS])
        next_duty[0] = level if effort > 0 else lag
        next_duty[1] = lag if effort > 0 else level
        if tick % 2 == 0:
            out = rows[tick // 2]
            out[p_.O_SETPOINT] = command[tick]
            out[p_.O_EFFORT] = effort
            out[p_.O_VELOCITY] = velocity
            if p[p_.DELAY_VEL] > 0.0:
                back = p[p_.DELAY_VEL] * late
                here = math.floor(past(ring, 5, newest, back) + p[p_.ROLLER_NOISE] * noise[tick])
                out[p_.O_VELOCITY] = here - math.floor(past(ring, 5, newest, back + SUBSTEPS))
            out[p_.O_THETA] = state[0]
            out[p_.O_THETA_LOG] = past(ring, 0, newest, p[p_.DELAY_POS] * late)
            out[p_.O_PHI_A] = past(ring, 1, newest, p[p_.DELAY_TACH] * late)
            out[p_.O_PHI_B] = past(ring, 2, newest, p[p_.DELAY_TACH] * late)
            out[p_.O_I_A], out[p_.O_I_B] = state[6], state[7]
            out[p_.O_I_A_LOG] = past(ring, 3, newest, p[p_.DELAY_ADC] * late)
            out[p_.O_I_B_LOG] = past(ring, 4, newest, p[p_.DELAY_ADC] * late)
            out[p_.O_OMEGA] = state[1]
            out[p_.O_DUTY_A], out[p_.O_DUTY_B] = duty[0], duty[1]
            for i in range(4):
                out[p_.O_E_TORQUE + i] = own_sum[i] / (2 * SUBSTEPS)
            out[p_.O_E_ROLLER] = own_sum[4] / 2.0
            for i in range(4):
                out[p_.O_F_COULOMB + i] = figures_sum[i] / (2 * SUBSTEPS)
            own_sum[:] = 0.0
            figures_sum[:] = 0.0
        for sub in range(SUBSTEPS):
            if sub == EARLY:
                duty[0], duty[1] = next_duty[0], next_duty[1]
            t = p[p_.T_SESSION] + tick * p[p_.TICK] + sub * step
            own[:] = 0.0
            h_.hold_friction(t, state, held, p, own)
            if rubs:
                f_.shadow(step, state, held, p, bristles, own, figures)
                for i in range(4):
                    figures_sum[i] += figures[i]
            h_.hold_axis(state, memory, torque[tick], held, p, own)
            h_.hold_motors(t, burst[tick], state, memory, duty, held, p, own)
            before = state[0]
            stiff = p[p_.SIG0] * abs(state[1]) / r_.friction_level(state[1], held, p) * step
            parts = 1 + int(stiff)
            for _ in range(parts):
                r_.rk4(state, step / parts, held, p, scratch, work)
            move = state[0] - before
            h_.remember(step, move, state, memory, p)
            if p[p_.J2] > 0.0:
                accel = (state[1] - omega_before) / step
                w = p[p_.W2]
                spring = w * w * (state[9] - state[0]) + 2.0 * p[p_.Z2] * w * (state[10] - state[1])
                own[0] += p[p_.J2] * (spring + accel)
            accel = (state[1] - omega_before) / step
            omega_before = state[1]
            slip = 0.0
            if p[p_.SLIP_C] > 0.0 and abs(accel) > p[p_.SLIP_A0]:
                slip = p[p_.SLIP_C] * (abs(accel) - p[p_.SLIP_A0]) * step
                slip = math.copysign(min(slip, 0.9 * abs(move)), move)
            lost = p[p_.ROLLER_EPS] * move - slip
            roller += (move + lost) * p[p_.ROLLER_SCALE]
            own_sum[4] += lost * p[p_.ROLLER_SCALE]
            for i in range(4):
                own_sum[i] += own[i]
            newest = (newest + 1) % RING
            ring[0, newest], ring[1, newest], ring[2, newest] = state[0], state[2], state[4]
            ring[3, newest] = state[6] if duty[0] > 0.0 else 0.0
            ring[4, newest] = state[7] if duty[1] > 0.0 else 0.0
            ring[5, newest] = roller
    return rows
