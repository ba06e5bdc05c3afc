"""ITelescopeV4: properties, and which members there are. What moves is in `slewing.py`."""

import math
from collections.abc import Callable

from host.alpaca import slewing
from host.alpaca.device import Get, Member, Put, does, fixed, missing, missing_put, of, table, unknown
from host.alpaca.requests import INVALID_OPERATION, VALUE_NOT_SET, AlpacaError, Parameters, within
from host.sky.observed import Observed, Place, sidereal_time_rad
from host.sky.tracks import SIDEREAL_ARCSEC_S
from host.telescope import DriveRate, Observatory

RATES = tuple(DriveRate)
"""By ASCOM's number."""
_SECONDS_RA_PER_ARCSEC = 1 / SIDEREAL_ARCSEC_S
"""ASCOM's RightAscensionRate counts seconds of right ascension per sidereal second."""


class TelescopeDevice(slewing.SlewingDevice):
    """Equatorial coordinates are apparent places of date (`equTopocentric`); azimuth: N through E."""

    kind = "telescope"
    interface_version = 4
    description = "50/80 cm Schmidt telescope, two axes, equatorial"
    unique_id = "8ad6c6f4-0b0e-4f0b-9c52-5c1d5f1d0001"
    actions = {  # noqa: RUF012
        "PowerOn": lambda telescope: telescope.drive.power_on(),
        "PowerOff": lambda telescope: telescope.drive.power_off(),
        "EmergencyStop": lambda telescope: telescope.emergency_stop(),
    }

    @property
    def about(self) -> Observatory:
        """Site, clock and mount."""
        return self.desk.telescope.observatory

    @property
    def steps(self) -> tuple[int, int]:
        """Readings of both encoders."""
        ra, dec = self.now.ra.steps, self.now.dec.steps
        if ra is None or dec is None:
            raise unknown()
        return ra, dec

    def place(self) -> Place:
        """Where it points, apparent."""
        return self.about.apparent(*self.steps, self.now.ra.latched_s)

    def observed(self) -> Observed:
        """Where it points over the ground."""
        return self.about.observed(*self.steps)

    def sidereal_h(self) -> float:
        """Local apparent sidereal time."""
        return sidereal_time_rad(self.about.site, self.about.clock, self.now.t_s) * 12 / math.pi

    def state(self) -> dict[str, object]:
        """Operational properties."""
        return {name: read(self) for name, read in _STATE.items()}


_STATE: dict[str, Callable[[TelescopeDevice], object]] = {
    "Altitude": lambda device: math.degrees(device.observed().altitude_rad),
    "AtHome": lambda _: False,
    "AtPark": lambda device: device.now.parked,
    "Azimuth": lambda device: math.degrees(device.observed().azimuth_rad) % 360,
    "Declination": lambda device: math.degrees(device.place().declination_rad),
    "IsPulseGuiding": lambda device: device.now.pulse_guiding,
    "RightAscension": lambda device: device.place().right_ascension_rad * 12 / math.pi,
    "SiderealTime": lambda device: device.sidereal_h(),
    "Slewing": lambda device: device.now.slewing,
    "Tracking": lambda device: device.now.tracking,
    "UTCDate": lambda device: device.about.clock.iso(device.now.t_s),
}
"""What DeviceState tells, each of which is a property, too."""


def _target(attribute: str, name: str) -> Get:
    def get(device: TelescopeDevice, _: Parameters) -> float:
        value = getattr(device, attribute)
        if value is None:
            raise AlpacaError(VALUE_NOT_SET, f"{name} has not been set")
        return float(value)

    return get


def _set_target_ra(device: TelescopeDevice, given: Parameters) -> None:
    value = given.number("TargetRightAscension")
    device.target_ra_h = slewing.right_ascension_h(value)


def _set_target_dec(device: TelescopeDevice, given: Parameters) -> None:
    value = given.number("TargetDeclination")
    device.target_dec_deg = within("TargetDeclination", value, -90, 90)


def _guide(index: int) -> Get:
    return lambda device, _: device.desk.telescope.paddle.guide_arcsec_s[index] / 3600


