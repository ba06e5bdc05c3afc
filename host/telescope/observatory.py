"""Where the telescope stands and how its encoders are aligned: what turns steps into sky and back."""

from dataclasses import dataclass

from host.sky.apparent import Place, apparent_of_observed, horizontal
from host.sky.mount import Mount
from host.sky.observed import Clock, Observed
from host.sky.pointstars import Sighting
from host.sky.site import Site
from host.sky.visibility import HORIZON_RAD


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
