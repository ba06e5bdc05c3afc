"""Where the telescope stands and how its encoders are aligned: what turns steps into sky and back."""

from dataclasses import dataclass, replace

from host.sky.apparent import Place, apparent_of_observed, horizontal
from host.sky.catalogue import Star
from host.sky.mount import Mount
from host.sky.observed import Clock, Observed
from host.sky.pointfit import fit
from host.sky.pointmodel import PointingModel
from host.sky.pointstars import Sighting
from host.sky.site import Site
from host.sky.visibility import HORIZON_RAD, check_reachable


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

    def check(self, star: Star, t_s: float) -> None:
        """Raise `Unreachable` unless the star is above the horizon limit and within the soft limits."""
        check_reachable(star, self, t_s)

    def align(self, ra_offset_steps: int, dec_offset_steps: int) -> None:
        """Both encoders read this much too much (H4)."""
        mount = self.mount
        self.mount = replace(
            mount, ra=mount.ra.aligned(ra_offset_steps), dec=mount.dec.aligned(dec_offset_steps)
        )

    def fit(self) -> PointingModel:
        """The pointing model of the stars so far; raises TooFewStars."""
        return fit(self.stars, self.mount, self.site.latitude_rad)

    def apply(self, model: PointingModel | None) -> None:
        """Point by a model, or by the encoders alone."""
        self.mount = replace(self.mount, model=model)

    def set_park(self, hour_angle_rad: float, declination_rad: float) -> None:
        """Park here from now on: angles of the axes."""
        self.mount = replace(
            self.mount, park_hour_angle_rad=hour_angle_rad, park_declination_rad=declination_rad
        )
