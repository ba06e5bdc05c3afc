"""alpyca, ASCOM's own Python client, drives telescope and focuser; refused cases included."""

from collections.abc import Callable
from time import monotonic, sleep

import pytest
from alpaca import discovery, management
from alpaca.exceptions import (
    InvalidOperationException,
    InvalidValueException,
    NotConnectedException,
    NotImplementedException,
    ParkedException,
    ValueNotSetException,
)
from alpaca.focuser import Focuser
from alpaca.telescope import DriveRates, GuideDirections, Telescope, TelescopeAxes

from tests.host.alpaca.conftest import AlpacaLive


def until(condition: Callable[[], bool], limit_s: float = 60.0) -> None:
    end = monotonic() + limit_s
    while not condition():
        assert monotonic() < end
        sleep(0.05)


@pytest.mark.slow
def test_discovery_finds_the_server_and_its_devices(live: AlpacaLive) -> None:
    assert live.address in discovery.search_ipv4()  # as patient as the client is by itself
    devices = management.configureddevices(live.address)
    assert sorted(device["DeviceType"] for device in devices) == ["Camera", "Camera", "Focuser", "Telescope"]
    assert management.apiversions(live.address) == [1]
    assert management.description(live.address)["ServerName"] == "schmidt"


@pytest.mark.slow
def test_connect_slew_read_back_abort_park(live: AlpacaLive) -> None:
    telescope = Telescope(live.address, 0)
    telescope.Disconnect()
    with pytest.raises(NotConnectedException):
        _ = telescope.RightAscension
    telescope.Connect()
    until(lambda: not telescope.Connecting)
    assert telescope.Connected and telescope.InterfaceVersion == 4

    assert telescope.AtPark
    for move in (
        lambda: telescope.SlewToCoordinatesAsync(telescope.SiderealTime, 20.0),
        lambda: setattr(telescope, "Tracking", True),
        lambda: telescope.MoveAxis(TelescopeAxes.axisPrimary, 1.0),
        lambda: telescope.PulseGuide(GuideDirections.guideNorth, 100),
        telescope.AbortSlew,
    ):
        with pytest.raises(ParkedException):
            move()
    with pytest.raises(ValueNotSetException):
        _ = telescope.TargetDeclination
    telescope.Unpark()
    until(lambda: not telescope.AtPark)
    with pytest.raises(InvalidOperationException):
        telescope.SlewToCoordinatesAsync(telescope.SiderealTime, 20.0)
    telescope.Tracking = True
    assert telescope.Tracking

    ra, dec = (telescope.SiderealTime + 0.5) % 24, 22.5
    telescope.SlewToCoordinatesAsync(ra, dec)
    assert telescope.Slewing
    until(lambda: not telescope.Slewing)
    off = max(abs(telescope.RightAscension - ra) * 15, abs(telescope.Declination - dec)) * 3600
    print(f"read back {off:.2f} arcsec off")
    assert off <= 10
    assert telescope.TargetRightAscension == pytest.approx(ra) and telescope.TargetDeclination == dec

    telescope.SyncToCoordinates(ra, dec + 0.01)
    assert telescope.Declination == pytest.approx(dec + 0.01, abs=10 / 3600)
    with pytest.raises(InvalidOperationException):  # below the horizon
        telescope.SlewToCoordinatesAsync((telescope.SiderealTime + 12) % 24, -40.0)
    with pytest.raises(InvalidValueException):
        telescope.SlewToCoordinatesAsync(24.5, 0.0)
    with pytest.raises(InvalidOperationException):
        telescope.SlewToAltAzAsync(180.0, 60.0)  # while tracking

    telescope.PulseGuide(GuideDirections.guideNorth, 5000)
    assert telescope.IsPulseGuiding
    until(lambda: not telescope.IsPulseGuiding)
    telescope.TrackingRate = DriveRates.driveLunar
    assert telescope.TrackingRate == DriveRates.driveLunar
    with pytest.raises(InvalidOperationException):
        telescope.RightAscensionRate = 0.1
    telescope.TrackingRate = DriveRates.driveSidereal
    telescope.RightAscensionRate = 0.05
    telescope.DeclinationRate = -0.2
    assert telescope.RightAscensionRate == pytest.approx(0.05)
    assert telescope.DeclinationRate == pytest.approx(-0.2)
    telescope.RightAscensionRate = 0.0
    telescope.DeclinationRate = 0.0

    telescope.SlewToCoordinatesAsync((ra + 2.0) % 24, -10.0)
    sleep(0.2)
    telescope.AbortSlew()
    until(lambda: not telescope.Slewing)
    assert telescope.Declination > -5 and telescope.Tracking

    telescope.Tracking = False
    before = telescope.Declination
    telescope.MoveAxis(TelescopeAxes.axisSecondary, 1.0)
    assert telescope.Slewing
    sleep(0.3)
    telescope.MoveAxis(TelescopeAxes.axisSecondary, 0.0)
    until(lambda: not telescope.Slewing)
    assert telescope.Declination - before > 0.5
    telescope.SlewToAltAzAsync(180.0, 70.0)
    until(lambda: not telescope.Slewing)
    assert telescope.Altitude == pytest.approx(70.0, abs=20 / 3600)
    assert telescope.Azimuth == pytest.approx(180.0, abs=60 / 3600)
    assert telescope.AxisRates(TelescopeAxes.axisPrimary)[0].Maximum == 2.0
    with pytest.raises(NotImplementedException):
        telescope.FindHome()

    telescope.Park()
    until(lambda: telescope.AtPark)
    assert not telescope.Slewing and not telescope.Tracking
    telescope.Disconnect()


def test_focuser(live: AlpacaLive) -> None:
    focuser = Focuser(live.address, 0)
    with pytest.raises(NotConnectedException):
        _ = focuser.Position
    focuser.Connected = True
    assert focuser.Absolute and focuser.MaxStep == 1600 and focuser.StepSize == 6.25
    focuser.Action("Reference", "")
    until(lambda: not focuser.IsMoving)
    focuser.Move(850)
    assert focuser.IsMoving
    until(lambda: not focuser.IsMoving)
    assert focuser.Position == 850
    live.speed = 1.0  # so that a fast machine is not there before it is halted
    focuser.Move(100)
    until(lambda: focuser.Position < 850)
    focuser.Halt()
    live.speed = 30.0
    until(lambda: not focuser.IsMoving)
    assert 100 < focuser.Position < 850
    for wrong in (-1, 1601):
        with pytest.raises(InvalidValueException):
            focuser.Move(wrong)
    with pytest.raises(NotImplementedException):
        _ = focuser.Temperature
    with pytest.raises(NotImplementedException):
        focuser.TempComp = True
    focuser.Action("Free", "")
    sleep(0.2)
    with pytest.raises(InvalidOperationException):
        focuser.Move(800)
    focuser.Action("Hold", "")
    focuser.Disconnect()
