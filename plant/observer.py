"""The state observer of the axis board at a drive (`boards/axis/observer.py`): its sections, and where from.

Model: the axis around steady sliding (`plant/linear.py`) with both rotors as one, and a slow disturbance. The
last effort is a state, as it still acts while the next one is computed. Observer and feedback are those of
least variance (LQG) for weights and noise below. Together they are one linear system, from the effort that
went out and the angle that the axis is off to the next effort. Its poles are put in pairs.
"""

from typing import Final

import numpy as np

from plant import linear as of
from plant.compiled import Floats
from plant.linear import ANGLE, RATE
from plant.parts import AxisModel, PlantModel
from plant.units import ARCSEC

TICK_S: Final = 0.005
"""Paper, section 3.3."""
DELAY_S: Final = 0.00009
"""From the encoder to the new duty: 81 us with the observer (`boards/axis/config.py`), rounded up."""
RATE_ARCSEC: Final = 15.041
POSITION: Final = 1e11
"""Weight of the position beside the effort, (PWM steps/rad)^2: a step is worth 0.65 arcsec."""
DISTURBANCE: Final = 10.0
"""Noise of the disturbance, (N m)^2 per tick.

Of all decades of the two these leave the least rate on three drives, without cogging and with it. No number
of a drive that is off by a tenth may raise the peak of the sensitivity beyond 2. Source: Astrom and Hagglund,
Advanced PID Control, 2006 (general knowledge). `tests/studies/objective/test_weights.py` picks them."""
OTHERS = (1e-12, 1e-2)
"""Noise of the rate, (rad/s)^2 per tick, and of the motors' torque, (N m)^2 per tick. ASSUMPTION: a
thousandth of either changes nothing by 1 %, as that test shows."""
_REST: Final = 1e-16
"""Of every other state, so that no variance vanishes."""
LOAD, LAST, SIZE = 6, 7, 8
"""Behind axis angle and rate, bristle torque, rotor angle and rate, and motor torque."""


def lumped(model: PlantModel, part: AxisModel) -> tuple[Floats, Floats]:
    """Matrices of the first seven states and of the effort, PWM steps: the rotors turn alike."""
    a, b, push = of.continuous(model, part, RATE_ARCSEC * ARCSEC)
    whole, one = np.zeros((len(a), LOAD)), np.zeros((LOAD, len(a)))
    for place, (first, second, share) in enumerate(
        ((ANGLE, ANGLE, 0.5), (RATE, RATE, 0.5), (of.BRISTLE, of.BRISTLE, 0.5),
         (of.ROTOR_A, of.ROTOR_B, 0.5), (of.SPEED_A, of.SPEED_B, 0.5), (of.TORQUE_A, of.TORQUE_B, 1.0))
    ):  # fmt: skip
        whole[[first, second], place] = 1.0
        one[place, first] += share
        one[place, second] += share
    whole[of.TORQUE_B, LOAD - 1] = 0.0
    found = np.zeros((LAST, LAST))
    found[:LOAD, :LOAD], found[:LOAD, LOAD] = one @ a @ whole, (one @ push)[:, 0]
    return found, np.vstack([one @ b, np.zeros((1, 1))])


def designed(
    model: PlantModel, part: AxisModel, position: float = POSITION, disturbance: float = DISTURBANCE
) -> tuple[Floats, Floats, Floats, Floats]:
    """a, b, gain, correction: x(k+1) = a x + b u and u = -gain x, of the observer's states at one tick.

    They are moved by correction times what a reading was not expected to be.
    """
    from scipy.linalg import solve_discrete_are  # of the extra `calibrate`

    plant = lumped(model, part)
    a, b = np.zeros((SIZE, SIZE)), np.zeros((SIZE, 1))
    (whole, _), (rest, new), (_, last) = (of.stepped(*plant, s) for s in (TICK_S, TICK_S - DELAY_S, DELAY_S))
    a[:LAST, :LAST], a[:LAST, LAST:], b[:LAST], b[LAST] = whole, rest @ last, new, 1.0
    keep = [n for n in range(SIZE) if n != LOAD]  # nobody controls the disturbance
    weight = np.zeros((SIZE - 1, SIZE - 1))
    weight[ANGLE, ANGLE] = position
    ac, bc = a[np.ix_(keep, keep)], b[keep]
    cost = solve_discrete_are(ac, bc, weight, np.eye(1))
    gain = np.zeros(SIZE)
    gain[keep] = np.linalg.solve(1.0 + bc.T @ cost @ bc, bc.T @ cost @ ac)[0]
    # where the states rest under a unit of the disturbance, with the axis on its place, and the effort there
    moved = np.column_stack([np.delete(a - np.eye(SIZE), [ANGLE, LOAD], axis=1), b])
    rest_at = np.linalg.lstsq(moved, -a[:, LOAD] + np.eye(SIZE)[LOAD], rcond=None)[0]
    gain[LOAD] = -rest_at[-1] - np.delete(gain, [ANGLE, LOAD]) @ rest_at[:-1]
    noise = _REST * np.eye(SIZE)
    noise[LOAD, LOAD], (noise[RATE, RATE], noise[LOAD - 1, LOAD - 1]) = disturbance, OTHERS
    reading = count_rad(part) ** 2 / 12.0  # evenly within a count
    reads = np.eye(SIZE)[:, :1]
    spread = solve_discrete_are(a.T, reads, noise, np.array([[reading]]))
    return a, b, gain, spread[:, ANGLE] / (spread[ANGLE, ANGLE] + reading)


def count_rad(part: AxisModel) -> float:
    """A count of the incremental encoder, rad of the axis."""
    return float(2.0 * np.pi / (part.encoders.incremental.si * part.encoders.roller_ratio.si))


def sections(model: PlantModel, part: AxisModel) -> tuple[list[tuple[float, ...]], float]:
    """Trace, determinant and numerators of four sections; what goes straight through, PWM steps per count.

    A section is (n1 z + n0) / (z^2 - trace z + determinant). Both numbers come for the effort first, then for
    the angle in counts.
    """
    a, b, gain, correction = designed(model, part)
    count = count_rad(part)
    after = np.eye(SIZE) - np.outer(correction, np.eye(SIZE)[ANGLE])
    poles, modes = np.linalg.eig(a @ after)
    inputs = np.linalg.solve(modes, np.column_stack([b[:, 0], a @ correction * count]).astype(complex))
    share = -(gain @ after @ modes)[:, None] * inputs
    order = np.lexsort((poles.real, np.abs(poles.imag) < 1e-9))  # conjugates are neighbours, and come first
    found = []
    for p, q in order.reshape(-1, 2):
        first, second = share[p] + share[q], -(share[p] * poles[q] + share[q] * poles[p])
        pair = (poles[p] + poles[q], poles[p] * poles[q], first[0], second[0], first[1], second[1])
        found.append(tuple(float(np.real(each)) for each in pair))
    return found, float(-gain @ correction * count)
