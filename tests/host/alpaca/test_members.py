"""Members of Alpaca's telescope on wired boards, by ASCOM's texts (ITelescopeV4), without a socket."""

import asyncio
import math
from typing import Any

import pytest

from bus.protocol import Device as Board
from bus.protocol import Opcode
from bus.protocol.scales import rate_q16
from host.alpaca import device as module
from host.alpaca.device import Device
from host.alpaca.observing import dew_point_c
from host.alpaca.requests import AlpacaError, Malformed, Parameters
from host.alpaca.telescope import TelescopeDevice
from host.sky.observed import sidereal_time_rad
from host.sky.tracks import GUIDE_ARCSEC_S
from host.telescope import AsyncDesk, DriveRate
from tests.host.telescope.wired import AXES, CENTRE, Wired, awake

SIDEREAL = 15.041067
REFUSED, VALUE, UNSET, PARKED, STATE = 0x400, 0x401, 0x402, 0x408, 0x40B


def made(parked: bool = False) -> tuple[Wired, TelescopeDevice]:
    wired = Wired() if parked else awake()
    wired.tick(2)
    return wired, TelescopeDevice(AsyncDesk(wired.telescope))


def get(device: Device, name: str, given: str = "") -> Any:
    member = device.members[name.lower()]
    assert member.get is not None
    return member.get(device, Parameters(given, False))


def put(wired: Wired, device: Device, name: str, given: str = "", ticks: int = 600) -> Any:
    """The boards go on meanwhile."""
    act = device.members[name.lower()].put
    assert act is not None

    async def body() -> Any:
        task = asyncio.ensure_future(act(device, Parameters(given, True)))
        for _ in range(ticks):
            await asyncio.sleep(0)
            if task.done():
                break
            wired.tick()
        return await task

    return asyncio.run(body())


def number(wired: Wired, device: Device, name: str, given: str = "") -> int:
    """Of the error that a PUT is answered with."""
    with pytest.raises(AlpacaError) as found:
        put(wired, device, name, given)
    return found.value.number


def test_properties_are_those_of_the_place() -> None:
    wired, device = made()
    wired.steps = [CENTRE + round(2**29 / 24), CENTRE]
    wired.tick()
    about, t_s = wired.observatory, wired.client.now_s
    sidereal = sidereal_time_rad(about.site, about.clock, t_s) * 12 / math.pi
    assert get(device, "SiderealTime") == pytest.approx(sidereal, abs=1e-9)
    assert get(device, "RightAscension") == pytest.approx((sidereal - 1) % 24, abs=1e-2)
    assert get(device, "Declination") == pytest.approx(0.0, abs=0.02)
    height = math.degrees(math.asin(math.cos(about.site.latitude_rad) * math.cos(math.radians(15))))
    assert get(device, "Altitude") == pytest.approx(height, abs=1e-4)
    assert 180 < get(device, "Azimuth") < 270
    assert get(device, "UTCDate") == about.clock.iso(t_s)
    assert [get(device, name) for name in ("AtHome", "AtPark", "IsPulseGuiding", "Slewing", "Tracking")] == [
        False
    ] * 5
    assert get(device, "SiteElevation") == 1950.0 and get(device, "DoesRefraction") is True
    assert (get(device, "SiteLatitude"), get(device, "SiteLongitude")) == pytest.approx((29 + 22 / 60, 79.45))
    state = {each["Name"]: each["Value"] for each in get(device, "DeviceState")}
    assert state["Altitude"] == pytest.approx(height, abs=1e-4) and state["TimeStamp"] == about.clock.iso(t_s)
    assert state["AtPark"] is False and len(state) == 12


def test_before_the_boards_speak_a_place_is_a_drivers_error() -> None:
    wired = Wired()
    device = TelescopeDevice(AsyncDesk(wired.telescope))
    with pytest.raises(AlpacaError, match="the boards have sent nothing yet") as found:
        get(device, "RightAscension")
    assert found.value.number == 0x500
    wired.tick()
    del wired.link.measurements[Board.POSITION_DEC]
    wired.telescope.tick(wired.client.now_ns + 1)
    with pytest.raises(AlpacaError):
        get(device, "Altitude")


