"""What counts as declared: the paper's tables, or the plant file the log was made with."""

from dataclasses import dataclass
from pathlib import Path

from calibration.errors import CalibrationInputError
from calibration.inputs.declaration import Friction, FrictionLaw, Rig, made
from calibration.inputs.header import TRAIN_STIFFNESS
from calibration.inputs.rigfile import telescope
from calibration.inputs.run import Run
from plant.effects import REGISTRY
from plant.effects.signals import Hook
from plant.model import PlantModel, default_files, load
from plant.parts import EffectModel

# a log whose note starts with this was made by the emulator: its plant file is what is declared
OWN = "schmidt"


def stage_of_wave(effect: EffectModel) -> str | None:
    """Where a plant file's torque over the axis' angle has its known order; None of any other effect."""
    spec = REGISTRY[effect.name]
    fitted = "order" in {p.name for p in spec.parameters}
    if not spec.wave or spec.terms[0].hook != Hook.AXIS_TORQUE or fitted:
        return None
    return effect.stage if spec.staged else "axis"


#: name in a report -> path in a plant, below axes.<axis>
PATHS = {
    "coulomb": "friction.coulomb",
    "stiction": "friction.stiction",
    "viscous": "friction.viscous",
    "stribeck_speed": "friction.stribeck_rate",
    "sigma_0": "friction.bristle_stiffness",
    "torque_constant": "motor.torque_constant",
    "resistance": "motor.resistance",
    "inertia": "inertia",
    "stiffness": "gear.stiffness",
}


@dataclass(frozen=True, kw_only=True)
class Declared(Friction):
    """Declared friction and drive of one axis, SI; `lines`: name, stage, harmonic of its periodic effects."""

    stiffness: float
    torque_constant: float  # N m/A
    resistance: float  # ohm, of the whole loop
    lines: tuple[tuple[str, str, int], ...] = ()
    readings: tuple[float, ...] = (1.0,)  # of the stiffness: a plant file says what it means
    ripple: float | None = None  # A/V: current above its mean at the falling edge is this V d (1 - d)
    diode_drop: float = 0.0  # V, of the power stage; 0: none is declared
    switch: float = 0.0  # ohm, of the declared loop in switch and sense resistor
    gear_lag_s: float = 0.0  # damping over stiffness of a train: its torque lags its motor's
    own: bool = False  # the emulator's own boards made the log

    @property
    def law(self) -> FrictionLaw:
        """Of the friction, where its fit begins."""
        return FrictionLaw(
            stiction_ratio=self.stiction / self.coulomb,
            stribeck_speed=self.stribeck_rate,
            stribeck_exponent=self.stribeck_exponent,
            bristle_travel=self.coulomb / self.bristle_stiffness,
        )

    def number(self, name: str) -> float:
        """A number by its name in a report."""
        return float(getattr(self, PATHS.get(name, name).rpartition(".")[2]))


def declared_model(header: dict[str, str], base: Path | None) -> tuple[PlantModel, bool]:
    """The plant a log is held against, and whether its effects are part of what is declared.

    It is `base` when given. For the emulator's own logs it is the plant file their note names. Else it is the
    project's plant of that preload, whose effects are a choice of the project and not the paper's.
    """
    note, files = header.get("note", "").lower(), default_files()
    own = note.startswith(OWN)
    named = next((name for name in files if own and note.endswith(f"plant {name}")), None)
    return load(base or files[named or f"{header.get('preload', 'low')}_preload"]), base is not None or own


def _from_rig(rig: Rig, runs: list[Run]) -> Declared:
    """The rig file's numbers for a state of the friction, and the headers' word on the trains' stiffness."""
    assert rig.motors is not None
    m, preload = rig.motors, runs[0].header.get("preload", "low")
    f = next((f for f in rig.friction if f.state == preload), rig.friction[0])
    said = {float(r.header[TRAIN_STIFFNESS]): r.path for r in runs if TRAIN_STIFFNESS in r.header}
    if len(said) > 1:
        what = f"'{TRAIN_STIFFNESS}' is another one in another log: one drive has one"
        raise CalibrationInputError(list(said.values())[-1], what)
    stiffness, readings = next(iter(said), m.train_stiffness), (1.0,) if said else m.stiffness_readings
    motors = {"torque_constant": m.torque_constant, "resistance": m.resistance}
    return made(Declared, vars(f), stiffness=stiffness, readings=readings, **motors)


def declared_numbers(runs: list[Run], plant: Path | None, rig: Rig | None = None) -> Declared:
    """From `plant`; without it, for the emulator's own logs, from the project's plant file.

    Other logs' numbers come from the rig file and the logs' headers. Without a rig file the telescope's own
    axis stands for it.
    """
    header = runs[0].header
    axis, own = header["axis"], header.get("note", "").lower().startswith(OWN)
    if plant is None and not own:
        return _from_rig(rig or telescope(axis), runs)
    model, _ = declared_model(header, plant)
    part = getattr(model.axes, axis)
    gear, motor = part.gear, part.motor
    waves = [(e, stage_of_wave(e)) for e in part.effects if e.enabled]
    return made(
        Declared,
        {name: number.si for name, number in vars(part.friction).items()},
        stiffness=gear.stiffness.si / 2,
        torque_constant=motor.torque_constant.si,
        resistance=motor.loop,
        lines=tuple((e.name, stage, e.harmonic) for e, stage in waves if stage),
        ripple=0.5 / (motor.inductance.si * model.controller.pwm_frequency.si) if own else None,
        diode_drop=motor.diode_drop.si if motor.diode_drop is not None else 0.0,
        switch=motor.loop - motor.resistance.si,
        gear_lag_s=gear.damping.si / gear.stiffness.si if own else 0.0,
        own=own,
    )
