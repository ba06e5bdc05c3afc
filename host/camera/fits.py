"""Frames as FITS files (FITS 4.0), with a WCS of the truth."""

import math
from pathlib import Path

import numpy as np
from astropy.io import fits

from host.camera.camera import Frame, file_name
from host.camera.stars import catalogued, turning
from host.sky.observed import Clock
from host.sky.site import Site


def write(frame: Frame, site: Site, clock: Clock, folder: Path) -> Path:
    """Write a frame into a folder; returns the file."""
    folder.mkdir(parents=True, exist_ok=True)
    file = file_name(frame, clock, folder)
    fits.PrimaryHDU(frame.counts, header(frame, site, clock)).writeto(file, overwrite=True)
    return file


def header(frame: Frame, site: Site, clock: Clock) -> fits.Header:
    """Keywords of a frame. RA, DEC and the WCS are of the true place at half time, ICRS, degrees.

    The WCS is linear: refraction bends a field by less than a thousandth of its size.
    """
    model, order = frame.model, frame.order
    middle = frame.looks[len(frame.looks) // 2]
    ra, dec = (math.degrees(angle) for angle in catalogued(middle, site, clock))
    scale = model.pixel_rad * order.binning
    matrix = turning(middle, 1e-4, site, clock) * scale * np.array([1.0, -1.0])  # rows go down
    window = order.window
    found = fits.Header()
    found["ROWORDER"] = ("TOP-DOWN", "the first row is the upper one")
    found["INSTRUME"] = (model.sensor, model.name)
    found["TELESCOP"] = "schmidt"
    found["DATE-OBS"] = (clock.iso(frame.start_s).rstrip("Z"), "UTC, shutter open")
    days, fraction = clock.julian(frame.start_s)
    found["MJD-OBS"] = (days - 2400000.5 + fraction, "the same in days")
    found["EXPTIME"] = (frame.seconds, "s")
    found["IMAGETYP"] = "Light Frame" if order.lit else "Dark Frame"
    found["GAIN"] = (model.gain_e_adu, "electrons per ADU")
    found["CCD-TEMP"] = (model.temperature_c, "deg C")
    found["XBINNING"], found["YBINNING"] = order.binning, order.binning
    found["XPIXSZ"] = (model.pixel_m * order.binning * 1e6, "um")
    found["YPIXSZ"] = (model.pixel_m * order.binning * 1e6, "um")
    found["FOCALLEN"] = (model.focal_length_m * 1e3, "mm")
    found["APTDIA"] = (model.aperture_m * 1e3, "mm")
    found["SITELAT"], found["SITELONG"] = math.degrees(site.latitude_rad), math.degrees(site.longitude_rad)
    found["RA"], found["DEC"] = (ra, "deg, true"), (dec, "deg, true")
    found["RADESYS"], found["CTYPE1"], found["CTYPE2"] = "ICRS", "RA---TAN", "DEC--TAN"
    found["CUNIT1"], found["CUNIT2"] = "deg", "deg"
    found["CRVAL1"], found["CRVAL2"] = ra, dec
    found["CRPIX1"] = ((model.width - 1) / 2 - window.left + 0.5) / order.binning + 0.5
    found["CRPIX2"] = ((model.height - 1) / 2 - window.top + 0.5) / order.binning + 0.5
    for row in (0, 1):
        for column in (0, 1):
            found[f"CD{row + 1}_{column + 1}"] = float(matrix[row, column])
    return found
