"""A guide log in the text format of PHD2, which its viewers, and `schmidt calibrate`, read."""

import math
from collections.abc import Sequence
from datetime import timedelta

from host.camera.models import GUIDE
from host.procedures.autoguide import LEAST_ARCSEC, LONGEST_S, Guided
from host.sky.catalogue import Star
from host.sky.observed import Clock
from host.sky.tracks import GUIDE_ARCSEC_S

_HEAD = (
    "Frame,Time,mount,dx,dy,RARawDistance,DECRawDistance,RAGuideDistance,DECGuideDistance,"
    "RADuration,RADirection,DECDuration,DECDirection,XStep,YStep,StarMass,SNR,ErrorCode"
)


def opening(version: str, clock: Clock, t_s: float) -> str:
    """The file's first line."""
    made = f"PHD2 version 2.6, written by schmidt {version}, Log version 2.5."
    return f"{made} Log enabled at {_when(clock, t_s)}\n"


def hysteresis(aggressiveness: float) -> str:
    """The algorithm of `autoguide` in PHD2's words: a share of the error, above a least one."""
    least = LEAST_ARCSEC / GUIDE.pixel_arcsec
    words = f"Hysteresis, Hysteresis = 0.000, Aggression = {aggressiveness:.3f}"
    return f"{words}, Minimum move = {least:.3f}"


def section(
    name: str,
    begin_s: float,
    star: Star,
    clock: Clock,
    frames: Sequence[Guided],
    *,
    exposure_s: float,
    algorithm: str,
    longest_s: float = LONGEST_S,
) -> str:
    """One session of guiding. algorithm: of both axes; longest_s: of a pulse.

    The camera's x axis runs along right ascension. As in PHD2, positive distances are corrected to the west
    and to the south. There is no picture, so a star has neither mass nor signal-to-noise ratio.
    """
    px, west = GUIDE.pixel_arcsec, math.cos(star.declination_rad)
    end_s = frames[-1].t_s if frames else begin_s
    return "".join(
        f"{line}\n"
        for line in (
            f"Guiding Begins at {_when(clock, begin_s)}",
            f"Equipment Profile = {name}",
            f"Pixel scale = {px:.4f} arc-sec/px, Binning = 1,"
            f" Focal length = {GUIDE.focal_length_m * 1e3:.0f} mm",
            f"Camera = {GUIDE.name}, full size = {GUIDE.width} x {GUIDE.height},"
            f" pixel size = {GUIDE.pixel_m * 1e6:.2f} um",
            f"Exposure = {exposure_s * 1e3:.0f} ms",
            f"Mount = Schmidt telescope,  connected, guiding enabled, xAngle = 0.0,"
            f" xRate = {GUIDE_ARCSEC_S * west / px:.3f}, yAngle = 90.0, yRate = {GUIDE_ARCSEC_S / px:.3f},"
            " parity = +/+",
            *(f"{axis} guide algorithm = {algorithm}" for axis in "XY"),
            "Backlash comp = disabled, pulse = 0 ms",
            f"Max RA duration = {longest_s * 1e3:.0f}, Max DEC duration = {longest_s * 1e3:.0f},"
            " DEC guide mode = Auto",
            f"RA Guide Speed = {GUIDE_ARCSEC_S:.1f} a-s/s, Dec Guide Speed = {GUIDE_ARCSEC_S:.1f} a-s/s",
            f"Dec = {math.degrees(star.declination_rad):.1f} deg",
            f"Lock position = {GUIDE.width / 2:.3f}, {GUIDE.height / 2:.3f}",
            _HEAD,
            *(_row(k, begin_s, px, each) for k, each in enumerate(frames, 1)),
            f"Guiding Ends at {_when(clock, end_s)}",
            "",
        )
    )


def _row(number: int, begin_s: float, px: float, each: Guided) -> str:
    ra, dec = each.off[0] / px, -each.off[1] / px
    ra_sent, dec_sent = each.sent[0] / px, -each.sent[1] / px
    ra_s, dec_s = each.pulses_s
    pulses = ",".join(
        f"{abs(seconds) * 1e3:.0f},{ways[seconds < 0] if seconds else ''}"
        for seconds, ways in ((ra_s, "WE"), (dec_s, "NS"))
    )
    distances = ",".join(f"{value:.3f}" for value in (ra, dec, ra, dec, ra_sent, dec_sent))
    return f'{number},{each.t_s - begin_s:.3f},"Mount",{distances},{pulses},,,,,0'


def _when(clock: Clock, t_s: float) -> str:
    """UTC to the second."""
    return (clock.start_utc + timedelta(seconds=t_s)).strftime("%Y-%m-%d %H:%M:%S")
