"""Tracks against plain arithmetic: drifts, shifts of pulses with their ramps, and a place on the ground."""

import dataclasses
import math

import pytest

from host.sky import tracks as module
from host.sky.catalogue import STARS
from host.sky.mount import STEP_ARCSEC
from host.sky.observed import Observed, observe
from host.sky.site import NAINITAL
from host.sky.tracks import GroundTrack, Pulse, SkyTrack, StarTrack
from tests.host.sky.seen import MOUNT, plain
from tests.host.sky.test_mount import EVENING

CAPELLA = STARS["Capella"]


def track(drift: tuple[float, float] = (0.0, 0.0), since_s: float = 0.0) -> SkyTrack:
    return SkyTrack(CAPELLA, NAINITAL, EVENING, MOUNT, drift, since_s)


def off(one: StarTrack, other: StarTrack, t_s: float) -> list[float]:
    """Steps apart, arcseconds."""
    return [(a - b) * STEP_ARCSEC for a, b in zip(one.steps(t_s), other.steps(t_s), strict=True)]


@pytest.mark.parametrize("t_s", [0.0, 100.0, 1e-3, 3600.0])
def test_steps_are_those_of_the_observed_place(t_s: float) -> None:
    made = StarTrack(CAPELLA, NAINITAL, EVENING, MOUNT)
    for later in (0.0, 2.4, 2.6, 4.9, 5.1, 7.4):
        place = observe(CAPELLA, NAINITAL, EVENING, t_s + later)
        expected = MOUNT.steps(place.hour_angle_rad, place.declination_rad)
        assert [
            abs(a - b) * STEP_ARCSEC < 0.01 for a, b in zip(made.steps(t_s + later), expected, strict=True)
        ] == [True] * 2


def test_a_place_is_computed_anew_every_five_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[float] = []

    def counted(star: object, site: object, clock: object, t_s: float) -> Observed:
        asked.append(t_s)
        return observe(CAPELLA, NAINITAL, EVENING, t_s)

    monkeypatch.setattr(module, "observe", counted)
    made = StarTrack(CAPELLA, NAINITAL, EVENING, MOUNT)
    for t_s in (0.0, 2.5, 4.99, 5.01, 9.9, 10.1, 7.0):
        made.steps(t_s)
        made.rates(t_s)
    assert asked == pytest.approx([2.5, 7.51, 12.6, 9.5])


def test_a_model_turns_the_rates_too() -> None:
    """An axis' zero changes nothing; a polar axis off by 600″ does, and the steps go with the rates."""
    turned = dataclasses.replace(MOUNT, model=plain(IH=3600.0))
    plain_rates = StarTrack(CAPELLA, NAINITAL, EVENING, MOUNT).rates(50.0)
    assert StarTrack(CAPELLA, NAINITAL, EVENING, turned).rates(50.0) == pytest.approx(plain_rates, abs=1e-5)
    bent = StarTrack(CAPELLA, NAINITAL, EVENING, dataclasses.replace(MOUNT, model=plain(ME=6000.0)))
    rates = bent.rates(50.0)
    measured = [
        (a - b) * STEP_ARCSEC / 4
        for a, b in zip(
            *(StarTrack(CAPELLA, NAINITAL, EVENING, bent._mount).steps(50.0 + k) for k in (4.0, 0.0)),
            strict=True,
        )
    ]
    assert rates == pytest.approx(measured, abs=2e-3) and abs(rates[1] - plain_rates[1]) > 0.05


def test_a_drift_grows_from_its_beginning() -> None:
    made, still = track((0.5, -0.25), 100.0), track()
    assert off(made, still, 100.0) == pytest.approx([0.0, 0.0], abs=0.005)
    assert off(made, still, 140.0) == pytest.approx([20.0, -10.0], abs=0.005)
    apart = [a - b for a, b in zip(made.rates(140.0), still.rates(140.0), strict=True)]
    assert apart == pytest.approx([0.5, -0.25])


def trapeze(t_s: float, seconds: float, ramp: float) -> float:
    """Way of a rate of one that rises over the ramp, lasts, and falls: summed in small steps."""
    step, way = 1e-3, 0.0
    for k in range(round(max(t_s, 0.0) / step)):
        age = (k + 0.5) * step
        way += step * max(min(age / ramp, seconds / ramp, 1.0, (seconds + ramp - age) / ramp), 0.0)
    return way


@pytest.mark.parametrize("seconds", [2.0, 0.1])
@pytest.mark.parametrize("t_s", [-1.0, 0.1, 0.25, 0.5, 1.9, 2.1, 2.25, 5.0])
def test_a_pulse_comes_and_goes_over_three_tenths(seconds: float, t_s: float) -> None:
    pulse = Pulse(0, 7.0, 100.0, seconds)
    assert pulse.end_s == pytest.approx(100.0 + seconds + 0.3)
    assert pulse.arcsec(100.0 + t_s) == pytest.approx(7.0 * trapeze(t_s, seconds, 0.3), abs=0.01)


def test_pulses_add_up_also_when_they_are_over() -> None:
    made, still = track(), track()
    made.guide(Pulse(0, 5.0, 10.0, 2.0))
    made.guide(Pulse(1, -4.0, 11.0, 1.0))
    assert made.shifted(11.0) == pytest.approx([5.0 * trapeze(1.0, 2.0, 0.3), 0.0], abs=0.01)
    assert made.shifted(20.0) == pytest.approx([10.0, -4.0])
    made.guide(Pulse(0, 1.0, 13.2, 1.0))
    assert len(made._pulses) == 3, "readings may still be older"
    made.guide(Pulse(0, 1.0, 13.4, 1.0))
    assert len(made._pulses) == 2 and made._shift == pytest.approx([10.0, -4.0])
    assert made.shifted(30.0) == pytest.approx([12.0, -4.0])
    assert off(made, still, 30.0) == pytest.approx([12.0, -4.0], abs=0.003)


def test_a_place_on_the_ground_stands_still() -> None:
    made = GroundTrack(Observed(0.3, 0.2, 1.0, 1.0), NAINITAL, EVENING, MOUNT)
    assert made.steps(0.0) == made.steps(1e6) == MOUNT.steps(0.3, 0.2)
    assert made.rates(5.0) == (0.0, 0.0) and made.star.name == "altitude and azimuth"


def test_rates_of_the_sky_the_moon_and_the_sun() -> None:
    """The Earth turns by 7.292115e-5 rad/s; ASCOM's DriveRates give the others."""
    assert pytest.approx(7.292115e-5 * 648000 / math.pi, abs=1e-5) == module.SIDEREAL_ARCSEC_S
    assert [each.value for each in module.DriveRate] == [module.SIDEREAL_ARCSEC_S, 14.685, 15.0, 15.0369]
    assert pytest.approx(module.SIDEREAL_ARCSEC_S / 2) == module.GUIDE_ARCSEC_S
