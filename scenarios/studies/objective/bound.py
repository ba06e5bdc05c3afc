"""The best that can be done in wind: the linear controller that knows plant and wind to the last digit.

Its reading is the incremental encoder at every tick, counts taken as noise. Its duty comes at once, in any
fraction of a step, and stays for the tick. The counter torque stands still. Rate alone is weighed, between
ticks, too: a Kalman filter and the gain of least variance (LQG). As far as friction, gears and windings are
linear around the rate, no firmware with this encoder, tick and motor leaves less. It knows everything, so a
firmware need not come near.
"""

from typing import Final, NamedTuple

import numpy as np
from scipy.linalg import expm, solve_discrete_are, solve_discrete_lyapunov

from plant.compiled import Floats
from plant.effects import wind_torque
from plant.gears import RATIO
from plant.linear import ANGLE, RATE, ROTOR_A, ROTOR_B, SIZE, SPEED_A, SPEED_B, TORQUE_A, continuous, stepped
from plant.parts import EffectModel, PlantModel
from plant.rows import values
from plant.units import ARCSEC
from scenarios.studies.objective.bench import SIDEREAL

TICK_S: Final = 0.005  # Paper, section 3.3.
PARTS: Final = 5  # Instants of a tick at which the rate counts.
_LAGS: Final = (
    (wind_torque.SLOW, wind_torque.OF_SLOW),
    (wind_torque.MIDDLE, wind_torque.OF_MIDDLE),
    (wind_torque.FAST, wind_torque.OF_FAST),
)
_ANGLE_WEIGHT: Final = 1e-4
"""Of an arcsec against an arcsec/s, squared: enough that the angle does not walk away."""
_EFFORT_WEIGHT: Final = 1e-7
"""Of a PWM step, the same: so little that ten times as much changes nothing that is printed."""


class Bound(NamedTuple):
    """rms: of the rate, arcsec/s. exact: with an encoder without counts. torque: rms that it takes of the
    leading motor, N m at the axis; available: what that has at rest."""

    rms: float
    exact: float
    torque: float
    available: float


class Design(NamedTuple):
    """x(k+1) = a x + b u, u = -gain x, PWM steps of the leading motor.

    A reading of the angle adds correction times what it was not expected to be. rms: of the rate, arcsec/s.
    torque: rms, N m at the axis.
    """

    a: Floats
    b: Floats
    gain: Floats
    correction: Floats
    rms: float
    torque: float


def bound(model: PlantModel, wind: EffectModel) -> Bound:
    """For a plant at the tracking rate, in this wind."""
    count = 360.0 * 3600.0 / (model.axes.ra.encoders.incremental.si * model.axes.ra.encoders.roller_ratio.si)
    best = designed(model, wind, count / 12**0.5)  # evenly within a count; six of them pass in a tick
    motor = model.axes.ra.motor
    available = model.supply.voltage.si / motor.loop * motor.torque_constant.si * RATIO
    return Bound(best.rms, designed(model, wind, 1e-3 * count).rms, best.torque, available)


def designed(
    model: PlantModel, wind: EffectModel, reading: float, effort_weight: float = _EFFORT_WEIGHT
) -> Design:
    """The best controller and what it leaves; reading: the encoder's rms, arcsec."""
    a, b, noise = disturbed(model, wind)
    steps = [held(a, b, noise, TICK_S * part / PARTS) for part in range(1, PARTS + 1)]
    ad, bd, w = steps[-1]
    n = len(ad)
    weight, cross, r = np.zeros((n, n)), np.zeros((n, 1)), np.array([[effort_weight]])
    for step, push, _ in steps:
        for place, size in ((RATE, 1.0), (ANGLE, _ANGLE_WEIGHT)):
            row, move = step[place : place + 1], push[place : place + 1]
            weight += size / PARTS * row.T @ row
            cross += size / PARTS * row.T @ move
            r = r + size / PARTS * move.T @ move
    shift = np.linalg.solve(r, cross.T)  # u = v - shift x leaves no cross term
    cost = solve_discrete_are(ad - bd @ shift, bd, weight - cross @ shift, r)
    gain = np.linalg.solve(r + bd.T @ cost @ bd, bd.T @ cost @ ad + cross.T)
    reads = np.zeros((1, n))
    reads[0, ANGLE] = 1.0
    before = solve_discrete_are(ad.T, reads.T, w, np.array([[reading**2]]))
    correction: Floats = before @ reads.T / (reads @ before @ reads.T + reading**2)
    after = before - correction @ reads @ before
    known = solve_discrete_lyapunov(ad - bd @ gain, before - after)
    rates = []
    for step, push, moved in steps:
        rows = (step - push @ gain)[RATE : RATE + 1]
        blind = step[RATE : RATE + 1]
        rates.append(float((rows @ known @ rows.T + blind @ after @ blind.T)[0, 0] + moved[RATE, RATE]))
    torque = float(known[TORQUE_A, TORQUE_A] + after[TORQUE_A, TORQUE_A]) ** 0.5
    return Design(ad, bd, np.array(gain), correction[:, 0], float(np.mean(rates)) ** 0.5, torque)


def disturbed(model: PlantModel, wind: EffectModel) -> tuple[Floats, Floats, Floats]:
    """Matrices of state and effort, the wind's lags behind the plant's states, and their drive; in arcsec."""
    plant, effort, push = continuous(model, model.axes.ra, SIDEREAL * ARCSEC)
    given = values(wind)
    time = given["correlation_time"]
    n = SIZE + len(_LAGS)
    a, b, drive = np.zeros((n, n)), np.zeros((n, 1)), np.zeros((n, 1))
    a[:SIZE, :SIZE], b[:SIZE] = plant, effort
    for k, (lag, share) in enumerate(_LAGS, SIZE):
        a[k, k] = -1.0 / (lag * time)
        drive[k] = 1.0 / (lag * time)
        a[:SIZE, k] = given["deviation"] * share * push[:, 0]
    scale = np.ones(n)
    scale[[ANGLE, RATE, ROTOR_A, SPEED_A, ROTOR_B, SPEED_B]] = 1.0 / ARCSEC
    return a * np.outer(scale, 1.0 / scale), b * scale[:, None], 2.0 * time * drive @ drive.T


def held(a: Floats, b: Floats, noise: Floats, seconds: float) -> tuple[Floats, Floats, Floats]:
    """Exact step with the input held: matrices of state and input, and what noise adds (Van Loan 1978)."""
    n = len(a)
    pair = np.block([[-a, noise], [np.zeros((n, n)), a.T]])
    pieces = 64  # the fast winding would overflow in one
    found = expm(pair * (seconds / pieces))
    part = found[n:, n:].T
    added = part @ found[:n, n:]
    total = np.zeros((n, n))
    for _ in range(pieces):
        total = part @ total @ part.T + added
    return *stepped(a, b, seconds), (total + total.T) / 2
