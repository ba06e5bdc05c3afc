"""A night without seeing, and what its frames are compared with."""

import numpy as np
import numpy.typing as npt
from scipy.special import ndtr

from host.camera.light import light
from host.camera.models import CameraModel, Look, Window
from host.camera.seeing import Wander
from host.camera.stars import Array, Sky, Stars, SyntheticSky
from host.sky.catalogue import STARS
from host.sky.site import NAINITAL
from tests.host.camera.test_frames import CLOCK

POLLUX = STARS["Pollux"]


class Still(Wander):
    """Images stand still."""

    def __init__(self) -> None:
        super().__init__(0.5, 1, "still")

    def __call__(self, t_s: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        return np.zeros((2, len(t_s)))


def pollux(magnitude: float) -> Stars:
    """It alone, as bright as this."""
    alone = SyntheticSky().near(POLLUX.right_ascension_rad, POLLUX.declination_rad, 1e-6)
    assert len(alone.magnitude) == 1
    return alone._replace(magnitude=np.array([magnitude]))


def middle(model: CameraModel, size: int) -> Window:
    """In the middle of an even detector: its centre is between two pixels if `size` is even."""
    return Window(left=(model.width - size) // 2, top=(model.height - size) // 2, width=size, height=size)


def drawn(model: CameraModel, looks: list[Look], sky: Sky, window: Window) -> Array:
    """Light without seeing."""
    return light(model, looks, window, sky, NAINITAL, CLOCK, Still())


def bell(count: int, at: float, sigma: float) -> Array:
    """Shares of a Gaussian in a row of pixels; pixel 0 reaches from -1/2 to 1/2."""
    edges = np.arange(count + 1) - 0.5
    return np.asarray(np.diff(ndtr((edges - at) / sigma)))
