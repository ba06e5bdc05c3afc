"""A telescope client on the emulated boards, advanced by the test in simulated time."""

import datetime as dt
from collections.abc import Callable, Iterator
from math import pi, radians
from pathlib import Path
from typing import TypeVar

import pytest

from host.sky.catalogue import Star
from host.sky.observed import Clock, Place, sidereal_time_rad, star_of_apparent
from host.telescope import Job, Telescope
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.language.load import DEFAULT_PLANT
from scenarios.language.model import Scenario
from scenarios.language.plants import plant_model
from tests.host.inprocess import HostInProcess

T = TypeVar("T")
START = dt.datetime(2026, 2, 10, 14, 0, tzinfo=dt.UTC)
"""The night of the main scenario: Pollux is well up in the east."""


class Rig:
    """Boards, plant and telescope client on one queue."""

    def __init__(self, logs: Path | None = None, start: dt.datetime = START, network: str = "lab") -> None:
        place, plant = {"name": network}, {"file": DEFAULT_PLANT}
        self.scenario = Scenario(file=Path("rig"), name="rig", clock=Clock(start), network=place, plant=plant)
        self.served = LiveNetwork(self.scenario, plant_model(self.scenario.plant, Path()))
        self.network = self.served.network
        self.host = HostInProcess(self.served, logs)
        self.pc = self.host.pc
        self.telescope: Telescope = self.pc.telescope
        self.advance(2.0)

    def advance(self, seconds: float) -> None:
        """What serve does, in slices of 10 ms."""
        end_ns = self.served.now_ns + round(seconds * 1e9)
        while self.served.now_ns < end_ns:
            self.host.poll(self.served.now_ns)
            self.served.run_until(min(self.served.now_ns + 10_000_000, end_ns))

    def do(self, act: Callable[[Telescope], T]) -> T:
        """What a door does: the next tick carries it out."""
        future = self.telescope.call(act)
        self.advance(0.1)
        return future.result(0)

    def run(self, act: Callable[[Telescope], Job[T]], limit_s: float = 400.0) -> T:
        job = self.do(act)
        for _ in range(round(limit_s / 0.5)):
            if not job.running:
                return job.finished.result(0)
            self.advance(0.5)
        raise AssertionError(f"{job.name} has not ended within {limit_s} s")

    def up(self, name: str = "here", hour_angle_h: float = -1.0, dec_deg: float = 20.0) -> Star:
        """A place in the sky that is up now, given by hour angle and declination."""
        about, t_s = self.pc.observatory, self.telescope.snapshot.t_s
        sidereal = sidereal_time_rad(about.site, about.clock, t_s)
        place = Place((sidereal - hour_angle_h * pi / 12) % (2 * pi), radians(dec_deg))
        return star_of_apparent(place, about.clock, t_s, name)


@pytest.fixture
def rig(tmp_path: Path) -> Iterator[Rig]:
    made = Rig(tmp_path)
    yield made
    made.host.close()
