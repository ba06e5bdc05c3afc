"""Keywords of a frame's file, by FITS 4.0 and the table of cameras."""

import math
from pathlib import Path

import numpy as np
import pytest

from host.camera.camera import Frame, Order
from host.camera.fits import header, write
from host.camera.models import GUIDE, MAIN, CameraModel, Window
from host.camera.stars import catalogued
from host.sky.site import NAINITAL
from tests.host.camera.test_frames import CLOCK, path

WINDOW = Window(left=100, top=40, width=8, height=6)


def frame(model: CameraModel = GUIDE, binning: int = 1, lit: bool = True) -> Frame:
    counts = np.arange(48, dtype=np.uint16).reshape(6, 8)
    order = Order(seconds=0.5, window=WINDOW, binning=binning, lit=lit)
    return Frame(model=model, order=order, looks=tuple(path(0.5, west_rad_s=1e-4)), counts=counts)


def test_a_header_tells_the_detector_and_its_optics() -> None:
    found = header(frame(MAIN, binning=2), NAINITAL, CLOCK)
    said = {key: found[key] for key in (
        "ROWORDER", "INSTRUME", "TELESCOP", "DATE-OBS", "IMAGETYP", "GAIN", "CCD-TEMP", "XBINNING",
        "YBINNING", "RADESYS", "CTYPE1", "CTYPE2", "CUNIT1", "CUNIT2",
    )}  # fmt: skip
    assert said == {
        "ROWORDER": "TOP-DOWN", "INSTRUME": "KAF-16801E", "TELESCOP": "schmidt",
        "DATE-OBS": "2026-02-10T14:01:40.000", "IMAGETYP": "Light Frame", "GAIN": 1.6, "CCD-TEMP": -20.0,
        "XBINNING": 2, "YBINNING": 2, "RADESYS": "ICRS", "CTYPE1": "RA---TAN", "CTYPE2": "DEC--TAN",
        "CUNIT1": "deg", "CUNIT2": "deg",
    }  # fmt: skip
    sizes = [found[key] for key in ("EXPTIME", "XPIXSZ", "YPIXSZ", "FOCALLEN", "APTDIA")]
    assert sizes == pytest.approx([0.5, 18.0, 18.0, 500.0, 500.0])
    assert (found["SITELAT"], found["SITELONG"]) == pytest.approx((29 + 22 / 60, 79 + 27 / 60))
    assert header(frame(lit=False), NAINITAL, CLOCK)["IMAGETYP"] == "Dark Frame"


def test_the_date_in_days_is_the_same() -> None:
    """2026-02-10 is the day 61081 of the modified Julian date; 14:01:40 UTC."""
    days = 61081 + (14 * 3600 + 100) / 86400
    assert header(frame(), NAINITAL, CLOCK)["MJD-OBS"] == pytest.approx(days, abs=1e-6)


def test_the_place_is_the_true_one_at_half_time() -> None:
    found, looks = header(frame(), NAINITAL, CLOCK), path(0.5, west_rad_s=1e-4)
    place = [math.degrees(each) for each in catalogued(looks[25], NAINITAL, CLOCK)]
    assert [found["RA"], found["DEC"]] == pytest.approx(place, abs=1e-9)
    assert [found["CRVAL1"], found["CRVAL2"]] == pytest.approx(place, abs=1e-9)


@pytest.mark.parametrize("binning", [1, 2])
def test_the_reference_pixel_is_the_detectors_middle_counted_from_one(binning: int) -> None:
    """By hand: the middle is at 639.5, 479.5, from 0; that is 540 and 440 pixels' edges into the window."""
    found = header(frame(binning=binning), NAINITAL, CLOCK)
    expected = (540 / binning + 0.5, 440 / binning + 0.5)
    assert (found["CRPIX1"], found["CRPIX2"]) == pytest.approx(expected)
    matrix = np.array([[found[f"CD{row}_{column}"] for column in (1, 2)] for row in (1, 2)])
    pixel_deg = math.degrees(3.75e-6 / 0.4) * binning
    assert matrix / pixel_deg == pytest.approx(np.array([[-1.0, 0.0], [0.0, -1.0]]), abs=6e-3)


def test_a_file_lies_in_a_folder_that_is_made_and_may_be_written_again(tmp_path: Path) -> None:
    folder = tmp_path / "one" / "two"
    file = write(frame(), NAINITAL, CLOCK, folder)
    assert file == folder / "guide-camera-2026-02-10T14-01-40-000Z.fits"
    assert write(frame(), NAINITAL, CLOCK, folder) == file and file.stat().st_size % 2880 == 0
