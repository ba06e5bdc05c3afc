"""What counts as declared: the paper's tables, or the plant file the log was made with."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from calibration.channels.declared import DECLARED, paper_start
from calibration.errors import CalibrationInputError
from calibration.readers.drive import TRAIN_STIFFNESS
from calibration.readers.run import Array, Run

SIGMA_0 = 5.9e6  # N m/rad; design.md, the near miss that reaches the paper's rows together
STIFFNESS = {"ra": 3.08e6, "dec": 2.46e6}  # N m/rad per train, paper Table 1
TABLE_1 = (1.0, 0.5)  # readings of that number, per train: it may mean one train, or both side by side
# design.md, the near miss that reaches the paper's rows together
TORQUE_CONSTANT, RESISTANCE = 0.39, 2.2  # N m/A, ohm
# periodic effects of a plant file, and the stage of those that have only one
PERIODIC = {"gear_eccentricity": None, "gear_mesh": None, "gravity_imbalance": "axis"}
# a log whose note starts with this was made by the emulator: its plant file is what is declared
OWN = "schmidt"


@dataclass(frozen=True)
class Declared:
    """Declared numbers of one axis, SI; `lines` are (name, stage, harmonic) of periodic effects already
    declared."""

    coulomb: float
    stiction: float
    stribeck_speed: float
    viscous: float
    sigma_0: float
    stiffness: float
    lines: tuple[tuple[str, str, int], ...] = ()
    readings: tuple[float, ...] = (1.0,)  # of the stiffness: a plant file says what it means
    start: Array = field(default_factory=lambda: paper_start("low"))  # log (Ts/Tc, vs, sigma_0/Tc)
    stribeck_exponent: float = 2.0
    torque_constant: float = TORQUE_CONSTANT  # N m/A
    resistance: float = RESISTANCE  # ohm, of the whole loop
    ripple: float | None = None  # A/V: current above its mean at the falling edge is this V d (1 - d)
    gear_lag_s: float = 0.0  # damping over stiffness of a train: its torque lags its motor's
    own: bool = False  # the emulator's own boards made the log


def _train_stiffness(runs: list[Run]) -> str | None:
    """As the headers declare it, in all of them or in none of them another one."""
    said = {r.header[TRAIN_STIFFNESS]: r.path for r in runs if TRAIN_STIFFNESS in r.header}
    if len(set(map(float, said))) > 1:
        raise CalibrationInputError(
            list(said.values())[-1], f"'{TRAIN_STIFFNESS}' is another one in another log: one drive has one"
        )
    return next(iter(said), None)


def declared_numbers(runs: list[Run], plant: Path | None) -> Declared:
    """From `plant`, from the project's plant file for the emulator's own logs, else from the paper's
    tables and the logs' headers."""
    axis, preload = runs[0].header["axis"], runs[0].header.get("preload", "low")
    note = runs[0].header.get("note", "").lower()
    own = note.startswith(OWN)
    if plant is None and not own:
        d, said = DECLARED[preload], _train_stiffness(runs)
        return Declared(
            d["coulomb"],
            d["stiction"],
            d["stribeck_speed"],
            d["viscous"],
            SIGMA_0,
            float(said) if said else STIFFNESS[axis],
            readings=(1.0,) if said else TABLE_1,
            start=paper_start(preload),
        )
    from plant.model import default_files, load

    files = default_files()
    named = [name for name in files if note.endswith(f"plant {name}")]
    model = load(plant if plant is not None else files[named[0] if named else f"{preload}_preload"])
    part = getattr(model.axes, axis)
    f = part.friction
    lines = tuple(
        (e.name, stage, e.harmonic)
        for e in part.effects
        if e.enabled and (stage := e.stage or PERIODIC.get(e.name)) and e.name in PERIODIC
    )
    motor = part.motor
    log = np.log([f.stiction.si / f.coulomb.si, f.stribeck_rate.si, f.bristle_stiffness.si / f.coulomb.si])
    return Declared(
        f.coulomb.si,
        f.stiction.si,
        f.stribeck_rate.si,
        f.viscous.si,
        f.bristle_stiffness.si,
        part.gear.stiffness.si / 2,
        lines,
        start=log,
        stribeck_exponent=f.stribeck_exponent.si,
        torque_constant=motor.torque_constant.si,
        resistance=motor.resistance.si + motor.switch_resistance.si + motor.sense_resistance.si,
        ripple=0.5 / (motor.inductance.si * model.controller.pwm_frequency.si) if own else None,
        gear_lag_s=part.gear.damping.si / part.gear.stiffness.si if own else 0.0,
        own=own,
    )
