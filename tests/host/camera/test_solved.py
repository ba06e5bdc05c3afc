"""astrometry.net (Debian: astrometry.net) finds where a frame was taken, from the stars in it alone."""

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from bus.units import ARCSEC_PER_RAD
from host.camera.camera import Order, expose
from host.camera.models import GUIDE, MAIN, CameraModel, Look, Window
from host.camera.place import catalogued
from host.camera.seeing import Wander
from host.camera.stars import SyntheticSky, separation
from host.sky.site import NAINITAL
from tests.host.camera.test_frames import CLOCK, path

BOUND_ARCSEC = 5.0
"""Between the solver's place of the middle and that of the true axes."""
ROLL_RAD = 0.05

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore:The WCS transformation has more axes"),  # a header without an image
    pytest.mark.skipif(shutil.which("solve-field") is None, reason="apt install astrometry.net"),
]


def _run(folder: Path, *words: object) -> str:
    done = subprocess.run([str(word) for word in words], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr or done.stdout
    return done.stdout


def _index(folder: Path, look: Look, scale: int) -> None:
    """An index of the sky around. It knows the catalogue, and nothing of the camera or where it looks.

    scale: astrometry.net's number of the size of a pattern; 4: 11 to 16 arcmin, 9: 60 to 85.
    """
    table = pytest.importorskip("astropy.table", reason="pip install .[camera]")
    around = SyntheticSky().near(*catalogued(look, NAINITAL, CLOCK), np.radians(4.0))
    columns = {
        "RA": np.degrees(around.right_ascension),
        "DEC": np.degrees(around.declination),
        "MAG": around.magnitude,
    }
    table.Table(columns).write(folder / "stars.fits")
    words = ("-i", "stars.fits", "-o", "index.fits", "-P", scale, "-S", "MAG", "-E", "-I", 1)
    _run(folder, "build-astrometry-index", *words)
    (folder / "solver").write_text(f"add_path {folder}\nindex index.fits\ncpulimit 200\n")


@pytest.mark.parametrize(("model", "scale", "seconds"), [(GUIDE, 4, 10.0), (MAIN, 9, 2.0)])
def test_a_plate_solver_finds_where_the_true_axes_look(
    tmp_path: Path, model: CameraModel, scale: int, seconds: float
) -> None:
    fits = pytest.importorskip("astropy.io.fits", reason="pip install .[camera]")
    from astropy.wcs import WCS

    from host.camera.fits import write

    looks = tuple(
        look._replace(hour_angle_rad=look.hour_angle_rad + 0.004, roll_rad=ROLL_RAD) for look in path(seconds)
    )
    window = Window(left=0, top=0, width=model.width, height=model.height)
    wander, random = Wander(model.aperture_m, 1, model.name), np.random.default_rng(1)
    frame = expose(
        model, Order(seconds=seconds, window=window), looks, SyntheticSky(), NAINITAL, CLOCK, wander, random
    )
    file = write(frame, NAINITAL, CLOCK, tmp_path)
    _index(tmp_path, looks[0], scale)
    with fits.open(file, mode="update") as opened:  # the solver gets pixels, not our coordinates
        middle = opened[0].header["CRPIX1"] - 1, opened[0].header["CRPIX2"] - 1
        bare = fits.PrimaryHDU(opened[0].data)
    bare.writeto(tmp_path / "bare.fits")
    limits = ("--scale-low", 0.7 * model.pixel_arcsec, "--scale-high", 1.4 * model.pixel_arcsec)
    words = ("--config", "solver", "--no-plots", "--no-verify", "--scale-units", "arcsecperpix")
    _run(tmp_path, "solve-field", *words, *limits, "bare.fits")
    assert (tmp_path / "bare.solved").exists()
    found = np.radians(WCS(fits.getheader(tmp_path / "bare.wcs")).all_pix2world(*middle, 0))
    true = catalogued(looks[len(looks) // 2], NAINITAL, CLOCK)
    off = float(separation(found[0], found[1], *true)) * ARCSEC_PER_RAD
    print(f"{model.name}: {off:.2f} arcsec")
    assert off < BOUND_ARCSEC
