"""Where the telescope stands and how its encoders are aligned: what turns steps into sky and back."""

from dataclasses import dataclass, replace

from host.sky.apparent import Place, apparent_of_observed, horizontal
from host.sky.catalogue import Star
from host.sky.mount import AxisScale, Mount
from host.sky.observed import Clock, Observed
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

    def observed(self, ra_steps: int, dec_steps: int) -> Observed:
        """Where encoder readings point: observed hour angle, declination, altitude, azimuth."""
        mount = self.mount
        return horizontal(mount.ra.angle_rad(ra_steps), mount.dec.angle_rad(dec_steps), self.site)

    def apparent(self, ra_steps: int, dec_steps: int, t_s: float) -> Place:
        """Apparent place of date that encoder readings latched at `t_s` point to."""
        mount = self.mount
        hour_angle, declination = mount.ra.angle_rad(ra_steps), mount.dec.angle_rad(dec_steps)
        return apparent_of_observed(hour_angle, declination, self.site, self.clock, t_s)

    def check(self, star: Star, t_s: float) -> None:
        """Raise `Unreachable` unless the star is above the horizon limit and within the soft limits."""
        check_reachable(star, self, t_s)

    def align(self, ra_offset_steps: int, dec_offset_steps: int) -> None:
        """Both encoders read this much too much (H4)."""
        mount = self.mount
        self.mount = replace(
            mount, ra=mount.ra.aligned(ra_offset_steps), dec=mount.dec.aligned(dec_offset_steps)
        )

    def limit(self, axis: str, low_steps: int, high_steps: int) -> None:
        """Keep an axis' soft limits as its boards have taken them."""
        scale: AxisScale = getattr(self.mount, axis)
        changed = AxisScale(scale.zero_steps, low_steps, high_steps)
        mount = self.mount
        self.mount = replace(mount, ra=changed) if axis == "ra" else replace(mount, dec=changed)

    def set_park(self, hour_angle_rad: float, declination_rad: float) -> None:
        """Park here from now on."""
        self.mount = replace(
            self.mount, park_hour_angle_rad=hour_angle_rad, park_declination_rad=declination_rad
        )
