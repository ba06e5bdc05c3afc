"""Pointing runs as files: TPOINT's format of right ascensions and sidereal times, and CSV."""

from __future__ import annotations

import csv
import math
import re
from pathlib import Path

import erfa
import numpy as np

from host.sky.pointstars import Stars

HOUR_ANGLE, DECLINATION = "hour_angle_deg", "declination_deg"
AXES = ("ra_reading_deg", "dec_reading_deg")
"""Columns of a CSV run, as pointing-stars.csv has them: where the star was seen, observed place, and what the
encoders read. Every other column of numbers is a variable that errors may depend on."""
LABEL = "step"
"""A column of text."""
_LATITUDE = re.compile(r"#\s*latitude_deg\s*:\s*(\S+)\s*$")
_OTHERS = ("#", "PHD2")
"""An axis log and a guide log begin so, whatever the file is called; TPOINT's caption does not."""
_LINE = 200
"""Characters of a first line that are looked at."""
_SKIPPED = ("", "END")
_RECORD = 14
"""Numbers of a record: three each of both places of the star and of the telescope, two of sidereal time."""
_AIR = (
    ("temperature", -100.0, 60.0, "°C"), ("pressure", 0.0, 1100.0, "hPa"), ("height", -500.0, 9000.0, "m"),
    ("humidity", 0.0, 1.0, ""), ("wavelength", 0.1, 100.0, "µm"),
)  # fmt: skip
"""What a site's air may be. ASSUMPTION: beyond what was ever measured on the ground (-89 °C, 1084 hPa)."""
_MOST_DEG = {HOUR_ANGLE: 360.0, DECLINATION: 90.0, AXES[0]: 360.0, AXES[1]: 360.0}
"""Of angles, either way; an axis may stand beyond the pole."""


def is_run(path: Path) -> bool:
    """Whether a file is a pointing run: `.dat` or `.tpt` without another's head, or a CSV by its columns."""
    if path.suffix.lower() not in (".dat", ".tpt", ".csv") or not path.is_file():
        return False
    with path.open(encoding="utf-8", errors="replace") as file:
        if path.suffix.lower() != ".csv":
            return not file.readline(_LINE).startswith(_OTHERS)
        head = next((line for line in file if not line.startswith("#")), "")
    return {HOUR_ANGLE, DECLINATION, *AXES} <= {each.strip() for each in head.split(",")}


def read(path: Path) -> Stars:
    """The stars of a run; raises ValueError."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except UnicodeDecodeError:
        raise ValueError(f"{path}: is not UTF-8 text") from None
    return _csv(path, lines) if path.suffix.lower() == ".csv" else _tpoint(path, lines)


def _csv(path: Path, lines: list[str]) -> Stars:
    latitude = next((found[1] for line in lines if (found := _LATITUDE.match(line))), None)
    if latitude is None:
        raise ValueError(f"{path}: the latitude is missing; write a first line '# latitude_deg: 29.367'")
    first = next(number for number, line in enumerate(lines) if not line.startswith("#"))
    every = [each.strip() for each in lines[first].split(",")]
    names = [each for each in every if each != LABEL]
    rows = []
    try:
        table = list(csv.reader(lines[first + 1 :]))
    except csv.Error as error:
        raise ValueError(f"{path}: {error}") from None
    for number, row in enumerate(table, first + 2):
        if row and not row[0].startswith("#"):
            if len(row) != len(every):
                raise ValueError(f"{path}:{number}: {len(row)} values for {len(every)} columns")
            rows.append(
                [
                    _number(path, number, each, _MOST_DEG.get(name, math.inf))
                    for name, each in zip(every, row, strict=True)
                    if name != LABEL
                ]
            )
    columns = dict(zip(names, np.array(rows).reshape(-1, len(names)).T, strict=True))
    angles = [np.radians(columns.pop(each)) for each in (HOUR_ANGLE, DECLINATION, *AXES)]
    return Stars(
        h=angles[0], d=angles[1], ra=angles[2], dec=angles[3],
        latitude_rad=math.radians(_number(path, 1, latitude, 90.0)), others=columns,
    )  # fmt: skip


def _tpoint(path: Path, lines: list[str]) -> Stars:
    """Caption, options, site, then a star a line: right ascension and declination of the star and of the
    telescope, and local sidereal time. Air pressure other than 0: the star's place is without refraction."""
    body = [(number, line.split()) for number, line in enumerate(lines, 1)][1:]
    for number, words in body:
        if words and words[0].startswith(":") and "ALTAZ" in " ".join(words).upper():
            raise ValueError(f"{path}:{number}: only equatorial mounts have these terms, not ALTAZ")
    body = [(number, words) for number, words in body if words and not words[0].startswith((":", "!"))]
    body = [(number, words) for number, words in body if words[0].upper() not in _SKIPPED]
    if not body:
        raise ValueError(f"{path}: a TPOINT file has a caption, then a line of the site, then stars")
    number, words = body[0]
    site = [_number(path, number, each) for each in words]
    if len(site) < 6:
        raise ValueError(f"{path}:{number}: the site is latitude in three parts, date in three parts, …")
    latitude = _sexagesimal(words[:3], site[:3], path, number, 90.0)
    a, b = _refraction(path, number, site[6:])
    stars = [_star(path, line, words, math.radians(latitude), a, b) for line, words in body[1:]]
    if not stars:
        raise ValueError(f"{path}: there are no stars after the site")
    h, d, ra, dec = np.array(stars).T
    return Stars(h=h, d=d, ra=ra, dec=dec, latitude_rad=math.radians(latitude), others={})


