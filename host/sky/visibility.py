"""Is a target within reach, now and until the end of what is planned? Asked before anything moves."""

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from host.sky.angles import format_degrees
from host.sky.catalogue import Star
from host.sky.mount import Mount
from host.sky.observed import Clock, Observed, Place, apparent_of_observed, horizontal, observe_many
from host.sky.pointstars import Sighting
from host.sky.site import Site

HORIZON_RAD = math.radians(15.0)
"""ASSUMPTION: below 15° the dome's slit and the air mass make observing pointless; scenarios may lower it."""
_STEP_S = 10.0


class Unreachable(ValueError):
    """A target the telescope must not be sent to; the message says why and when."""


class BelowHorizon(Unreachable):
    """It is, or will be, below the horizon limit."""


class Standpoint(Protocol):
    """Where a telescope stands, when, and how far it may point: an observatory, or a scenario."""

    @property
    def site(self) -> Site:
        """Its place on the Earth."""

    @property
    def clock(self) -> Clock:
        """What simulated second 0 is."""

    @property
    def mount(self) -> Mount:
        """Encoders and soft limits."""

    @property
    def horizon_rad(self) -> float:
        """Lowest altitude to point at."""


def check_reachable(star: Star, place: Standpoint, t_s: float, stay_s: float = 0.0) -> None:
    """Raise `Unreachable` unless the target stays above the horizon and inside the soft limits.

    t_s: when it is to be reached; stay_s: for how long it is tracked then.
    """
    clock, mount, horizon_rad = place.clock, place.mount, place.horizon_rad
    times = t_s + np.linspace(0.0, stay_s, 2 + int(stay_s // _STEP_S))
    hour_angle, declination, altitude, _ = observe_many(star, place.site, clock, times)
    low = np.flatnonzero(altitude < horizon_rad)
    if low.size:
        index = int(low[0])
        raise BelowHorizon(
            f"{star.name} is at altitude {format_degrees(altitude[index])} {_when(index, times, clock)}, "
            f"below the horizon limit of {math.degrees(horizon_rad):g}°"
        )
    axes = (("hour angle", mount.ra, hour_angle), ("declination", mount.dec, declination))
    for name, scale, angles in axes:
        outside = [index for index, angle in enumerate(angles) if not scale.within(float(angle))]
        if outside:
            index = outside[0]
            low_deg = math.degrees(scale.angle_rad(scale.low_steps))
            high_deg = math.degrees(scale.angle_rad(scale.high_steps))
            raise Unreachable(
                f"{star.name} is at {name} {format_degrees(angles[index])} {_when(index, times, clock)}, "
                f"beyond the soft limits {low_deg:.1f}°..{high_deg:.1f}°"
            )


def _when(index: int, times: np.ndarray[tuple[int, ...], np.dtype[np.float64]], clock: Clock) -> str:
    moment = "when it is to be reached" if index == 0 else "before the track ends"
    return f"{moment} ({clock.iso(float(times[index]))[:19]}Z)"


@dataclass
class Observatory:
    """Site, clock and mount. The mount is replaced as a whole when the telescope is synchronised or its
    limits change. So a reader in another thread always sees one that fits together."""

    site: Site
    clock: Clock
    mount: Mount
    horizon_rad: float = HORIZON_RAD
    name: str = "Nainital"
    stars: tuple[Sighting, ...] = ()
    """Stars that the telescope was synchronised on, for a pointing model."""

    def observed(self, ra_steps: int, dec_steps: int) -> Observed:
        """Where encoder readings point: observed hour angle, declination, altitude, azimuth."""
        return horizontal(*self.mount.place(ra_steps, dec_steps), self.site)

    def apparent(self, ra_steps: int, dec_steps: int, t_s: float) -> Place:
        """Apparent place of date that encoder readings latched at `t_s` point to."""
        return apparent_of_observed(*self.mount.place(ra_steps, dec_steps), self.site, self.clock, t_s)