def test_a_target_is_unset_until_it_is_set() -> None:
    wired, device = made()
    for name in ("TargetRightAscension", "TargetDeclination"):
        with pytest.raises(AlpacaError, match=f"{name} has not been set") as found:
            get(device, name)
        assert found.value.number == UNSET
    wired.telescope.drive.tracking = True
    wired.tick()
    assert number(wired, device, "SlewToTargetAsync") == UNSET
    put(wired, device, "TargetRightAscension", "TargetRightAscension=5.5")
    assert number(wired, device, "SlewToTargetAsync") == UNSET
    put(wired, device, "TargetDeclination", "TargetDeclination=-90")
    assert (get(device, "TargetRightAscension"), get(device, "TargetDeclination")) == (5.5, -90.0)
    for name, value in (
        ("TargetDeclination", 90.01), ("TargetDeclination", -90.01), ("TargetRightAscension", 24),
        ("TargetRightAscension", -0.01),
    ):  # fmt: skip
        assert number(wired, device, name, f"{name}={value}") == VALUE
    put(wired, device, "TargetRightAscension", "TargetRightAscension=0")
    put(wired, device, "TargetDeclination", "TargetDeclination=90")


def test_guide_rates_are_degrees_a_second() -> None:
    wired, device = made()
    half = GUIDE_ARCSEC_S / 3600
    assert (
        get(device, "GuideRateRightAscension") == get(device, "GuideRateDeclination") == pytest.approx(half)
    )
    put(wired, device, "GuideRateRightAscension", "GuideRateRightAscension=0.001")
    put(wired, device, "GuideRateDeclination", "GuideRateDeclination=0.002")
    assert wired.telescope.paddle.guide_arcsec_s == pytest.approx((3.6, 7.2))
    assert number(wired, device, "GuideRateDeclination", "GuideRateDeclination=0.0022") == VALUE


def test_a_drift_is_in_seconds_of_right_ascension_and_arcseconds() -> None:
    """ASCOM: right ascension grows to the east, and a second is 15.04″."""
    wired, device = made()
    assert (
        get(device, "RightAscensionRate") == 0.0 and math.copysign(1, get(device, "RightAscensionRate")) == 1
    )
    put(wired, device, "RightAscensionRate", "RightAscensionRate=0.1")
    put(wired, device, "DeclinationRate", "DeclinationRate=-2")
    assert wired.telescope.drive.drift_arcsec_s == pytest.approx((-0.1 * SIDEREAL, -2.0))
    assert get(device, "RightAscensionRate") == pytest.approx(0.1)
    assert get(device, "DeclinationRate") == -2.0
    for name, value in (
        ("DeclinationRate", 600.1), ("DeclinationRate", -600.1), ("RightAscensionRate", 39.9),
        ("RightAscensionRate", -39.9),
    ):  # fmt: skip
        assert number(wired, device, name, f"{name}={value}") == VALUE
    put(wired, device, "DeclinationRate", "DeclinationRate=600")
    put(wired, device, "DeclinationRate", "DeclinationRate=-600")
    for rate, known in enumerate(DriveRate):
        put(wired, device, "TrackingRate", f"TrackingRate={rate}")
        assert wired.telescope.drive.drive_rate is known and get(device, "TrackingRate") == rate
        assert wired.telescope.drive.drift_arcsec_s == (0.0, 0.0)
    assert number(wired, device, "DeclinationRate", "DeclinationRate=1") == STATE
    for rate in (-1, 4):
        assert number(wired, device, "TrackingRate", f"TrackingRate={rate}") == VALUE


