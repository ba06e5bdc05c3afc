"""The `:G…#` commands and what else only looks: answers come from the last snapshot."""

import importlib.metadata
from collections.abc import Callable

from host.lx200 import angles
from host.lx200.session import Handler, Session
from host.sky.observed import Observed, Place, sidereal_time_rad

Encoders = tuple[int, int, float]
_SLEWING = "\x7f"
"""The bar of Meade's `:D#`: one is enough, INDI looks for anything before the `#`."""


def _points(read: Callable[[Session, Encoders], str]) -> Handler:
    async def answer(session: Session, _: str) -> str:
        return read(session, await session.desk.encoders()) + "#"

    return answer


def _place(session: Session, at: Encoders) -> Place:
    """Apparent place of date."""
    return session.telescope.observatory.apparent(*at)


def _seen(session: Session, at: Encoders) -> Observed:
    """With refraction, as the tube stands; azimuth from north through east."""
    return session.telescope.observatory.observed(*at[:2])


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
    "GR": _points(lambda s, at: angles.hours(_place(s, at).right_ascension_rad, s.precise)),
    "GD": _points(lambda s, at: angles.signed(_place(s, at).declination_rad, s.precise)),
    "GA": _points(lambda s, at: angles.signed(_seen(s, at).altitude_rad, s.precise, "'")),
    "GZ": _points(lambda s, at: angles.unsigned(_seen(s, at).azimuth_rad, s.precise, "'")),
    **{letters: _says(read) for letters, read in _READ.items()},
}  # fmt: skip
"""Command letters to handlers."""
