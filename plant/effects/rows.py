"""From the effects of a plant model to the rows of numbers that the kernel reads."""

import hashlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from plant.effects import REGISTRY
from plant.effects.base import Effect
from plant.effects.dispatch import KINDS as KINDS
from plant.effects.signals import MOTOR_HOOKS, Hook
from plant.effects.targets import DOMAINS, TARGETS
from plant.effects.unknown import CHOICE, COUNT, DOMAIN, FIRST, KIND, KNOTS, PERIOD
from plant.effects.unknown import KINDS as INTERPOLATIONS
from plant.gears import ORDERS
from plant.kernels.layout import EFFECTS, MAX_EFFECTS, MEMORY_SIZE, ROW, ROW_MEMORY, ROWS_ALL, ROWS_MOTOR
from plant.parts import EffectModel, Function
from plant.units import to_si

FIRST_PARAMETER = ROW_MEMORY + MEMORY_SIZE
ENCODERS = (Hook.INCREMENTAL, Hook.ABSOLUTE, Hook.AUXILIARY)
STAGE_ENCODER = {"axis": Hook.ABSOLUTE, "roller": Hook.INCREMENTAL, "aux": Hook.AUXILIARY}


def number_from(seed: int, name: str) -> float:
    """Return a whole number below 2**53 from a seed and a name, the same on every machine."""
    digest = hashlib.sha256(f"{seed}:{name}".encode()).digest()
    return float(int.from_bytes(digest[:8], "little") >> 11)


def values(model: EffectModel) -> dict[str, float]:
    """Return the parameters of an effect in SI units, defaults filled in."""
    effect = REGISTRY[model.name]
    result: dict[str, float] = {}
    for spec in effect.parameters:
        given = model.parameters.get(spec.name)
        result[spec.name] = to_si(spec.default, spec.unit) if given is None else given.si
    return result


def vector(
    effect: Effect, order: float, parameters: Mapping[str, float], constants: Mapping[str, float]
) -> list[float]:
    """Return what follows the memory in a formula's `p`: [order,] parameters, constants; SI units."""
    start = [order] if effect.staged else []
    return [
        *start,
        *(parameters[spec.name] for spec in effect.parameters),
        *(constants[name] for name in effect.constants),
    ]


def order_of(model: EffectModel) -> float:
    """Return the order of a staged effect, cycles per axis turn; 0 for the others."""
    return ORDERS[model.stage] * model.harmonic if model.stage is not None else 0.0


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


def write(
    world: NDArray[np.float64],
    effects: tuple[EffectModel, ...],
    constants: Mapping[str, float],
    seed: int,
    axis: str,
) -> None:
    """Write the enabled effects of one axis into its row of the world; ValueError when they are too many.

    Effects of the hooks SWITCH and LOG do not act in the step and are left out (see world.py and AxisPort).
    """
    rows: list[tuple[Hook, list[float]]] = []
    for k, model in enumerate(effects):
        if not model.enabled:
            continue
        effect = REGISTRY[model.name]
        parameters = values(model)
        numbers = (
            _function(model.function)
            if model.function
            else vector(effect, order_of(model), parameters, constants)
        )
        for term in effect.terms:
            hook = _hook(model, term.hook, parameters)
            if hook in (Hook.SWITCH, Hook.LOG) or (
                hook is Hook.TRANSMISSION and parameters.get("kinematic") == 0.0
            ):
                continue
            memory = [0.0, 0.0, 0.0, number_from(seed, f"{axis}.{model.name}.{k}")]
            rows.append((hook, [float(hook), float(KINDS[term.formula]), *memory, *numbers]))
    if len(rows) > MAX_EFFECTS:
        raise ValueError(
            f"plant model: axes.{axis}.effects: {len(rows)} effects, at most {MAX_EFFECTS} can act at once"
        )
    rows.sort(key=lambda row: row[0])  # stable: the file's order within a hook
    for place, (_, row) in enumerate(rows):
        start = EFFECTS + place * ROW
        world[start : start + ROW] = 0.0
        world[start : start + len(row)] = row
    world[ROWS_MOTOR] = sum(1 for hook, _ in rows if hook < MOTOR_HOOKS)
    world[ROWS_ALL] = len(rows)
