"""alpyca on the cameras of a live network: frames in both formats, windows, refusals, and where stars are."""

import array
import json
from collections.abc import Iterator
from urllib.request import urlopen

import numpy as np
import pytest
from alpaca.camera import Camera, CameraStates
from alpaca.exceptions import InvalidOperationException, InvalidValueException, NotImplementedException
from alpaca.telescope import GuideDirections

from tests.host.alpaca.conftest import AlpacaLive
from tests.host.alpaca.test_alpyca import until


@pytest.fixture(scope="module")
def skies(tmp_path_factory: pytest.TempPathFactory) -> Iterator[AlpacaLive]:
    made = AlpacaLive(tmp_path_factory.mktemp("skies"), cameras=True)
    yield made
    made.close()


def exposed(camera: Camera, seconds: float, light: bool = True) -> np.ndarray:
    """Rows from the top."""
    camera.StartExposure(seconds, light)
    until(lambda: camera.ImageReady)
    pixels: array.array[int] = camera.ImageArrayRaw
    return np.array(pixels).reshape(camera.ImageArrayInfo.Dimension1, -1).T


@pytest.mark.slow
def test_a_frame_comes_in_both_formats(skies: AlpacaLive) -> None:
    camera = Camera(skies.address, 1)
    camera.Connected = True
    assert (camera.CameraXSize, camera.CameraYSize, camera.PixelSizeX) == (1280, 960, 3.75)
    with pytest.raises(InvalidOperationException):
        _ = camera.ImageArray
    camera.BinX, camera.StartX, camera.NumX, camera.StartY, camera.NumY = 2, 20, 600, 10, 450
    counts = exposed(camera, 5.0)
    assert counts.shape == (450, 600) and counts.max() > np.median(counts) + 500
    with urlopen(f"http://{skies.address}/api/v1/camera/1/imagearray", timeout=30) as said:
        answer = json.load(said)
    assert (answer["Rank"], answer["Type"]) == (2, 2)
    assert np.array_equal(np.array(answer["Value"]).T, counts)
    assert camera.LastExposureDuration == pytest.approx(5.0, abs=1e-6)
    assert str(camera.LastExposureStartTime).startswith("2026-02-10T14:0")
    assert camera.CameraState == CameraStates.cameraIdle and camera.PercentCompleted == 100
    dark = exposed(camera, 5.0, light=False)
    assert dark.max() < counts.max() - 300


@pytest.mark.slow
def test_what_the_standard_refuses_and_ends(skies: AlpacaLive) -> None:
    camera = Camera(skies.address, 0)
    camera.Connected = True
    assert camera.SensorName == "KAF-16801E" and camera.InterfaceVersion == 4
    for wrong in (-1.0, 1e5, 0.001):
        with pytest.raises(InvalidValueException):
            camera.StartExposure(wrong, True)
    camera.NumX = 5000
    with pytest.raises(InvalidValueException):
        camera.StartExposure(1.0, True)
    with pytest.raises(InvalidValueException):
        camera.BinX = 5
    with pytest.raises(NotImplementedException):
        _ = camera.Gain
    camera.NumX, camera.NumY = 64, 64
    camera.StartExposure(1000.0, True)
    with pytest.raises(InvalidOperationException):
        camera.StartExposure(1.0, True)
    until(lambda: camera.PercentCompleted > 0)
    camera.AbortExposure()
    assert camera.CameraState == CameraStates.cameraIdle and not camera.ImageReady
    camera.StartExposure(1000.0, True)
    until(lambda: camera.PercentCompleted > 0)
    camera.StopExposure()
    until(lambda: camera.ImageReady)
    assert 1.0 < camera.LastExposureDuration < 1000.0
    assert camera.CanPulseGuide
    with pytest.raises(Exception, match="parked"):
        camera.PulseGuide(GuideDirections.guideNorth, 100)
