"""Moving by hand: keys held down, rates of one axis, and a guider's pulses."""

import math
from collections.abc import Callable
from typing import Final

from bus.protocol import Opcode, SpeedClass
from bus.protocol.scales import rate_q16
from host.client import Procedure
from host.procedures.autoguide import TICK_S, Shifting
from host.procedures.manual import AXES
from host.sky.tracks import GUIDE_ARCSEC_S, SIDEREAL_ARCSEC_S, Pulse, SkyTrack
from host.telescope.drive import Drive
from host.telescope.jobs import Activity, Job, Reason, Refused, Side

_LONGEST_S: Final = 60.0
"""Pulses of an axis that may wait, together. ASSUMPTION: as long as the longest one."""


class Guider:
    """Pulses of both axes (0: RA, 1: Dec); those of an axis follow one another.

    A shift at once is none a mount can make. It takes RA over the peak of its Stribeck curve, where friction
    falls to a third. The effort held against that friction throws the axis 60″ too far.
    """

    def __init__(self, drive: Drive, side: Side) -> None:
        self._drive, self._client, self._side = drive, drive.client, side
        self.told: Callable[[Pulse], None] | None = None
        """Hears of every pulse that is taken, begun when it came."""
        self._ends_s = [-1.0, -1.0]
        self._jobs: list[Job[None] | None] = [None, None]

    @property
    def pulsing(self) -> bool:
        """Whether a pulse still lasts."""
        return any(map(self._busy, (0, 1)))

    def pulse(self, axis: int, arcsec_s: float, seconds: float) -> None:
        """Shift what is tracked, ″/s for a time."""
        track = self._drive.pointing.track
        if self._drive.activity is not Activity.TRACKING or not isinstance(track, SkyTrack):
            raise Refused(Reason.STATE, "guiding needs a telescope that tracks")
        begin_s = self._ends_s[axis] if self._busy(axis) else self._client.now_s
        if begin_s - self._client.now_s > _LONGEST_S:
            raise Refused(Reason.STATE, f"pulses of this axis for {_LONGEST_S:g} s wait already")
        pulse = Pulse(axis, arcsec_s, begin_s, seconds)
        track.guide(pulse)
        self._ends_s[axis] = pulse.end_s
        if self.told is not None:
            self.told(pulse._replace(begin_s=self._client.now_s))
        job = self._jobs[axis]
        if job is None or not job.running:
            self._jobs[axis] = self._side.start(Job("guide", self._guide(axis, track), Activity.TRACKING))

    def _guide(self, axis: int, track: SkyTrack) -> Procedure:
        """Rates, tick by tick, that bring the board's target where the pulses want it."""
        pointing, client = self._drive.pointing, self._client
        shifting = Shifting(track.shifted(self._client.now_s - TICK_S)[axis], self._client.now_s)
        while pointing.commanding and self._follows(track):
            yield
        pointing.guided += 1
        try:
            while self._follows(track):
                now_s = self._client.now_s
                rate = shifting.rate(track.shifted(now_s + TICK_S)[axis], now_s)
                base = track.rates(now_s)[axis] + pointing.trims[axis]
                device = list(AXES.values())[axis]
                yield from client.ask(device, Opcode.TRACK_RATE, rate_q16(base + rate))
                if now_s > self._ends_s[axis] and not rate_q16(rate):
                    return
        finally:
            pointing.guided -= 1

    def _busy(self, axis: int) -> bool:
        job = self._jobs[axis]
        return job is not None and job.running and self._client.now_s < self._ends_s[axis]

    def _follows(self, track: SkyTrack) -> bool:
        return self._drive.activity is Activity.TRACKING and self._drive.pointing.track is track


CLASS_ARCSEC_S = {
    SpeedClass.SLEW: 7200.0,
    SpeedClass.SET: 600.0,
    SpeedClass.GUIDE: 100.0,
    SpeedClass.FINE: 15.0,
}
"""Rates of the keys: what the axis boards are programmed with (parameters 7 to 10; ASSUMPTION there)."""
FASTEST_ARCSEC_S = CLASS_ARCSEC_S[SpeedClass.SLEW]
LOCKED_ARCSEC_S = 1000.0
"""Up to this rate a key moves the target of the position loop: the velocity loop sticks and slips below some
1000″/s (paper, Fig. 12) and would be tens of percent off within ten seconds."""
DIRECTIONS = {"n": ("dec", 1), "s": ("dec", -1), "e": ("ra", -1), "w": ("ra", 1)}
"""Axis and sign; hour angle grows to the west."""


