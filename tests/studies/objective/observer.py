"""A state observer at high preload: `python -m tests.studies.objective.observer` prints the table.

Not firmware: floating point on the plant's pins, one control tick of 5 ms, effort with a spread duty and
the bias. At 15 arcsec/s the Stribeck curve of the high preload makes the sliding axis an unstable pole of
18 rad/s; the paper's PI of velocity counts cannot hold it. The observer knows the axis, both rotors on their
trains, the bristles linearised at the rate, the winding, and a slow disturbance; it reads the incremental
encoder, whose counts the axis board samples itself, so that no bus lies in the loop. Gains by DARE (LQG).
"""

from math import exp
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm, solve_discrete_are

from plant.deadzone import bias_steps, ohms, step_torque
from plant.gears import RATIO
from plant.kernels import layout as at
from plant.model import get, load, with_value
from plant.parts import PlantModel
from plant.plant import Plant
from plant.units import ARCSEC, TURN
from scenarios.studies.objective.bench import SIDEREAL
from scenarios.studies.objective.cases import starts

Floats = NDArray[np.float64]
TICK_S = 0.005
_COUNT_RAD = TURN / 112_896_000
EFFORT_LIMIT = 1500.0
"""PWM steps: half the supply."""
RAMP_S, SETTLE_S = 10.0, 25.0
"""The rate is asked for slowly, so that the bristles load without a leap."""
DESIGN_DELAY_S = 0.0025
"""From reading the encoder to the new duty; the table runs 0.1 to 4.9 ms."""
_POSITION, _EFFORT = 1e8, 1e-4
"""Weights of position, 1/rad^2, and effort, 1/step^2: the middle of a window that is narrow (the docs)."""
_ACCELERATION, _DISTURBANCE = 1e-12, 1e3
"""Noise of rate, (rad/s)^2 per tick, and of the disturbance, (N m)^2 per tick."""
READING = (_COUNT_RAD / 12**0.5) ** 2
"""rad^2: one count, evenly."""
# states: axis angle and rate, bristle torque, rotor angle and rate, motor torque, disturbance, last effort
ANGLE, _RATE, _BRISTLE, _ROTOR, _ROTOR_RATE, _TORQUE, LOAD, LAST, SIZE = range(9)


class Design(NamedTuple):
    """x(k+1) = a x + b u; u = -gain x - load / per_step; the observer corrects with `correction`."""

    a: Floats
    b: Floats
    gain: Floats
    correction: Floats
    per_step: float


def continuous(model: PlantModel, rate: float) -> tuple[Floats, Floats, float]:
    """Matrices at steady sliding with `rate`, rad/s; effort in PWM steps."""
    part = model.axes.ra
    f, motor, gear = part.friction, part.motor, part.gear
    ohm = ohms(motor)
    x = (rate / f.stribeck_rate.si) ** f.stribeck_exponent.si
    excess = (f.stiction.si - f.coulomb.si) * exp(-x)
    level = f.coulomb.si + excess
    slope = -excess * x * f.stribeck_exponent.si  # rate times dg/drate, N m
    rotors, load = 2.0 * motor.rotor_inertia.si * RATIO**2, part.inertia.si
    k, c, sigma0 = gear.stiffness.si, gear.damping.si, f.bristle_stiffness.si
    brake = (motor.torque_constant.si * RATIO) ** 2 / ohm
    brake *= 2.0 if motor.diode_drop else 1.0  # with a bias both currents flow on
    per_step = step_torque(model, motor) * (1.0 - model.controller.counter_split.si)
    a = np.zeros((LAST, LAST))
    a[ANGLE, _RATE] = a[_ROTOR, _ROTOR_RATE] = 1.0
    a[_RATE, [ANGLE, _RATE, _BRISTLE, _ROTOR, _ROTOR_RATE, LOAD]] = (
        np.array([-k, -c - f.viscous.si, -1.0, k, c, 1.0]) / load
    )
    a[_BRISTLE, _RATE], a[_BRISTLE, _BRISTLE] = sigma0 * slope / level, -sigma0 * rate / level
    a[_ROTOR_RATE, [ANGLE, _RATE, _ROTOR, _ROTOR_RATE, _TORQUE]] = (
        np.array([k, c, -k, -c - brake, 1.0]) / rotors
    )
    electric = motor.inductance.si / ohm
    a[_TORQUE, _TORQUE] = -1.0 / electric
    b = np.zeros((LAST, 1))
    b[_TORQUE, 0] = per_step / electric
    return a, b, per_step


def _held(a: Floats, b: Floats, seconds: float) -> tuple[Floats, Floats]:
    """Exact step of a continuous system with its input held."""
    n = len(a)
    both = np.zeros((n + 1, n + 1))
    both[:n, :n], both[:n, n:] = a, b
    step: Floats = expm(both * seconds)
    return step[:n, :n], step[:n, n:]


def noise() -> Floats:
    """Return the covariance of what moves the states in a tick that the model does not know."""
    found = 1e-16 * np.eye(SIZE)
    found[ANGLE, ANGLE], found[_RATE, _RATE] = 1e-20, _ACCELERATION
    found[_TORQUE, _TORQUE], found[LOAD, LOAD] = 1e-2, _DISTURBANCE
    return found


