"""A camera: it gathers where the telescope looks while its shutter is open, then makes the frame."""

import threading
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path

import numpy as np

from bus.time import generator
from host.camera.light import light
from host.camera.models import CameraModel, Look, Window
from host.camera.readout import Counts, flat, read_out
from host.camera.seeing import Wander
from host.camera.stars import Sky
from host.sky.observed import Clock
from host.sky.site import Site


class State(IntEnum):
    """ASCOM's CameraStates, those that occur."""

    IDLE, WAITING, EXPOSING, READING, DOWNLOAD, ERROR = range(6)


@dataclass(frozen=True, kw_only=True)
class Order:
    """An exposure that is asked for. window: in pixels of the detector. lit: False for a dark frame."""

    seconds: float
    window: Window
    binning: int = 1
    lit: bool = True


@dataclass(frozen=True, kw_only=True)
class Frame:
    """An exposure as it was read out. counts: rows from the top, in ADU; looks: from opening to closing."""

    model: CameraModel
    order: Order
    looks: tuple[Look, ...]
    counts: Counts

    @property
    def start_s(self) -> float:
        """Simulated time at which the shutter opened."""
        return self.looks[0].t_ns * 1e-9

    @property
    def seconds(self) -> float:
        """How long it was open."""
        return (self.looks[-1].t_ns - self.looks[0].t_ns) * 1e-9


class Camera:
    """Commands come from any thread, looks from the ticking one; frames are made in a thread of their own.

    keep: gets every frame, such as a writer of files; what it raises makes `error`.
    """

    def __init__(
        self,
        model: CameraModel,
        sky: Sky,
        site: Site,
        clock: Clock,
        seed: int,
        keep: Callable[[Frame], object] | None = None,
    ) -> None:
        self.model, self.sky, self.site, self.clock = model, sky, site, clock
        self.state = State.IDLE
        self.frame: Frame | None = None
        self.error = ""
        self._seed, self._keep = seed, keep
        self._wander = Wander(model.aperture_m, seed, model.name)
        self._lock = threading.Lock()
        self._order: Order | None = None
        self._looks: list[Look] = []
        self._stop = False
        self._number = 0

    @property
    def looking(self) -> bool:
        """Whether it wants to know where the telescope looks."""
        return self._order is not None

    @property
    def done(self) -> float:
        """Share of the exposure that is over, 0..1."""
        with self._lock:
            if self._order is None or len(self._looks) < 2:
                return 0.0 if self._order is not None or self.frame is None else 1.0
            return min(1.0, (self._looks[-1].t_ns - self._looks[0].t_ns) * 1e-9 / self._order.seconds)

    def start(self, order: Order) -> None:
        """Open the shutter with the next look; the last frame is gone."""
        with self._lock:
            self._order, self._looks, self._stop = order, [], False
            self.frame, self.error, self.state = None, "", State.EXPOSING
            self._number += 1

    def abort(self) -> None:
        """Close the shutter and keep nothing."""
        with self._lock:
            self._order, self.state = None, State.IDLE
            self._number += 1

    def stop(self) -> None:
        """Close the shutter and read out what there is."""
        with self._lock:
            self._stop = self._order is not None

    def take(self, look: Look) -> None:
        """A look; exposures end with the one at their end, interpolated."""
        with self._lock:
            order = self._order
            if order is None:
                return
            self._looks.append(look)
            end_ns = self._looks[0].t_ns + round(order.seconds * 1e9)
            if len(self._looks) < 2 or (look.t_ns < end_ns and not self._stop):
                return
            if look.t_ns > end_ns:
                self._looks[-1] = _between(self._looks[-2], look, end_ns)
            self._order, self.state = None, State.READING
            work = threading.Thread(
                target=self._make, args=(order, tuple(self._looks), self._number), name="frame", daemon=True
            )
            work.start()

    def _make(self, order: Order, looks: tuple[Look, ...], number: int) -> None:
        try:
            frame = expose(
                self.model, order, looks, self.sky, self.site, self.clock, self._wander,
                generator(self._seed, f"{self.model.name} {number}"),
            )  # fmt: skip
            if self._keep is not None:
                self._keep(frame)
            error = ""
        except Exception as broken:  # of a thread nobody waits for: the camera says it
            error = f"{type(broken).__name__}: {broken}"
        with self._lock:
            if number == self._number:
                if error:
                    self.error, self.state = error, State.ERROR
                else:
                    self.frame, self.state = frame, State.IDLE


def expose(
    model: CameraModel, order: Order, looks: tuple[Look, ...], sky: Sky, site: Site, clock: Clock,
    wander: Wander, random: np.random.Generator,
) -> Frame:  # fmt: skip
    """The frame of an exposure along these looks."""
    window = order.window
    seconds = (looks[-1].t_ns - looks[0].t_ns) * 1e-9
    electrons = np.full((window.height, window.width), model.dark_e_s * seconds)
    if order.lit:
        electrons += flat(model, window) * light(model, looks, window, sky, site, clock, wander)
    counts = read_out(model, electrons, order.binning, random)
    return Frame(model=model, order=order, looks=looks, counts=counts)


def _between(before: Look, after: Look, t_ns: int) -> Look:
    part = (t_ns - before.t_ns) / (after.t_ns - before.t_ns)
    return Look(t_ns, *(a + part * (b - a) for a, b in zip(before[1:], after[1:], strict=True)))


def file_name(frame: Frame, clock: Clock, folder: Path) -> Path:
    """Where a frame is kept: camera and opening of the shutter."""
    stamp = clock.iso(frame.start_s).translate({ord(sign): "-" for sign in ":."})
    return folder / f"{frame.model.name.lower().replace(' ', '-')}-{stamp}.fits"