class Paddle:
    """The hand paddle and what guiding programs send instead of one.

    guide_arcsec_s: rates of a pulse, right ascension and declination.
    """

    def __init__(self, drive: Drive, side: Side) -> None:
        self.drive = drive
        self.guide_arcsec_s = (GUIDE_ARCSEC_S, GUIDE_ARCSEC_S)
        self.guider = Guider(drive, side)
        self._rates: dict[str, float] = {}
        self._over_sky = True

    @property
    def held(self) -> frozenset[str]:
        """Axes that are being moved by hand."""
        return frozenset(self._rates) if self.drive.activity is Activity.PADDLE else frozenset()

    def press(self, direction: str, speed: SpeedClass, wake: bool = False) -> None:
        """Hold a key (n, s, e, w): move at a speed class, over the sky while tracking, until `release`."""
        if direction not in DIRECTIONS:
            raise Refused(Reason.VALUE, f"direction {direction!r}; there are n, s, e and w")
        if speed not in CLASS_ARCSEC_S:
            raise Refused(Reason.VALUE, f"speed {speed!r}; there are slew, set, guide and fine")
        axis, sign = DIRECTIONS[direction]
        self.move(axis, sign * CLASS_ARCSEC_S[speed], over_sky=True, wake=wake)

    def move(self, axis: str, rate_arcsec_s: float, over_sky: bool = False, wake: bool = False) -> None:
        """Move one axis (`ra`: hour angle, positive west; `dec`) at a rate until it is released."""
        self.drive.unparked(wake)
        if not abs(rate_arcsec_s) <= FASTEST_ARCSEC_S:
            raise Refused(Reason.VALUE, f"{rate_arcsec_s:g}″/s is more than {FASTEST_ARCSEC_S:g}″/s")
        self._rates = {**{each: self._rates[each] for each in self.held}, axis: rate_arcsec_s}
        self._over_sky = over_sky
        self.drive.begin(f"{axis} by hand, {rate_arcsec_s:g}″/s", self._run(), Activity.PADDLE)

    def release(self, axis: str | None = None) -> None:
        """Let go of one axis or both; tracking goes on when it is on. Without a key held: nothing."""
        held = self.held
        if not held or (axis is not None and axis not in held):
            return
        if axis is not None and held != {axis}:
            del self._rates[axis]
            self.drive.begin(f"{axis} released", self._run(), Activity.PADDLE)
            return
        self.drive.abort()

    def pulse(self, direction: str, seconds: float) -> None:
        """Shift what is tracked: move at the guide rate for a time."""
        if direction not in DIRECTIONS or not 0 <= seconds <= 60:
            raise Refused(Reason.VALUE, "a pulse is n, s, e or w and lasts 0 to 60 s")
        name, sign = DIRECTIONS[direction]
        axis = 0 if name == "ra" else 1
        self.guider.pulse(axis, sign * self.guide_arcsec_s[axis], seconds)

    def set_guide_rates(self, ra_arcsec_s: float, dec_arcsec_s: float) -> None:
        """Rates of a pulse, ″/s, up to `GUIDE_ARCSEC_S`."""
        for rate in (ra_arcsec_s, dec_arcsec_s):
            if not (math.isfinite(rate) and 0 < rate <= GUIDE_ARCSEC_S * 1.0001):
                raise Refused(Reason.VALUE, f"guide rate {rate:g}″/s is outside 0 to {GUIDE_ARCSEC_S:.4g}")
        self.guide_arcsec_s = (ra_arcsec_s, dec_arcsec_s)

    def _run(self) -> Procedure:
        client, rates = self.drive.client, dict(self._rates)
        yield from self.drive.power()
        follow = SIDEREAL_ARCSEC_S if self.drive.tracking else 0.0
        for name, device in AXES.items():
            base = follow if name == "ra" and (self._over_sky or name not in rates) else 0.0
            rate = rates.get(name, 0.0) + base
            locked = abs(rate) <= LOCKED_ARCSEC_S
            yield from client.ask(device, Opcode.TRACK_RATE if locked else Opcode.SET_RATE, rate_q16(rate))
        while True:
            yield
