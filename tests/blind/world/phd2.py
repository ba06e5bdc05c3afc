"""A guide log in PHD2's format: a star, a camera, pulses, dithers, lost stars.

Source of the format and of what a dither does to dx, RARawDistance and the lock position: PHD2's own logs
(the measured data hold six), and PHD2's manual, "Guide Log Contents". The Hysteresis algorithm is the
manual's: (1 - h) error + h last correction, times the aggression, nothing below the least move.
"""

import math
from dataclasses import dataclass
from datetime import timedelta

import numpy as np

from tests.blind.world import sky
from tests.blind.world.logfile import DAY
from tests.blind.world.made import Array, Rng, pick, wide
from tests.blind.world.sky import Error, Sky

HEAD = (
    "Frame,Time,mount,dx,dy,RARawDistance,DECRawDistance,RAGuideDistance,DECGuideDistance,"
    "RADuration,RADirection,DECDuration,DECDirection,XStep,YStep,StarMass,SNR,ErrorCode"
)


@dataclass
class Guider:
    """Camera, pulses, habits. hit: what a pulse really moves, over what is told."""

    scale: float  # arcsec per px
    angle: float  # deg, of right ascension on the chip
    aggression: float
    hysteresis: float
    least: float  # px
    rate: float  # px/s
    hit: float
    dither_s: float  # between dithers; 0: none
    dither_px: float
    lost: float  # share of frames
    lag_s: float  # between exposure's middle and pulse: longer frames


def draw(rng: Rng) -> Guider:
    """A setup."""
    dithers = rng.random() < 0.6
    return Guider(
        wide(rng, 0.8, 7.0), float(rng.uniform(-180, 180)), rng.uniform(0.3, 1.0), pick(rng, 0.0, 0.1, 0.25),
        pick(rng, 0.05, 0.1, 0.2), wide(rng, 1.5, 8.0), rng.uniform(0.85, 1.1),
        wide(rng, 150.0, 900.0) if dithers else 0.0, wide(rng, 1.0, 5.0), wide(rng, 1e-4, 0.03) - 1e-4,
        wide(rng, 0.05, 0.8),
    )  # fmt: skip


def pulse(error: float, last: float, g: Guider) -> float:
    """Px that the Hysteresis algorithm asks for."""
    wanted = (1.0 - g.hysteresis) * error + g.hysteresis * last
    return 0.0 if abs(error) < g.least else wanted * g.aggression


def head(s: Sky, g: Guider, mount: str, start_s: float) -> list[str]:
    """The lines before a section's frames."""
    at = (DAY + timedelta(seconds=start_s)).strftime("%Y-%m-%d %H:%M:%S")
    return [
        f"Guiding Begins at {at}",
        "Dither = both axes, Dither scale = 1.000, Image noise reduction = none, Guide-frame time lapse = 0,"
        " Server enabled",
        f"Pixel scale = {g.scale:.2f} arc-sec/px, Binning = 1,"
        f" Focal length = {3.75 * 206.265 / g.scale:.0f} mm",
        "Search region = 15 px, Star mass tolerance = 50.0%",
        "Equipment Profile = field",
        "Camera = ZWO ASI120MM, gain = 60, full size = 1280 x 960, have dark, dark dur = 2000, no defect map,"
        " pixel size = 3.8 um",
        f"Exposure = {1000 * s.exposure_s:.0f} ms",
        f"Mount = {mount},  connected, guiding enabled, xAngle = {g.angle:.1f}, xRate = {g.rate:.3f},"
        f" yAngle = {g.angle + 88.0:.1f}, yRate = {g.rate:.3f}, parity = +/-",
        f"X guide algorithm = Hysteresis, Hysteresis = {g.hysteresis:.3f}, Aggression = {g.aggression:.3f},"
        f" Minimum move = {g.least:.3f}",
        "Y guide algorithm = Resist Switch, Minimum move = 0.100 Aggression = 80% FastSwitch = enabled",
        "Backlash comp = disabled, pulse = 0 ms",
        "Max RA duration = 2500, Max DEC duration = 2500, DEC guide mode = Auto",
        "RA Guide Speed = 7.5 a-s/s, Dec Guide Speed = 7.5 a-s/s, Cal Dec = 5.0, Last Cal Issue = None",
        "Dec = 5.0 deg, Hour angle = -1.20 hr, Pier side = West, Rotator pos = N/A",
        "Lock position = 620.000, 480.000, Star position = 620.000, 480.000, HFD = 2.51 px",
        HEAD,
    ]