def test_axes_that_can_be_moved() -> None:
    wired, device = made()
    assert (
        get(device, "AxisRates", "axis=0")
        == [{"Minimum": 0.0, "Maximum": 2.0}]
        == get(device, "AxisRates", "axis=1")
    )
    assert get(device, "AxisRates", "axis=2") == []
    assert [get(device, "CanMoveAxis", f"axis={k}") for k in range(3)] == [True, True, False]
    for name in ("AxisRates", "CanMoveAxis"):
        for axis in (-1, 3):
            with pytest.raises(AlpacaError):
                get(device, name, f"axis={axis}")
    put(wired, device, "MoveAxis", "Axis=0&Rate=-2")
    wired.tick(6)
    assert (AXES[0], Opcode.SET_RATE, rate_q16(-7200.0)) in wired.since()
    put(wired, device, "MoveAxis", "Axis=1&Rate=0.01")
    wired.tick(6)
    assert (AXES[1], Opcode.TRACK_RATE, rate_q16(36.0)) in wired.since()
    put(wired, device, "MoveAxis", "Axis=0&Rate=0")
    assert wired.telescope.paddle.held == {"dec"}
    put(wired, device, "MoveAxis", "Axis=1&Rate=0")
    assert wired.telescope.paddle.held == frozenset()
    for given in ("Axis=2&Rate=1", "Axis=-1&Rate=1", "Axis=0&Rate=2.001", "Axis=0&Rate=-2.001"):
        assert number(wired, device, "MoveAxis", given) == VALUE


def test_a_parked_telescope_says_so_by_its_number() -> None:
    wired, device = made(parked=True)
    assert get(device, "AtPark") is True
    for name, given in (
        ("MoveAxis", "Axis=0&Rate=1"), ("AbortSlew", ""), ("PulseGuide", "Direction=0&Duration=10"),
        ("SlewToCoordinates", "RightAscension=5&Declination=20"), ("SlewToAltAz", "Azimuth=90&Altitude=50"),
        ("Tracking", "Tracking=True"),
    ):  # fmt: skip
        assert number(wired, device, name, given) == PARKED, name
    put(wired, device, "Unpark")
    assert not wired.telescope.drive.parked and wired.telescope.drive.powered
    wired.tick(3)
    wired.since()
    put(wired, device, "Unpark")
    assert wired.since() == []


def test_slews_need_tracking_on_for_the_sky_and_off_for_the_ground() -> None:
    wired, device = made()
    about = wired.observatory
    ra_h = sidereal_time_rad(about.site, about.clock, wired.client.now_s) * 12 / math.pi
    sky = f"RightAscension={ra_h % 24}&Declination=20"
    for name in ("SlewToCoordinates", "SlewToCoordinatesAsync", "SyncToCoordinates"):
        assert number(wired, device, name, sky) == STATE
    assert device.target_ra_h is None
    wired.telescope.drive.tracking = True
    wired.tick()
    for name in ("SlewToAltAz", "SlewToAltAzAsync"):
        assert number(wired, device, name, "Azimuth=90&Altitude=50") == STATE
    put(wired, device, "SlewToCoordinatesAsync", sky)
    wired.tick(8)
    assert (device.target_ra_h, device.target_dec_deg) == pytest.approx((ra_h % 24, 20.0))
    goal = [each[2] for each in wired.since() if each[1] == Opcode.MOVE_TO][:2]
    place = about.apparent(goal[0], goal[1], wired.client.now_s)
    assert math.degrees(place.declination_rad) == pytest.approx(20.0, abs=1e-3)
    assert place.right_ascension_rad * 12 / math.pi == pytest.approx(ra_h % 24, abs=1e-3)
    assert get(device, "Slewing") is True
    for given in (
        "RightAscension=24&Declination=0", "RightAscension=-1&Declination=0",
        "RightAscension=1&Declination=91",
        "RightAscension=1&Declination=-91",
    ):  # fmt: skip
        assert number(wired, device, "SlewToCoordinatesAsync", given) == VALUE
    put(wired, device, "AbortSlew")
    wired.tick(8)
    assert get(device, "Slewing") is False and get(device, "Tracking") is True


