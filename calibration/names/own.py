"""Names whose columns are the effect's own formula: a torque at the axis, or its friction."""

from collections.abc import Mapping
from itertools import product
from math import pi
from typing import Any

import numpy as np

from calibration.arrays import Array
from calibration.balances.candidate import Candidate
from calibration.inputs.declaration import Stage
from calibration.names.name import STEP, Name, Scene
from calibration.names.name import tried as first_value
from plant.effects import REGISTRY
from plant.effects import signals as column
from plant.effects.base import MESHES, STAGES, Effect
from plant.effects.signals import Hook
from plant.evaluate import evaluate, signals
from plant.units import to_si


def from_formula(name: str, *, size: str, tried: Mapping[str, tuple[float, ...]], experiment: str) -> Name:
    """The name of an effect that needs nothing but its formula, which is linear in the parameter `size`.

    `tried` are first values of other parameters, each in its unit; the best is refined. What is not tried
    keeps its default. ValueError for another hook than the axis' torque or its friction.
    """
    effect = REGISTRY[name]
    if [term.hook for term in effect.terms] not in ([Hook.AXIS_TORQUE], [Hook.FRICTION]):
        raise ValueError(f"{name}: only a torque at the axis, or its friction, is found by its formula alone")

    def columns(s: Scene) -> list[Candidate]:
        if lacks(s):
            return []
        places: list[Stage | None] = [None]
        if effect.staged:
            places = [g for g in s.view.rig.stages if g.period and fits(effect, g)]
        return [c for g in places for c in own_candidates(effect, size, tried, s, g)]

    return Name(name=name, columns=columns, experiment=experiment, lacks=lacks)


def lacks(s: Scene) -> str:
    """The formula's angle is in rad."""
    return "" if s.view.turn else "an angle: position in rad, deg or turns, or 'turn'"


def fits(effect: Effect, stage: Stage) -> bool:
    """Whether the effect may sit on a stage: by the telescope's names, or a mesh on a mesh."""
    if stage.name in STAGES:
        return stage.name in effect.stages
    return (stage.kind == "gear_mesh") == (effect.stages == MESHES)


def own_candidates(
    effect: Effect, size: str, tried: Mapping[str, tuple[float, ...]], s: Scene, stage: Stage | None = None
) -> list[Candidate]:
    """One candidate per set of tried values: what accelerates is torque that the motors need not give."""
    scale = 2 * pi / (s.view.turn or 1.0)
    clock = s.view.t if s.pair is None else s.view.clock
    along = {column.TIME: clock, column.ANGLE: s.view.x * scale, column.RATE: s.view.speed * scale}
    rows = signals(len(clock), along | _friction(s, scale))
    order = (s.view.turn or 1.0) / stage.period if stage is not None and stage.period else None
    specs = [effect.parameter(k) for k in tried]
    one = effect.parameter(size)
    fixed = {p.name: to_si(p.default, p.unit) for p in effect.parameters}
    fixed |= {one.name: to_si(1.0, one.unit), "order": order or 0.0}
    of_friction = effect.terms[0].hook == Hook.FRICTION

    def shape(values: Array) -> Array:
        tried_now = ((p, float(np.clip(v, p.low, p.high))) for p, v in zip(specs, values, strict=False))
        given = fixed | {p.name: to_si(v, p.unit) for p, v in tried_now}
        torque = -np.asarray(evaluate(effect.name, rows, given))
        return (s.answer(torque * np.sign(rows[:, column.RATE])) if of_friction else s.at(torque))[:, None]

    place: dict[str, Any] = {"order": order, "sign": int(one.low >= 0)}
    place |= {"stage": stage.name, "harmonic": 1} if stage is not None else {}
    out, sized = [], (size, s.unit if one.unit == "N m" else one.unit)
    for values in product(*tried.values()):
        at = {p.name: (v, p.unit) for p, v in zip(specs, values, strict=True)}
        # of the way to the next tried value, or of the value itself where one is tried
        rows_of = zip(values, tried.values(), strict=True)
        apart = (min((abs(x - v) for x in row if x != v), default=abs(v)) for v, row in rows_of)
        steps = tuple(STEP * x for x in apart)
        out.append(first_value(effect.name, shape, sized, at=at, steps=steps, **place))
    return out


def _friction(s: Scene, scale: float) -> dict[int, Array]:
    """The declared friction, one value per row, for the formulas that change it; `scale` rad per position."""
    law, coulomb = s.sliding.law, max(s.declared.get("coulomb", 0.0), 0.0)
    numbers = {
        column.SIGMA0: 1.0,
        column.SIGMA2: s.declared.get("viscous", 0.0) / scale,
        column.COULOMB: coulomb,
        column.STICTION: coulomb * law.stiction_ratio,
        column.STRIBECK_RATE: law.stribeck_speed * scale,
        column.STRIBECK_EXPONENT: law.stribeck_exponent,
    }
    return {place: np.full(len(s.view.t), value) for place, value in numbers.items()}
