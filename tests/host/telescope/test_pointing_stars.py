"""Stars that a client synchronises on become a pointing model, and the telescope points by it."""

import math

import numpy as np
import pytest

from bus.units import ARCSEC_PER_RAD
from host.sky.mount import STEPS_PER_TURN
from host.sky.observed import observe
from host.sky.tracks import SIDEREAL_ARCSEC_S
from host.telescope.jobs import Refused
from plant.mount import sky
from plant.parts import MountErrors
from tests.host.sky.seen import LATITUDE, sightings
from tests.host.telescope.conftest import Rig


def looks_at(rig: Rig) -> tuple[float, float]:
    """Hour angle and declination, rad, that a telescope with a typical mount looks at, by the true axes."""
    plant, mount, rad = rig.network.plant, rig.scenario.mount, 2 * math.pi / STEPS_PER_TURN
    now_ns = rig.served.now_ns
    ra = plant.ra.truth(now_ns)[0] - mount.ra.zero_steps * rad
    dec = plant.dec.truth(now_ns)[0] - mount.dec.zero_steps * rad
    h, d = sky(ra, dec, LATITUDE, MountErrors())
    return float(h), float(d)


def test_every_sync_keeps_its_star(rig: Rig) -> None:
    for number in range(3):
        here = rig.telescope.drive.here()
        rig.do(lambda t, here=here: t.drive.sync(here))  # type: ignore[misc]
        assert len(rig.pc.observatory.stars) == number + 1
    ra, dec, _ = rig.telescope.drive.readings()
    last = rig.pc.observatory.stars[-1]
    assert (abs(last.ra_steps - ra), abs(last.dec_steps - dec)) < (10, 10)
    with pytest.raises(Refused, match="needs 6 stars, there are 3"):
        rig.do(lambda t: t.drive.fit_model())


@pytest.mark.slow
def test_a_telescope_with_the_model_of_its_stars_looks_at_the_star(rig: Rig) -> None:
    rig.run(lambda t: t.drive.power_on())
    rig.pc.observatory.stars = tuple(sightings(MountErrors(), 40, 21))
    model = rig.do(lambda t: t.drive.fit_model())
    rig.do(lambda t: t.drive.apply_model(model))
    target = rig.up(hour_angle_h=-1.5, dec_deg=50.0)
    rig.run(lambda t: t.drive.goto(target))
    rig.advance(3.0)
    h, d = looks_at(rig)
    place = observe(target, rig.pc.observatory.site, rig.pc.observatory.clock, rig.served.now_ns * 1e-9)
    off = math.hypot((place.hour_angle_rad - h) * math.cos(d), place.declination_rad - d) * ARCSEC_PER_RAD
    assert off < 2.0
    # What it says to clients is where it looks, and it goes on tracking there without the model, too.
    told = rig.pc.observatory.observed(*rig.telescope.drive.readings()[:2])
    assert (told.hour_angle_rad - h) * ARCSEC_PER_RAD == pytest.approx(0.0, abs=2.0)
    rig.do(lambda t: t.drive.apply_model(None))
    rig.advance(10.0)
    there = looks_at(rig)
    assert np.hypot((there[0] - h) * math.cos(d), there[1] - d) * ARCSEC_PER_RAD == pytest.approx(
        SIDEREAL_ARCSEC_S * 10.2 * math.cos(d), rel=0.03
    )