def test_a_place_over_the_ground_has_its_bounds() -> None:
    wired, device = made()
    for given in (
        "Azimuth=-0.1&Altitude=50", "Azimuth=360.1&Altitude=50", "Azimuth=90&Altitude=90.1",
        "Azimuth=90&Altitude=-90.1",
    ):  # fmt: skip
        assert number(wired, device, "SlewToAltAzAsync", given) == VALUE
    put(wired, device, "SlewToAltAzAsync", "Azimuth=180&Altitude=50")
    wired.tick(8)
    goal = [each[2] for each in wired.since() if each[1] == Opcode.MOVE_TO][:2]
    place = wired.observatory.observed(*goal)
    assert math.degrees(place.altitude_rad) == pytest.approx(50.0, abs=1e-3)
    assert math.degrees(place.azimuth_rad) == pytest.approx(180.0, abs=1e-3)
    assert number(wired, device, "SlewToAltAzAsync", "Azimuth=180&Altitude=10") == STATE, "below the limit"


@pytest.mark.parametrize(("direction", "axis", "sign"), [(0, 1, 1), (1, 1, -1), (2, 0, -1), (3, 0, 1)])
def test_a_guide_pulse_is_north_south_east_west(direction: int, axis: int, sign: int) -> None:
    wired, device = made()
    put(wired, device, "Tracking", "Tracking=True")
    wired.tick(80)
    told: list[Any] = []
    wired.telescope.paddle.guider.told = told.append
    put(wired, device, "PulseGuide", f"Direction={direction}&Duration=1500")
    assert (told[0].axis, told[0].seconds, told[0].arcsec_s) == (axis, 1.5, sign * GUIDE_ARCSEC_S)
    assert get(device, "IsPulseGuiding") is True
    for given in (
        "Direction=-1&Duration=1", "Direction=4&Duration=1", "Direction=0&Duration=-1",
        "Direction=0&Duration=60001",
    ):  # fmt: skip
        assert number(wired, device, "PulseGuide", given) == VALUE
    put(wired, device, "PulseGuide", f"Direction={direction}&Duration=0")


def test_tracking_and_parking_by_their_methods() -> None:
    wired, device = made()
    put(wired, device, "Tracking", "Tracking=true")
    assert get(device, "Tracking") is True
    put(wired, device, "Tracking", "Tracking=False")
    assert get(device, "Tracking") is False
    wired.steps = [CENTRE + 1000, CENTRE + 2000]
    wired.tick()
    put(wired, device, "SetPark")
    assert wired.observatory.mount.park_steps == pytest.approx((CENTRE + 1000, CENTRE + 2000), abs=1)
    put(wired, device, "Park")
    wired.tick(40)
    assert get(device, "AtPark") is True


def test_actions_go_by_any_case() -> None:
    wired, device = made()
    assert get(device, "SupportedActions") == ["PowerOn", "PowerOff", "EmergencyStop"]
    assert put(wired, device, "Action", "Action=emergencystop&Parameters=") == "ok"
    wired.tick(5)
    assert {(axis, Opcode.STOP) for axis in AXES} <= {*wired.since()}
    assert put(wired, device, "Action", "Action=POWEROFF&Parameters=") == "ok"
    wired.tick(10)
    assert not wired.telescope.snapshot.powered
    assert put(wired, device, "Action", "Action=PowerOn&Parameters=") == "ok"
    wired.tick(10)
    assert wired.telescope.snapshot.powered
    assert number(wired, device, "Action", "Action=Dance&Parameters=") == 0x40C


def test_what_every_device_says_of_itself() -> None:
    wired, device = made()
    assert get(device, "Name") == "Schmidt telescope" and get(device, "InterfaceVersion") == 4
    assert get(device, "Connecting") is False and get(device, "Connected") is False
    put(wired, device, "Connected", "Connected=True")
    assert get(device, "Connected") is True
    put(wired, device, "Disconnect")
    assert get(device, "Connected") is False
    put(wired, device, "Connect")
    assert get(device, "Connected") is True
    put(wired, device, "Connected", "Connected=false")
    assert get(device, "Connected") is False
    for what in ("Blind", "Bool", "String"):
        assert number(wired, device, f"Command{what}", "Command=x&Raw=True") == REFUSED
    for name in ("FindHome", "DoesRefraction", "SiteElevation", "SiteLatitude", "SiteLongitude", "UTCDate"):
        assert number(wired, device, name) == REFUSED
    always = {name for name, member in device.members.items() if member.always}
    assert always == {
        "connected", "connecting", "connect", "disconnect", "description", "driverinfo", "driverversion",
        "interfaceversion", "name", "supportedactions",
    }  # fmt: skip


