"""What an axis with two motors adds to the scene of its balances."""

from dataclasses import dataclass, field

import numpy as np

from calibration.arrays import Array
from calibration.balances.friction import Sliding
from calibration.balances.motion import Motion
from calibration.inputs.train import Train


@dataclass(frozen=True, kw_only=True)
class Pair:
    """What moved, and of stacked rows the motor (n_fitted,), 0 for A and 1 for B.

    In the balance of torques also the friction along the motion, and either motor, A first. Torques are
    signed, in N m at the axis, and angles in turns, on the fitted rows. `lagging` is the torque of the one
    that holds the counter torque, `load` what the declared model needs: the measured one would explain
    itself. `softness_s2`: a rotor's inertia over its train's stiffness.
    """

    motion: Motion
    motor: Array | None = None
    sliding: Sliding | None = None
    torque: tuple[Array, ...] = ()
    turns: tuple[Array, ...] = ()
    lagging: Array = field(default_factory=lambda: np.zeros(0))
    load: Array = field(default_factory=lambda: np.zeros(0))
    softness_s2: float = 0.0

    @property
    def train(self) -> Train:
        """The declared gear train."""
        return self.motion.frame.train
