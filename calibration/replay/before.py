"""The declared model re-calibrated without the effects: what "before" means for a closed loop."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from calibration.corrected.making import wrapped
from calibration.decide.tolerance import SIGMA_TOLERANCE, TOLERANCE
from calibration.declaredplant import PERIODIC
from calibration.finding import Finding, Parameter
from calibration.statistics.regression import Fit
from calibration.twomotors.result import AxisResult
from plant.effects import REGISTRY
from plant.model import PlantModel, with_effects
from plant.parts import Number

LARGEST_STEP = (
    0.3  # log of a ratio: linear corrections of the bristle's shape hold no further (channels/declared.py)
)


def before_numbers(
    result: AxisResult, calibrated: dict[str, Parameter], effects: list[Finding]
) -> dict[str, Parameter]:
    """The calibrated numbers as a fit without any effect has them; the others as they are.

    A declared number that is an effect itself may only move within the tolerance of the declared one.
    """
    out = dict(calibrated)
    t = result.selections.get("T")
    if t is not None and t.chosen and result.torque is not None:
        f, beta = result.torque.friction, t.before.beta
        ratio, speed = np.clip(beta[3:5], -LARGEST_STEP, LARGEST_STEP)
        coulomb = float(beta[2])
        _put(out, "inertia", float(beta[0]))
        _put(out, "viscous", float(beta[1]))
        _put(out, "coulomb", coulomb)
        _put(out, "stiction", coulomb * f.ratio * float(np.exp(ratio)))
        _put(out, "stribeck_speed", f.stribeck_speed * float(np.exp(speed)))
        _put(out, "sigma_0", coulomb * f.stiffness)
    e = result.selections.get("E")
    if e is not None and e.chosen:
        for k, (name, _) in enumerate(e.problem.base_labels[:2]):
            _put(out, name, float(e.before.beta[k]))
    k_channel = result.selections.get("K")
    if k_channel is not None and k_channel.chosen and k_channel.before.beta[0] > 0:
        _put(out, "stiffness", 1.0 / float(k_channel.before.beta[0]))
    changed = {f.name for f in effects}
    d = result.declared
    for name, number, declared, factor in (
        ("coulomb_change", "coulomb", d.coulomb, TOLERANCE),
        ("viscous_change", "viscous", d.viscous, TOLERANCE),
        ("stribeck_change", "stiction", d.stiction, TOLERANCE),
        ("stribeck_change", "stribeck_speed", d.stribeck_speed, TOLERANCE),
        ("presliding", "sigma_0", d.sigma_0, SIGMA_TOLERANCE),
        ("shaft_compliance", "stiffness", d.stiffness, TOLERANCE),
    ):
        if name in changed and number in out:
            _put(out, number, float(np.clip(out[number].value, declared / factor, declared * factor)))
    return out


def _put(out: dict[str, Parameter], name: str, value: float) -> None:
    if name in out and np.isfinite(value):
        out[name] = replace(out[name], value=value)


def with_declared_lines(model: PlantModel, axis: str, result: AxisResult, fit: Fit | None) -> PlantModel:
    """The model with its own periodic torques at the size and phase that `fit` of channel T gives them."""
    t = result.selections.get("T")
    if t is None or fit is None or not result.declared.lines:
        return model
    labels = [name for name, _ in t.problem.base_labels]
    effects = []
    for effect in getattr(model.axes, axis).effects:
        stage = effect.stage or PERIODIC.get(effect.name)
        label = f"declared {stage} {effect.harmonic}"
        if (
            effect.enabled
            and (effect.name, stage, effect.harmonic) in result.declared.lines
            and label in labels
        ):
            at = slice(labels.index(label), labels.index(label) + 2)
            c, s = fit.beta[at]
            most = next(p.high for p in REGISTRY[effect.name].parameters if p.name == "amplitude")
            if np.hypot(c, s) > most or np.trace(fit.covariance[at, at]) > np.hypot(c, s) ** 2:
                effects.append(effect)  # this motion does not tell it: it stays as declared
                continue
            # the motors' counter-torque c cos + s sin as a sine on the axis; imbalance: cos(angle - phase)
            shift = float(np.arctan2(-s, c))
            phase = np.pi - shift if effect.name == "gravity_imbalance" else shift - np.pi / 2
            sizes = {"amplitude": float(np.hypot(c, s)), "phase": wrapped(phase)}
            numbers = {
                name: Number(value, "N m" if name == "amplitude" else "rad", "re-calibrated")
                for name, value in sizes.items()
            }
            effect = replace(effect, parameters={**effect.parameters, **numbers})
        effects.append(effect)
    return with_effects(model, axis, effects)
