"""Guiding by a star: a pulse of each axis after every exposure of a guide camera."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from bus.protocol import Opcode
from bus.protocol.scales import rate_q16
from bus.units import ARCSEC_PER_RAD
from host.client import TICK_NS, Client, ClientError, Procedure
from host.procedures.manual import BOARDS
from host.procedures.pointing import Pointing
from host.procedures.pointing_run import Eye
from host.sky.tracks import GUIDE_ARCSEC_S, RAMP_S, Pulse, SkyTrack
from host.sky.visibility import Standpoint

LEAST_ARCSEC: Final = 0.2
"""A smaller error is not corrected: 0.1 px of the guide camera. ASSUMPTION: about the noise of a frame."""
LONGEST_S: Final = 2.5
"""Of a pulse. ASSUMPTION: what guiding programs allow unless told otherwise."""


@dataclass(frozen=True, kw_only=True)
class Guiding:
    """How long to guide, s; exposure, s; the share of an error that a pulse takes out.

    by_rate: RA runs by `SET_RATE`. Its board then looks at the motors and not at the encoder of the axis.
    """

    seconds: float
    exposure_s: float
    aggressiveness: float
    by_rate: bool


@dataclass(frozen=True, kw_only=True)
class Guided:
    """An exposure that ended at `t_s`, on the sky, west and north.

    off: star less its place in the first exposure, ″. sent: what the pulses move the telescope by, ″.
    pulses_s: how long they last.
    """

    t_s: float
    off: tuple[float, float]
    sent: tuple[float, float]
    pulses_s: tuple[float, float]


def autoguide(
    pointing: Pointing, place: Standpoint, eye: Eye, how: Guiding, told: Callable[[Guided], None]
) -> Procedure:
    """Follow the last goto's star by pictures of it alone; the axes go on with it. told: of every exposure.

    Raises ClientError without a star, or when a board refuses.
    """
    if pointing.track is None:
        raise ClientError("autoguide: there is no target yet; go to one first")
    client, star = pointing.client, pointing.track.star
    followed, apart = (SkyTrack(star, place.site, place.clock, place.mount) for _ in range(2))
    if isinstance(pointing.track, SkyTrack):  # what was guided before stays
        followed = pointing.track
    pointing.track, pointing.tracking = followed, True
    # the encoder of an axis that looks at its motors does not go where the pulses want it
    tracks = (apart if how.by_rate else followed, followed)
    opcodes = (Opcode.SET_RATE if how.by_rate else Opcode.TRACK_RATE, Opcode.TRACK_RATE)
    driven = [_driven(client, axis, opcodes[axis], tracks[axis]) for axis in (0, 1)]
    beside = [*driven, _exposures(client, tracks, eye, how, told)]
    end_ns = client.now_ns + round(how.seconds * 1e9)
    while client.now_ns < end_ns:
        for each in beside:
            next(each)
        yield
    for axis, opcode in enumerate(opcodes):  # a pulse may be under way
        yield from client.ask(BOARDS[axis], opcode, rate_q16(followed.rates(client.now_s)[axis]))
    pointing.tracking = False


def _driven(client: Client, axis: int, opcode: Opcode, track: SkyTrack) -> Procedure:
    """The star's rate and the pulses', for ever."""
    shifting, sent = Shifting(track.shifted(client.now_s)[axis], client.now_s), None
    while True:
        now_s = client.now_s
        pulse = shifting.rate(track.shifted(now_s + TICK_S)[axis], now_s)
        rate = rate_q16(track.rates(now_s)[axis] + pulse)
        if rate == sent:
            yield
        else:
            sent = rate
            yield from client.ask(BOARDS[axis], opcode, rate)


def _exposures(
    client: Client,
    tracks: tuple[SkyTrack, SkyTrack],
    eye: Eye,
    how: Guiding,
    told: Callable[[Guided], None],
) -> Procedure:
    """One after the other, for ever: where the star was in the middle of each, then pulses."""
    star = tracks[0].star
    west = math.cos(star.declination_rad)
    speeds = GUIDE_ARCSEC_S * west, GUIDE_ARCSEC_S
    first: tuple[float, float] | None = None
    while True:
        begin_ns, length_ns = client.now_ns, round(how.exposure_s * 1e9)
        yield from client.wait(how.exposure_s / 2)
        angles = eye(star, client.now_ns)
        yield from client.wait((begin_ns + length_ns - client.now_ns) * 1e-9)  # of ticks, whole ones pass
        seen = angles[0] * west * ARCSEC_PER_RAD, angles[1] * ARCSEC_PER_RAD
        first = first or seen
        off = seen[0] - first[0], seen[1] - first[1]
        ra_s, dec_s = (
            _pulse_s(each, how.aggressiveness, speed) for each, speed in zip(off, speeds, strict=True)
        )
        for axis, seconds in enumerate((ra_s, dec_s)):
            if seconds:
                rate = math.copysign(GUIDE_ARCSEC_S, seconds)
                tracks[axis].guide(Pulse(axis, rate, client.now_s, abs(seconds)))
        sent = ra_s * speeds[0], dec_s * speeds[1]
        told(Guided(t_s=client.now_s, off=off, sent=sent, pulses_s=(ra_s, dec_s)))
        if longest := max(abs(ra_s), abs(dec_s)):
            yield from client.wait(longest + RAMP_S)


def _pulse_s(off: float, aggressiveness: float, speed: float) -> float:
    """Length of a pulse in whole ms, negative to the east or south."""
    if abs(off) < LEAST_ARCSEC:
        return 0.0
    return math.copysign(min(round(aggressiveness * abs(off) / speed, 3), LONGEST_S), off)


TICK_S = TICK_NS * 1e-9
"""Between two commands at the most often, s."""
_LATE = 1.5
"""Ticks between two commands from which they are late; a tick more or less is 1 or 2."""


class Shifting:
    """Of one axis: the rate that brings it, within a tick, from where its rates have taken it to a place.

    made: where it begins, ″; t_s: when.
    """

    def __init__(self, made: float, t_s: float) -> None:
        self._made, self._rate, self._t_s = made, 0.0, t_s

    def rate(self, wanted: float, t_s: float) -> float:
        """″/s from now on, towards a place wanted a tick from now.

        A rate lasts until the next one is taken. Where that takes ticks, as on a slow machine, the way is
        given as long: in one tick it would be overshot, more every time.
        """
        gone_s = t_s - self._t_s
        self._made += self._rate * gone_s
        lasts_s = gone_s if gone_s > _LATE * TICK_S else TICK_S
        self._rate, self._t_s = (wanted - self._made) / lasts_s, t_s
        return self._rate
