"""plant.yaml: the calibrated numbers and the effects found, as a plant that the emulator runs."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from calibration.corrected.convert import convert
from calibration.corrected.making import Facts
from calibration.declaredplant import OWN
from calibration.finding import Finding, Parameter
from plant.gears import RATIO
from plant.model import (
    ModelError,
    PlantModel,
    default_files,
    dump,
    dumps,
    get,
    load,
    loads,
    with_effects,
    with_value,
)
from plant.parts import EffectModel
from plant.units import to_si

#: calibrated name -> path below axes.<axis>
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
LEAST_INERTIA = 10.0  # kg m2: a load that is left when the rotors are taken off


def declared_model(header: dict[str, str], base: Path | None) -> tuple[PlantModel, bool]:
    """The plant a log is held against, and whether its effects are part of what is declared.

    `base` when given; for the emulator's own logs the plant file their note names; else the project's plant
    of that preload, whose effects are a choice of the project and not the paper's.
    """
    if base is not None:
        return load(base), True
    files = default_files()
    note = header.get("note", "").lower()
    named = [name for name in files if note.endswith(f"plant {name}")]
    name = named[0] if named and note.startswith(OWN) else f"{header.get('preload', 'low')}_preload"
    return load(files[name]), note.startswith(OWN)


def calibrate_model(
    model: PlantModel, axis: str, calibrated: dict[str, Parameter], name: str, skip: list[str]
) -> tuple[PlantModel, list[str]]:
    """The model with the calibrated numbers, except those in `skip` (which this log cannot tell)."""
    remarks, declared = [], model
    for key, path in PATHS.items():
        if key not in calibrated or key in skip:
            continue
        changed = _set(model, axis, path, _as_declared(model, axis, key, calibrated[key].value), name)
        if changed is None:
            remarks.append(
                f"{key}: {calibrated[key].value:.4g} {calibrated[key].unit} is no number of a plant"
            )
        else:
            model = changed
    return _with_rules(model, declared, axis, name), remarks


def _with_rules(model: PlantModel, declared: PlantModel, axis: str, name: str) -> PlantModel:
    """What no log tells keeps the rule it was declared by.

    sigma1 keeps its share of the passivity bound, the gears' damping its share of the critical one.
    """
    f, g = (getattr(model.axes, axis), getattr(declared.axes, axis))
    bounds = [
        x.friction.viscous.si * x.friction.coulomb.si / (x.friction.stiction.si - x.friction.coulomb.si)
        for x in (f, g)
        if x.friction.stiction.si > x.friction.coulomb.si
    ]
    for path, factor in (
        ("friction.bristle_damping", bounds[0] / bounds[1] if len(bounds) == 2 else 1.0),
        ("gear.damping", float(np.sqrt(f.gear.stiffness.si / g.gear.stiffness.si))),
    ):
        old = get(declared, f"axes.{axis}.{path}").si
        model = (
            (_set(model, axis, path, old * factor, f"{name}, by the rule it was declared by") or model)
            if factor != 1.0
            else model
        )
    return model


def _as_declared(model: PlantModel, axis: str, key: str, value: float) -> float:
    """A calibrated number as the plant file means it, SI: inertia of the load, winding alone, both trains."""
    motor = getattr(model.axes, axis).motor
    if key == "inertia":
        return float(max(value - 2 * motor.rotor_inertia.si * RATIO**2, LEAST_INERTIA))
    if key == "resistance":
        return float(value - motor.switch_resistance.si - motor.sense_resistance.si)
    return float(2.0 * value if key == "stiffness" else value)


def _set(model: PlantModel, axis: str, path: str, si: float, name: str) -> PlantModel | None:
    """The model with one number in its own unit, None where its bounds forbid it."""
    full = f"axes.{axis}.{path}"
    unit = get(model, full).unit
    try:
        changed = with_value(model, full, si / to_si(1.0, unit), f"fitted to {name}")
        return loads(dumps(changed))
    except ModelError:
        return None


def correct(
    model: PlantModel, axis: str, effects: list[Finding], facts: Facts
) -> tuple[PlantModel, list[str]]:
    """The model with the effects found behind those it has; remarks on what could not be put into it."""
    remarks: list[str] = []
    rows: list[EffectModel] = list(getattr(model.axes, axis).effects)
    for f in effects:
        made = convert(f, facts)
        remarks += made.remarks
        for path, change in made.numbers.items():
            changed = _set(model, axis, path, get(model, f"axes.{axis}.{path}").si + change, facts.name)
            if changed is None:
                remarks.append(f"{f.name}: {path} cannot be changed by {change:.4g}")
            else:
                model = changed
        for effect in made.effects:
            trial = with_effects(model, axis, [*rows, effect])
            try:
                loads(dumps(trial))
            except ModelError as error:
                remarks.append(f"{f.name} left out of the plant: {error}")
            else:
                rows.append(effect)
    return with_effects(model, axis, rows), remarks


def write_plant(
    out: Path,
    model: PlantModel,
    axis: str,
    calibrated: dict[str, Parameter],
    effects: list[Finding],
    facts: Facts,
    skip: list[str],
) -> tuple[PlantModel, list[str]]:
    """Write `model` with calibrated numbers and effects to `out`; return it with remarks on what it lacks."""
    model, remarks = calibrate_model(model, axis, calibrated, facts.name, skip)
    model, more = correct(model, axis, effects, facts)
    dump(model, out)
    return load(out), remarks + more