def design(model: PlantModel, rate: float = SIDEREAL * ARCSEC, delay_s: float = DESIGN_DELAY_S) -> Design:
    """Observer and gains for a plant at a rate, the effort coming `delay_s` after the reading."""
    a, b, per_step = continuous(model, rate)
    whole, _ = _held(a, b, TICK_S)
    rest, new = _held(a, b, TICK_S - delay_s)
    _, old = _held(a, b, delay_s)
    ad, bd = np.zeros((SIZE, SIZE)), np.zeros((SIZE, 1))
    ad[:LAST, :LAST], ad[:LAST, LAST:], bd[:LAST] = whole, rest @ old, new
    bd[LAST] = 1.0
    keep = [n for n in range(SIZE) if n != LOAD]  # nobody controls the disturbance
    ac, bc = ad[np.ix_(keep, keep)], bd[keep]
    weight = np.zeros((len(keep), len(keep)))
    weight[0, 0] = _POSITION
    cost = solve_discrete_are(ac, bc, weight, np.array([[_EFFORT]]))
    gain = np.zeros(SIZE)
    gain[keep] = np.linalg.solve(_EFFORT + bc.T @ cost @ bc, bc.T @ cost @ ac)[0]
    reads = np.zeros((1, SIZE))
    reads[0, ANGLE] = 1.0
    spread = solve_discrete_are(ad.T, reads.T, noise(), np.array([[READING]]))
    correction = (spread @ reads.T / (spread[0, 0] + READING))[:, 0]
    return Design(ad, bd[:, 0], gain, correction, per_step)


def hold(
    model: PlantModel, made: Design, delay_s: float, seconds: float, start_deg: float, seed: int = 1,
    whole_steps: bool = False,
) -> Floats:  # fmt: skip
    """True rate less 15.041 arcsec/s, one value per tick, without the start. whole_steps: PWM not spread."""
    plant = Plant(model, seed, {"ra": start_deg / 360.0 * 2**29})
    axis, delay_ns = plant.ra, round(delay_s * 1e9)
    wanted = SIDEREAL * ARCSEC
    first = axis.incremental(0)
    x = np.zeros(SIZE)
    reference = 0.0
    ticks = round((seconds + SETTLE_S) / TICK_S)
    errors = np.empty(ticks)
    steps, bias = model.controller.pwm_steps.si, bias_steps(model, model.axes.ra.motor)
    split = model.controller.counter_split.si
    for tick in range(ticks):
        t_ns = tick * 5_000_000
        read = (axis.incremental(t_ns) - first + 0.5) * _COUNT_RAD
        errors[tick] = float(plant.world[0, at.RATE]) / ARCSEC - SIDEREAL
        reference += wanted * min(1.0, tick * TICK_S / RAMP_S) * TICK_S if tick else 0.0
        x = x + made.correction * (read - reference - x[ANGLE])
        effort = float(-made.gain @ x - x[LOAD] / made.per_step)
        effort = max(-EFFORT_LIMIT, min(EFFORT_LIMIT, effort))
        if whole_steps:
            effort = float(round(effort))
        lead, lag = ((share * abs(effort) + bias) / steps for share in (1.0, split))
        axis.drive(t_ns + delay_ns, *((lead, lag) if effort >= 0 else (lag, lead)))
        x = made.a @ x + made.b * effort
    return errors[round(SETTLE_S / TICK_S) :]


NUMBERS = (
    "friction.coulomb", "friction.stiction", "friction.viscous", "friction.stribeck_rate",
    "friction.bristle_stiffness", "inertia", "motor.torque_constant", "motor.resistance", "gear.stiffness",
)  # fmt: skip


def _peak(*given: Any, **more: Any) -> float:
    return float(np.abs(hold(*given, **more)).max())


def table(name: str = "high_preload_motor_units", seconds: float = 60.0) -> None:
    """Print peaks, arcsec/s: from eight starts, over delays, with each number of the plant off by a share."""
    model = load(name)
    made = design(model)
    angles = starts(0.0)
    found = [_peak(model, made, DESIGN_DELAY_S, 600.0, start) for start in angles]
    print(f"{name}, eight starts, 600 s: worst {max(found):.2f}, median {np.median(found):.2f}", flush=True)
    whole = _peak(model, made, DESIGN_DELAY_S, seconds, angles[0], whole_steps=True)
    print(f"the same in whole PWM steps, {seconds:g} s: {whole:.2f}", flush=True)
    for delay_s in (0.0001, 0.0015, 0.003, 0.0049):
        print(
            f"delay {delay_s * 1e3:g} ms: {_peak(model, made, delay_s, seconds, angles[0]):.2f}", flush=True
        )
    for share in (0.05, 0.1, 0.2):
        worst: list[tuple[float, str]] = []
        for number in NUMBERS:
            path = f"axes.ra.{number}"
            for factor in (1.0 - share, 1.0 + share):
                other = with_value(model, path, get(model, path).value * factor)
                for delay_s in (0.0015, 0.0049):
                    peak = _peak(other, made, delay_s, seconds / 4, angles[0])
                    worst.append((peak, f"{number} x {factor:g}, {delay_s * 1e3:g} ms"))
        worst.sort(reverse=True)
        kept = sum(peak <= 1.0 for peak, _ in worst)
        said = "; ".join(f"{peak:.2f} ({what})" for peak, what in worst[:4])
        print(f"one number off by {share:.0%}: {kept} of {len(worst)} within 1; worst {said}", flush=True)


if __name__ == "__main__":
    table()
