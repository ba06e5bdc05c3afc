"""plant.yaml: the calibrated numbers and the effects found, as a plant that the emulator runs."""

from pathlib import Path

import numpy as np

from calibration.finding import Finding, Parameter
from calibration.inputs.declaredplant import PATHS
from calibration.names import NAMES
from calibration.names.inplant import Facts, Made
from plant.gears import RATIO
from plant.model import ModelError, PlantModel, dump, dumps, get, load, loads, with_effects, with_value
from plant.parts import EffectModel
from plant.units import to_si

LEAST_INERTIA = 10.0  # kg m2: a load that is left when the rotors are taken off. ASSUMPTION


def calibrate_model(
    model: PlantModel, axis: str, calibrated: dict[str, Parameter], name: str, skip: list[str]
) -> tuple[PlantModel, list[str]]:
    """The model with the calibrated numbers, except those in `skip` (which this log cannot tell)."""
    remarks, declared = [], model
    for key, path in PATHS.items():
        if key not in calibrated or key in skip:
            continue
        found = calibrated[key]
        changed = _set(model, axis, path, _as_declared(model, axis, key, found.value), name)
        if changed is None:
            remarks.append(f"{key}: {found.value:.4g} {found.unit} is no number of a plant")
        model = changed or model
    return _with_rules(model, declared, axis, name), remarks


def _with_rules(model: PlantModel, declared: PlantModel, axis: str, name: str) -> PlantModel:
    """What no log tells keeps the rule it was declared by. sigma1 keeps its share of the passivity bound, the
    gears' damping its share of the critical one."""
    f, g = (getattr(model.axes, axis), getattr(declared.axes, axis))
    bounds = [
        x.friction.viscous.si * x.friction.coulomb.si / (x.friction.stiction.si - x.friction.coulomb.si)
        for x in (f, g)
        if x.friction.stiction.si > x.friction.coulomb.si
    ]
    rules = {
        "friction.bristle_damping": bounds[0] / bounds[1] if len(bounds) == 2 else 1.0,
        "gear.damping": float(np.sqrt(f.gear.stiffness.si / g.gear.stiffness.si)),
    }
    for path, factor in rules.items():
        if factor != 1.0:
            si = get(declared, f"axes.{axis}.{path}").si * factor
            model = _set(model, axis, path, si, f"{name}, by the rule it was declared by") or model
    return model


def _as_declared(model: PlantModel, axis: str, key: str, value: float) -> float:
    """A calibrated number as the plant file means it, SI: inertia of the load, winding alone, both trains."""
    motor = getattr(model.axes, axis).motor
    if key == "inertia":
        return float(max(value - 2 * motor.rotor_inertia.si * RATIO**2, LEAST_INERTIA))
    if key == "resistance":
        return float(value - motor.loop + motor.resistance.si)
    return float(2.0 * value if key == "stiffness" else value)


def _set(model: PlantModel, axis: str, path: str, si: float, name: str) -> PlantModel | None:
    """The model with one number in its own unit, None where its bounds forbid it."""
    full = f"axes.{axis}.{path}"
    unit = get(model, full).unit
    try:
        return _checked(with_value(model, full, si / to_si(1.0, unit), f"fitted to {name}"))
    except ModelError:
        return None


def _checked(model: PlantModel) -> PlantModel:
    """The model as its file is read again; raises ModelError where it is none."""
    return loads(dumps(model))


def convert(f: Finding, facts: Facts) -> Made:
    """What `f` becomes in the plant file: effects, changed numbers, or a remark on what it cannot say."""
    name = NAMES[f.name]
    if name.changed is None:
        return name.to_plant(f, facts)
    written = " and ".join(PATHS[number] for number in name.changed.numbers)
    return Made(remarks=[f"{f.name}: in the plant as axes.{facts.axis}.{written}"])


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
            model = changed or model
        for effect in made.effects:
            try:
                _checked(with_effects(model, axis, [*rows, effect]))
            except ModelError as error:
                remarks.append(f"{f.name} left out of the plant: {error}")
            else:
                rows.append(effect)
    return with_effects(model, axis, rows), remarks


def write_plant(
    out: Path,
    model: PlantModel,
    calibrated: dict[str, Parameter],
    effects: list[Finding],
    facts: Facts,
    skip: list[str],
) -> tuple[PlantModel, list[str]]:
    """Write `model` with calibrated numbers and effects to `out`; return it with remarks on what it lacks."""
    model, remarks = calibrate_model(model, facts.axis, calibrated, facts.name, skip)
    model, more = correct(model, facts.axis, effects, facts)
    dump(model, out)
    return load(out), remarks + more
