"""Logs for the calibration benchmark: ten minutes of one axis in one file, from the plant's compiled loop."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from plant.loop import LOG_COLUMNS, SAMPLE_S, Excitation, simulate
from plant.model import load, with_effects
from plant.parts import EffectModel, Number

Floats = NDArray[np.float64]
TRUE_LINES = (("axis", 1), ("shaft1", 1))  # stage and harmonic of the two effects below
ACCELERATION = 2400.0  # arcsec/s2, a third of the paper's 2 deg/s2
#: rate in arcsec/s and seconds at it: both sides of the Stribeck speed (82 arcsec/s) to the slew rate
LEVELS = ((60, 8), (600, 8), (1500, 8), (3600, 10), (7200, 22))
START_STEPS = 4e8  # absolute encoder, of 2^29
HEADER = (
    "# format: axis-log 1\n# axis: ra\n# sample_period_s: 0.010\n# session: bench {seed}\n# loop: closed\n"
    "# start_utc: 2026-01-15T14:00:00Z\n# preload: low\n# counter_torque: 0.1\n# supply_V: 24\n"
    "# note: schmidt plant loop, plant low_preload\n"
)
FORMATS = {"t": "%.6f", "setpoint": "%.4f"}


@dataclass(frozen=True)
class Drive:
    """A log and what was put into it."""

    path: Path
    rows: int
    amplitudes: dict[str, float]  # N m, by effect


def programme(seconds: float, rng: np.random.Generator) -> Floats:
    """Set points in arcsec/s, one per 10 ms: every level both ways, again and again at other rates."""
    parts: list[Floats] = []
    here, rows, wanted = 0.0, 0, round(seconds / SAMPLE_S)
    while rows < wanted:
        for level, hold in LEVELS:
            rate = min(7200.0, level * rng.uniform(0.8, 1.2))
            for sign in (1.0, -1.0):
                steps = max(1, round(abs(sign * rate - here) / ACCELERATION / SAMPLE_S))
                parts += [
                    np.linspace(here, sign * rate, steps, endpoint=False),
                    np.full(round(hold / SAMPLE_S), sign * rate),
                ]
                here = sign * rate
                rows += len(parts[-1]) + steps
    return np.concatenate(parts)[:wanted]


def write_drive(path: Path, seconds: float, seed: int) -> Drive:
    """Simulate and write one log; the two effects' sizes and phases are drawn from the seed."""
    rng = np.random.default_rng(seed)
    sizes = {"gravity_imbalance": rng.uniform(25.0, 60.0), "gear_eccentricity": rng.uniform(4.0, 12.0)}
    drawn = [
        EffectModel(
            name,
            stage="shaft1" if name == "gear_eccentricity" else None,
            parameters={
                "amplitude": Number(size, "N m", "drawn"),
                "phase": Number(rng.uniform(-3.0, 3.0), "rad", "drawn"),
            },
        )
        for name, size in sizes.items()
    ]
    model = load("low_preload")
    model = with_effects(model, "ra", (*model.axes.ra.effects, *drawn))
    wanted = programme(seconds, rng)
    log = simulate(
        model, "ra", len(wanted) * SAMPLE_S, Excitation(setpoint=wanted, start_steps=START_STEPS), seed=seed
    )
    with path.open("w", encoding="utf-8") as file:
        file.write(HEADER.format(seed=seed) + ",".join(LOG_COLUMNS) + "\n")
        np.savetxt(
            file,
            np.column_stack([getattr(log, name) for name in LOG_COLUMNS]),
            fmt=[FORMATS.get(name, "%d") for name in LOG_COLUMNS],
            delimiter=",",
        )
    return Drive(path, len(wanted), sizes)
