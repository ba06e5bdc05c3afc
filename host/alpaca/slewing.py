"""The methods of ITelescopeV4 that move the telescope, or say where it points."""

import math
from collections.abc import Callable

from host.alpaca.device import Device, Member, Put
from host.alpaca.requests import (
    INVALID_OPERATION,
    INVALID_VALUE,
    PARKED,
    VALUE_NOT_SET,
    AlpacaError,
    Parameters,
    within,
)
from host.sky.catalogue import Star
from host.sky.observed import Place, star_of_apparent
from host.telescope import Job, Telescope
from host.telescope.paddle import FASTEST_ARCSEC_S

FASTEST_DEG_S = FASTEST_ARCSEC_S / 3600
_AXES = ("ra", "dec")
_DIRECTIONS = "nsew"
"""By ASCOM's GuideDirections."""
_LONGEST_PULSE_MS = 60_000


class SlewingDevice(Device):
    """What slews aim at; None: nobody has set it."""

    target_ra_h: float | None = None
    target_dec_deg: float | None = None


Where = Callable[[SlewingDevice, Parameters], Star]
Goto = Callable[[Telescope], Job[None]]
Way = Callable[[SlewingDevice, Parameters], Goto]


def right_ascension_h(value: float) -> float:
    """0 to 24 hours, 24 itself excluded."""
    if not 0 <= value < 24:
        raise AlpacaError(INVALID_VALUE, f"right ascension {value:g} h is outside 0 to 24 h")
    return value


def _star(device: SlewingDevice, ra_h: float, dec_deg: float) -> Star:
    place = Place(
        right_ascension_h(ra_h) * math.pi / 12, math.radians(within("Declination", dec_deg, -90, 90))
    )
    about = device.desk.telescope.observatory
    return star_of_apparent(place, about.clock, device.now.t_s, "Alpaca target")


def _coordinates(device: SlewingDevice, given: Parameters) -> Star:
    ra_h, dec_deg = given.number("RightAscension"), given.number("Declination")
    star = _star(device, ra_h, dec_deg)
    _must_track(device, True)
    device.target_ra_h, device.target_dec_deg = ra_h, dec_deg
    return star


def _target(device: SlewingDevice, _: Parameters) -> Star:
    if device.target_ra_h is None or device.target_dec_deg is None:
        raise AlpacaError(VALUE_NOT_SET, "TargetRightAscension and TargetDeclination have not been set")
    star = _star(device, device.target_ra_h, device.target_dec_deg)
    _must_track(device, True)
    return star


def _unparked(device: Device) -> None:
    if device.now.parked:
        raise AlpacaError(PARKED, "the telescope is parked")


def _must_track(device: SlewingDevice, on: bool) -> None:
    """Slews to the sky need tracking, slews to the ground need it off, none happens while parked."""
    _unparked(device)
    if device.now.tracking is not on:
        raise AlpacaError(INVALID_OPERATION, f"tracking has to be {'on' if on else 'off'} for this")


def _sky(where: Where) -> Way:
    """To a place in the sky."""

    def way(device: SlewingDevice, given: Parameters) -> Goto:
        star = where(device, given)
        return lambda t: t.drive.goto(star)

    return way


def _ground(device: SlewingDevice, given: Parameters) -> Goto:
    """To a place over the ground."""
    azimuth_rad = math.radians(within("Azimuth", given.number("Azimuth"), 0, 360))
    altitude_rad = math.radians(within("Altitude", given.number("Altitude"), -90, 90))
    _must_track(device, False)
    return lambda t: t.drive.goto_altaz(azimuth_rad, altitude_rad)


def _slew(name: str, way: Way) -> tuple[Member, Member]:
    """The two methods that take the telescope there: one answers when it has arrived, the other at once."""
    return (
        Member(name, put=lambda device, given: device.run(way(device, given))),
        Member(f"{name}Async", put=lambda device, given: device.do(way(device, given))),
    )


def _sync(where: Where) -> Put:
    """The telescope points there."""

    async def put(device: SlewingDevice, given: Parameters) -> None:
        star = where(device, given)
        await device.do(lambda t: t.drive.sync(star))

    return put


async def _abort(device: SlewingDevice, _: Parameters) -> None:
    _unparked(device)
    await device.do(lambda t: t.drive.abort())


async def _unpark(device: SlewingDevice, _: Parameters) -> None:
    if device.now.parked:
        await device.run(lambda t: t.drive.power_on())


async def _move_axis(device: SlewingDevice, given: Parameters) -> None:
    """Axis 0: hour angle, positive west; axis 1: declination. Rates in °/s; 0 lets go."""
    axis = int(within("Axis", given.integer("Axis"), 0, 1))
    rate = within("Rate", given.number("Rate"), -FASTEST_DEG_S, FASTEST_DEG_S)
    _unparked(device)
    if rate:
        await device.do(lambda t: t.paddle.move(_AXES[axis], rate * 3600))
    else:
        await device.do(lambda t: t.paddle.release(_AXES[axis]))


async def pulse(device: Device, given: Parameters) -> None:
    """PulseGuide, of a telescope or a camera."""
    direction = int(within("Direction", given.integer("Direction"), 0, 3))
    milliseconds = within("Duration", given.integer("Duration"), 0, _LONGEST_PULSE_MS)
    _unparked(device)
    await device.do(lambda t: t.paddle.pulse(_DIRECTIONS[direction], milliseconds / 1000))


MEMBERS = (
    Member("AbortSlew", put=_abort),
    Member("MoveAxis", put=_move_axis),
    Member("Park", put=lambda device, _: device.do(lambda t: t.drive.park())),
    Member("PulseGuide", put=pulse),
    Member("SetPark", put=lambda device, _: device.do(lambda t: t.drive.set_park())),
    *_slew("SlewToAltAz", _ground),
    *_slew("SlewToCoordinates", _sky(_coordinates)),
    *_slew("SlewToTarget", _sky(_target)),
    Member("SyncToCoordinates", put=_sync(_coordinates)),
    Member("SyncToTarget", put=_sync(_target)),
    Member("Unpark", put=_unpark),
)
