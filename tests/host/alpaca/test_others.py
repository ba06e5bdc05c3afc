"""Camera, focuser, dome and weather of Alpaca, without a socket; and what goes over the wire byte by byte."""

import asyncio
import json
import struct
from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from bus.protocol import Device as Board
from bus.protocol import FocusFlag, Opcode
from host.alpaca.camera import CameraDevice
from host.alpaca.dome import DomeDevice
from host.alpaca.focuser import FocuserDevice
from host.alpaca.observing import ObservingConditionsDevice, SafetyMonitorDevice
from host.alpaca.requests import AlpacaError, Malformed
from host.alpaca.server import MEDIA_TYPE, Alpaca, picture
from host.camera.camera import Frame, Order, State
from host.camera.models import GUIDE, Window
from host.telescope import AsyncDesk
from tests.host.alpaca.test_members import REFUSED, STATE, VALUE, get, number, put
from tests.host.camera.test_frames import CLOCK, path
from tests.host.telescope.wired import Wired, awake


class Camera:
    """What the device tells a camera."""

    def __init__(self) -> None:
        self.model, self.clock, self.state, self.error, self.done = GUIDE, CLOCK, State.IDLE, "", 0.496
        self.frame: Frame | None = None
        self.told: list[Any] = []

    def start(self, order: Order) -> None:
        self.told.append(order)

    def abort(self) -> None:
        self.told.append("abort")

    def stop(self) -> None:
        self.told.append("stop")


def camera() -> tuple[Wired, Any, CameraDevice]:
    wired, made = awake(), Camera()
    return wired, made, CameraDevice(AsyncDesk(wired.telescope), made, 1)  # type: ignore[arg-type]


def test_a_camera_tells_its_model_and_its_frame() -> None:
    wired, made, device = camera()
    said = {name: get(device, name) for name in (
        "CameraXSize", "CameraYSize", "MaxBinX", "MaxBinY", "BinX", "BinY", "StartX", "StartY", "NumX",
        "NumY", "ExposureMax", "ReadoutMode", "PercentCompleted", "CameraState", "ImageReady",
        "CanAbortExposure",
        "CanAsymmetricBin", "HasShutter", "MaxADU", "Name", "Description",
    )}  # fmt: skip
    assert said == {
        "CameraXSize": 1280, "CameraYSize": 960, "MaxBinX": 4, "MaxBinY": 4, "BinX": 1, "BinY": 1,
        "StartX": 0, "StartY": 0, "NumX": 1280, "NumY": 960, "ExposureMax": 3600.0, "ReadoutMode": 0,
        "PercentCompleted": 49, "CameraState": 0, "ImageReady": False, "CanAbortExposure": True,
        "CanAsymmetricBin": False,
        "HasShutter": True, "MaxADU": 65535, "Name": "Guide camera",
        "Description": "Guide camera with guide, emulated",
    }  # fmt: skip
    assert get(device, "PixelSizeX") == get(device, "PixelSizeY") == pytest.approx(3.75)
    for words in ("there is no frame; expose one first", "OSError: full"):
        with pytest.raises(AlpacaError, match=words) as found:
            get(device, "ImageArray")
        assert found.value.number == STATE
        made.error = "OSError: full"
    order = Order(seconds=0.5, window=Window(left=0, top=0, width=1, height=1))
    made.frame = Frame(
        model=GUIDE, order=order, looks=tuple(path(0.5)), counts=np.ones((2, 3), dtype=np.uint16)
    )
    assert get(device, "ImageReady") is True and get(device, "ImageArray").shape == (2, 3)
    assert get(device, "LastExposureStartTime") == "2026-02-10T14:01:40.000"
    assert get(device, "LastExposureDuration") == pytest.approx(0.5)
    put(wired, device, "ReadoutMode", "ReadoutMode=0")
    assert number(wired, device, "ReadoutMode", "ReadoutMode=1") == VALUE
    assert number(wired, device, "ReadoutMode", "ReadoutMode=-1") == VALUE


@pytest.mark.parametrize(("binning", "window", "taken"), [
    (1, (0, 0, 1280, 960), True), (1, (0, 0, 1281, 960), False), (1, (0, 0, 1280, 961), False),
    (2, (0, 0, 640, 480), True), (2, (1, 0, 640, 480), False), (2, (0, 1, 640, 480), False),
    (4, (10, 20, 1, 1), True),
    (1, (-1, 0, 10, 10), False), (1, (0, -1, 10, 10), False), (1, (0, 0, 0, 10), False),
    (1, (0, 0, 10, 0), False),
    (2, (0, 0, 641, 1), False),
])  # fmt: skip
def test_a_window_is_in_bins_and_has_to_lie_on_the_detector(
    binning: int, window: tuple[int, int, int, int], taken: bool
) -> None:
    wired, made, device = camera()
    put(wired, device, "BinX", f"BinX={binning}")
    for name, value in zip(("StartX", "StartY", "NumX", "NumY"), window, strict=True):
        put(wired, device, name, f"{name}={value}")
    if not taken:
        assert number(wired, device, "StartExposure", "Duration=1&Light=True") == VALUE
        return
    put(wired, device, "StartExposure", "Duration=1&Light=True")
    left, top, width, height = (each * binning for each in window)
    wanted = Window(left=left, top=top, width=width, height=height)
    assert made.told == [Order(seconds=1.0, window=wanted, binning=binning, lit=True)]


