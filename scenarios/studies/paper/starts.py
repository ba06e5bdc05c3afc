"""Where and with which seed an experiment begins, and the benches it may ask for there."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from plant.model import with_value
from plant.parts import PlantModel
from scenarios.studies.paper.runs import Bench
from scenarios.studies.paper.scales import GEAR_RATIO

STEPS_PER_DEGREE = (1 << 29) / 360.0
ANGLES_DEG = (97.3, 123.1, 149.6, 172.9, 193.4, 217.7, 241.2, 268.9)
"""Eight angles of the absolute encoder over the telescope's travel, at odd places of every gear stage.
ASSUMPTION: the paper names no place; travel +-100 deg about 180 deg."""
SEEDS = (1, 2, 3)
NOTHING = 1e-3
"""Torque left of a friction that is taken away: a plant file wants a positive number."""


@dataclass(frozen=True)
class Start:
    """One start: degrees of the absolute encoder, and the seed (encoder phases, crystals, sensor noise)."""

    angle_deg: float
    seed: int

    @property
    def steps(self) -> float:
        """Absolute encoder steps."""
        return round(self.angle_deg * STEPS_PER_DEGREE)


STARTS = tuple(Start(angle, SEEDS[k % len(SEEDS)]) for k, angle in enumerate(ANGLES_DEG))
"""What decides a row: eight angles, the seeds in turn."""
ALL = tuple(Start(angle, seed) for angle in ANGLES_DEG for seed in SEEDS)
"""Every angle with every seed."""
FRESH, TRAVEL_DEG = 20261126, (85.0, 275.0)
"""Seed of `others`, which the search must never see; degrees of the absolute encoder."""
QUICK = STARTS[::4]
"""For a look; decides nothing."""


def others(count: int) -> tuple[Start, ...]:
    """Angles and seeds that no search has used: always the same ones."""
    random = np.random.default_rng(FRESH)
    angles, seeds = random.uniform(*TRAVEL_DEG, count), random.integers(10, 100_000, count)
    return tuple(Start(round(float(angle), 1), int(seed)) for angle, seed in zip(angles, seeds, strict=True))


MakeBench = Callable[[PlantModel, int, tuple[float, float] | None, float], Bench]
"""Makes a bench, at rest and powered, of (plant, seed, gains instead of the plant file's, start in steps)."""


@dataclass(frozen=True)
class Benches:
    """Fresh benches of both preloads at one start."""

    make: MakeBench
    plants: Mapping[str, PlantModel]
    start: Start

    def __call__(self, preload: str = "low", gains: tuple[float, float] | None = None) -> Bench:
        """Return a fresh bench of a preload."""
        return self.of(self.plants[preload], gains)

    def of(self, model: PlantModel, gains: tuple[float, float] | None = None) -> Bench:
        """Return a fresh bench of another plant at this start."""
        return self.make(model, self.start.seed, gains, self.start.steps)

    @property
    def gains(self) -> tuple[float, float]:
        """Kp, Ki of the plant file."""
        controller = self.plants["low"].controller
        return controller.kp.si, controller.ki.si


def viscous_only(model: PlantModel) -> PlantModel:
    """Return a plant whose bearings are only viscous."""
    for name in ("coulomb", "stiction"):
        model = with_value(model, f"axes.ra.friction.{name}", NOTHING)
    return model


def with_inertia(model: PlantModel, factor: float) -> PlantModel:
    """Return a plant whose whole moment of inertia, rotors included, is `factor` times its own."""
    axis = model.axes.ra
    rotors = 2.0 * axis.motor.rotor_inertia.si * GEAR_RATIO**2
    load = factor * (axis.inertia.si + rotors) - rotors
    return with_value(model, "axes.ra.inertia", load * axis.inertia.value / axis.inertia.si)
