"""The sky from the zenith to the horizon, with what the soft limits and the horizon limit leave of it."""

import math

from host.sky.apparent import horizontal
from host.sky.mount import AxisScale, Mount
from host.sky.observed import Observed
from host.sky.site import Site
from host.telescope import Observatory

RADIUS = 100.0
STEPS = 60


def svg(about: Observatory, here: Observed | None, target: Observed | None) -> str:
    """North up, east to the left, as one sees it lying on one's back; the zenith in the middle."""
    limit = _radius(about.horizon_rad)
    shapes = [
        f'<circle r="{RADIUS}" class="sky-ground"/>',
        f'<circle r="{limit:.1f}" class="sky-free"/>',
        f'<path d="{_path(boundary(about.mount, about.site))}" class="sky-limit"/>',
    ]
    for degrees in (30, 60):
        shapes.append(f'<circle r="{_radius(math.radians(degrees)):.1f}" class="sky-ring"/>')
    for name, x, y in (("N", 0.0, -104.0), ("E", -109.0, 4.0), ("S", 0.0, 112.0), ("W", 109.0, 4.0)):
        shapes.append(f'<text x="{x}" y="{y}" class="sky-text">{name}</text>')
    if target is not None and target.altitude_rad > 0:
        x, y = _xy(target.altitude_rad, target.azimuth_rad)
        shapes.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="6" class="sky-target"/>')
    if here is not None:
        x, y = _xy(max(here.altitude_rad, 0.0), here.azimuth_rad)
        shapes.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" class="sky-here"/>')
    said = "nowhere yet" if here is None else f"altitude {math.degrees(here.altitude_rad):.0f} degrees"
    label = (
        f"Sky map: the telescope points at {said}; the line is the soft limits, the inner disc is what is"
        " above the horizon limit"
    )
    return f'<svg viewBox="-120 -120 240 240" role="img" aria-label="{label}">{"".join(shapes)}</svg>'


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
