"""Cameras of a served network: they look at the truth and change nothing; their options."""

import math
import os
from pathlib import Path
from time import monotonic, sleep

import numpy as np
import pytest

from bus.can import Frame
from host.camera.camera import Camera, Order, State
from host.camera.models import Window
from host.camera.stars import from_file
from host.sky.observed import observe
from scenarios.doors.making import check
from scenarios.doors.options import ServeOptions
from tests.host.inprocess import HostInProcess
from tests.host.telescope.conftest import Rig

ALPACA = {"alpaca": ("0",)}


def order(camera: Camera, seconds: float) -> Order:
    left, top = camera.model.width // 2 - 20, camera.model.height // 2 - 20
    return Order(seconds=seconds, window=Window(left=left, top=top, width=40, height=40))


def read_out(camera: Camera, limit_s: float = 60.0) -> None:
    end = monotonic() + limit_s
    while camera.state is State.READING:
        assert monotonic() < end, "the frame is not read out"
        sleep(0.01)
    assert camera.frame is not None, camera.error


def night(shutter: bool) -> tuple[list[tuple[int, Frame, str]], list[tuple[float, float]], int]:
    """Frames on the bus, true angles, and looks of an exposure, of axes that power up and move."""
    rig, frames, truth, looks = Rig(), [], [], 0
    rig.network.wire.tap(lambda *heard: frames.append(heard))
    rig.host.open_cameras(ServeOptions(asked=ALPACA))
    camera = rig.pc.cameras[1]
    rig.run(lambda t: t.drive.power_on())
    rig.do(lambda t: t.drive.goto(rig.up()))
    if shutter:
        camera.start(order(camera, 15.0))
    for _ in range(40):
        rig.advance(0.5)
        truth.append((rig.network.plant.ra.truth(rig.served.now_ns)[0],
                      rig.network.plant.dec.truth(rig.served.now_ns)[0]))  # fmt: skip
    if shutter:
        read_out(camera)
        assert camera.frame is not None
        looks = len(camera.frame.looks)
    rig.host.close()
    return frames, truth, looks


@pytest.mark.slow
def test_an_open_shutter_changes_nothing_on_bus_or_plant() -> None:
    frames, truth, none = night(shutter=False)
    again, true_again, looks = night(shutter=True)
    assert none == 0 and looks > 1000
    assert np.ptp([ra for ra, _ in truth]) > 1e-3  # it has moved
    assert again == frames and true_again == truth


def test_cameras_see_what_another_host_moves(monkeypatch: pytest.MonkeyPatch) -> None:
    """As `schmidt host` beside `schmidt serve`: the telescope is its own, the cameras are here."""
    rig = Rig()
    rig.host.open_cameras(ServeOptions(asked=ALPACA))
    here, other = rig.host.poll, HostInProcess(rig.served)
    monkeypatch.setattr(rig.host, "poll", lambda now_ns: (here(now_ns), other.poll(now_ns)))
    rig.telescope = other.pc.telescope
    rig.advance(2.0)
    rig.run(lambda t: t.drive.power_on())
    star = rig.up(hour_angle_h=-0.5)
    rig.run(lambda t: t.drive.goto(star))
    camera = rig.pc.cameras[1]
    camera.start(order(camera, 0.5))
    rig.advance(1.0)
    read_out(camera)
    rig.host.close()
    other.close()
    assert other.pc.cameras == () and camera.frame is not None
    look = camera.frame.looks[-1]
    place = observe(star, rig.pc.observatory.site, rig.pc.clock, look.t_ns * 1e-9)
    off = look.hour_angle_rad - place.hour_angle_rad, look.declination_rad - place.declination_rad
    assert math.degrees(math.hypot(*off)) < 0.2  # a mount with errors, and far from where it was parked


def test_a_catalogue_of_ones_own_is_the_sky(tmp_path: Path) -> None:
    file = tmp_path / "stars.csv"
    file.write_text("name,ra,dec,magnitude\nOne,05:00:00,+20:00:00,6.5\nTwo,05:00:10,-01:30:00,7\n")
    found = from_file(file)
    assert np.degrees(found.right_ascension) == pytest.approx([75.0, 75.0 + 10 / 240])
    assert np.degrees(found.declination) == pytest.approx([20.0, -1.5])
    assert list(found.magnitude) == [6.5, 7.0]
    assert len(found.near(found.right_ascension[1], found.declination[1], 0.01).magnitude) == 1


def test_a_catalogue_that_cannot_be_used_says_why(tmp_path: Path) -> None:
    file = tmp_path / "stars.csv"
    file.write_text("name,ra,dec\nOne,05:00:00,+20:00:00\n")
    with pytest.raises(ValueError, match=r"stars\.csv: One has no magnitude"):
        from_file(file)
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(ValueError, match="pipe: no regular file"):
        from_file(tmp_path / "pipe")


@pytest.mark.parametrize("option", ["stars", "frames"])
def test_options_of_cameras_need_their_door(option: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=f"--{option} needs --alpaca"):
        check(ServeOptions(asked={"lx200": ("0",)}, **{option: tmp_path}))  # type: ignore[arg-type]


def test_logs_of_the_host_need_a_host(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"--logs is the host's: it needs --lx200, --alpaca or --console"):
        check(ServeOptions(asked={"control": ("0",)}, logs=tmp_path))
    check(ServeOptions(asked={"lx200": ("0",)}, logs=tmp_path))


def test_frames_are_kept_as_files(tmp_path: Path) -> None:
    fits = pytest.importorskip("astropy.io.fits", reason="pip install .[camera]")
    rig = Rig()
    rig.host.open_cameras(ServeOptions(asked=ALPACA, frames=tmp_path / "frames"))
    camera = rig.pc.cameras[0]
    camera.start(order(camera, 0.5))
    rig.advance(1.0)
    read_out(camera)
    rig.host.close()
    (file,) = (tmp_path / "frames").iterdir()
    assert camera.frame is not None and np.array_equal(fits.getdata(file), camera.frame.counts)