def _set_guide(index: int, name: str) -> Put:
    async def put(device: TelescopeDevice, given: Parameters) -> None:
        rates = list(device.desk.telescope.paddle.guide_arcsec_s)
        rates[index] = given.number(name) * 3600
        await device.do(lambda t: t.paddle.set_guide_rates(rates[0], rates[1]))

    return put


def _drift(index: int) -> Get:
    scale = -_SECONDS_RA_PER_ARCSEC if index == 0 else 1.0
    return lambda device, _: device.desk.telescope.drive.drift_arcsec_s[index] * scale + 0.0


def _set_drift(index: int, name: str) -> Put:
    async def put(device: TelescopeDevice, given: Parameters) -> None:
        drive = device.desk.telescope.drive
        if drive.drive_rate is not DriveRate.SIDEREAL:
            raise AlpacaError(INVALID_OPERATION, f"{name} needs the sidereal tracking rate")
        value = given.number(name)
        arcsec_s = -value / _SECONDS_RA_PER_ARCSEC if index == 0 else value
        within(name, arcsec_s, -600, 600)
        drift = list(drive.drift_arcsec_s)
        drift[index] = arcsec_s
        await device.do(lambda t: t.drive.set_rates(drift_arcsec_s=(drift[0], drift[1])))

    return put


async def _set_rate(device: TelescopeDevice, given: Parameters) -> None:
    number = int(within("TrackingRate", given.integer("TrackingRate"), 0, len(RATES) - 1))
    await device.do(lambda t: t.drive.set_rates(RATES[number], (0.0, 0.0)))


async def _set_tracking(device: TelescopeDevice, given: Parameters) -> None:
    on = given.truth("Tracking")
    await device.do(lambda t: t.drive.track(on))


def _axis_rates(_device: TelescopeDevice, given: Parameters) -> list[dict[str, float]]:
    axis = within("Axis", given.integer("Axis"), 0, 2)
    return [] if axis == 2 else [{"Minimum": 0.0, "Maximum": slewing.FASTEST_DEG_S}]


def _side(_device: TelescopeDevice, given: Parameters) -> None:
    slewing.right_ascension_h(given.number("RightAscension"))
    within("Declination", given.number("Declination"), -90, 90)
    missing("DestinationSideOfPier")(_device, given)


_FIXED = missing_put("moving the telescope")

TelescopeDevice.members = table(
    "telescope",
    *(Member(name, of(_STATE[name])) for name in (
        "Altitude", "AtHome", "AtPark", "Azimuth", "Declination", "IsPulseGuiding", "RightAscension",
        "SiderealTime", "Slewing")),
    Member("AxisRates", _axis_rates),
    Member("CanMoveAxis", lambda _, given: within("Axis", given.integer("Axis"), 0, 2) < 2),
    Member("DeclinationRate", _drift(1), _set_drift(1, "DeclinationRate")),
    Member("DestinationSideOfPier", _side),
    Member("DoesRefraction", fixed(True), missing_put("switching refraction off")),
    Member("GuideRateDeclination", _guide(1), _set_guide(1, "GuideRateDeclination")),
    Member("GuideRateRightAscension", _guide(0), _set_guide(0, "GuideRateRightAscension")),
    Member("RightAscensionRate", _drift(0), _set_drift(0, "RightAscensionRate")),
    Member("SiteElevation", of(lambda d: d.about.site.height_m), _FIXED),
    Member("SiteLatitude", of(lambda d: math.degrees(d.about.site.latitude_rad)), _FIXED),
    Member("SiteLongitude", of(lambda d: math.degrees(d.about.site.longitude_rad)), _FIXED),
    Member("TargetDeclination", _target("target_dec_deg", "TargetDeclination"), does(_set_target_dec)),
    Member("TargetRightAscension", _target("target_ra_h", "TargetRightAscension"), does(_set_target_ra)),
    Member("Tracking", of(_STATE["Tracking"]), _set_tracking),
    Member("TrackingRate", lambda device, _: RATES.index(device.desk.telescope.drive.drive_rate), _set_rate),
    Member("UTCDate", of(_STATE["UTCDate"]), missing_put("setting the clock")),
    *slewing.MEMBERS,
)  # fmt: skip
