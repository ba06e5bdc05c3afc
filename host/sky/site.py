"""The place the telescope stands at, and the air above it."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Site:
    """A place on the ground with its weather and the Earth's orientation.

    Latitude and longitude are geodetic (WGS84), positive north and east. UT1 − UTC and polar motion are
    zero unless given. UT1 − UTC is at most 0.9 s by definition, 13.5″ of hour angle. This angle is the same
    for every star and so part of the zero point that the alignment console removes. Polar motion is at most
    0.6″.
    """

    latitude_rad: float
    longitude_rad: float
    height_m: float
    pressure_hpa: float
    temperature_c: float
    humidity: float
    """Relative humidity, 0..1."""
    wavelength_um: float = 0.55
    """Colour the refraction is computed for; 0.55 µm is the middle of the V band."""
    ut1_minus_utc_s: float = 0.0
    polar_motion_x_rad: float = 0.0
    polar_motion_y_rad: float = 0.0

    def __post_init__(self) -> None:
        if not -math.pi / 2 <= self.latitude_rad <= math.pi / 2:
            raise ValueError(f"latitude {math.degrees(self.latitude_rad):.4f}° is outside −90°..90°")
        if not 0.0 <= self.humidity <= 1.0:
            raise ValueError(f"relative humidity {self.humidity} is outside 0..1")

    @property
    def erfa(self) -> tuple[float, ...]:
        """What ERFA's functions of observed places take, in their order: from UT1 − UTC to the wavelength."""
        return (
            self.ut1_minus_utc_s, self.longitude_rad, self.latitude_rad, self.height_m,
            self.polar_motion_x_rad, self.polar_motion_y_rad, self.pressure_hpa, self.temperature_c,
            self.humidity, self.wavelength_um,
        )  # fmt: skip


def standard_pressure_hpa(height_m: float, temperature_c: float = 10.0) -> float:
    """Pressure of a standard atmosphere at a height (the estimate that ERFA's `apco13` documents)."""
    return 1013.25 * math.exp(-height_m / (29.3 * (temperature_c + 273.15)))


HEIGHT_M = 1950.0
"""ASSUMPTION: Manora Peak, Nainital, is at about 1950 m; the paper gives latitude and longitude only (P1)."""

NAINITAL = Site(
    latitude_rad=math.radians(29 + 22 / 60),  # paper, section 2.1
    longitude_rad=math.radians(79 + 27 / 60),  # paper, section 2.1
    height_m=HEIGHT_M,
    pressure_hpa=standard_pressure_hpa(HEIGHT_M),
    temperature_c=10.0,  # ASSUMPTION: a mild night
    humidity=0.5,  # ASSUMPTION
)
