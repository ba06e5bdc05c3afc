"""The `:G…#` commands and what else only looks: answers come from the last snapshot."""

import importlib.metadata

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


async def target_right_ascension(session: Session, _: str) -> str:
    """`:Gr#`."""
    return angles.hours(session.target_ra_rad or 0.0, session.precise) + "#"


async def target_declination(session: Session, _: str) -> str:
    """`:Gd#`."""
    return angles.signed(session.target_dec_rad or 0.0, session.precise) + "#"


async def altitude(session: Session, _: str) -> str:
    """`:GA#`, with refraction, as the tube stands."""
    return angles.signed((await _observed(session)).altitude_rad, session.precise, "'") + "#"


async def azimuth(session: Session, _: str) -> str:
    """`:GZ#`, from north through east."""
    return angles.unsigned((await _observed(session)).azimuth_rad, session.precise, "'") + "#"


async def _observed(session: Session) -> Observed:
    ra, dec, _ = await session.desk.encoders()
    return session.telescope.observatory.observed(ra, dec)


async def sidereal_time(session: Session, _: str) -> str:
    """`:GS#`, local apparent."""
    about = session.telescope.observatory
    return angles.hours(sidereal_time_rad(about.site, about.clock, session.now.t_s)) + "#"


async def slewing(session: Session, _: str) -> str:
    """`:D#`: a bar while slewing, parking or moved by hand; nothing but `#` when the target is reached."""
    return (_SLEWING if session.now.slewing else "") + "#"


async def latitude(session: Session, _: str) -> str:
    """`:Gt#`."""
    return angles.signed(session.telescope.observatory.site.latitude_rad, precise=False) + "#"


async def longitude(session: Session, _: str) -> str:
    """`:Gg#`, west positive, 0 to 360."""
    return angles.unsigned(-session.telescope.observatory.site.longitude_rad, precise=False) + "#"


async def clock_format(_session: Session, _: str) -> str:
    """`:Gc#`."""
    return "24#"


async def utc_offset(session: Session, _: str) -> str:
    """`:GG#`, hours to add to local time for UTC."""
    return f"{session.box.utc_offset_h:+05.1f}#"


async def local_time(session: Session, _: str) -> str:
    """`:GL#`."""
    return session.box.local(session.now.t_s).strftime("%H:%M:%S#")


async def local_date(session: Session, _: str) -> str:
    """`:GC#`."""
    return session.box.local(session.now.t_s).strftime("%m/%d/%y#")


async def frequency(session: Session, _: str) -> str:
    """`:GT#`, Hz."""
    return f"{session.box.frequency_hz:.1f}#"


async def alignment(session: Session, _: str) -> str:
    """`:GW#`: polar mount, tracking or not, aligned."""
    return f"P{'T' if session.now.tracking else 'N'}1#"


def _site(index: int) -> Handler:
    async def name(session: Session, _: str) -> str:
        return session.box.site_names[index] + "#"

    return name


def _text(text: str) -> Handler:
    async def fixed(_session: Session, _: str) -> str:
        return text + "#"

    return fixed


_VERSION = importlib.metadata.version("schmidt")
READING: dict[str, Handler] = {
    "GR": right_ascension, "GD": declination, "Gr": target_right_ascension, "Gd": target_declination,
    "GA": altitude, "GZ": azimuth, "GS": sidereal_time, "D": slewing, "Gt": latitude, "Gg": longitude,
    "Gc": clock_format, "GG": utc_offset, "GL": local_time, "GC": local_date, "GT": frequency,
    "GW": alignment, "GM": _site(0), "GN": _site(1), "GO": _site(2), "GP": _site(3),
    "GVP": _text("schmidt"), "GVN": _text(_VERSION), "GVD": _text("Nov 22 2026"), "GVT": _text("00:00:00"),
    "GVF": _text(f"schmidt {_VERSION}"),
}  # fmt: skip
"""Command letters to handlers."""
