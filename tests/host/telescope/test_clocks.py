"""The clock of the main console: airmass, time to the meridian and to a limit."""

import math

import pytest

from host.console.figures import SIDEREAL_RAD_S, airmass, clocks, duration, until_limit_s
from host.sky.observed import horizontal
from tests.host.telescope.conftest import Rig


@pytest.mark.parametrize("altitude_deg", [90, 60, 45, 30])
def test_high_up_the_airmass_is_that_of_a_flat_atmosphere(altitude_deg: float) -> None:
    """The Earth's curvature takes 0.3 % of it at 30°."""
    altitude = math.radians(altitude_deg)
    assert airmass(altitude) == pytest.approx(1 / math.sin(altitude), rel=4e-3)


def test_at_the_horizon_the_airmass_is_38() -> None:
    """About 38 in every table of it; 37.92 by Kasten and Young's formula, worked out by hand."""
    assert airmass(0.0) == pytest.approx(37.92, abs=0.05)
    assert airmass(-0.01) is None


def test_the_limit_is_met_when_it_says(rig: Rig) -> None:
    about = rig.telescope.observatory
    left_s = until_limit_s(about, 0.3, 0.35)
    assert left_s is not None and left_s > 0

    def free(after_s: float) -> bool:
        angle = 0.3 + after_s * SIDEREAL_RAD_S
        above = horizontal(angle, 0.35, about.site).altitude_rad >= about.horizon_rad
        return above and about.mount.ra.within(angle)

    assert free(left_s - 60.0)
    assert not free(left_s)


def test_the_times_of_a_night_are_told(rig: Rig) -> None:
    found = clocks(rig.telescope)
    assert found.utc == f"14:00:{int(rig.telescope.snapshot.t_s):02d}"
    assert found.to_limit.endswith(" h")
    assert found.to_meridian.split()[-1] in ("before", "after")


def test_durations_are_cut_to_the_minute() -> None:
    assert [duration(s) for s in (0, 59.9, 60, 3599, 3600, 86399)] == [
        "0:00 h", "0:00 h", "0:01 h", "0:59 h", "1:00 h", "23:59 h",
    ]  # fmt: skip
