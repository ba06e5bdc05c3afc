"""The cameras of a served network, as its options ask for them."""

from host.camera.camera import Camera, Frame
from host.camera.models import CAMERAS
from host.camera.stars import SyntheticSky, from_file
from host.logs.clientguiding import ClientGuiding
from scenarios.doors.options import DoorOptions
from scenarios.language.model import Scenario


def cameras(
    scenario: Scenario, options: DoorOptions, guiding: ClientGuiding | None = None
) -> tuple[Camera, ...]:
    """By Alpaca's number, where there is an Alpaca door. scenario: one with a date. guiding: sees the frames.
    Raises ValueError for a catalogue that cannot be used."""
    if not options.asked.get("alpaca"):
        return ()
    sky = SyntheticSky() if options.stars is None else from_file(options.stars)
    folder = options.frames

    def keep(frame: Frame) -> None:
        if guiding is not None:
            guiding.frame(frame)
        if folder is not None:
            from host.camera.fits import write  # of the extra `camera`

            write(frame, scenario.site, scenario.clock, folder)

    return tuple(Camera(model, sky, scenario.site, scenario.clock, scenario.seed, keep) for model in CAMERAS)