def test_exposures_have_their_bounds_and_their_states() -> None:
    wired, made, device = camera()
    for given in ("Duration=3600.1&Light=True", "Duration=-0.1&Light=False", "Duration=0.009&Light=True"):
        assert number(wired, device, "StartExposure", given) == VALUE
    put(wired, device, "StartExposure", "Duration=0&Light=False")
    put(wired, device, "StartExposure", "Duration=0.01&Light=True")
    assert [(each.seconds, each.lit) for each in made.told] == [(0.01, False), (0.01, True)]
    for state in (State.EXPOSING, State.READING):
        made.state = state
        assert number(wired, device, "StartExposure", "Duration=1&Light=True") == STATE
    made.state = State.ERROR
    put(wired, device, "StartExposure", "Duration=3600&Light=True")
    put(wired, device, "AbortExposure")
    put(wired, device, "StopExposure")
    assert made.told[-2:] == ["abort", "stop"]
    for binning in (0, 5):
        assert number(wired, device, "BinY", f"BinY={binning}") == VALUE
    for binning in (1, 4):
        put(wired, device, "BinY", f"BinY={binning}")
        assert get(device, "BinX") == binning
    with pytest.raises(Malformed):
        put(wired, device, "NumX", "NumX=x")


def test_a_focuser_counts_from_the_inner_end() -> None:
    wired = awake()
    device = FocuserDevice(AsyncDesk(wired.telescope))
    with pytest.raises(AlpacaError, match="sent nothing yet"):
        get(device, "Position")
    wired.focus(-120, int(FocusFlag.REFERENCED))
    wired.tick()
    assert get(device, "Position") == 680 and get(device, "IsMoving") is False
    assert get(device, "MaxStep") == get(device, "MaxIncrement") == 1600 and get(device, "TempComp") is False
    for position, told in ((0, -800), (1600, 800), (680, -120)):
        wired.since()
        put(wired, device, "Move", f"Position={position}")
        wired.tick(2)
        assert (Board.FOCUS, Opcode.FOCUS_MOVE_TO, told) in wired.since()
    wired.focus(5, int(FocusFlag.MOVING))
    wired.tick()
    assert get(device, "IsMoving") is True
    for position in (-1, 1601):
        assert number(wired, device, "Move", f"Position={position}") == VALUE
    assert number(wired, device, "TempComp", "TempComp=True") == REFUSED
    put(wired, device, "Halt")
    assert (Board.FOCUS, Opcode.FOCUS_HOLD) in wired.since()
    for action, opcode in (
        ("Reference", Opcode.FOCUS_REFERENCE),
        ("Hold", Opcode.FOCUS_HOLD),
        ("Free", Opcode.FOCUS_FREE),
    ):
        assert put(wired, device, "Action", f"Action={action}&Parameters=") == "ok"
        wired.tick(2)
        assert (Board.FOCUS, opcode) in wired.since()
    wired.focus(5, 0)
    job = wired.do(lambda t: t.focuser.move_to(20))
    assert get(device, "IsMoving") is True and job.running


DOME = {"Azimuth": 90.0, "Moving": 0.0, "ShutterMoving": 0.0, "Opened": 0.0, "Closed": 0.0, "BadWeather": 0.0}


def desk(**house: Any) -> Any:
    usual = {"opening": False, "slaved": False, "fresh": lambda _: DOME, "unsafe": list,
    "heard_s": lambda _: 7.5,
             "expected": lambda _: ["WEATHER_MAST", "WEATHER_DOME"]}  # fmt: skip
    return Some(telescope=Some(house=Some(**usual | house)), now=Some(t_s=10.0))


@pytest.mark.parametrize(("fields", "opening", "status", "slewing"), [
    ({}, False, 4, False), ({"Opened": 1.0}, False, 0, False), ({"Closed": 1.0}, False, 1, False),
    ({"ShutterMoving": 1.0}, True, 2, True), ({"ShutterMoving": 1.0}, False, 3, True),
    ({"ShutterMoving": 1.0, "BadWeather": 1.0}, True, 3, True), ({"Moving": 1.0}, False, 4, True),
])  # fmt: skip
def test_a_shutter_has_ascoms_states(
    fields: dict[str, float], opening: bool, status: int, slewing: bool
) -> None:
    device = DomeDevice(desk(fresh=lambda _: DOME | fields, opening=opening))
    assert device.state() == {"Azimuth": 90.0, "ShutterStatus": status, "Slewing": slewing}
    with pytest.raises(AlpacaError):
        DomeDevice(desk(fresh=lambda _: None)).state()


