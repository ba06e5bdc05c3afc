"""Coordinates as LX200 programs write and read them: rounded, not cut, in fixed columns."""

import math
import re

DEGREE = "\xdf"
"""The Meade hand box's degree sign, one byte; Stellarium expects it."""
_NUMBERS = re.compile(
    r"^\s*([+\-]?)\s*(\d{1,3})[*:\xdf°' ](\d{1,2})(?:\.(\d+)|[:'* ](\d{1,2}(?:\.\d+)?))?\s*$"
)


def parse(text: str) -> float:
    """`sDD*MM:SS`, `sDD*MM`, `HH:MM.T`, `HH:MM:SS`, with blanks and any of the separators; in units of the
    first number. Raises ValueError for anything else."""
    match = _NUMBERS.match(text)
    if match is None:
        raise ValueError(f"{text!r} is no angle")
    sign, whole, minutes, tenths, seconds = match.groups()
    minute = float(f"{minutes}.{tenths}") if tenths else float(minutes)
    second = float(seconds or 0)
    if minute >= 60 or second >= 60:
        raise ValueError(f"{text!r} has 60 or more minutes or seconds")
    value = int(whole) + minute / 60 + second / 3600
    return -value if sign == "-" else value


def hours(angle_rad: float, precise: bool = True) -> str:
    """Right ascension or time, `HH:MM:SS` or `HH:MM.T`."""
    if precise:
        seconds = round(angle_rad * 43200 / math.pi) % 86400
        return f"{seconds // 3600:02d}:{seconds // 60 % 60:02d}:{seconds % 60:02d}"
    tenths = round(angle_rad * 7200 / math.pi) % 14400
    return f"{tenths // 600:02d}:{tenths // 10 % 60:02d}.{tenths % 10}"


def signed(angle_rad: float, precise: bool = True, separator: str = ":") -> str:
    """Declination, altitude or latitude, `sDDßMM:SS` or `sDDßMM`."""
    sign = "-" if angle_rad < 0 else "+"
    return sign + _degrees(abs(angle_rad), 2, precise, separator)


def unsigned(angle_rad: float, precise: bool = True, separator: str = ":") -> str:
    """Azimuth or longitude, `DDDßMM:SS` or `DDDßMM`, 0 to 360."""
    return _degrees(angle_rad % (2 * math.pi), 3, precise, separator)


def _degrees(angle_rad: float, width: int, precise: bool, separator: str) -> str:
    if precise:
        seconds = round(math.degrees(angle_rad) * 3600) % (360 * 3600)
        return f"{seconds // 3600:0{width}d}{DEGREE}{seconds // 60 % 60:02d}{separator}{seconds % 60:02d}"
    minutes = round(math.degrees(angle_rad) * 60) % (360 * 60)
    return f"{minutes // 60:0{width}d}{DEGREE}{minutes % 60:02d}"
