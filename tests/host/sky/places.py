"""Where a star of the catalogue is, by ERFA alone."""

import erfa

from host.sky.catalogue import Star
from host.sky.observed import Clock, Place


def apparent_of_star(star: Star, clock: Clock, t_s: float) -> Place:
    """Apparent place of date (proper motion and parallax left out: below 1″ a year)."""
    terrestrial = erfa.taitt(*erfa.utctai(*clock.julian(t_s)))
    ra, dec, origins = erfa.atci13(
        star.right_ascension_rad, star.declination_rad, 0.0, 0.0, 0.0, 0.0, *terrestrial
    )
    return Place(float(erfa.anp(ra - origins)), float(dec))