def section(
    rng: Rng, s: Sky, g: Guider, mount: str, error: Error | None, kind: str, start_s: float, seconds: float
) -> tuple[list[str], Array, Array]:
    """Lines of one guided section; and its t s and drive error arcsec, seeing and drift left out."""
    step = s.exposure_s + g.lag_s
    rows = int(seconds / step)
    t = np.cumsum(step * rng.uniform(0.97, 1.06, rows))
    sky_ra = sky.air(rng, s, rows, step, kind) + sky.slow(s, t, rng)
    own = error.at(start_s + t) if error else np.zeros(rows)
    sky_dec = sky.air(rng, s, rows, step, kind) + sky.slow(s, t, rng) * 0.3
    out, lock, sent_x, sent_y, last = head(s, g, mount, start_s), np.array([620.0, 480.0]), 0.0, 0.0, 0.0
    turn = np.array([math.cos(math.radians(g.angle)), math.sin(math.radians(g.angle))])
    across = np.array([-turn[1], turn[0]])
    moved, moved_y, next_dither = 0.0, 0.0, g.dither_s
    mass, settled = wide(rng, 300.0, 5000.0), -1
    for k in range(rows):
        if g.dither_s and t[k] > next_dither:
            next_dither += g.dither_s
            by, by_y = rng.uniform(-g.dither_px, g.dither_px, 2)
            moved, moved_y = moved + by, moved_y + by_y
            lock = lock + by * turn + by_y * across
            place = f"{lock[0]:.3f}, {lock[1]:.3f}"
            out += [f"INFO: SET LOCK POSITION, new lock pos = {place}",
                    f"INFO: DITHER by {by:.3f}, {by_y:.3f}, new lock pos = {place}",
                    "INFO: SETTLING STATE CHANGE, Settling started"]  # fmt: skip
            settled = k + int(rng.integers(5, 15))
        if k == settled:
            out.append("INFO: SETTLING STATE CHANGE, Settling complete")
        if rng.random() < g.lost:
            out.append(f'{k + 1},{t[k]:.3f},"DROP",,,,,,,,,,,,,{0.2 * mass:.0f},2.10,2,"Star lost - low SNR"')
            continue
        raw = (sky_ra[k] + own[k]) / g.scale - sent_x - moved
        raw_y = sky_dec[k] / g.scale - sent_y - moved_y
        last = pulse(raw, last, g)
        asked_y = 0.6 * raw_y if abs(raw_y) > 0.15 else 0.0
        sent_x, sent_y = sent_x + last * g.hit, sent_y + asked_y
        dx, dy = raw * turn + raw_y * across
        ms, ms_y = round(1000 * abs(last) / g.rate), round(1000 * abs(asked_y) / g.rate)
        way, way_y = ("W" if last > 0 else "E") if ms else "", ("N" if asked_y < 0 else "S") if ms_y else ""
        star = f"{mass * rng.uniform(0.8, 1.2):.0f},{math.sqrt(mass) * rng.uniform(0.6, 0.8):.2f},0"
        out.append(
            f'{k + 1},{t[k]:.3f},"Mount",{dx:.3f},{dy:.3f},{raw:.3f},{raw_y:.3f},{last:.3f},{asked_y:.3f},'
            f"{ms},{way},{ms_y},{way_y},,,{star}"
        )
    ends = (DAY + timedelta(seconds=start_s + float(t[-1]))).strftime("%Y-%m-%d %H:%M:%S")
    return [*out, f"Guiding Ends at {ends}", ""], t, own
