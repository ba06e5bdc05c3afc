"""A guider of a few lines closes the loop through Alpaca: frames of the guide camera in, PulseGuide out."""

import csv
import math
from collections.abc import Iterator

import numpy as np
import pytest
from alpaca.camera import Camera
from alpaca.telescope import GuideDirections, Telescope

from calibration.inputs.guidelog import read_guide_log
from host.camera.models import GUIDE
from host.sky.catalogue import STARS
from host.sky.observed import apparent_of_observed, observe
from tests.host.alpaca.conftest import AlpacaLive
from tests.host.alpaca.test_alpyca import until
from tests.host.alpaca.test_camera import exposed

SIZE_PX = 101
SHIFT_ARCSEC = (12.0, -9.0)
"""Where the star shall stand beside where it is: to the right (west) and up (north)."""
GAIN = 0.8
"""Share of an error that a pulse corrects: PHD2's default for declination is near it."""


@pytest.fixture(scope="module")
def skies(tmp_path_factory: pytest.TempPathFactory) -> Iterator[AlpacaLive]:
    made = AlpacaLive(tmp_path_factory.mktemp("guided"), cameras=True)
    yield made
    made.close()


def star(camera: Camera) -> np.ndarray:
    """Where the star is, arcsec to the right and up of the middle."""
    light = exposed(camera, 4.0).astype(float)
    light -= np.median(light)
    light[light < 0.1 * light.max()] = 0.0
    rows, columns = np.indices(light.shape)
    x, y = (np.average(each, weights=light) for each in (columns, rows))
    return np.array([x - (SIZE_PX - 1) / 2, (SIZE_PX - 1) / 2 - y]) * GUIDE.pixel_arcsec


@pytest.mark.slow
def test_pulses_bring_the_star_where_it_shall_stand(skies: AlpacaLive) -> None:
    telescope, camera = Telescope(skies.address, 0), Camera(skies.address, 1)
    telescope.Connected = camera.Connected = True
    telescope.Unpark()
    until(lambda: not telescope.AtPark)
    telescope.Tracking = True
    here, clock = skies.host.pc.observatory.site, skies.host.pc.clock
    seen = observe(STARS["Pollux"], here, clock, skies.telescope.snapshot.t_s)
    place = apparent_of_observed(
        seen.hour_angle_rad, seen.declination_rad, here, clock, skies.telescope.snapshot.t_s
    )
    telescope.SlewToCoordinatesAsync(
        math.degrees(place.right_ascension_rad) / 15, math.degrees(place.declination_rad)
    )
    until(lambda: not telescope.Slewing)
    field = exposed(camera, 1.0)  # a mount with errors: the star is somewhere beside the middle
    row, column = np.unravel_index(np.argmax(field), field.shape)
    camera.StartX, camera.StartY = int(column) - SIZE_PX // 2, int(row) - SIZE_PX // 2
    camera.NumX = camera.NumY = SIZE_PX
    at = star(camera)
    wanted = at + SHIFT_ARCSEC
    rates = (
        telescope.GuideRateRightAscension * 3600 * math.cos(place.declination_rad),
        telescope.GuideRateDeclination * 3600,
    )
    ways = (
        (GuideDirections.guideWest, GuideDirections.guideEast),
        (GuideDirections.guideNorth, GuideDirections.guideSouth),
    )
    errors, seen, sent = [], [], []
    for _ in range(8):
        off = star(camera) - wanted
        seen.append(off)
        errors.append(np.abs(off).max())
        for error, rate, (ahead, back) in zip(off, rates, ways, strict=True):
            milliseconds = round(GAIN * abs(error) / rate * 1000)
            telescope.PulseGuide(ahead if error > 0 else back, milliseconds)
            sent.append((milliseconds if error > 0 else -milliseconds) / 1000)
        until(lambda: not telescope.IsPulseGuiding)
    print("largest error of each frame, arcsec:", " ".join(f"{each:.1f}" for each in errors))
    assert errors[0] > 8.0
    assert np.mean(errors[4:]) < 1.5  # seeing moves an image of 4 s by some tenths of an arcsec
    log = skies.logs / "guiding.txt"
    assert not log.exists()
    telescope.Tracking = False  # the star is left: its session is over
    until(log.exists)
    (run,) = read_guide_log(log)
    table = list(csv.DictReader(_table(log.read_text())))
    told = [
        int(row[f"{axis}Duration"]) / 1000 * (1 if row[f"{axis}Direction"] in "WN" else -1)
        for row in table
        for axis in ("RA", "DEC")
    ]
    assert told == pytest.approx(sent, abs=6e-4)  # what the client sent is what is logged
    scale = GUIDE.pixel_arcsec
    true = scale * np.array([[float(row["RARawDistance"]), -float(row["DECRawDistance"])] for row in table])
    # the client's own measure of the pictures, seeing included, against the true place that is logged
    assert true - true[0] == pytest.approx(np.array(seen) - seen[0], abs=1.5)
    assert len(run.columns["t"]) == len(errors) and np.all(np.diff(run.columns["t"]) > 4.0)
    # the drive alone, pulses taken out, is still but for the telescope's drift
    assert np.ptp(run.columns["ra"]) < 3.0 and np.ptp(run.columns["dec"]) < 3.0


def _table(text: str) -> list[str]:
    lines = text.splitlines()
    begin = next(k for k, line in enumerate(lines) if line.startswith("Frame,"))
    return lines[begin : next(k for k, line in enumerate(lines) if line.startswith("Guiding Ends"))]
