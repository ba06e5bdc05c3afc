"""Where and with which seed an experiment begins, benches it may ask for there, and the one that decides."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import floor

import numpy as np

from bus.can import Frame
from bus.protocol import MEASUREMENT_BASE, AxisParameter, Opcode, unpack_motion
from bus.protocol.scales import rate_q16
from plant.model import with_value
from plant.parts import PlantModel
from scenarios.lab.axisbench import AXIS, AxisBench
from scenarios.studies.paper.measures import Log
from scenarios.studies.paper.runs import Bench
from scenarios.studies.paper.scales import ARCSEC, GEAR_RATIO, LOG_PERIOD_S

STEPS_PER_DEGREE = (1 << 29) / 360.0
ANGLES_DEG = (97.3, 123.1, 149.6, 172.9, 193.4, 217.7, 241.2, 268.9)
"""Eight angles of the absolute encoder over the telescope's travel, at odd places of every gear stage.
ASSUMPTION: the paper names no place; travel +-100 deg about 180 deg."""
SEEDS = (1, 2, 3)
NOTHING = 1e-3  # Torque left of a friction that is taken away: a plant file wants a positive number.


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
FRESH, TRAVEL_DEG = 20261126, (85.0, 275.0)
"""Seed of `others`, which the search must never see; degrees of the absolute encoder."""
QUICK = STARTS[::4]  # For a look; decides nothing.


def others(count: int) -> tuple[Start, ...]:
    """Angles and seeds that no search has used: always the same ones."""
    random = np.random.default_rng(FRESH)
    angles, seeds = random.uniform(*TRAVEL_DEG, count), random.integers(10, 100_000, count)
    return tuple(Start(round(float(angle), 1), int(seed)) for angle, seed in zip(angles, seeds, strict=True))


Gains = tuple[float, float]
"""Kp and Ki of an incremental PI: PWM steps per count in 5 ms, PWM steps per count."""
MakeBench = Callable[[PlantModel, int, Gains | None, float], Bench]
"""Makes a bench, at rest and powered, of (plant, seed, gains instead of the plant file's, start in steps)."""


@dataclass(frozen=True)
class Benches:
    """Fresh benches of both preloads at one start."""

    make: MakeBench
    plants: Mapping[str, PlantModel]
    start: Start

    def __call__(self, preload: str = "low", gains: Gains | None = None) -> Bench:
        """Return a fresh bench of a preload."""
        return self.of(self.plants[preload], gains)

    def of(self, model: PlantModel, gains: Gains | None = None) -> Bench:
        """Return a fresh bench of another plant at this start."""
        return self.make(model, self.start.seed, gains, self.start.steps)

    @property
    def gains(self) -> Gains:
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


START_STEPS = float(1 << 28)
"""Where the axis begins, absolute encoder steps: half a turn from both soft limits."""
_Q12 = 4096


class EmulatorBench(AxisBench):
    """The bench that decides: the firmware on its emulated chips, its EnDat board, the bus and the plant.

    Commands go in as CAN frames. The log is what the axis board's MOTION frames carry every 10 ms, as the
    authors' logs did: velocity, control effort, ADC counts. Nothing is read from the plant except the true
    rate, which no verdict uses. gains: (Kp, Ki) instead of the plant file's, over the bus.
    """

    def __init__(
        self, model: PlantModel, seed: int = 1, gains: Gains | None = None, start_steps: float = START_STEPS
    ) -> None:
        super().__init__(model, seed, start_steps)
        self._rows: list[tuple[float, int, int, int, int, float]] = []
        self._angle, self._at_ns = self.plant.ra.truth(self._now_ns)[0], self._now_ns
        self.network.wire.tap(self._listen)
        if gains is not None:
            for number, gain in zip((AxisParameter.KP_Q12, AxisParameter.KI_Q12), gains, strict=True):
                self.command(Opcode.SET_PARAMETER, number, round(gain * _Q12))
        self.command(Opcode.POWER, 1)

    def closed_loop(self, arcsec_s: float, seconds: float) -> Log:
        """Run the velocity loop at a set point."""
        return self._run(seconds, Opcode.SET_RATE, rate_q16(arcsec_s))

    def open_loop(self, effort: int, seconds: float) -> Log:
        """Run with a fixed effort."""
        return self._run(seconds, Opcode.OPEN_LOOP, effort)

    def _run(self, seconds: float, opcode: Opcode, argument: int) -> Log:
        self._rows = []
        self.command(opcode, argument)
        whole = floor(seconds / LOG_PERIOD_S + 1e-6)
        self.wait((whole - len(self._rows)) * LOG_PERIOD_S)
        rows = np.array(self._rows, dtype=np.float64)
        self.wait(max(0.0, seconds - whole * LOG_PERIOD_S))
        return Log(*(np.ascontiguousarray(column) for column in rows.T))

    def _listen(self, t_ns: int, frame: Frame, _sender: str) -> None:
        if frame.identifier == MEASUREMENT_BASE + AXIS:
            motion = unpack_motion(frame.data)
            angle = self.plant.ra.truth(t_ns)[0]
            rate = (angle - self._angle) / ((t_ns - self._at_ns) * 1e-9) / ARCSEC
            self._angle, self._at_ns = angle, t_ns
            self._rows.append((t_ns * 1e-9, motion.velocity, motion.effort, motion.adc_a, motion.adc_b, rate))
