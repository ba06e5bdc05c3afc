"""The declared friction along a measured motion, by the plant's own kernel (LuGre; paper, equations 3-5).

A change of Tc or Ts does not add to the torque at once: the bristles bend to the new level over g/sigma_0.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from calibration.arrays import Array, Mask
from calibration.balances.filters import smooth
from calibration.balances.motion import Motion
from calibration.balances.view import View
from calibration.inputs.declaration import FrictionLaw
from plant.compiled import entry
from plant.kernels.friction import relax

# of the friction's level, either way, for its derivative: the answer's error is the square of it. arithmetic
SMALL = 1e-4


@entry
def _bent(position: Array, fresh: Any, period_s: float, g: Array) -> Array:
    """Bristle deflection along `position` (n,), at rest where `fresh`; `g` (n,) is that of steady sliding."""
    out = np.zeros(len(position))
    z = 0.0
    for k in range(1, len(position)):
        z = 0.0 if fresh[k] else relax(z, (position[k] - position[k - 1]) / period_s, g[k], period_s)
        out[k] = z
    return out


@dataclass(frozen=True, kw_only=True)
class Path:
    """Positions (n,) every `period_s`, bristles at rest where `fresh`; increments do not drift."""

    position: Array
    fresh: Mask
    period_s: float

    def level(self, law: FrictionLaw) -> Array:
        """Friction of steady sliding over Coulomb's, at every row's own rate."""
        return steady_level(law, np.diff(self.position, prepend=self.position[:1]) / self.period_s)

    def bristle(self, law: FrictionLaw, level: Array | None = None) -> Array:
        """Friction over Coulomb's (n,) by bristles, of the law's `level` or another one (n,)."""
        travel = law.bristle_travel
        assert travel is not None
        g = travel * (self.level(law) if level is None else level)
        return np.asarray(_bent(self.position, self.fresh, self.period_s, g)) / travel


def dip(law: FrictionLaw, speed: Array) -> Array:
    """Part of the dip from rest (Stribeck) that is there at `speed`: 1 at rest, 0 far above the law's."""
    return np.asarray(np.exp(-((np.abs(speed) / law.stribeck_speed) ** law.stribeck_exponent)))


def steady_level(law: FrictionLaw, speed: Array) -> Array:
    """Friction of steady sliding over Coulomb's."""
    return 1.0 + (law.stiction_ratio - 1.0) * dip(law, speed)


@dataclass(frozen=True, kw_only=True)
class Sliding:
    """The friction of a drive along its motion, full-rate columns (n,).

    `side`: direction, -1 to 1, with which friction turns where no bristles are. viscous: per `speed`.
    """

    law: FrictionLaw
    path: Path
    side: Array
    speed: Array
    coulomb: float = 1.0
    viscous: float = 0.0

    @property
    def shape(self) -> Array:
        """Friction over Coulomb's, without the viscous one."""
        if self.law.bristle_travel is not None:
            return self.path.bristle(self.law)
        return self.side * steady_level(self.law, self.speed)

    @cached_property
    def steady(self) -> Array:
        """Coulomb and Stribeck together, as they are in steady sliding, without sign."""
        return self.coulomb * steady_level(self.law, self.speed)

    @cached_property
    def stiction(self) -> Array:
        """The part of `steady` that the stiction scales; all of it where the law has no dip."""
        if self.law.stiction_ratio == 1.0:
            return self.steady
        return self.coulomb * self.law.stiction_ratio * dip(self.law, self.speed)

    @property
    def drag(self) -> Array:
        """Viscous friction, signed."""
        return self.viscous * self.speed

    @property
    def size(self) -> Array:
        """All friction of steady sliding, without sign."""
        return self.steady + np.abs(self.drag)

    @cached_property
    def _level(self) -> Array:
        return self.path.level(self.law)

    def answer(self, change: Array) -> Array:
        """What friction answers to a change (n,) of its level, both in the response's unit."""
        if self.law.bristle_travel is None:
            return self.side * change
        # where the friction is nil, as in a log whose effort never changes, there is no level to change
        part = np.divide(change, self.steady, out=np.zeros_like(change), where=self.steady != 0.0)
        most = float(np.abs(part).max(initial=0.0))
        if most == 0.0:
            return np.zeros_like(part)
        small = SMALL / most
        more, less = (self.path.bristle(self.law, self._level * (1.0 + h * part)) for h in (small, -small))
        return (more - less) * (self.coulomb / (2 * small))


def slid_by(m: Motion, law: FrictionLaw, coulomb: float, viscous: float) -> Sliding:
    """Of an axis with two motors: coulomb in N m, viscous in N m s/rad."""
    step = np.gradient(m.x)
    speed, side = step / m.period_s, np.sign(step)
    return Sliding(law=law, path=path_of(m), side=side, speed=speed, coulomb=coulomb, viscous=viscous)


def path_of(m: Motion) -> Path:
    """Of an axis' absolute encoder."""
    return Path(position=m.x, fresh=m.starts, period_s=m.period_s)


def sliding_of(view: View, coulomb: float = 1.0, viscous: float = 0.0) -> Sliding:
    """Of a drive with one motor, by the law that its rig declares."""
    # as the direction is: noise is no travel
    position = smooth(view.x, view.segment, max(view.wide / 2, 1.0))
    fresh = np.concatenate([[True], np.diff(view.segment) != 0])
    path = Path(position=position, fresh=fresh, period_s=view.period_s)
    law, side = view.rig.friction_law or FrictionLaw(), view.direction
    return Sliding(law=law, path=path, side=side, speed=view.speed, coulomb=coulomb, viscous=viscous)
