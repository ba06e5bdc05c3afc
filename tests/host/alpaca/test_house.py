"""alpyca drives the dome and reads the weather, on the network that has them; refused cases included."""

import math
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from alpaca import management
from alpaca.dome import Dome, ShutterState
from alpaca.exceptions import (
    InvalidOperationException,
    InvalidValueException,
    NotImplementedException,
    SlavedException,
)
from alpaca.observingconditions import ObservingConditions
from alpaca.safetymonitor import SafetyMonitor

from host.alpaca.observing import dew_point_c
from tests.host.alpaca.conftest import AlpacaLive
from tests.host.alpaca.test_alpyca import until
from tests.host.alpaca.test_http import get, put


@contextmanager
def rain(final: AlpacaLive) -> Iterator[None]:
    """Drops on the mast's sensor; dry again after it, and after the station's own hold."""
    board = final.network.board("WEATHER_MAST")
    pins, values = board.pins, board.values  # type: ignore[attr-defined]
    values["hold_s"].value, dry = 2, pins["rain"]
    pins["rain"] = lambda _t_ns: 1.0
    yield
    pins["rain"] = dry


@pytest.fixture
def dome(final: AlpacaLive) -> Dome:
    made = Dome(final.address, 0)
    made.Connect()
    return made


def test_the_devices_are_those_of_the_network(final: AlpacaLive) -> None:
    kinds = [device["DeviceType"] for device in management.configureddevices(final.address)]
    assert kinds == ["Telescope", "Focuser", "Dome", "ObservingConditions", "SafetyMonitor"]


@pytest.mark.parametrize("kind", ["dome", "observingconditions", "safetymonitor"])
def test_a_state_tells_only_what_there_is(final: AlpacaLive, kind: str) -> None:
    """ASCOM leaves out of DeviceState what a device has not implemented."""
    put(final, "connected", "Connected=True", device=kind)
    state = get(final, "devicestate", device=kind)[1]["Value"]
    assert isinstance(state, list)
    for each in state:
        if each["Name"] != "TimeStamp":
            body = get(final, each["Name"].lower(), device=kind)[1]
            assert body["ErrorNumber"] == 0 and type(body["Value"]) is type(each["Value"]), each


@pytest.mark.slow
def test_the_dome_turns_opens_stops_and_says_what_it_cannot(dome: Dome) -> None:
    assert dome.InterfaceVersion == 3 and dome.ShutterStatus == ShutterState.shutterClosed
    assert dome.CanSetAzimuth and dome.CanSetShutter and dome.CanSlave and not dome.CanPark
    dome.SlewToAzimuth(20.0)
    assert dome.Slewing
    until(lambda: not dome.Slewing)
    assert dome.Azimuth == pytest.approx(20.0, abs=0.6)  # the board's tolerance
    dome.OpenShutter()
    assert dome.ShutterStatus == ShutterState.shutterOpening and dome.Slewing
    dome.AbortSlew()
    assert dome.ShutterStatus == ShutterState.shutterError  # rests between its ends
    dome.OpenShutter()
    until(lambda: dome.ShutterStatus == ShutterState.shutterOpen)
    dome.CloseShutter()
    assert dome.ShutterStatus == ShutterState.shutterClosing
    until(lambda: dome.ShutterStatus == ShutterState.shutterClosed)
    for wrong in (-1.0, 361.0):
        with pytest.raises(InvalidValueException):
            dome.SlewToAzimuth(wrong)
    for missing in (dome.Park, dome.FindHome, dome.SetPark, lambda: dome.SlewToAltitude(45.0)):
        with pytest.raises(NotImplementedException):
            missing()
    with pytest.raises(NotImplementedException):
        _ = dome.Altitude


@pytest.mark.slow
def test_a_slaved_dome_follows_a_slew_and_refuses_to_be_sent_elsewhere(final: AlpacaLive, dome: Dome) -> None:
    assert not dome.Slaved
    star = final.up(hour_angle_h=-1.0, dec_deg=40.0)
    final.telescope.call(lambda t: t.drive.goto(star, wake=True))
    dome.Slaved = True
    with pytest.raises(SlavedException):
        dome.SlewToAzimuth(10.0)

    def behind_deg() -> float:
        aim = final.telescope.aim()
        assert aim is not None
        return abs(math.remainder(math.degrees(aim.azimuth_rad) - dome.Azimuth, 360))

    until(lambda: final.telescope.snapshot.activity == "tracking" and not dome.Slewing)
    assert behind_deg() < 2.6  # what is followed at all, and the board's tolerance
    dome.AbortSlew()
    assert not dome.Slaved


@pytest.mark.slow
def test_the_weather_is_read_and_rain_closes_the_shutter(final: AlpacaLive, dome: Dome) -> None:
    weather, monitor = ObservingConditions(final.address, 0), SafetyMonitor(final.address, 0)
    assert monitor.IsSafe is False  # not connected
    weather.Connect()
    monitor.Connect()
    assert monitor.IsSafe is True and weather.RainRate == 0.0
    assert weather.Temperature == pytest.approx(10.0, abs=0.1)
    assert weather.Humidity == pytest.approx(50.0, abs=0.2)
    assert weather.DewPoint == pytest.approx(0.06, abs=0.2)  # WMO's own tables
    assert weather.WindSpeed == pytest.approx(2.0, abs=0.1)
    assert 0 <= weather.TimeSinceLastUpdate("") < 2 and "mast" in weather.SensorDescription("humidity")
    weather.Refresh()
    assert weather.AveragePeriod == 0.0
    weather._put("averageperiod", AveragePeriod=0.0)  # alpyca has no setter
    with pytest.raises(InvalidValueException):
        weather._put("averageperiod", AveragePeriod=1.0)
    with pytest.raises(InvalidValueException):
        weather.SensorDescription("Moonlight")
    for name in ("SkyQuality", "windgust"):
        with pytest.raises(NotImplementedException):
            weather.TimeSinceLastUpdate(name)
    with pytest.raises(NotImplementedException):
        _ = weather.Pressure

    dome.OpenShutter()
    until(lambda: dome.ShutterStatus == ShutterState.shutterOpen)
    with rain(final):
        until(lambda: not monitor.IsSafe)
        assert weather.RainRate > 0
        until(lambda: dome.ShutterStatus == ShutterState.shutterClosed)
        with pytest.raises(InvalidOperationException):
            dome.OpenShutter()
    until(lambda: monitor.IsSafe)
    final.served.switch("WEATHER_DOME", False)
    until(lambda: not monitor.IsSafe)  # a station that is silent is no good news


def test_the_dew_point_is_that_of_the_tables() -> None:
    """WMO-No. 8: 20 °C at half saturation has 9.3 °C; saturated air has its own temperature."""
    assert dew_point_c(20.0, 0.5) == pytest.approx(9.26, abs=0.05)
    assert dew_point_c(-5.0, 1.0) == pytest.approx(-5.0)
