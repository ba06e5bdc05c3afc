"""Where a pointing run goes: all over the sky within reach, each star near the last; a dome's states."""

import math
from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from host.alpaca.dome import DomeDevice
from host.procedures.pointing_run import directions
from host.sky.mount import scale_from_limits
from host.sky.observed import Observed
from host.sky.site import Site

LATITUDE = math.radians(29 + 22 / 60)


def standpoint(horizon_deg: float = 20.0, limit_deg: float = 60.0) -> Any:
    return Some(
        site=Site(LATITUDE, math.radians(79.5), 1951.0, 810.0, 5.0, 0.4),
        horizon_rad=math.radians(horizon_deg),
        mount=Some(
            ra=scale_from_limits(math.radians(-limit_deg), math.radians(limit_deg)),
            dec=scale_from_limits(math.radians(-30.0), math.radians(80.0)),
        ),
    )


def away(a: Observed, b: Observed) -> float:
    """Of the axis that has the longer way."""
    return max(abs(a.hour_angle_rad - b.hour_angle_rad), abs(a.declination_rad - b.declination_rad))


@pytest.mark.parametrize("count", [1, 7, 40])
def test_so_many_directions_keep_off_the_horizon_and_the_limits(count: int) -> None:
    """Two degrees off, as the sky turns meanwhile."""
    found = directions(count, standpoint())
    assert len(found) == count == len(set(found))
    for each in found:
        assert math.degrees(each.altitude_rad) > 22.0
        assert abs(math.degrees(each.hour_angle_rad)) <= 58.0
        assert -28.0 <= math.degrees(each.declination_rad) <= 78.0


def test_they_are_equally_dense_over_the_sky() -> None:
    """Without limits: as many in every zone of the same height, and in every quarter of the horizon."""
    wide = standpoint(limit_deg=179.0)
    wide.mount.dec = scale_from_limits(math.radians(-89.0), math.radians(95.0))
    found = directions(200, wide)
    low = math.sin(math.radians(22.0))
    heights = [(math.sin(each.altitude_rad) - low) / (1 - low) for each in found]
    zones = np.histogram(heights, 4, (0.0, 1.0))[0]
    quarters = np.histogram([each.azimuth_rad for each in found], 4, (0.0, 2 * math.pi))[0]
    assert zones.min() >= 45 and quarters.min() >= 40  # limits take a few about the pole and in the north


def test_each_is_the_nearest_of_those_that_are_left() -> None:
    found = directions(30, standpoint())
    for k, here in enumerate(found[:-1]):
        nearest = min(away(here, each) for each in found[k + 1 :])
        assert away(here, found[k + 1]) == nearest


def test_another_run_has_other_stars() -> None:
    first, second = directions(20, standpoint()), directions(20, standpoint(), 0.3)
    assert min(away(a, b) for a in first for b in second) > 1e-6
    assert first == directions(20, standpoint())


@pytest.mark.parametrize(
    ("now", "opening", "status"),
    [
        ({"ShutterMoving": 0, "Opened": 1, "Closed": 0}, True, 0),
        ({"ShutterMoving": 0, "Opened": 0, "Closed": 1}, False, 1),
        ({"ShutterMoving": 1, "Opened": 0, "Closed": 0, "BadWeather": 0}, True, 2),
        ({"ShutterMoving": 1, "Opened": 0, "Closed": 0, "BadWeather": 0}, False, 3),
        ({"ShutterMoving": 1, "Opened": 0, "Closed": 0, "BadWeather": 1}, True, 3),
        ({"ShutterMoving": 0, "Opened": 0, "Closed": 0}, True, 4),
    ],
)
@pytest.mark.parametrize("moving", [0, 1])
def test_a_shutter_has_ascoms_five_states(
    now: dict[str, float], opening: bool, status: int, moving: int
) -> None:
    """ASCOM's ShutterState: open, closed, opening, closing, and 4, which is neither. Rain shuts it."""
    frame = now | {"Moving": moving, "Azimuth": 12.5}
    device: Any = DomeDevice.__new__(DomeDevice)
    device.desk = Some(telescope=Some(house=Some(fresh=lambda _: frame, opening=opening)))
    slewing = bool(moving or now["ShutterMoving"])
    assert device.state() == {"Azimuth": 12.5, "ShutterStatus": status, "Slewing": slewing}
