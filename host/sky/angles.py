"""Angles as astronomers write them, and wrapping."""

import math
import re

_SEXAGESIMAL = re.compile(
    r"^\s*([+\-−]?)\s*(\d{1,3})\s*[:hd°\s]\s*(\d{1,2})\s*[:m′'\s]\s*(\d{1,2}(?:\.\d{0,15})?)"
    r"\s*[s″\"]?\s*$",
    re.IGNORECASE,
)


def parse_right_ascension(text: str) -> float:
    """Read hours, minutes and seconds (`05:16:41.36`, `05h16m41.36s`) into radians, 0..2π."""
    sign, whole, minutes, seconds = _split(text, "right ascension", "05:16:41.36")
    hours = whole + minutes / 60 + seconds / 3600
    if sign < 0 or hours >= 24:
        raise ValueError(f"right ascension {text!r} is outside 0h..24h")
    return hours * math.pi / 12


def parse_declination(text: str) -> float:
    """Read degrees, minutes and seconds (`+45:59:52.8`, `+45°59′52.8″`) into radians, ±π/2."""
    sign, whole, minutes, seconds = _split(text, "declination", "+45:59:52.8")
    degrees = whole + minutes / 60 + seconds / 3600
    if degrees > 90:
        raise ValueError(f"declination {text!r} is outside −90°..+90°")
    return sign * math.radians(degrees)


def wrap_pi(angle_rad: float) -> float:
    """The same angle in −π..π."""
    return math.remainder(angle_rad, 2 * math.pi)


def format_degrees(angle_rad: float) -> str:
    """An angle as signed degrees, minutes and seconds, for people."""
    value = math.degrees(angle_rad)
    tenths = round(abs(value) * 36000)
    degrees, rest = divmod(tenths, 36000)
    minutes, rest = divmod(rest, 600)
    sign = "−" if value < 0 else "+"
    return f"{sign}{degrees:02d}°{minutes:02d}′{rest / 10:04.1f}″"


def _split(text: str, what: str, example: str) -> tuple[int, int, int, float]:
    match = _SEXAGESIMAL.match(text)
    if match is None:
        raise ValueError(f"{what} {text!r} cannot be read; write it like {example}")
    sign = -1 if match.group(1) in ("-", "−") else 1
    minutes, seconds = int(match.group(3)), float(match.group(4))
    if minutes >= 60 or seconds >= 60:
        raise ValueError(f"{what} {text!r} has 60 or more minutes or seconds")
    return sign, int(match.group(2)), minutes, seconds
