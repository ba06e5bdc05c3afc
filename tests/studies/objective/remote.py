"""The absolute encoder over the bus: `python -m tests.studies.objective.remote` prints a table.

Model, noise and feedback are observer.py's, but what is read is what the axis board gets in POSITION frames:
29 bits every 5 ms, and how old they are (1.5 to 5 ms), which the frame tells. The observer compares a reading
with where its model was at that time. Floating point on the plant's pins, as there.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm, solve_discrete_are

from plant.deadzone import bias_steps
from plant.kernels import layout as at
from plant.model import get, load, with_effects, with_value
from plant.parts import EffectModel, PlantModel
from plant.plant import Plant
from plant.units import ARCSEC, TURN
from scenarios.studies.objective.bench import SIDEREAL
from scenarios.studies.objective.cases import starts
from tests.studies.objective import observer
from tests.studies.objective.observer import NUMBERS, TICK_S, Design

Floats = NDArray[np.float64]
STEP_RAD = TURN / 2**29
CALCULATED_S = 0.0003
"""From the tick to the new duty: some hundred products of 32 bits (docs/results/one-arcsecond.md)."""
AGES_S = (0.0015, 0.003, 0.0049)
"""Of the reading at the tick: both boards run on their own crystals, so it drifts through this range."""


def reader(model: PlantModel, made: Design, age_s: float) -> tuple[Floats, Floats]:
    """Return what a reading of this age says of the state (a row), and the observer's correction for it."""
    a, _, _ = observer.continuous(model, SIDEREAL * ARCSEC)
    row = np.zeros(observer.SIZE)
    row[: observer.LAST] = expm(-a * age_s)[observer.ANGLE]
    noise = observer.noise()
    spread = solve_discrete_are(made.a.T, row[:, None], noise, np.array([[observer.READING]]))
    return row, np.asarray(spread @ row / (row @ spread @ row + observer.READING), dtype=np.float64)


def hold(
    plant_model: PlantModel, known: PlantModel, age_s: float, seconds: float, start_deg: float, seed: int = 1
) -> Floats:
    """Return true rate less 15.041 arcsec/s, one value per tick, without the start. known: the model that
    observer and feedback were made from."""
    made = observer.design(known, delay_s=CALCULATED_S)
    row, correction = reader(known, made, age_s)
    plant = Plant(plant_model, seed, {"ra": start_deg / 360.0 * 2**29})
    axis, first = plant.ra, plant.ra.absolute(0)
    age_ns, delay_ns = round(age_s * 1e9), round(CALCULATED_S * 1e9)
    x, reference, reading = np.zeros(observer.SIZE), 0.0, 0.0
    ticks = round((seconds + observer.SETTLE_S) / TICK_S)
    errors = np.empty(ticks)
    steps, split = plant_model.controller.pwm_steps.si, plant_model.controller.counter_split.si
    bias = bias_steps(plant_model, plant_model.axes.ra.motor)
    for tick in range(ticks):
        t_ns = tick * 5_000_000
        errors[tick] = float(plant.world[0, at.RATE]) / ARCSEC - SIDEREAL
        rate = SIDEREAL * ARCSEC * min(1.0, tick * TICK_S / observer.RAMP_S)
        reference += rate * TICK_S if tick else 0.0
        x = x + correction * (reading - (reference - rate * age_s) - float(row @ x))
        effort = float(-made.gain @ x - x[observer.LOAD] / made.per_step)
        effort = max(-observer.EFFORT_LIMIT, min(observer.EFFORT_LIMIT, effort))
        lead, lag = ((share * abs(effort) + bias) / steps for share in (1.0, split))
        axis.drive(t_ns + delay_ns, *((lead, lag) if effort >= 0 else (lag, lead)))
        x = made.a @ x + made.b * effort
        reading = (axis.absolute(t_ns + 5_000_000 - age_ns) - first + 0.5) * STEP_RAD
    return errors[round(observer.SETTLE_S / TICK_S) :]


def peak(*given: object, **more: object) -> float:
    """Return the largest error of a run, arcsec/s; infinite when the axis ran away."""
    with np.errstate(all="ignore"):
        found = float(np.abs(hold(*given, **more)).max())  # type: ignore[arg-type]
    return found if np.isfinite(found) else float("inf")


def table(name: str = "high_preload_motor_units", seconds: float = 60.0) -> None:
    """Print peaks, arcsec/s: from eight starts, over ages, with the encoder's error, with numbers off."""
    model = load(name)
    angles = starts(4.7)
    found = [peak(model, model, 0.003, seconds, start) for start in angles]
    print(f"{name}, eight starts, 3 ms, {seconds:g} s: worst {max(found):.2f}", flush=True)
    for age_s in AGES_S:
        print(f"age {age_s * 1e3:g} ms: {peak(model, model, age_s, seconds, angles[0]):.2f}", flush=True)
    lines = with_effects(model, "ra", (*model.axes.ra.effects, EffectModel("encoder_subdivision")))
    print(f"encoder's error within a line: {peak(lines, model, 0.003, seconds, angles[0]):.2f}", flush=True)
    for age_s in AGES_S:
        for share in (0.05, 0.2):
            worst: list[tuple[float, str]] = []
            for number in NUMBERS:
                path = f"axes.ra.{number}"
                for factor in (1.0 - share, 1.0 + share):
                    other = with_value(model, path, get(model, path).value * factor)
                    off = peak(other, model, age_s, seconds / 4, angles[0])
                    worst.append((off, f"{number} x {factor:g}"))
            worst.sort(reverse=True)
            kept = sum(off <= 1.0 for off, _ in worst)
            said = "; ".join(f"{off:.2f} ({what})" for off, what in worst[:3])
            print(
                f"{age_s * 1e3:g} ms, one number off by {share:.0%}: {kept} of {len(worst)} within 1; {said}",
                flush=True,
            )


if __name__ == "__main__":
    table()
