"""The equatorial mount: hour angle and declination against the absolute encoders' steps."""

from __future__ import annotations

import math
from dataclasses import dataclass

from bus.units import ARCSEC_PER_TURN
from host.sky.pointmodel import PointingModel

STEPS_PER_TURN = 1 << 29
"""RCN 829, 29 bit (paper, section 3.2)."""
STEP_ARCSEC = ARCSEC_PER_TURN / STEPS_PER_TURN
"""0.0024140″ on the sky, since the encoder sits on the axis itself."""
CENTRE_STEPS = 1 << 28
"""Reading at hour angle 0 and declination 0. ASSUMPTION: aligned so that no wrap lies within the travel."""


@dataclass(frozen=True)
class AxisScale:
    """One axis' alignment: encoder reading at angle zero and the soft limits, all in encoder steps."""

    zero_steps: int
    low_steps: int
    high_steps: int

    def steps(self, angle_rad: float) -> int:
        """Encoder reading for an angle, rounded to a step."""
        return self.zero_steps + round(angle_rad / (2 * math.pi) * STEPS_PER_TURN)

    def angle_rad(self, steps: int) -> float:
        """Angle for an encoder reading (no wrap: the travel is less than a turn)."""
        return (steps - self.zero_steps) / STEPS_PER_TURN * 2 * math.pi

    def within(self, angle_rad: float) -> bool:
        """Whether the angle lies inside the soft limits."""
        return self.low_steps <= self.steps(angle_rad) <= self.high_steps

    def aligned(self, offset_steps: int) -> AxisScale:
        """The scale after a star has shown the encoder to read `offset_steps` too much (H4)."""
        return AxisScale(self.zero_steps + offset_steps, self.low_steps, self.high_steps)


def scale_from_limits(low_rad: float, high_rad: float, zero_steps: int = CENTRE_STEPS) -> AxisScale:
    """A scale whose soft limits are given as angles: low below high, both inside the encoder's turn."""
    if not low_rad < high_rad:
        low_deg, high_deg = math.degrees(low_rad), math.degrees(high_rad)
        raise ValueError(f"soft limits {low_deg:.3f}° and {high_deg:.3f}° are the wrong way round")
    bare = AxisScale(zero_steps, 0, STEPS_PER_TURN - 1)
    low, high = bare.steps(low_rad), bare.steps(high_rad)
    if low < 0 or high >= STEPS_PER_TURN:
        raise ValueError("soft limits reach over the encoder's zero; move the zero offset")
    return AxisScale(zero_steps, low, high)


@dataclass(frozen=True)
class Mount:
    """The two axes, where the telescope is parked (angles of the axes), and what they look at.

    model: None for axes that look where they stand.
    """

    ra: AxisScale
    dec: AxisScale
    park_hour_angle_rad: float
    park_declination_rad: float
    model: PointingModel | None = None

    @property
    def park_steps(self) -> tuple[int, int]:
        """Encoder readings of the parked telescope."""
        return self.ra.steps(self.park_hour_angle_rad), self.dec.steps(self.park_declination_rad)

    def axes(self, hour_angle_rad: float, declination_rad: float) -> tuple[float, float]:
        """Angles of both axes, rad, that look at an observed place."""
        if self.model is None:
            return hour_angle_rad, declination_rad
        return self.model.axes(hour_angle_rad, declination_rad)

    def steps(self, hour_angle_rad: float, declination_rad: float) -> tuple[int, int]:
        """Encoder readings at which the telescope looks at an observed place."""
        ra, dec = self.axes(hour_angle_rad, declination_rad)
        return self.ra.steps(ra), self.dec.steps(dec)

    def place(self, ra_steps: int, dec_steps: int) -> tuple[float, float]:
        """Observed hour angle and declination, rad, that the telescope looks at."""
        ra, dec = self.ra.angle_rad(ra_steps), self.dec.angle_rad(dec_steps)
        return (ra, dec) if self.model is None else self.model.sky(ra, dec)


def limits_mount(
    hour_angle_limit_rad: float,
    declination_low_rad: float,
    declination_high_rad: float,
    park_declination_rad: float,
) -> Mount:
    """A mount with symmetric hour angle limits, parked on the meridian."""
    return Mount(
        scale_from_limits(-hour_angle_limit_rad, hour_angle_limit_rad),
        scale_from_limits(declination_low_rad, declination_high_rad),
        0.0,
        park_declination_rad,
    )
