"""A picture taken with the telescope, as far as a run needs it: how far a star is from the middle."""

import math
from collections import deque
from collections.abc import Callable, Iterable

from bus.time import generator
from bus.units import ARCSEC_PER_RAD
from host.camera.models import Look
from host.sky.catalogue import Star
from host.sky.mount import STEPS_PER_TURN
from host.sky.observed import observe
from plant.air import best_focus_m
from plant.mount import sky
from plant.plant import Plant
from scenarios.language.model import Scenario

NOISE_ARCSEC = 0.3
"""Standard deviation of a solved place in each coordinate. ASSUMPTION: seeing of 2″ over some 50 stars."""
_UP_RAD = 1e-5  # A step of the declination axis, which shows what is up in a picture.


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
            _, hour_angle, declination, *_ = look(self.plant, self._scenario, t_ns)
            off = (
                math.remainder(place.hour_angle_rad - hour_angle, 2 * math.pi) + west / math.cos(declination),
                place.declination_rad - declination + north,
            )
        if self.told is not None:
            self.told(*off)
        return off


def look(plant: Plant, scenario: Scenario, t_ns: int) -> Look:
    """Where the true telescope looks, the mount's errors included, and how far its focus is from the best."""
    mount, rad = scenario.mount, 2 * math.pi / STEPS_PER_TURN
    ra = plant.ra.truth(t_ns)[0] - mount.ra.zero_steps * rad
    dec = plant.dec.truth(t_ns)[0] - mount.dec.zero_steps * rad
    focus_m = plant.focus.position_m(t_ns) - best_focus_m(plant.model, t_ns)
    errors = plant.model.mount
    if errors is None:
        return Look(t_ns, ra, dec, 0.0, focus_m)
    hour_angles, declinations = sky([ra, ra], [dec, dec + _UP_RAD], scenario.site.latitude_rad, errors)
    west = (hour_angles[1] - hour_angles[0]) * math.cos(declinations[0])
    roll = math.atan2(west, declinations[1] - declinations[0])
    return Look(t_ns, float(hour_angles[0]), float(declinations[0]), roll, focus_m)
