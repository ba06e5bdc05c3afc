"""A picture taken with the telescope, as far as a run needs it: how far a star is from the middle."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from bus.time import generator
from bus.units import ARCSEC_PER_RAD
from host.sky.catalogue import Star
from host.sky.mount import STEPS_PER_TURN
from host.sky.observed import observe

if TYPE_CHECKING:
    from plant.plant import Plant
    from scenarios.language.model import Scenario

NOISE_ARCSEC = 0.3
"""Standard deviation of a solved place in each coordinate. ASSUMPTION: seeing of 2″ over some 50 stars."""


class Eye:
    """Looks through the true telescope; so what it says holds, whatever the encoders read.

    told: of every offset, for who records what the host hears.
    """

    def __init__(self, plant: Plant, scenario: Scenario) -> None:
        self.plant = plant
        self.told: Callable[[float, float], None] | None = None
        self._scenario = scenario
        self._noise = generator(scenario.seed, "eye")
        self._known: deque[tuple[float, float]] = deque()

    def replay(self, offsets: Iterable[tuple[float, float]]) -> None:
        """Say these first: a host that lives again looks at a sky that is over."""
        self._known.extend(offsets)

    def __call__(self, star: Star, t_ns: int) -> tuple[float, float]:
        """Star less telescope in hour angle and declination, rad."""
        west, north = self._noise.normal(0.0, NOISE_ARCSEC / ARCSEC_PER_RAD, 2)
        if self._known:
            off = self._known.popleft()
        else:
            place = observe(star, self._scenario.site, self._scenario.clock, t_ns * 1e-9)
            hour_angle, declination = self._looks_at(t_ns)
            off = (
                math.remainder(place.hour_angle_rad - hour_angle, 2 * math.pi) + west / math.cos(declination),
                place.declination_rad - declination + north,
            )
        if self.told is not None:
            self.told(*off)
        return off

    def _looks_at(self, t_ns: int) -> tuple[float, float]:
        mount, rad = self._scenario.mount, 2 * math.pi / STEPS_PER_TURN
        ra = self.plant.ra.truth(t_ns)[0] - mount.ra.zero_steps * rad
        dec = self.plant.dec.truth(t_ns)[0] - mount.dec.zero_steps * rad
        errors = self.plant.model.mount
        if errors is None:
            return ra, dec
        from plant.mount import sky

        hour_angle, declination = sky(ra, dec, self._scenario.site.latitude_rad, errors)
        return float(hour_angle), float(declination)
