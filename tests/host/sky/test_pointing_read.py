"""Pointing runs from files: TPOINT's lines and CSV, and what is wrong with one."""

import math
from pathlib import Path

import numpy as np
import pytest

from bus.units import ARCSEC, ARCSEC_PER_RAD
from host.sky.pointfind import find
from host.sky.pointread import is_run, read
from host.sky.pointstars import Stars
from tests.host.sky.seen import LATITUDE
from tests.host.sky.test_pointing_find import run

SITE = "+29 22 00.0  2026 03 03"
STAR = "05 16 41.36 +45 59 52.8  05 16 50.10 +45 58 40.2  06 12.5"
HEAD = "# latitude_deg: 29.5\nhour_angle_deg,declination_deg,ra_reading_deg,dec_reading_deg,dome_C\n"


def three(angle: float, digits: int) -> str:
    """Whole, minutes, seconds with a sign."""
    size = round(abs(angle) * 3600, digits)
    minutes, seconds = divmod(size, 60)
    whole, minutes = divmod(minutes, 60)
    return f"{'-' if angle < 0 else '+'}{whole:02.0f} {minutes:02.0f} {seconds:0{3 + digits}.{digits}f}"


def tpoint(stars: Stars, site: str = SITE) -> str:
    """A run as TPOINT's manual writes it, at a sidereal time that goes on."""
    lines = ["Caption", ": NODA", site]
    for k, (h, d, ra, dec) in enumerate(zip(stars.h, stars.d, stars.ra, stars.dec, strict=True)):
        sidereal = (3 + 0.1 * k) % 24
        places = [three((sidereal - math.degrees(a) / 15) % 24, 4)[1:] for a in (h, ra)]
        north = [three(math.degrees(each), 3) for each in (d, dec)]
        time = f"{int(sidereal):02d} {60 * (sidereal % 1):09.6f}"
        lines.append(f"{places[0]} {north[0]}  {places[1]} {north[1]}  {time} 12.5")
    return "\n".join([*lines, "END", ""])


def written(folder: Path, text: str, name: str = "stars.dat") -> Path:
    path = folder / name
    path.write_text(text)
    return path


def test_a_run_in_tpoints_format_is_the_same_run(tmp_path: Path) -> None:
    stars = run(7100, "FO")
    path = written(tmp_path, tpoint(stars))
    assert is_run(path)
    again = read(path)
    assert again.latitude_rad == pytest.approx(LATITUDE, abs=1e-7)
    for name in ("h", "d", "ra", "dec"):
        off = np.remainder(getattr(again, name) - getattr(stars, name) + np.pi, 2 * np.pi) - np.pi
        assert np.max(np.abs(off)) * ARCSEC_PER_RAD < 0.01  # its last digit
    assert [each.name for each in find(again).lacks] == ["FO"]


def test_air_pressure_says_that_places_are_without_refraction(tmp_path: Path) -> None:
    """At 45 degrees and 1010 hPa refraction is 58″ (Allen, Astrophysical Quantities, 10 C)."""
    plain = f"x\n{SITE}\n00 00 00 -15 38 00 00 00 00 -15 38 00 00 00\n"
    without = read(written(tmp_path, plain))
    air = read(written(tmp_path, plain.replace("2026 03 03", "2026 03 03 10 1010 0 0.5 0.574")))
    assert (air.d - without.d)[0] / ARCSEC == pytest.approx(58.0, abs=1.0)
    assert air.dec[0] == without.dec[0]


def test_a_csv_keeps_its_other_columns(tmp_path: Path) -> None:
    path = written(tmp_path, HEAD + "10,20,10.5,19.5,7\n-10,30,-9.5,29.5,6\n", "stars.csv")
    assert is_run(path)
    stars = read(path)
    assert list(np.degrees(stars.h)) == pytest.approx([10, -10])
    assert list(np.degrees(stars.dec)) == pytest.approx([19.5, 29.5])
    assert list(stars.others["dome_C"]) == [7, 6]


def test_another_csv_is_no_pointing_run(tmp_path: Path) -> None:
    assert not is_run(written(tmp_path, "t,position\n0,1\n", "log.csv"))
    assert not is_run(written(tmp_path, "# format: axis-log 1\n", "log.dat"))
    assert not is_run(written(tmp_path, "PHD2 version 2.6\n", "guide.dat"))
    assert not is_run(tmp_path / "none.dat")


@pytest.mark.parametrize(
    ("name", "text", "line"),
    [
        ("a.dat", "x\n: ALTAZ\n" + SITE + "\n", "a.dat:2: only equatorial"),
        ("a.dat", "x\n", "a.dat: a TPOINT file has"),
        ("a.dat", f"x\n{SITE}\n", "a.dat: there are no stars"),
        ("a.dat", "x\n29 22 00\n", "a.dat:2: the site is"),
        ("a.dat", f"x\n{SITE} 10 5000\n{STAR}\n", "a.dat:2: pressure 5000 hPa"),
        ("a.dat", f"x\n{SITE}\n{STAR.replace('45 59', '45 61')}\n", r"a.dat:3: \+45 61 52.8 is not"),
        ("a.dat", f"x\n{SITE}\n{STAR[:40]}\n", "a.dat:3: a star has 14 numbers"),
        ("a.dat", f"x\n{SITE}\n{STAR.replace('06 12.5', '18 12.5')}\n", "a.dat:3: this star is below"),
        ("a.dat", f"x\n{SITE}\n{STAR.replace('12.5', 'nan')}\n", "a.dat:3: 'nan' is not a number"),
        ("a.csv", HEAD.split("\n")[1] + "\n1,2,3,4,5\n", "a.csv: the latitude is missing"),
        ("a.dat", f"x\n{SITE} -300 800\n{STAR}\n", "a.dat:2: temperature -300 °C is outside -100 to 60"),
        ("a.dat", f"x\n{SITE} 10 800 1950 0.5 0\n{STAR}\n", "a.dat:2: wavelength 0 µm is outside 0.1 to 100"),
        ("a.dat", f"x\n{SITE.replace('29 22', '91 22')}\n{STAR}\n", r"a.dat:2: \+91 22 00.0 is beyond 90"),
        ("a.dat", f"x\n{SITE}\n{STAR.replace('45 59', '95 59')}\n", r"a.dat:3: \+95 59 52.8 is beyond 90"),
        ("a.csv", HEAD + "1,1e300,3,4,5\n", "a.csv:3: 1e300 is beyond 90"),
        ("a.csv", HEAD.replace("29", "129", 1) + "1,2,3,4,5\n", "a.csv:1: 129.* is beyond 90"),
        ("a.csv", HEAD + "1,2,3,4\n", "a.csv:3: 4 values for 5 columns"),
        ("a.csv", HEAD + "1,2,3,4,x\n", "a.csv:3: 'x' is not a number"),
        ("a.csv", HEAD + "1,2,3,4," + "5" * 200_000 + "\n", "a.csv: field larger than"),
    ],
)
def test_what_is_wrong_is_said_with_its_line(tmp_path: Path, name: str, text: str, line: str) -> None:
    with pytest.raises(ValueError, match=line):
        read(written(tmp_path, text, name))
