"""The commands that move: slew, stop, keys, pulses, tracking, park, sync, focus."""

from collections.abc import Callable

from bus.protocol import SpeedClass
from host.lx200.session import FREQUENCIES, Handler, Session
from host.sky.catalogue import Star
from host.sky.observed import star_of_apparent
from host.telescope import DriveRate, Reason, Telescope

_KEYS = {"R" + letter: speed for letter, speed in zip(
    "SMCG", (SpeedClass.SLEW, SpeedClass.SET, SpeedClass.GUIDE, SpeedClass.FINE), strict=True)}  # fmt: skip
"""Slew, find, centre, guide: from the fastest key to the slowest."""
_MATCHED = "Coordinates     matched.        #"


async def slew(session: Session, _: str) -> str:
    """`:MS#`: `0`, or `1<text>#` below the horizon, `2<text>#` for whatever else is in the way; one piece."""
    try:
        star = _target(session)
    except ValueError as error:
        return f"2{error}#"
    refusal = await session.act(lambda t: t.drive.goto(star, wake=True))
    if refusal is None:
        return "0"
    return f"{'1' if refusal.reason is Reason.BELOW_HORIZON else '2'}{_plain(str(refusal))}#"


async def slew_ground(session: Session, _: str) -> str:
    """`:MA#`: to `:Sz` and `:Sa` over the ground, and stand there; `0`, or `1` for whatever is in the way."""
    azimuth, altitude = session.target_az_rad, session.target_alt_rad
    if azimuth is None or altitude is None:
        session.say("no azimuth and altitude have been set")
        return "1"
    refusal = await session.act(lambda t: t.drive.goto_altaz(azimuth, altitude, wake=True))
    return "0" if refusal is None else "1"


async def sync(session: Session, _: str) -> str:
    """`:CM#`: the telescope points at the target."""
    try:
        star = _target(session)
        await session.desk.do(lambda t: t.drive.sync(star))
    except ValueError as error:
        session.say(f"sync: {error}")
        return _plain(f"not matched: {error}") + "#"
    return _MATCHED


def _target(session: Session) -> Star:
    clock, t_s = session.telescope.observatory.clock, session.now.t_s
    return star_of_apparent(session.target(), clock, t_s, "LX200 target")


def _plain(text: str) -> str:
    """Nothing that ends an answer or is no ASCII."""
    for mark, word in (("°", "d"), ("′", "m"), ("″", "s"), ("−", "-"), ("#", "")):
        text = text.replace(mark, word)
    return text.encode("ascii", "replace").decode("ascii")


async def precision(session: Session, _: str) -> str:
    """`:U#` toggles between seconds and tenths of a minute."""
    session.precise = session.box.precise = not session.precise
    return ""


async def pulse(session: Session, argument: str) -> str:
    """`:Mgn2000#`, ms."""
    direction, milliseconds = argument[:1], argument[1:]
    if milliseconds.isascii() and milliseconds.isdigit():
        await session.act(lambda t: t.paddle.pulse(direction, int(milliseconds) / 1000))
    return ""


async def nothing(_session: Session, _: str) -> str:
    """Understood, without an answer and without effect here."""
    return ""


def _does(act: Callable[[Telescope, Session], object]) -> Handler:
    async def do(session: Session, _: str) -> str:
        await session.act(lambda t: act(t, session))
        return ""

    return do


def _key(direction: str) -> Handler:
    return _does(lambda t, s: t.paddle.press(direction, s.speed, wake=True))


def _release(axis: str) -> Handler:
    return _does(lambda t, _: t.paddle.release(axis))


def _focus(outward: bool) -> Handler:
    return _does(lambda t, s: t.focuser.run(outward, s.focus_slow))


def _keeps(**fields: object) -> Handler:
    async def keep(session: Session, _: str) -> str:
        for name, value in fields.items():
            setattr(session, name, value)
        return ""

    return keep


def _rate(rate: DriveRate) -> Handler:
    async def choose(session: Session, _: str) -> str:
        session.box.frequency_hz = FREQUENCIES[rate]
        await session.act(lambda t: t.drive.set_rates(rate, (0.0, 0.0)))
        return ""

    return choose


_STOP = _does(lambda t, _: t.drive.abort())
"""Whatever moves over the sky; tracking goes on."""
_PARK = _does(lambda t, _: t.drive.park())
_WAKE = _does(lambda t, _: t.drive.wake())
"""Track, after powering up where that is needed."""
_LAND = _does(lambda t, _: t.drive.track(False))
"""Stop following the sky."""
_FOCUS_STOP = _does(lambda t, _: t.focuser.hold())
MOVING: dict[str, Handler] = {
    "MS": slew, "MA": slew_ground, "CM": sync, "Q": _STOP, "U": precision, "hP": _PARK, "hW": _WAKE,
    "AP": _WAKE, "AL": _LAND, "AA": nothing, "TM": nothing,
    **{f"M{letter}": _key(letter) for letter in "nsew"},
    "Qn": _release("dec"), "Qs": _release("dec"), "Qe": _release("ra"), "Qw": _release("ra"),
    **{letters: _keeps(speed=speed) for letters, speed in _KEYS.items()},
    "TQ": _rate(DriveRate.SIDEREAL), "TS": _rate(DriveRate.SOLAR), "TL": _rate(DriveRate.LUNAR),
    "F+": _focus(outward=False), "F-": _focus(outward=True), "FQ": _FOCUS_STOP,
    "FS": _keeps(focus_slow=True), "FF": _keeps(focus_slow=False),
}  # fmt: skip
"""Commands without argument to handlers."""
TAKING: dict[str, Handler] = {"Mg": pulse, "W": nothing, "L": nothing}
"""Letters before an argument to handlers."""
