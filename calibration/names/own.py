"""Names whose columns are the effect's own formula: a torque at the axis, linear in one size."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import product
from math import pi

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.names.name import FORCE, Name, OwnFormula
from calibration.names.scene import Scene
from calibration.readers.run import Array
from plant.effects import REGISTRY
from plant.effects.evaluate import evaluate, signals
from plant.effects.signals import ANGLE, RATE, TIME, Hook
from plant.units import to_si

STEP = 0.1  # of a tried value, for its refinement


def from_formula(
    name: str, size: str, tried: Mapping[str, tuple[float, ...]], twins: tuple[str, ...], experiment: str
) -> Name:
    """The name of an effect that needs nothing but its formula; see OwnFormula. ValueError for another hook
    than the axis' torque."""
    if [term.hook for term in REGISTRY[name].terms] != [Hook.AXIS_TORQUE] or REGISTRY[name].staged:
        raise ValueError(
            f"{name}: only a torque at the axis, of no gear stage, is found by its formula alone"
        )
    own = OwnFormula(size, tried)

    def columns(s: Scene) -> list[Candidate]:
        if lacks(s):
            return []
        scale = 2 * pi / (s.view.turn or 1.0)
        along = {TIME: s.view.t, ANGLE: s.view.x * scale, RATE: s.view.speed * scale}
        return own_candidates(name, own, along, s.at, s.unit)

    return Name(name, (FORCE,), columns, twins, experiment, lacks, own)


def lacks(s: Scene) -> str:
    """The formula's angle is in rad."""
    return "" if s.view.turn else "an angle: position in rad, deg or turns, or 'turn'"


def own_candidates(
    name: str, own: OwnFormula, along: Mapping[int, Array], at: Callable[[Array], Array], unit: str = ""
) -> list[Candidate]:
    """One candidate per set of tried values. `along` are full-rate signals (n,) in SI units, `at` takes a
    torque (n,) to the rows of the balance; what accelerates is torque that the motors need not give."""
    effect = REGISTRY[name]
    size = effect.parameter(own.size)
    specs = [effect.parameter(k) for k in own.tried]
    rows = signals(len(along[TIME]), dict(along))
    fixed = {p.name: to_si(p.default, p.unit) for p in effect.parameters} | {size.name: to_si(1.0, size.unit)}

    def shape(values: Array) -> Array:
        given = {
            p.name: to_si(float(np.clip(v, p.low, p.high)), p.unit)
            for p, v in zip(specs, values, strict=False)
        }
        return np.asarray(-at(np.asarray(evaluate(name, rows, {**fixed, **given}))))[:, None]

    return [
        Candidate(
            name,
            effect.domain,
            shape(np.array(values)),
            ((size.name, unit or size.unit),),
            sign=1 if size.low >= 0 else 0,
            fixed={p.name: (v, p.unit) for p, v in zip(specs, values, strict=True)},
            shape=shape if specs else None,
            steps=tuple(STEP * abs(v) for v in values),
            searched=len(specs),
        )
        for values in product(*own.tried.values())
    ]