def test_a_command_of_the_dome_is_answered_when_its_frames_show_it(monkeypatch: pytest.MonkeyPatch) -> None:
    slept: list[float] = []

    async def sleep(seconds: float) -> None:
        slept.append(seconds)

    monkeypatch.setattr(asyncio, "sleep", sleep)
    turned: list[float] = []
    for heard, looks in ((10.1, 150), (10.101, 0)):
        slept.clear()
        device = DomeDevice(desk(heard_s=lambda _, at=heard: at, turn=turned.append))

        async def run(act: Any, to: DomeDevice = device) -> None:
            act(to.desk.telescope)

        device.run = run  # type: ignore[method-assign]
        asyncio.run(device.command(lambda t: t.house.turn(5.0)))
        assert slept == [0.02] * looks
    assert turned == [5.0, 5.0]


def test_weather_is_that_of_the_mast() -> None:
    now = {"Temperature": 20.0, "Humidity": 50.0, "Wind": 3.5, "Rain": 0.0}
    device = ObservingConditionsDevice(desk(fresh={"WEATHER_MAST": now}.get))
    assert (
        get(device, "Temperature") == 20.0
        and get(device, "Humidity") == 50.0
        and get(device, "WindSpeed") == 3.5
    )
    assert get(device, "RainRate") == 0.0 and get(device, "DewPoint") == pytest.approx(9.3, abs=0.1)
    now["Rain"], now["Humidity"] = 1.0, 0.0
    assert get(device, "RainRate") == 1.0 and get(device, "DewPoint") < -50
    assert get(device, "TimeSinceLastUpdate", "SensorName=") == 2.5
    assert get(device, "TimeSinceLastUpdate", "SensorName=temperature") == 2.5
    assert get(device, "AveragePeriod") == 0
    assert get(device, "SensorDescription", "SensorName=WINDSPEED").startswith("at the mast")
    for name, code in (("pressure", REFUSED), ("CloudCover", REFUSED), ("smell", VALUE)):
        for member in ("SensorDescription", "TimeSinceLastUpdate"):
            with pytest.raises(AlpacaError) as found:
                get(device, member, f"SensorName={name}")
            assert found.value.number == code
    silent = ObservingConditionsDevice(desk(fresh=lambda _: None))
    for member, given in (("Temperature", ""), ("TimeSinceLastUpdate", "SensorName=")):
        with pytest.raises(AlpacaError, match="sent nothing yet"):
            get(silent, member, given)


@pytest.mark.parametrize(("connected", "causes", "safe"), [
    (True, [], True), (False, [], False), (True, ["rain"], False), (False, ["rain"], False),
])  # fmt: skip
def test_it_is_safe_when_every_station_says_so(connected: bool, causes: list[str], safe: bool) -> None:
    device = SafetyMonitorDevice(desk(unsafe=lambda: causes))
    device.connected = connected
    assert get(device, "IsSafe") is safe and device.members["issafe"].always


def test_a_picture_is_columns_in_json_and_bytes() -> None:
    """Alpaca's ImageBytes, version 1: eleven numbers of 32 bits, then x by x."""
    counts = np.array([[1, 2, 3], [4, 5, 65535]], dtype=np.uint16)
    answer = picture(counts, "text/html, Application/ImageBytes", 7, (1 << 32) + 8)
    assert answer.media_type == MEDIA_TYPE
    body = bytes(answer.body)
    assert struct.unpack_from("<iiIIiiiiiii", body) == (1, 0, 7, 8, 44, 2, 8, 2, 3, 2, 0)
    assert list(np.frombuffer(body[44:], dtype="<u2")) == [1, 4, 2, 5, 3, 65535]
    plain = json.loads(bytes(picture(counts, "application/json", 7, 8).body))
    assert plain == {
        "Type": 2, "Rank": 2, "Value": [[1, 4], [2, 5], [3, 65535]], "ClientTransactionID": 7,
        "ServerTransactionID": 8, "ErrorNumber": 0, "ErrorMessage": "",
    }  # fmt: skip


def test_answers_count_up_and_devices_are_listed() -> None:
    wired = awake()
    alpaca = Alpaca(wired.telescope, ())
    first, second = (json.loads(bytes(alpaca._answer(5, value).body)) for value in (1.5, None))
    assert first == {
        "Value": 1.5, "ClientTransactionID": 5, "ServerTransactionID": first["ServerTransactionID"],
        "ErrorNumber": 0, "ErrorMessage": "",
    }  # fmt: skip
    assert "Value" not in second and second["ServerTransactionID"] == first["ServerTransactionID"] + 1
    kinds = [(each["DeviceType"], each["DeviceNumber"]) for each in alpaca.configured()]
    assert ("Telescope", 0) in kinds and ("Focuser", 0) in kinds
