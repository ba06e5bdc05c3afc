"""From the effects of a plant model to the rows of numbers that the kernel reads."""

import hashlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from plant.effects import REGISTRY
from plant.effects.base import Effect
from plant.effects.signals import MOTOR_HOOKS, Hook
from plant.effects.targets import DOMAINS, TARGETS
from plant.effects.unknown import CHOICE, COUNT, DOMAIN, FIRST, KIND, KNOTS, PERIOD
from plant.effects.unknown import KINDS as INTERPOLATIONS
from plant.gears import ORDERS
from plant.kernels.dispatch import KINDS as KINDS
from plant.kernels.layout import EFFECTS, MAX_EFFECTS, ROW, ROWS_ALL, ROWS_MOTOR
from plant.parts import EffectModel, Function
from plant.units import to_si

ENCODERS = (Hook.INCREMENTAL, Hook.ABSOLUTE, Hook.AUXILIARY)
STAGE_ENCODER = {"axis": Hook.ABSOLUTE, "roller": Hook.INCREMENTAL, "aux": Hook.AUXILIARY}


def number_from(seed: int, name: str) -> float:
    """Return a whole number below 2**53 from a seed and a name, the same on every machine."""
    digest = hashlib.sha256(f"{seed}:{name}".encode()).digest()
    return float(int.from_bytes(digest[:8], "little") >> 11)


def values(model: EffectModel) -> dict[str, float]:
    """Return the parameters of an effect in SI units, defaults filled in; of a staged effect the order, too,
    in cycles per axis turn.
    """
    effect = REGISTRY[model.name]
    result: dict[str, float] = {}
    if model.stage is not None:
        result["order"] = ORDERS[model.stage] * model.harmonic
    for spec in effect.parameters:
        given = model.parameters.get(spec.name)
        result[spec.name] = to_si(spec.default, spec.unit) if given is None else given.si
    return result


def vector(effect: Effect, numbers: Mapping[str, float]) -> list[float]:
    """Return what follows memory and seed in an effect's row."""
    return [numbers[name] for name in effect.numbers]


def _function(function: Function) -> list[float]:
    row = [0.0] * (FIRST + 2 * KNOTS)
    row[DOMAIN] = float(DOMAINS[function.domain])
    row[KIND] = INTERPOLATIONS[function.interpolation]
    row[CHOICE] = float(function.motor)
    row[PERIOD] = function.period
    row[COUNT] = float(len(function.knots))
    for k, (x, y) in enumerate(function.knots):
        row[FIRST + k] = x
        row[FIRST + KNOTS + k] = y
    return row


def _hook(model: EffectModel, hook: Any, parameters: Mapping[str, float]) -> Hook:
    if model.function is not None:
        return TARGETS[model.function.target]
    if hook != "encoder":
        return Hook(hook)
    if "encoder" in parameters:
        return ENCODERS[int(parameters["encoder"])]
    return STAGE_ENCODER[str(model.stage)]


def rows_of(
    effects: tuple[EffectModel, ...], constants: Mapping[str, float], seed: int, axis: str
) -> list[tuple[Hook, int, list[float]]]:
    """Return the rows of the enabled effects in the order of the kernel: hook, place in `effects`, numbers.

    Effects of the hooks SWITCH and LOG do not act in the step and are left out (see world.py and AxisPort).
    """
    rows: list[tuple[Hook, int, list[float]]] = []
    for k, model in enumerate(effects):
        if not model.enabled:
            continue
        effect = REGISTRY[model.name]
        parameters = values(model)
        numbers = _function(model.function) if model.function else vector(effect, {**constants, **parameters})
        for term in effect.terms:
            hook = _hook(model, term.hook, parameters)
            if hook in (Hook.SWITCH, Hook.LOG) or (
                hook is Hook.TRANSMISSION and parameters.get("kinematic") == 0.0
            ):
                continue
            memory = [0.0, 0.0, 0.0, number_from(seed, f"{axis}.{model.name}.{k}")]
            rows.append((hook, k, [float(hook), float(KINDS[term.formula]), *memory, *numbers]))
    if len(rows) > MAX_EFFECTS:
        raise ValueError(
            f"plant model: axes.{axis}.effects: {len(rows)} effects, at most {MAX_EFFECTS} can act at once"
        )
    return sorted(rows, key=lambda row: row[0])  # stable: the file's order within a hook


def write(
    world: NDArray[np.float64],
    effects: tuple[EffectModel, ...],
    constants: Mapping[str, float],
    seed: int,
    axis: str,
) -> None:
    """Write the enabled effects of one axis into its row of the world; ValueError when they are too many."""
    rows = rows_of(effects, constants, seed, axis)
    for place, (_, _, row) in enumerate(rows):
        start = EFFECTS + place * ROW
        world[start : start + ROW] = 0.0
        world[start : start + len(row)] = row
    world[ROWS_MOTOR] = sum(1 for hook, _, _ in rows if hook < MOTOR_HOOKS)
    world[ROWS_ALL] = len(rows)
