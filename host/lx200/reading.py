"""The `:G…#` commands and what else only looks: answers come from the last snapshot."""

import importlib.metadata
from collections.abc import Callable

from host.lx200 import angles
from host.lx200.session import Handler, Session
from host.sky.apparent import sidereal_time_rad
from host.sky.observed import Observed

_SLEWING = "\x7f"
"""The bar of Meade's `:D#`: one is enough, INDI looks for anything before the `#`."""


async def right_ascension(session: Session, _: str) -> str:
    """`:GR#`, apparent place of date."""
    place = await session.place()
    return angles.hours(place.right_ascension_rad, session.precise) + "#"


async def declination(session: Session, _: str) -> str:
    """`:GD#`, apparent place of date."""
    place = await session.place()
    return angles.signed(place.declination_rad, session.precise) + "#"


async def altitude(session: Session, _: str) -> str:
    """`:GA#`, with refraction, as the tube stands."""
    return angles.signed((await _observed(session)).altitude_rad, session.precise, "'") + "#"


async def azimuth(session: Session, _: str) -> str:
    """`:GZ#`, from north through east."""
    return angles.unsigned((await _observed(session)).azimuth_rad, session.precise, "'") + "#"


async def _observed(session: Session) -> Observed:
    ra, dec, _ = await session.desk.encoders()
    return session.telescope.observatory.observed(ra, dec)


def _says(read: Callable[[Session], str]) -> Handler:
    async def answer(session: Session, _: str) -> str:
        return read(session) + "#"

    return answer


def _sidereal_time(session: Session) -> str:
    about = session.telescope.observatory
    return angles.hours(sidereal_time_rad(about.site, about.clock, session.now.t_s))


_VERSION = importlib.metadata.version("schmidt")
_READ: dict[str, Callable[[Session], str]] = {
    # the target
    "Gr": lambda s: angles.hours(s.target_ra_rad or 0.0, s.precise),
    "Gd": lambda s: angles.signed(s.target_dec_rad or 0.0, s.precise),
    # a bar while slewing, parking or moved by hand; nothing but `#` when the target is reached
    "D": lambda s: _SLEWING if s.now.slewing else "",
    # the site: latitude; longitude, west positive, 0 to 360; names
    "Gt": lambda s: angles.signed(s.telescope.observatory.site.latitude_rad, precise=False),
    "Gg": lambda s: angles.unsigned(-s.telescope.observatory.site.longitude_rad, precise=False),
    "GM": lambda s: s.box.site_names[0],
    "GN": lambda s: s.box.site_names[1],
    "GO": lambda s: s.box.site_names[2],
    "GP": lambda s: s.box.site_names[3],
    # time: local apparent sidereal; format; hours to add to local time for UTC; local time and date
    "GS": _sidereal_time,
    "Gc": lambda _: "24",
    "GG": lambda s: f"{s.box.utc_offset_h:+05.1f}",
    "GL": lambda s: s.box.local(s.now.t_s).strftime("%H:%M:%S"),
    "GC": lambda s: s.box.local(s.now.t_s).strftime("%m/%d/%y"),
    # frequency, Hz; polar mount, tracking or not, aligned
    "GT": lambda s: f"{s.box.frequency_hz:.1f}",
    "GW": lambda s: f"P{'T' if s.now.tracking else 'N'}1",
    # product, version, its date and time
    "GVP": lambda _: "schmidt",
    "GVN": lambda _: _VERSION,
    "GVD": lambda _: "Nov 22 2026",
    "GVT": lambda _: "00:00:00",
    "GVF": lambda _: f"schmidt {_VERSION}",
}
READING: dict[str, Handler] = {
    "GR": right_ascension, "GD": declination, "GA": altitude, "GZ": azimuth,
    **{letters: _says(read) for letters, read in _READ.items()},
}  # fmt: skip
"""Command letters to handlers."""
