"""A pointing run: from star to star all over the sky, noting where the telescope was seen to look."""

import math
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass

from host.procedures.pointing import ENCODERS, Pointing
from host.sky.catalogue import Star
from host.sky.observed import Observed, apparent_of_observed, equatorial, observe, star_of_apparent
from host.sky.pointstars import Sighting
from host.sky.tracks import StarTrack
from host.sky.visibility import Standpoint

Eye = Callable[[Star, int], tuple[float, float]]
"""(star, time ns) -> star less telescope, hour angle and declination, rad: what a picture of it shows."""

_MARGIN_RAD = math.radians(2.0)
"""Stars keep this far from horizon and soft limits: the sky turns by 1° in four minutes. ASSUMPTION."""
_GOLDEN = math.pi * (3 - math.sqrt(5))
"""Azimuth from one direction to the next, rad: a spiral that is equally dense everywhere."""


@dataclass(frozen=True, kw_only=True)
class Visit:
    """A star of the run, when it was looked at, and what was seen."""

    t_s: float
    star: Star
    sighting: Sighting


def directions(count: int, place: Standpoint, turn_rad: float = 0.0) -> list[Observed]:
    """Directions equally dense over all of the sky within reach, each near the one before.

    turn_rad: turns the pattern in azimuth, so that another run has other stars.
    """
    total, found = count, list[Observed]()
    while len(found) < count:
        found = [each for each in _spiral(total, place, turn_rad) if _within(each, place)]
        total += 1
    left, path = found[:count], list[Observed]()
    while left:
        here = path[-1] if path else left[0]
        path.append(min(left, key=lambda each: _way(here, each)))
        left.remove(path[-1])
    return path


def visit(
    pointing: Pointing, place: Standpoint, where: Sequence[Observed], eye: Eye
) -> Generator[None, None, tuple[Visit, ...]]:
    """Go to every direction and look; the axes go on with the last star."""
    visits = []
    client = pointing.client
    for number, each in enumerate(where, 1):
        now_s = client.now_s
        apparent = apparent_of_observed(*each[:2], place.site, place.clock, now_s)
        star = star_of_apparent(apparent, place.clock, now_s, f"field {number}")
        yield from pointing.goto(StarTrack(star, place.site, place.clock, place.mount))
        visits.append(_look(pointing, place, star, eye))
    return tuple(visits)


def _look(pointing: Pointing, place: Standpoint, star: Star, eye: Eye) -> Visit:
    """The star's offset changes by less than 1 ″/s, so it holds for the moments the encoders were latched."""
    client = pointing.client
    off = eye(star, client.now_ns)
    steps, seen = [], []
    for encoder in ENCODERS:
        reading = client.position(encoder)
        assert reading is not None  # the telescope has just been brought here by it
        steps.append(reading.position)
        seen.append(observe(star, place.site, place.clock, client.latched_s(encoder, reading)))
    sighting = Sighting(
        hour_angle_rad=seen[0].hour_angle_rad - off[0],
        declination_rad=seen[1].declination_rad - off[1],
        ra_steps=steps[0],
        dec_steps=steps[1],
    )
    return Visit(t_s=client.now_s, star=star, sighting=sighting)


def _spiral(total: int, place: Standpoint, turn_rad: float) -> list[Observed]:
    low, high = math.sin(place.horizon_rad + _MARGIN_RAD), 1.0
    return [
        equatorial(
            (turn_rad + _GOLDEN * index) % (2 * math.pi),
            math.asin(low + (high - low) * (index + 0.5) / total),
            place.site,
        )
        for index in range(total)
    ]


def _within(each: Observed, place: Standpoint) -> bool:
    axes = (place.mount.ra, each.hour_angle_rad), (place.mount.dec, each.declination_rad)
    return all(scale.within(angle + side) for scale, angle in axes for side in (-_MARGIN_RAD, _MARGIN_RAD))


def _way(here: Observed, there: Observed) -> float:
    return max(abs(a - b) for a, b in zip(here[:2], there[:2], strict=True))
