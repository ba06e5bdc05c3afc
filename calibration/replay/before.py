"""The declared model re-calibrated without the effects: what "before" means for a closed loop."""

from dataclasses import replace

import numpy as np

from calibration.decide.tolerance import CHANGES, fitted_numbers
from calibration.finding import Finding, Parameter
from calibration.inputs.declaredplant import stage_of_wave
from calibration.look.axis_result import AxisResult
from calibration.names import NAMES
from calibration.names.inplant import Facts
from calibration.replay.thresholds import LARGEST_STEP
from calibration.statistics.regression import Fit
from plant.effects import REGISTRY
from plant.model import PlantModel, with_effects


def before_numbers(
    result: AxisResult, calibrated: dict[str, Parameter], effects: list[Finding]
) -> dict[str, Parameter]:
    """The calibrated numbers as a fit without any effect has them; the others as they are.

    A declared number that is an effect itself may only move within the tolerance of the declared one.
    """
    found: dict[str, float] = {}
    t, e, k = (result.selections.get(channel) for channel in "TEK")
    if t is not None and t.chosen and result.torque is not None:
        numbers = fitted_numbers(result.torque, t.before, LARGEST_STEP)
        found |= {name: one.value for name, one in numbers.items()}
        # its correction moves too far
        found["sigma_0"] = found["coulomb"] * result.torque.friction.law.numbers["sigma_0"]
    if e is not None and e.chosen:
        loop = e.problem.named(e.before)
        found |= {name: loop[name].value for name in ("resistance", "torque_constant")}
    if k is not None and k.chosen and (compliance := k.problem.named(k.before)["compliance"].value) > 0:
        found["stiffness"] = 1.0 / compliance
    found = {name: x for name, x in found.items() if name in calibrated and np.isfinite(x)}
    out = calibrated | {name: replace(calibrated[name], value=x) for name, x in found.items()}
    for changed in (CHANGES[f.name] for f in effects if f.name in CHANGES):
        for number in set(changed.numbers) & set(out):
            declared = result.declared.number(number)
            value = float(np.clip(out[number].value, declared / changed.factor, declared * changed.factor))
            out[number] = replace(out[number], value=value)
    return out


def with_declared_lines(model: PlantModel, axis: str, result: AxisResult, fit: Fit | None) -> PlantModel:
    """The model with its own periodic torques at the size and phase that `fit` of channel T gives them."""
    t = result.selections.get("T")
    if t is None or fit is None or not result.declared.lines:
        return model
    labels = [name for name, _ in t.problem.base_labels]
    effects = []
    for effect in getattr(model.axes, axis).effects:
        stage = stage_of_wave(effect)
        line, label = (effect.name, stage, effect.harmonic), f"declared {stage} {effect.harmonic}"
        if effect.enabled and line in result.declared.lines and label in labels:
            at = slice(labels.index(label), labels.index(label) + 2)
            c, s = fit.beta[at]  # the motors' counter-torque c cos + s sin
            size, variance = float(np.hypot(c, s)), np.trace(fit.covariance[at, at])
            # a line that this motion does not show stays as declared
            if size <= REGISTRY[effect.name].parameter("amplitude").high and variance <= size**2:
                sizes = {"amplitude": size, "phase": float(np.arctan2(-s, c))}
                found = {name: Parameter(value, "") for name, value in sizes.items()}
                place = {"stage": stage, "harmonic": effect.harmonic}
                wave = Finding(effect.name, "T", "axis_angle", parameters=found, **place)
                (made,) = NAMES[effect.name].to_plant(wave, Facts("")).effects
                numbers = {name: replace(made.parameters[name], source="re-calibrated") for name in sizes}
                effect = replace(effect, parameters={**effect.parameters, **numbers})
        effects.append(effect)
    return with_effects(model, axis, effects)