def test_a_connection_waits_for_the_boards_but_not_for_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    wired = Wired()
    device = TelescopeDevice(AsyncDesk(wired.telescope))
    slept: list[float] = []

    async def sleep(seconds: float) -> None:
        slept.append(seconds)
        if len(slept) == 5:
            wired.tick()

    monkeypatch.setattr(asyncio, "sleep", sleep)
    asyncio.run(module._connect(device, Parameters("", True)))
    assert slept == [0.05] * 5 and device.connected
    silent = TelescopeDevice(AsyncDesk(Wired().telescope))
    slept[:] = [0.0] * 5
    asyncio.run(module._connect(silent, Parameters("", True)))
    assert len(slept) == 65 and silent.connected


def test_a_destination_is_checked_although_there_is_no_pier() -> None:
    _, device = made()
    for given, code in (
        ("RightAscension=24&Declination=0", VALUE), ("RightAscension=1&Declination=90.1", VALUE),
        ("RightAscension=1&Declination=-90.1", VALUE), ("RightAscension=1&Declination=90", REFUSED),
    ):  # fmt: skip
        with pytest.raises(AlpacaError) as found:
            get(device, "DestinationSideOfPier", given)
        assert found.value.number == code


@pytest.mark.parametrize(
    ("air_c", "humidity", "dew_c"), [(20.0, 1.0, 20.0), (20.0, 0.5, 9.26), (0.0, 0.6, -6.78)]
)
def test_a_dew_point_is_that_of_tables(air_c: float, humidity: float, dew_c: float) -> None:
    """Smithsonian Meteorological Tables, to a tenth."""
    assert dew_point_c(air_c, humidity) == pytest.approx(dew_c, abs=0.1)


def test_parameters_are_read_as_the_standard_says() -> None:
    given = Parameters("A=1&b=2.5&C=True&D=x&E=-2147483648&F=2147483648&G=1_0&H=", True)
    assert given.text("H") == "" and given.integer("A") == 1 and given.number("b") == 2.5
    assert given.truth("C") is True and given.integer("E") == -(2**31)
    for read, name in (
        (given.integer, "F"), (given.integer, "b"), (given.integer, "G"), (given.number, "D"),
        (given.truth, "D"), (given.text, "a"), (given.text, "B"), (given.number, "H"),
    ):  # fmt: skip
        with pytest.raises(Malformed):
            read(name)
    loose = Parameters("A=1", False)
    assert loose.text("a") == loose.text("A") == "1"
    assert Parameters("E=2147483647", True).integer("E") == 2**31 - 1
    with pytest.raises(Malformed):
        Parameters("E=-2147483649", True).integer("E")
    with pytest.raises(Malformed, match="has two values"):
        Parameters("a=1&A=2", False)
    assert Parameters("a=1&A=2", True).text("A") == "2" and Parameters("a=1&a=1", True).text("a") == "1"
    with pytest.raises(Malformed):
        Parameters("&".join(f"a{k}=1" for k in range(101)), True)
    assert Parameters("&".join(f"a{k}=1" for k in range(100)), True).text("a99") == "1"


@pytest.mark.parametrize(("text", "value"), [
    ("", 0), ("ClientID=", 0), ("ClientID=%207%20", 7), ("ClientID=4294967295", 2**32 - 1),
    ("ClientID=4294967296", None), ("ClientID=00000000001", None), ("ClientID=-1", None),
    ("ClientID=x", None),
    ("ClientID=%D9%A1", None), ("ClientID=0000000001", 1),
])  # fmt: skip
def test_identifiers_have_32_bits(text: str, value: int | None) -> None:
    if value is not None:
        assert Parameters(text, True).identifier("ClientID") == value
        return
    with pytest.raises(Malformed):
        Parameters(text, True).identifier("ClientID")
