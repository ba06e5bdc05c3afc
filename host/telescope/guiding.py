"""A guider's pulses: the axis runs at the guide rate for the time, beside what it tracks."""

from collections.abc import Callable
from typing import Final

from bus.protocol import Opcode
from bus.protocol.scales import rate_q16
from host.client import Procedure
from host.procedures.power import AXES
from host.procedures.shifting import TICK_S, Shifting
from host.sky.tracks import Pulse, SkyTrack
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
                device = AXES[axis]
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
