"""The sky from the zenith to the horizon, with what the soft limits and the horizon limit leave of it."""

import math

import numpy as np

from host.sky.catalogue import Star
from host.sky.listed import Listed, listed, moon
from host.sky.mount import AxisScale, Mount
from host.sky.observed import Observed, equatorial, horizontal, observe_all
from host.sky.site import Site
from host.telescope import Observatory

RADIUS, CENTRE = 100.0, 120
SIZE = (2 * CENTRE, 2 * CENTRE)
STEPS = 60
_NEAR = 2.5
"""As near as this to an object a click means it: 2.3°."""
_FAINTEST = 5.0
"""Of what is drawn; all are in the list of names."""
_NAMED = 1.3
"""Stars brighter than this have their name beside them."""
_RENEWED_S = 30.0
"""Of the sky: an eighth of a degree."""


class Chart:
    """Stars, nebulae and clusters above the ground, looked at anew every half minute; for all pages."""

    def __init__(self, about: Observatory) -> None:
        self._about = about
        self._at_s = -math.inf
        self._layer = ""
        self._seen: list[tuple[float, float, Listed]] = []

    def layer(self, t_s: float) -> str:
        """As SVG, with the Moon."""
        if abs(t_s - self._at_s) < _RENEWED_S:
            return self._layer
        about, objects = self._about, [e for e in listed().values() if (e.magnitude or 0.0) < _FAINTEST]
        altitudes, azimuths = observe_all([each.star for each in objects], about.site, about.clock, t_s)
        self._seen = [
            (*_xy(float(altitudes[k]), float(azimuths[k])), objects[k]) for k in np.flatnonzero(altitudes > 0)
        ]
        shapes = [draw(*each) for draw in (_shape, _name) for each in self._seen]
        place, lit = moon(about.site, about.clock, t_s)
        if place.altitude_rad > 0:
            x, y = _xy(place.altitude_rad, place.azimuth_rad)
            shapes.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" class="sky-moon"/>')
            shapes.append(_text(x, y - 6, f"Moon, {100 * lit:.0f} %"))
        self._at_s, self._layer = t_s, _shifted(shapes)
        return self._layer

    def pick(self, x: float, y: float) -> Star | Observed | None:
        """What was clicked: an object, the bare sky beside all of them, or what is no sky."""
        x, y = x - CENTRE, y - CENTRE
        near = min(self._seen, key=lambda each: math.hypot(each[0] - x, each[1] - y), default=None)
        if near is not None and math.hypot(near[0] - x, near[1] - y) < _NEAR:
            return near[2].star
        altitude = (1 - math.hypot(x, y) / RADIUS) * math.pi / 2
        site = self._about.site
        return equatorial(math.atan2(-x, -y) % (2 * math.pi), altitude, site) if altitude > 0 else None


def _shape(x: float, y: float, each: Listed) -> str:
    magnitude = 3.0 if each.magnitude is None else each.magnitude
    kind = "sky-star" if each.stellar else "sky-cloud"
    size = max(0.4, 1.6 - 0.3 * magnitude) if each.stellar else 1.6
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{size:.1f}" class="{kind}"/>'


def _name(x: float, y: float, each: Listed) -> str:
    bright = each.stellar and each.magnitude is not None and each.magnitude < _NAMED
    return _text(x, y - 3, each.star.name) if bright else ""


def _text(x: float, y: float, text: str) -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" class="sky-name">{text}</text>'


def _shifted(shapes: list[str]) -> str:
    return f'<g transform="translate({CENTRE} {CENTRE})">{"".join(shapes)}</g>'


def svg(
    about: Observatory, here: Observed | None, target: Observed | None, slit_deg: float | None = None
) -> str:
    """North up, east left, as one sees it lying on one's back; zenith in the middle. slit_deg: the dome's."""
    shapes = [
        f'<circle r="{RADIUS}" class="sky-ground"/>',
        f'<circle r="{_radius(about.horizon_rad):.1f}" class="sky-free"/>',
        f'<path d="{_path(boundary(about.mount, about.site))}" class="sky-limit"/>',
    ]
    for degrees in (30, 60):
        shapes.append(f'<circle r="{_radius(math.radians(degrees)):.1f}" class="sky-ring"/>')
    for name, x, y in (("N", 0.0, -104.0), ("E", -109.0, 4.0), ("S", 0.0, 112.0), ("W", 109.0, 4.0)):
        shapes.append(f'<text x="{x}" y="{y}" class="sky-text">{name}</text>')
    if slit_deg is not None:
        x, y = _xy(0.0, math.radians(slit_deg))
        shapes.append(f'<line x2="{x:.1f}" y2="{y:.1f}" class="sky-slit"/>')
        shapes.append(_text(0.93 * x, 0.93 * y, "slit"))
    if target is not None and target.altitude_rad > 0:
        x, y = _xy(target.altitude_rad, target.azimuth_rad)
        shapes.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="6" class="sky-target"/>')
    if here is not None:
        x, y = _xy(max(here.altitude_rad, 0.0), here.azimuth_rad)
        shapes.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" class="sky-here"/>')
    return _shifted(shapes)


def label(here: Observed | None) -> str:
    """What the chart shows, also for who cannot see it."""
    said = "nowhere yet" if here is None else f"at altitude {math.degrees(here.altitude_rad):.0f}°"
    return f"The telescope points {said}. Dashed: soft limits; inner disc: above the horizon limit."


def boundary(mount: Mount, site: Site) -> list[tuple[float, float]]:
    """(altitude, azimuth) along the rectangle of the soft limits in hour angle and declination, rad."""
    low_h, high_h = _span(mount.ra)
    low_d, high_d = _span(mount.dec)
    low_d, high_d = max(low_d, -math.pi / 2), min(high_d, math.pi / 2)
    share = [k / STEPS for k in range(STEPS)]
    corners = [
        *((low_h + s * (high_h - low_h), low_d) for s in share),
        *((high_h, low_d + s * (high_d - low_d)) for s in share),
        *((high_h - s * (high_h - low_h), high_d) for s in share),
        *((low_h, high_d - s * (high_d - low_d)) for s in share),
    ]
    places = [horizontal(h, d, site) for h, d in corners]
    return [(p.altitude_rad, p.azimuth_rad) for p in places]


def _span(scale: AxisScale) -> tuple[float, float]:
    return scale.angle_rad(scale.low_steps), scale.angle_rad(scale.high_steps)


def _radius(altitude_rad: float) -> float:
    return RADIUS * (1 - max(altitude_rad, 0.0) / (math.pi / 2))


def _xy(altitude_rad: float, azimuth_rad: float) -> tuple[float, float]:
    r = _radius(altitude_rad)
    return -r * math.sin(azimuth_rad), -r * math.cos(azimuth_rad)


def _path(points: list[tuple[float, float]]) -> str:
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in (_xy(*point) for point in points)) + "Z"
