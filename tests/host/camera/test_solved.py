"""astrometry.net (Debian: astrometry.net) finds where a frame was taken, from the stars in it alone."""

import shutil
import subprocess
from pathlib import Path

import erfa
import numpy as np
import pytest

from bus.units import ARCSEC_PER_RAD
from host.camera.camera import Order, expose
from host.camera.models import GUIDE, MAIN, CameraModel, Look, Window
from host.camera.seeing import Wander
from host.camera.stars import SyntheticSky, catalogued
from host.sky.site import NAINITAL
from scenarios.doors.options import ServeOptions
from scenarios.lab.eye import look
from tests.doors.test_cameras import read_out
from tests.host.camera.test_frames import CLOCK, path
from tests.host.telescope.conftest import Rig

BOUND_ARCSEC = 5.0
"""Between the solver's place of the middle and that of the true axes."""
ROLL_RAD = 0.05
SCALES = {GUIDE.name: 4, MAIN.name: 9}
"""astrometry.net's numbers of the size of a pattern; 4: 11 to 16 arcmin, 9: 60 to 85."""

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore:The WCS transformation has more axes"),  # a header without an image
    pytest.mark.skipif(shutil.which("solve-field") is None, reason="apt install astrometry.net"),
]


def _run(folder: Path, *words: object) -> str:
    done = subprocess.run([str(word) for word in words], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr or done.stdout
    return done.stdout


def _index(folder: Path, where: Look, scale: int) -> None:
    """An index of the sky around. It knows the catalogue, and nothing of the camera or where it looks."""
    table = pytest.importorskip("astropy.table", reason="pip install .[camera]")
    around = SyntheticSky().near(*catalogued(where, NAINITAL, CLOCK), np.radians(4.0))
    columns = {
        "RA": np.degrees(around.right_ascension),
        "DEC": np.degrees(around.declination),
        "MAG": around.magnitude,
    }
    table.Table(columns).write(folder / "stars.fits")
    words = ("-i", "stars.fits", "-o", "index.fits", "-P", scale, "-S", "MAG", "-E", "-I", 1)
    _run(folder, "build-astrometry-index", *words)
    (folder / "solver").write_text(f"add_path {folder}\nindex index.fits\ncpulimit 200\n")


def _off_arcsec(file: Path, model: CameraModel, true: Look) -> float:
    """Between the place that the solver finds for the middle of a frame and that of the true axes."""
    fits = pytest.importorskip("astropy.io.fits", reason="pip install .[camera]")
    from astropy.wcs import WCS

    folder = file.with_suffix("")
    folder.mkdir()
    _index(folder, true, SCALES[model.name])
    with fits.open(file) as opened:  # the solver gets pixels, not our coordinates
        middle = opened[0].header["CRPIX1"] - 1, opened[0].header["CRPIX2"] - 1
        fits.PrimaryHDU(opened[0].data).writeto(folder / "bare.fits")
    limits = ("--scale-low", 0.7 * model.pixel_arcsec, "--scale-high", 1.4 * model.pixel_arcsec)
    words = ("--config", "solver", "--no-plots", "--no-verify", "--scale-units", "arcsecperpix")
    _run(folder, "solve-field", *words, *limits, "bare.fits")
    assert (folder / "bare.solved").exists()
    found = np.radians(WCS(fits.getheader(folder / "bare.wcs")).all_pix2world(*middle, 0))
    off = float(erfa.seps(found[0], found[1], *catalogued(true, NAINITAL, CLOCK))) * ARCSEC_PER_RAD
    print(f"{model.name}: {off:.2f} arcsec")
    return off


def _whole(model: CameraModel, seconds: float) -> Order:
    return Order(seconds=seconds, window=Window(left=0, top=0, width=model.width, height=model.height))


@pytest.mark.parametrize(("model", "seconds"), [(GUIDE, 10.0), (MAIN, 2.0)])
def test_a_plate_solver_finds_where_the_true_axes_look(
    tmp_path: Path, model: CameraModel, seconds: float
) -> None:
    pytest.importorskip("astropy.io.fits", reason="pip install .[camera]")
    from host.camera.fits import write

    looks = tuple(
        each._replace(hour_angle_rad=each.hour_angle_rad + 0.004, roll_rad=ROLL_RAD) for each in path(seconds)
    )
    wander, random = Wander(model.aperture_m, 1, model.name), np.random.default_rng(1)
    frame = expose(
        model, _whole(model, seconds), looks, SyntheticSky(), NAINITAL, CLOCK, wander, random
    )  # fmt: skip
    file = write(frame, NAINITAL, CLOCK, tmp_path)
    assert _off_arcsec(file, model, looks[len(looks) // 2]) < BOUND_ARCSEC


def test_frames_of_a_served_telescope_are_solved_to_where_its_plant_points(tmp_path: Path) -> None:
    """Boards track a star on a mount with errors; the truth is read behind the exposures, from the plant."""
    pytest.importorskip("astropy.io.fits", reason="pip install .[camera]")
    rig = Rig()
    rig.host.open_cameras(ServeOptions(asked={"alpaca": ("0",)}, frames=tmp_path))
    rig.run(lambda t: t.drive.power_on())
    rig.run(lambda t: t.focuser.reference())
    rig.run(lambda t: t.focuser.move_to(0))  # at f/1 a few half steps make a disc of every star
    rig.run(lambda t: t.drive.goto(rig.up()))
    for camera in rig.pc.cameras:
        camera.start(_whole(camera.model, 10.0 if camera.model is GUIDE else 2.0))
    rig.advance(11.0)
    true = look(rig.network.plant, rig.served.scenario, rig.served.now_ns)
    for camera in rig.pc.cameras:
        read_out(camera, 600.0)
        (file,) = tmp_path.glob(f"{camera.model.name.lower().replace(' ', '-')}-*.fits")
        assert _off_arcsec(file, camera.model, true) < BOUND_ARCSEC
    rig.host.close()
