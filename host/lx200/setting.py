"""The `:S…#` commands: `1` when taken, `0` when not."""

import datetime as dt
import math
from collections.abc import Callable

from host.lx200 import angles
from host.lx200.session import Handler, Session
from host.sky.tracks import SIDEREAL_ARCSEC_S
from host.telescope import DriveRate

_SITE_DEG = 0.5
"""A site this far from where the telescope stands is another place, and refused. ASSUMPTION."""
_PLANETARY = "1Updating Planetary Data#" + " " * 30 + "#"
"""Both sections of the answer to `:SC`; drivers wait for the second."""


def _answering(set_it: Callable[[Session, str], None]) -> Handler:
    """`1`, or `0` when the value cannot be read or used."""

    async def handler(session: Session, argument: str) -> str:
        try:
            set_it(session, argument)
        except ValueError as error:
            session.say(f"not set: {error}")
            return "0"
        return "1"

    return handler


def right_ascension(session: Session, argument: str) -> None:
    """`:SrHH:MM:SS#`."""
    hours = angles.parse(argument)
    if not 0 <= hours < 24 or argument.strip().startswith("-"):
        raise ValueError(f"right ascension {argument!r} is outside 0 to 24 h")
    session.target_ra_rad = hours * math.pi / 12


def _degrees(field: str, name: str, low: int, high: int) -> Handler:
    """`:SdsDD*MM:SS#`; `:SzDDD*MM#`, from north through east; `:SasDD*MM#`, with refraction, as the tube
    stands."""

    def set_it(session: Session, argument: str) -> None:
        degrees = angles.parse(argument)
        if not low <= degrees <= high:
            raise ValueError(f"{name} {argument!r} is outside {low} to {high}")
        setattr(session, field, math.radians(degrees))

    return _answering(set_it)


def longitude(session: Session, argument: str) -> None:
    """`:Sg`, west positive, 0 to 360 or signed; the telescope stands where it stands."""
    west = angles.parse(argument)
    here = -math.degrees(session.telescope.observatory.site.longitude_rad)
    if abs(west) > 360 or abs(math.remainder(west - here, 360)) > _SITE_DEG:
        raise ValueError(f"longitude {argument!r}: the telescope stands {here % 360:.2f} deg west")


def latitude(session: Session, argument: str) -> None:
    """`:St`, north positive; the telescope stands where it stands."""
    here = math.degrees(session.telescope.observatory.site.latitude_rad)
    if abs(angles.parse(argument) - here) > _SITE_DEG:
        raise ValueError(f"latitude {argument!r}: the telescope stands {here:.2f} deg north")


def utc_offset(session: Session, argument: str) -> None:
    """`:SGsHH.H#`, hours to add to local time for UTC."""
    hours = float(argument)
    if not -14 <= hours <= 14:
        raise ValueError(f"UTC offset {argument!r} is outside -14 to 14 h")
    session.box.utc_offset_h = hours


def local_time(session: Session, argument: str) -> None:
    """`:SLHH:MM:SS#`."""
    session.box.set_time(session.now.t_s, dt.datetime.strptime(argument.strip(), "%H:%M:%S").time())


async def local_date(session: Session, argument: str) -> str:
    """`:SCMM/DD/YY#`, answered in two sections."""
    try:
        date = dt.datetime.strptime(argument.strip(), "%m/%d/%y").date()
    except ValueError as error:
        session.say(f"date not set: {error}")
        return "0"
    session.box.set_date(session.now.t_s, date)
    return _PLANETARY


async def frequency(session: Session, argument: str) -> str:
    """`:STnn.n#`, Hz: the rate of hour angle in proportion, 60.1 being sidereal."""
    try:
        hertz = float(argument)
    except ValueError:
        return "0"
    if not 56.4 <= hertz <= 62.0:
        return "0"
    session.box.frequency_hz = hertz
    extra = (hertz / 60.1 - 1) * SIDEREAL_ARCSEC_S
    await session.act(lambda t: t.drive.set_rates(DriveRate.SIDEREAL, (extra, 0.0)))
    return "1"


def _name(index: int) -> Handler:
    def keep(session: Session, argument: str) -> None:
        session.box.site_names[index] = argument[:15]

    return _answering(keep)


def _taken(_session: Session, argument: str) -> None:
    """Limits of brightness, size and altitude of a catalogue that is not here: taken, without effect."""
    float(argument.strip().rstrip("'*"))


SETTING: dict[str, Handler] = {
    "Sr": _answering(right_ascension), "Sd": _degrees("target_dec_rad", "declination", -90, 90),
    "Sz": _degrees("target_az_rad", "azimuth", 0, 360),
    "Sa": _degrees("target_alt_rad", "altitude", -90, 90), "Sg": _answering(longitude),
    "St": _answering(latitude), "SG": _answering(utc_offset), "SL": _answering(local_time),
    "SC": local_date, "ST": frequency, "SM": _name(0), "SN": _name(1), "SO": _name(2), "SP": _name(3),
    "So": _answering(_taken), "Sh": _answering(_taken), "Sw": _answering(_taken),
}  # fmt: skip
"""Command letters to handlers."""
