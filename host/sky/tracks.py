"""What the axes can be made to follow: a star, a star and a guider's shifts, a place fixed to the ground."""

from enum import Enum
from typing import NamedTuple

from bus.units import ARCSEC
from host.sky.catalogue import Star
from host.sky.mount import STEP_ARCSEC, Mount
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


SIDEREAL_ARCSEC_S = 15.041067
"""Hour angle of the sky per second of UTC (IAU 2006 Earth rotation rate 7.292115e-5 rad/s)."""
GUIDE_ARCSEC_S = 0.5 * SIDEREAL_ARCSEC_S
"""Guide rate until somebody sets another, and the fastest: half the sidereal rate, as is common. At
the whole, RA runs west at 30″/s, where friction falls with speed faster than the loop follows. ASSUMPTION."""

RAMP_S = 0.3
"""A pulse's rate comes and goes over this: a step could break an axis out of its friction. ASSUMPTION."""
_OLDEST_S = 1.0
"""Readings are younger than this, so an older pulse is a plain shift. ASSUMPTION."""


class DriveRate(Enum):
    """Rates of hour angle, ″/s: what the sky, the Moon and the Sun do on average (ASCOM's DriveRates)."""

    SIDEREAL = SIDEREAL_ARCSEC_S
    LUNAR = 14.685
    SOLAR = 15.0
    KING = 15.0369


class Pulse(NamedTuple):
    """A guider's shift of one axis (0: hour angle, 1: declination): ″/s, begun and lasting s.

    It comes and goes over `RAMP_S`: the mean over that time of a pulse with edges.
    """

    axis: int
    arcsec_s: float
    begin_s: float
    seconds: float

    @property
    def end_s(self) -> float:
        """When it is all made."""
        return self.begin_s + self.seconds + RAMP_S

    def arcsec(self, t_s: float) -> float:
        """How far it has shifted by a time, ″."""
        age_s = min(t_s, self.end_s) - self.begin_s
        corners = (age_s, age_s - self.seconds, age_s - RAMP_S, age_s - self.seconds - RAMP_S)
        squares = [max(each, 0.0) ** 2 for each in corners]
        return self.arcsec_s * (squares[0] - squares[1] - squares[2] + squares[3]) / (2 * RAMP_S)


class SkyTrack(StarTrack):
    """A star, shifted by a guider and drifting at a rate of its own.

    Shifts and drifts are of the axes, in ″ and ″/s of hour angle (positive west) and declination.
    """

    def __init__(
        self,
        star: Star,
        site: Site,
        clock: Clock,
        mount: Mount,
        drift_arcsec_s: tuple[float, float] = (0.0, 0.0),
        since_s: float = 0.0,
    ) -> None:
        super().__init__(star, site, clock, mount)
        self._drift = drift_arcsec_s
        self._since_s = since_s
        self._shift = [0.0, 0.0]
        self._pulses: list[Pulse] = []

    def guide(self, pulse: Pulse) -> None:
        """Follow a place that a pulse moves, and leaves beside the one followed so far."""
        over = [each for each in self._pulses if each.end_s < pulse.begin_s - _OLDEST_S]
        for each in over:
            self._shift[each.axis] += each.arcsec(each.end_s)
            self._pulses.remove(each)
        self._pulses.append(pulse)

    def shifted(self, t_s: float) -> list[float]:
        """What guiding has made of both axes by a time, ″."""
        shift = list(self._shift)
        for each in self._pulses:
            shift[each.axis] += each.arcsec(t_s)
        return shift

    def rates(self, t_s: float) -> Rates:
        """Rates of the axes at a time, ″/s."""
        plain = super().rates(t_s)
        return Rates(plain[0] + self._drift[0], plain[1] + self._drift[1])

    def steps(self, t_s: float) -> tuple[int, int]:
        """Encoder readings on which the place is at a time."""
        ra, dec = super().steps(t_s)
        age_s = t_s - self._since_s
        shifts = [each + drift * age_s for each, drift in zip(self.shifted(t_s), self._drift, strict=True)]
        return ra + round(shifts[0] / STEP_ARCSEC), dec + round(shifts[1] / STEP_ARCSEC)


class GroundTrack(StarTrack):
    """A place that stands still over the ground: altitude and azimuth."""

    def __init__(self, place: Observed, site: Site, clock: Clock, mount: Mount) -> None:
        super().__init__(Star("altitude and azimuth", 0.0, 0.0), site, clock, mount)
        self._steps = mount.steps(place.hour_angle_rad, place.declination_rad)

    def rates(self, t_s: float) -> Rates:
        """Nothing moves."""
        return Rates(0.0, 0.0)

    def steps(self, t_s: float) -> tuple[int, int]:
        """The same at all times."""
        return self._steps
