"""Friction that changes over the position."""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from calibration.names.bearing_pass import strongest
from calibration.names.inplant import Facts, Made, value
from calibration.names.lines import STEP_OF_CELL, as_one, line, of_stage
from calibration.names.name import Array, Candidate, Finding, Name, Scene, both_ways, tried
from plant.gears import ORDERS

HARMONICS = 3  # harmonics of the travelled range. ASSUMPTION
OF_STAGE = 12  # harmonics of every stage. ASSUMPTION
ENOUGH = 1.5  # turns of a stage, before friction over it differs from friction over the range. ASSUMPTION
WAVES = np.arange(0.75, 12.1, 0.5)  # over the travelled range, of a friction that follows no stage
BESIDE = 2.0  # part of the friction that is fitted without the effect: what it may be beside it. ASSUMPTION
# rad by which a line of the nearest possible order may walk off within half the travel. ASSUMPTION
MISPLACED = 0.1


def columns(s: Scene) -> list[Candidate]:
    """Sines odd in direction: over the range, over every slow stage, and of any length; where positions are
    absolute the strongest orders, whatever their stage."""
    if s.span <= 0 or not (s.both or s.pair):
        return []
    if s.pair is not None:
        return [_line(s, rate) for rate in strongest(s, s.answer(np.ones(len(s.view.x))))]
    # friction that changes its sign would feed energy; how much there is is known beside the effect
    form: dict[str, Any] = {"stage": "axis", "most": BESIDE * s.declared.get("coulomb", 0.0) or np.inf}
    period = min(s.span, s.view.turn or s.span)
    out = [_line(s, h / period, harmonic=h, **form) for h in range(1, HARMONICS + 1)]
    for stage in s.view.rig.stages:
        short = replace(stage, harmonics=min(stage.harmonics, OF_STAGE))
        mine = of_stage(s, short, line(s, NAME.name, 0.0, **form), s.view.direction, ENOUGH)
        out += [*mine, *as_one(mine)]
    # waves over the range whose length is fitted
    one, shape, size = s.turn / s.span, partial(_waves, s), ("amplitude", s.unit)
    form |= {"steps": (STEP_OF_CELL * one,), "kind": "line"}
    return out + [tried(NAME.name, shape, size, at={"order": (w * one, "1")}, **form) for w in WAVES]


def _line(s: Scene, rate: float, **more: Any) -> Candidate:
    return replace(line(s, NAME.name, rate, **more), columns=_waves(s, np.array([rate * s.turn])))


def _waves(s: Scene, order: Array) -> Array:
    phase = 2 * np.pi * s.view.x * (float(order[0]) / s.turn)
    return np.column_stack([s.answer(np.cos(phase)), s.answer(np.sin(phase))])


def to_plant(f: Finding, facts: Facts) -> Made:
    """The stage and harmonic whose order is nearest, its phase right at mid travel; a cosine there, too."""
    order = f.order or ORDERS[f.stage or "axis"] * (f.harmonic or 1)
    stage, harmonic = nearest_place(order)
    written = ORDERS[stage] * harmonic
    phase = -value(f, "phase") + (written - order) * facts.middle
    made = Made().add(f.name, facts, {"amplitude": value(f, "amplitude"), "phase": phase}, stage, harmonic)
    off = abs(written - order) * facts.span / 2
    if off > MISPLACED:
        place = f"{stage}, harmonic {harmonic} ({written:.5g}): {off:.2f} rad off at the ends of the travel"
        made.remarks.append(f"position_friction: order {order:.5g} is written as {place}")
    return made


def nearest_place(order: float) -> tuple[str, int]:
    """Stage and harmonic (1 to 1000) whose order is nearest; of equals, the lowest harmonic."""
    harmonics = {stage: int(np.clip(round(order / one), 1, 1000)) for stage, one in ORDERS.items()}
    _, harmonic, stage = min((abs(ORDERS[k] * h - order), h, k) for k, h in harmonics.items())
    return stage, harmonic


NAME = Name(
    name="position_friction",
    scaled=True,
    columns=columns,
    to_plant=to_plant,
    experiment="go there and back over the same place: friction changes its sign, a gear or cogging does not",
    lacks=both_ways,
    waves_of_friction=True,
)
