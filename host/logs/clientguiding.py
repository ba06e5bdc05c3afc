"""The guide log of clients: what their pulses were, and where the star truly was in the guide camera."""

import math
from dataclasses import dataclass, field
from importlib.metadata import version
from itertools import pairwise
from pathlib import Path
from threading import Lock
from typing import Final, NamedTuple

import numpy as np

from bus.units import ARCSEC_PER_RAD
from host.camera.camera import Frame
from host.camera.models import GUIDE
from host.logs.files import LogError, write_file
from host.logs.guidelog import opening, section
from host.logs.journal import KEPT_FILES, put_aside
from host.procedures.autoguide import Guided
from host.sky.observed import observe_many
from host.sky.tracks import Pulse, SkyTrack
from host.telescope import Telescope
from host.telescope.jobs import Activity

_LONGEST_S: Final = 60.0
"""Of a client's pulse (`host.telescope.paddle`)."""
_LOOKS: Final = 25
"""Of an exposure that are compared with the star. ASSUMPTION: enough for the mean of a smooth path."""


class _Exposure(NamedTuple):
    """Opened and closed, s; star less telescope on the sky, west and north, ″."""

    begin_s: float
    end_s: float
    west: float
    north: float


@dataclass
class _Session:
    """A star that is followed from one time to another, s, with what came meanwhile."""

    track: SkyTrack
    begin_s: float
    end_s: float = math.inf
    exposures: list[_Exposure] = field(default_factory=list)
    pulses: list[Pulse] = field(default_factory=list)


class ClientGuiding:
    """Frames come from threads of their own, pulses and ticks from the ticking one.

    The file is written when a star is left and at the end. Without pulses there is none. One of an earlier
    run is put aside.
    """

    def __init__(self, file: Path, telescope: Telescope) -> None:
        self._file, self._telescope = file, telescope
        self._sessions: list[_Session] = []
        self._lock = Lock()
        self._begun = False
        telescope.paddle.guider.told = self._pulsed

    def tick(self) -> None:
        """Notice which star is followed."""
        drive, last = self._telescope.drive, self._sessions[-1] if self._sessions else None
        track = drive.pointing.track if drive.activity is Activity.TRACKING else None
        open_ = last is not None and last.end_s == math.inf
        if open_ and last is not None and track is not last.track:
            last.end_s = self._telescope.client.now_s
            self.write()
        if isinstance(track, SkyTrack) and (last is None or last.end_s < math.inf):
            with self._lock:
                self._sessions = [each for each in self._sessions if each.pulses]
                self._sessions.append(_Session(track, self._telescope.client.now_s))

    def frame(self, frame: Frame) -> None:
        """A frame that was read out. It counts when the guide camera saw one star all along."""
        begin_s, end_s = frame.start_s, frame.start_s + frame.seconds
        if frame.model is not GUIDE or not frame.order.lit:
            return
        with self._lock:
            for session in self._sessions:
                if session.begin_s <= begin_s and end_s <= session.end_s:
                    session.exposures.append(_Exposure(begin_s, end_s, *self._off(session, frame)))

    def write(self) -> None:
        """Write all sessions so far; what goes wrong is said in the error log."""
        about = self._telescope.observatory
        with self._lock:
            guided = [(each, rows) for each in self._sessions if (rows := _rows(each))]
        sections = [
            section(
                "client", each.begin_s, each.track.star, about.clock, rows,
                exposure_s=each.exposures[0].end_s - each.exposures[0].begin_s,
                algorithm="None", longest_s=_LONGEST_S,
            )
            for each, rows in guided
        ]  # fmt: skip
        if not sections:
            return
        try:
            if not self._begun and self._file.exists():
                put_aside(self._file, KEPT_FILES)
            self._begun = True
            fresh = self._file.with_suffix(".new")  # whoever reads the log finds a whole one
            write_file(fresh, "\n".join([opening(version("schmidt"), about.clock, 0.0), *sections]))
            fresh.replace(self._file)
        except (LogError, OSError) as error:
            self._telescope.journal.error(self._telescope.client.now_ns, "HOST", f"guide log: {error}")

    def _off(self, session: _Session, frame: Frame) -> tuple[float, float]:
        """Mean of star less telescope over an exposure, ″."""
        star, about = session.track.star, self._telescope.observatory
        places = np.linspace(0, len(frame.looks) - 1, _LOOKS).round().astype(int)
        looks = np.array([frame.looks[k][:3] for k in places], dtype=float)
        hour_angles, declinations, *_ = observe_many(star, about.site, about.clock, looks[:, 0] * 1e-9)
        turned = np.remainder(hour_angles - looks[:, 1] + math.pi, 2 * math.pi) - math.pi
        west = float(turned.mean()) * math.cos(star.declination_rad)
        return west * ARCSEC_PER_RAD, float((declinations - looks[:, 2]).mean()) * ARCSEC_PER_RAD

    def _pulsed(self, pulse: Pulse) -> None:
        with self._lock:
            if self._sessions and self._sessions[-1].end_s == math.inf:
                self._sessions[-1].pulses.append(pulse)


def _rows(session: _Session) -> list[Guided]:
    """A row for each exposure from the first with pulses on; its pulses came until the next one ended."""
    exposures, west = sorted(session.exposures), math.cos(session.track.star.declination_rad)
    ends = [*(each.end_s for each in exposures), math.inf]
    rows: list[Guided] = []
    first: _Exposure | None = None
    for each, (low_s, high_s) in zip(exposures, pairwise(ends), strict=True):
        came = [pulse for pulse in session.pulses if low_s <= pulse.begin_s < high_s]
        if first is None and not came:
            continue
        first = first or each
        sent, seconds = [0.0, 0.0], [0.0, 0.0]
        for pulse in came:
            sent[pulse.axis] += pulse.arcsec_s * pulse.seconds
            seconds[pulse.axis] += math.copysign(pulse.seconds, pulse.arcsec_s)
        rows.append(
            Guided(
                t_s=each.end_s,
                off=(each.west - first.west, each.north - first.north),
                sent=(sent[0] * west, sent[1]),
                pulses_s=(seconds[0], seconds[1]),
            )
        )
    return rows
