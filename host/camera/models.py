"""The two cameras, optics and detectors, and where the telescope truly looks at one moment."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import yaml

from bus.units import ARCSEC_PER_RAD


class Look(NamedTuple):
    """One sample of the truth. Angles are observed ones, rad, hour angle positive west.

    t_ns: simulated time. roll_rad: from north to the camera's upper edge, positive through west. focus_m: of
    the focus from the middle of its travel.
    """

    t_ns: int
    hour_angle_rad: float
    declination_rad: float
    roll_rad: float = 0.0
    focus_m: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Window:
    """A part of a detector, in its pixels; 0, 0 is at the upper left."""

    left: int
    top: int
    width: int
    height: int


PHOTONS_M2_S = 8.8e9
"""Photons of a star of V = 0 above the air in the V band, per m² and s.

Source: Bessell 1979, PASP 91, 589: about 1000 per cm², s and Å. The band is 890 Å wide.
"""


@dataclass(frozen=True, kw_only=True)
class CameraModel:
    """A detector and the optics before it; SI units unless a name says otherwise.

    throughput: electrons per photon above the air. dark_e_s: dark current of a pixel at `temperature_c`.
    focusing: the focus drive moves it. blooms: full wells spill along their columns.
    """

    name: str
    sensor: str
    aperture_m: float
    focal_length_m: float
    pixel_m: float
    width: int
    height: int
    full_well_e: float
    read_noise_e: float
    dark_e_s: float
    gain_e_adu: float
    offset_adu: int
    throughput: float
    temperature_c: float
    shortest_s: float
    focusing: bool
    blooms: bool

    @property
    def pixel_rad(self) -> float:
        """Angle of a pixel in the middle of the field, rad."""
        return self.pixel_m / self.focal_length_m

    @property
    def pixel_arcsec(self) -> float:
        """The same in arcseconds."""
        return self.pixel_rad * ARCSEC_PER_RAD

    @property
    def zero_point_e_s(self) -> float:
        """Electrons per second of a star of V = 0."""
        return PHOTONS_M2_S * self.throughput * math.pi * self.aperture_m**2 / 4

    @property
    def most_adu(self) -> int:
        """The converter's end: 16 bits."""
        return (1 << 16) - 1


MAIN, GUIDE = (
    CameraModel(**fields)
    for fields in yaml.safe_load(
        Path(__file__).with_name("cameras.yaml").read_text(encoding="utf-8")
    ).values()
)
CAMERAS = (MAIN, GUIDE)
"""By Alpaca's device number."""
