"""ICameraV4: the telescope's camera and the guide camera, on the emulated sky."""

from host.alpaca.device import Device, Member, does, fixed, of, table, zero
from host.alpaca.requests import INVALID_OPERATION, INVALID_VALUE, AlpacaError, Parameters, within
from host.alpaca.slewing import pulse
from host.camera.camera import Camera, Frame, Order, State
from host.camera.models import Window
from host.telescope import AsyncDesk

MOST_BINNING = 4
LONGEST_S = 3600.0
"""ASSUMPTION: an hour, as the looks of an exposure are kept in memory."""


class CameraDevice(Device):
    """Windows are in binned pixels, from the upper left. Exposures take simulated time."""

    kind = "camera"
    interface_version = 4

    def __init__(self, desk: AsyncDesk, camera: Camera, number: int) -> None:
        super().__init__(desk)
        self.camera, self.model, self.number = camera, camera.model, str(number)
        self.description = f"{camera.model.name} with {camera.model.sensor}, emulated"
        self.unique_id = f"8ad6c6f4-0b0e-4f0b-9c52-5c1d5f1d001{number}"
        self.binning = 1
        self.window = {"StartX": 0, "StartY": 0, "NumX": self.model.width, "NumY": self.model.height}

    @property
    def name(self) -> str:
        """For people."""
        return self.model.name

    @property
    def frame(self) -> Frame:
        """The last one, or INVALID_OPERATION."""
        found = self.camera.frame
        if found is None:
            raise AlpacaError(INVALID_OPERATION, self.camera.error or "there is no frame; expose one first")
        return found

    def state(self) -> dict[str, object]:
        """Operational properties."""
        return {
            "CameraState": int(self.camera.state), "CCDTemperature": self.model.temperature_c,
            "ImageReady": self.camera.frame is not None, "IsPulseGuiding": self.now.pulse_guiding,
            "PercentCompleted": int(self.camera.done * 100),
        }  # fmt: skip

    def checked(self) -> Window:
        """The window in pixels of the detector, or INVALID_VALUE."""
        b, w = self.binning, self.window
        wide, high = self.model.width // b, self.model.height // b
        for start, size, most in (("StartX", "NumX", wide), ("StartY", "NumY", high)):
            if not (w[start] >= 0 and w[size] >= 1 and w[start] + w[size] <= most):
                raise AlpacaError(
                    INVALID_VALUE,
                    f"{start} {w[start]} and {size} {w[size]} leave the {most} bins of the detector",
                )
        return Window(left=w["StartX"] * b, top=w["StartY"] * b, width=w["NumX"] * b, height=w["NumY"] * b)


def _binning(name: str) -> Member:
    def put(device: CameraDevice, given: Parameters) -> None:
        device.binning = int(within(name, given.integer(name), 1, MOST_BINNING))

    return Member(name, of(lambda d: d.binning), does(put))


def _edge(name: str) -> Member:
    put = does(lambda d, given: d.window.update({name: given.integer(name)}))
    return Member(name, of(lambda d: d.window[name]), put)


def _start(device: CameraDevice, given: Parameters) -> None:
    low = device.model.shortest_s
    seconds, lit = within("Duration", given.number("Duration"), 0, LONGEST_S), given.truth("Light")
    if lit:
        within("Duration", seconds, low, LONGEST_S)
    window = device.checked()
    if device.camera.state in (State.EXPOSING, State.READING):
        raise AlpacaError(INVALID_OPERATION, "an exposure is under way; abort it first")
    device.camera.start(Order(seconds=max(seconds, low), window=window, binning=device.binning, lit=lit))


CameraDevice.members = table(
    "camera",
    *map(_binning, ("BinX", "BinY")),
    *(Member(f"Max{name}", fixed(MOST_BINNING)) for name in ("BinX", "BinY")),
    *map(_edge, ("StartX", "StartY", "NumX", "NumY")),
    Member("ExposureMax", fixed(LONGEST_S)),
    Member("LastExposureStartTime", of(lambda d: d.camera.clock.iso(d.frame.start_s).rstrip("Z"))),
    *(Member(name, of(lambda d: d.model.pixel_m * 1e6)) for name in ("PixelSizeX", "PixelSizeY")),
    zero("ReadoutMode", Parameters.integer),
    Member("AbortExposure", put=does(lambda d, _: d.camera.abort())),
    Member("PulseGuide", put=pulse),
    Member("StartExposure", put=does(_start)),
    Member("StopExposure", put=does(lambda d, _: d.camera.stop())),
)  # fmt: skip
