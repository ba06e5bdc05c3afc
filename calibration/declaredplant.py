"""What counts as declared: the paper's tables, or the plant file the log was made with."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from calibration.errors import CalibrationInputError
from calibration.inputs.declaration import Rig
from calibration.inputs.telescope import telescope
from calibration.readers.drive import TRAIN_STIFFNESS
from calibration.readers.run import Array, Run

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
    torque_constant: float  # N m/A
    resistance: float  # ohm, of the whole loop
    lines: tuple[tuple[str, str, int], ...] = ()
    readings: tuple[float, ...] = (1.0,)  # of the stiffness: a plant file says what it means
    stribeck_exponent: float = 2.0
    ripple: float | None = None  # A/V: current above its mean at the falling edge is this V d (1 - d)
    gear_lag_s: float = 0.0  # damping over stiffness of a train: its torque lags its motor's
    own: bool = False  # the emulator's own boards made the log

    @property
    def start(self) -> Array:
        """log (Ts/Tc, Stribeck speed, sigma_0/Tc), where a fit of the friction begins."""
        return np.log([self.stiction / self.coulomb, self.stribeck_speed, self.sigma_0 / self.coulomb])


def _train_stiffness(runs: list[Run]) -> str | None:
    """As the headers declare it, in all of them or in none of them another one."""
    said = {r.header[TRAIN_STIFFNESS]: r.path for r in runs if TRAIN_STIFFNESS in r.header}
    if len(set(map(float, said))) > 1:
        raise CalibrationInputError(
            list(said.values())[-1], f"'{TRAIN_STIFFNESS}' is another one in another log: one drive has one"
        )
    return next(iter(said), None)


def _from_rig(rig: Rig, preload: str, stiffness: str | None) -> Declared:
    """The rig file's numbers for a state of the friction, and a header's word on the trains' stiffness."""
    assert rig.motors is not None
    f = next((f for f in rig.friction if f.state == preload), rig.friction[0])
    return Declared(
        f.coulomb,
        f.stiction,
        f.stribeck_rate,
        f.viscous,
        f.bristle_stiffness,
        float(stiffness) if stiffness else rig.motors.train_stiffness,
        rig.motors.torque_constant,
        rig.motors.resistance,
        readings=(1.0,) if stiffness else rig.motors.stiffness_readings,
        stribeck_exponent=f.stribeck_exponent,
    )


def declared_numbers(runs: list[Run], plant: Path | None, rig: Rig | None = None) -> Declared:
    """From `plant`, from the project's plant file for the emulator's own logs, else from the rig file (the
    telescope's own axis without one) and the logs' headers."""
    axis, preload = runs[0].header["axis"], runs[0].header.get("preload", "low")
    note = runs[0].header.get("note", "").lower()
    own = note.startswith(OWN)
    if plant is None and not own:
        return _from_rig(rig or telescope(axis), preload, _train_stiffness(runs))
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
    return Declared(
        f.coulomb.si,
        f.stiction.si,
        f.stribeck_rate.si,
        f.viscous.si,
        f.bristle_stiffness.si,
        part.gear.stiffness.si / 2,
        motor.torque_constant.si,
        motor.resistance.si + motor.switch_resistance.si + motor.sense_resistance.si,
        lines,
        stribeck_exponent=f.stribeck_exponent.si,
        ripple=0.5 / (motor.inductance.si * model.controller.pwm_frequency.si) if own else None,
        gear_lag_s=part.gear.damping.si / part.gear.stiffness.si if own else 0.0,
        own=own,
    )
