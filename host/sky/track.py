"""A star's place as the client needs it: cheap at every tick, exact every few seconds."""

from bus.units import ARCSEC
from host.sky.catalogue import Star
from host.sky.mount import Mount
from host.sky.observed import Clock, Observed, Rates, observe, rates
from host.sky.site import Site

_REFRESH_S = 5.0
"""Between two exact places the rates carry the axes on: below 0.001″ of error at altitude 20°."""


class StarTrack:
    """Observed place and rates of one star, and where the axes have to be for it."""

    def __init__(self, star: Star, site: Site, clock: Clock, mount: Mount) -> None:
        self.star = star
        self._site, self._clock, self._mount = site, clock, mount
        self._at_s = -1e9
        self._axes = 0.0, 0.0
        self._rates = Rates(0.0, 0.0)

    def rates(self, t_s: float) -> Rates:
        """Rates of the axes at a time, ″/s."""
        self._renew(t_s)
        return self._rates

    def steps(self, t_s: float) -> tuple[int, int]:
        """Encoder readings of both axes on which the star is at a time."""
        self._renew(t_s)
        since = (t_s - self._at_s) * ARCSEC
        return (
            self._mount.ra.steps(self._axes[0] + since * self._rates.hour_angle_arcsec_s),
            self._mount.dec.steps(self._axes[1] + since * self._rates.declination_arcsec_s),
        )

    def _renew(self, t_s: float) -> None:
        if abs(t_s - self._at_s) > _REFRESH_S / 2:
            # Half a period ahead, so that the exact place lies in the middle of its use.
            self._at_s = t_s + _REFRESH_S / 2
            place = observe(self.star, self._site, self._clock, self._at_s)
            self._rates = rates(self.star, self._site, self._clock, self._at_s)
            self._axes = self._mount.axes(place.hour_angle_rad, place.declination_rad)
            if self._mount.model is not None:
                self._rates = self._of_axes(place, self._rates)

    def _of_axes(self, place: Observed, sky: Rates) -> Rates:
        """Rates of the axes while the place moves at these, over a second either way."""
        step = sky.hour_angle_arcsec_s * ARCSEC, sky.declination_arcsec_s * ARCSEC
        ahead = self._mount.axes(place.hour_angle_rad + step[0], place.declination_rad + step[1])
        behind = self._mount.axes(place.hour_angle_rad - step[0], place.declination_rad - step[1])
        ra, dec = ((a - b) / (2 * ARCSEC) for a, b in zip(ahead, behind, strict=True))
        return Rates(ra, dec)
