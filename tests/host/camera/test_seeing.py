"""Seeing: its numbers by hand, and what a path through time does."""

import math

import numpy as np
import pytest

from host.camera.seeing import Wander, sigma_arcsec, wander_arcsec

WIDE_M, NARROW_M = 0.5, 0.08


def test_the_wander_is_tatarskis_by_hand() -> None:
    """r0 = 0.98 * 0.55 µm / 2″ = 55.59 mm; sqrt(0.182) λ/D (D/r0)^(5/6): 0.6038″ and 0.8194″."""
    assert wander_arcsec(WIDE_M) == pytest.approx(0.6038, abs=2e-4)
    assert wander_arcsec(NARROW_M) == pytest.approx(0.8194, abs=2e-4)


def test_image_and_wander_are_two_arcseconds_wide_together() -> None:
    """At half of its height a Gaussian is 2.3548 sigma wide."""
    together = math.hypot(sigma_arcsec(WIDE_M), wander_arcsec(WIDE_M)) * 2.3548
    assert together == pytest.approx(2.0, rel=1e-6)
    assert sigma_arcsec(NARROW_M) == pytest.approx(math.sqrt(0.1))


@pytest.mark.parametrize("aperture_m", [WIDE_M, NARROW_M])
def test_a_long_path_has_the_size_and_the_spectrum(aperture_m: float) -> None:
    """Power of a logarithmic row of lines: f^(1/3) below the knee and f^(-8/3) beyond."""
    wander = Wander(aperture_m, 3, "test")
    t_s = np.arange(0, 1000.0, 0.05)
    both = wander(t_s)
    assert both.shape == (2, len(t_s))
    assert both.std(axis=1) == pytest.approx(wander_arcsec(aperture_m), rel=0.1)
    assert abs(float(np.asarray(np.corrcoef(both))[0, 1])) < 0.1
    hz, power = wander._hz, wander._size**2
    assert (hz[0], hz[-1], len(hz)) == pytest.approx((0.005, 50.0, 120))
    assert np.diff(np.log(hz)) == pytest.approx(math.log(1e4) / 119)
    knee = 0.6 * 10 / aperture_m
    slopes = np.diff(np.log(power)) / np.diff(np.log(hz))
    assert slopes[hz[1:] < knee] == pytest.approx(1 / 3)
    assert slopes[hz[:-1] > knee] == pytest.approx(-8 / 3)
    assert power.sum() / 2 == pytest.approx(wander_arcsec(aperture_m) ** 2)
    assert np.argmax(power) == pytest.approx(np.searchsorted(hz, knee), abs=1)


def test_phases_are_all_round_and_of_the_seed() -> None:
    one, again, other = Wander(0.5, 1, "a"), Wander(0.5, 1, "a"), Wander(0.5, 2, "a")
    t_s = np.linspace(0, 10, 50)
    assert np.array_equal(one(t_s), again(t_s)) and not np.allclose(one(t_s), other(t_s))
    assert one._phase.min() >= 0 and 6.0 < one._phase.max() < 2 * math.pi
    assert one(np.array([0.0]))[0, 0] == pytest.approx(float(np.sin(one._phase[0]) @ one._size))
    assert one(np.array([0.25]))[1, 0] == pytest.approx(
        float(np.sin(math.pi / 2 * one._hz + one._phase[1]) @ one._size)
    )