def _refraction(path: Path, number: int, air: list[float]) -> tuple[float, float]:
    """Constants of tan z and its cube, rad. air: temperature C, pressure hPa, height m, humidity 0 to 1,
    wavelength um, as far as they are there."""
    if len(air) < 2 or air[1] == 0:
        return 0.0, 0.0
    for value, (what, low, high, unit) in zip(air, _AIR, strict=False):
        if not low <= value <= high:
            told = f"{what} {value:g} {unit}".rstrip()
            raise ValueError(f"{path}:{number}: {told} is outside {low:g} to {high:g}")
    humidity, wavelength = air[3:5] if len(air) >= 5 else (0.5, 0.55)
    a, b = erfa.refco(air[1], air[0], humidity, wavelength)
    return float(a), float(b)


def _star(
    path: Path, number: int, words: list[str], latitude_rad: float, a: float, b: float
) -> tuple[float, float, float, float]:
    """Observed hour angle and declination, and those of the axes, rad."""
    if len(words) < _RECORD:
        raise ValueError(f"{path}:{number}: a star has {_RECORD} numbers, here are {len(words)}")
    parts = [_number(path, number, each) for each in words[:_RECORD]]
    places = [
        _sexagesimal(words[k : k + 3], parts[k : k + 3], path, number, most)
        for k, most in ((0, 24.0), (3, 90.0), (6, 24.0), (9, 360.0))
    ]
    sidereal = parts[12] + parts[13] / 60
    h, ra = (math.radians(15 * (sidereal - place)) for place in (places[0], places[2]))
    d, dec = math.radians(places[1]), math.radians(places[3])
    azimuth, altitude = erfa.hd2ae(h, d, latitude_rad)
    if altitude <= 0:
        raise ValueError(f"{path}:{number}: this star is below the horizon; check latitude and time")
    tangent = 1 / math.tan(altitude)
    h, d = (
        float(each) for each in erfa.ae2hd(azimuth, altitude + a * tangent + b * tangent**3, latitude_rad)
    )
    return math.remainder(h, 2 * math.pi), d, math.remainder(ra, 2 * math.pi), dec


def _sexagesimal(words: list[str], parts: list[float], path: Path, number: int, most: float) -> float:
    """Whole, minutes, seconds; the sign stands before the whole, also before a 0. most: either way."""
    if not (0 <= parts[1] < 60 and 0 <= parts[2] < 60):
        raise ValueError(f"{path}:{number}: {' '.join(words)} is not whole, minutes and seconds")
    size = abs(parts[0]) + parts[1] / 60 + parts[2] / 3600
    if size > most:
        raise ValueError(f"{path}:{number}: {' '.join(words)} is beyond {most:g}")
    return -size if words[0].startswith("-") else size


def _number(path: Path, number: int, text: str, most: float = math.inf) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"{path}:{number}: {text!r} is not a number")
    if abs(value) > most:
        raise ValueError(f"{path}:{number}: {text} is beyond {most:g}")
    return value
