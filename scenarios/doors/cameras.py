"""The cameras of a served network, as its options ask for them."""

from collections.abc import Callable

from host.camera.camera import Camera, Frame
from host.camera.models import CAMERAS
from host.camera.stars import SyntheticSky, from_file
from scenarios.doors.options import DoorOptions
from scenarios.language.model import Scenario


def cameras(scenario: Scenario, options: DoorOptions) -> tuple[Camera, ...]:
    """By Alpaca's number, where there is an Alpaca door. scenario: one with a date. Raises ValueError for a
    catalogue that cannot be used."""
    if not options.asked.get("alpaca"):
        return ()
    sky = SyntheticSky() if options.stars is None else from_file(options.stars)
    keep = _kept(scenario, options)
    return tuple(Camera(model, sky, scenario.site, scenario.clock, scenario.seed, keep) for model in CAMERAS)


def _kept(scenario: Scenario, options: DoorOptions) -> Callable[[Frame], object] | None:
    folder = options.frames
    if folder is None:
        return None
    from host.camera.fits import write  # of the extra `camera`

    return lambda frame: write(frame, scenario.site, scenario.clock, folder)
