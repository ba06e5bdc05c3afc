"""How the friction torque answers to a change of its level along the measured motion.

An effect that changes Tc or Ts does not add its change to the torque: the bristles must first bend to the
new level, over a travel of g/sigma_0, and after a reversal they still hold the old one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.channels.declared import Friction
from calibration.channels.motion import Motion
from calibration.readers.run import Array
from plant.compiled import entry


@entry
def _response(theta: Array, fresh: Array, dt: float, p: Array, exponent: float, change: Array) -> Array:
    """d(sigma_0 z / Tc) per relative change `change` (n,) of the level g along theta (n,); p = (Ts / Tc,
    Stribeck speed, sigma_0 / Tc); see `_bristle`."""
    ratio, vs, stiffness = p
    out = np.zeros(len(theta))
    z = 0.0
    dz = 0.0
    for k in range(1, len(theta)):
        if fresh[k]:
            z = 0.0
            dz = 0.0
            continue
        move = theta[k] - theta[k - 1]
        w = abs(move) / dt
        g = 1.0 + (ratio - 1.0) * np.exp(-((w / vs) ** exponent))
        end = g if move > 0 else -g
        a = stiffness * abs(move) / g
        left = np.exp(-a)
        u = change[k]
        dz = end * u * (1.0 - left) + dz * left + (z - end) * left * a * u
        z = end + (z - end) * left
        out[k] = dz
    return out


@dataclass(frozen=True)
class Level:
    """Full-rate columns (n,) that a change of the friction level may depend on, and its answer in N m.

    `steady` is Tc and Stribeck together, `stiction` the part that Ts scales, both N m and without sign;
    `side` the sign of motion.
    """

    motion: Motion
    friction: Friction
    exponent: float  # of the Stribeck curve
    angle: Array  # rad
    clock: Array  # s
    session: NDArray[np.int64]
    side: Array
    steady: Array
    stiction: Array

    def answer(self, change: Array) -> Array:
        """Torque (n_analysis,) in N m for a change of level (n,) in N m."""
        f, m = self.friction, self.motion
        one = _response(
            m.theta,
            m.starts.astype(float),
            m.period_s / m.width,
            np.array([f.ratio, f.stribeck_speed, f.stiffness]),
            self.exponent,
            # where the friction is nil, as in a log whose effort never changes, there is no level to change
            np.divide(change, self.steady, out=np.zeros_like(change), where=self.steady != 0.0),
        )
        return m.at(one) * f.coulomb


def level_of(
    motion: Motion, friction: Friction, exponent: float, clock: Array, session: NDArray[np.int64]
) -> Level:
    """The declared friction's level along a motion; `clock` (n,) at full rate, s."""
    step = np.gradient(motion.theta)
    speed = np.abs(step) * motion.width / motion.period_s
    fade = np.exp(-((speed / friction.stribeck_speed) ** exponent))
    stiction = friction.coulomb * friction.ratio * fade
    return Level(
        motion,
        friction,
        exponent,
        motion.theta,
        clock,
        session,
        np.sign(step),
        friction.coulomb * (1.0 - fade) + stiction,
        stiction,
    )
