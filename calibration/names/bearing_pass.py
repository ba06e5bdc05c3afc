"""A line over position at a period of no stage."""

from dataclasses import replace
from math import pi

import numpy as np

from calibration.inputs.declaration import GUESSED, Stage
from calibration.inputs.train import MESH, OF_A_GUESS, SHAFT
from calibration.names.lines import OWN, cell, has_train, movable, peaks_over_place, seen
from calibration.names.name import SEARCHED_WORTH, Array, Candidate, Finding, Made, Name, value
from calibration.names.scene import FORCE, SENSORS, SPEED, Scene
from calibration.statistics.orders import order_spectrum, peaks
from plant.effects import REGISTRY

NARROW = 0.2  # of a stage's harmonic: an interval that holds a whole one by chance once in five. ASSUMPTION
# rollers that pass in a turn of a shaft: a bearing has 7 to 30, six tenths of which pass (Harris, Rolling
# Bearing Analysis, 25). ASSUMPTION: slewing rings, which have more, sit on shafts that turn slowly
MOST_ROLLERS = 18.0
# turns of a bearing's cage, its slowest part, per turn of its shaft: 0.35 to 0.45 (Harris). ASSUMPTION: less
CAGE = 0.3
MOST = 6  # lines that are tried of a drive with one motor. ASSUMPTION
HARMONICS = 3  # harmonics of an axis' stage at least, at which no line is free. ASSUMPTION
TOP = 3000.0  # cycles per turn that are searched on an axis whose position is absolute. ASSUMPTION
FREE = 4  # lines that are tried there. ASSUMPTION
APART = 1.5  # share of 1 / travel that lies between them at least. ASSUMPTION
# parts of such a cell, places about each line: it is refined from the best. ASSUMPTION
SHIFTS = (-0.2, 0.0, 0.2)


def free_lines(s: Scene) -> list[Candidate]:
    """Lines over position at no stage's period that stand out of the residual; of a pair the strongest."""
    least = HARMONICS if s.pair is not None else 0
    turning = [(g.period, g.listed or range(1, max(g.harmonics, least) + 1)) for g in s.view.rig.stages]
    taken = np.array([h / period for period, orders in turning if period for h in orders])
    if s.span <= 0:
        return []
    if s.pair is not None:
        found = strongest(s, np.ones(len(s.problem.y)), taken)
    else:
        peaked = peaks_over_place(s, MOST)
        found = [f for f in peaked if np.all(np.abs(f - taken) * s.span >= OWN) and seen(s, f)]
    return [c for rate in found for c in movable(s, rate, between(rate, taken, s.span))]


def strongest(s: Scene, weight: Array, taken: Array | None = None) -> list[float]:
    """Rates (1/position unit) about a pair's strongest lines times `weight` (n_fitted,), off the `taken`."""
    rows, turns, cells = s.problem.train, s.view.x[s.view.rows] / s.turn, s.turn / s.span
    e = np.where(rows, s.residual, 0.0)
    orders, power = order_spectrum(e, turns, np.where(rows, weight, 0.0), TOP)
    if taken is not None and len(orders):
        near = np.min(np.abs(orders[:, None] - taken[None, :] * s.turn), axis=1) < OWN * cells
        power = np.where(near, 0.0, power)
    found = peaks(orders, power, FREE, APART * cells)
    return [float(order) / s.turn + shift / s.span for order in found for shift in SHIFTS]


def between(rate: float, known: Array, span: float) -> tuple[float, float]:
    """How far a rate may be moved: within its resolution cell, and not to where a stage's begins."""
    low, high = cell(rate, span)
    near = known[np.abs(known - rate) < 1.0 / span]
    low = max([low, *(near[near < rate] + OWN / span).tolist()])
    return low, max(low, min([high, *(near[near >= rate] - OWN / span).tolist()]))


def of_no_stage(f: Finding, s: Scene) -> Finding:
    """A line at an order that no stage has is a bearing only when the gear table is there to say so."""
    if f.name != NAME.name or not (order := f.order):
        return f
    f = replace(f, note=f"period {(s.view.turn or 1.0) / order:.5g} {s.angle_unit}")
    stage, harmonic = _harmonic_of(f, s)
    turning = [s.turn / g.period for g in s.view.rig.stages if g.period]
    slow = bool(turning) and order < CAGE * min(turning)
    if stage is None and has_train(s) and not slow and order <= MOST_ROLLERS * max(turning):
        return f
    name = _called(stage, f)
    alike = [x for x in dict.fromkeys([*f.equivalent, *_others(f), NAME.name]) if x != name]
    f = replace(f, name=name, equivalent=alike)
    if stage is None:
        declared = f"{'every' if slow else 'no'} declared stage turns quicker"
        table = declared if s.view.rig.stages else "no gear table was given"
        return replace(f, stage=None).noted(f"{table}, so its stage cannot be named")
    sizes = {k: p for k, p in f.parameters.items() if k != "order"}  # the stage and its harmonic say it
    shaft = replace(f, stage=stage.name, harmonic=harmonic, parameters=sizes)
    return shaft.noted(f"the order's interval holds {harmonic} times that of {stage.name}")


def _others(f: Finding) -> tuple[str, ...]:
    """Names that a part of unknown kind has in this balance: two sensors see no magnets."""
    return OF_A_GUESS if f.channel == "T" else (SHAFT, MESH)


def of_a_guess(f: Finding, s: Scene) -> Finding:
    """A line of a stage of which nobody said whether it is a gear or a motor."""
    guessed = any(g.name == f.stage and g.kind == GUESSED for g in s.view.rig.stages)
    alike = [x for x in dict.fromkeys([*f.equivalent, *_others(f)]) if x != f.name]
    return replace(f, equivalent=alike) if guessed and f.name == SHAFT else f


def _harmonic_of(f: Finding, s: Scene) -> tuple[Stage | None, int]:
    """The quickest stage of which a whole multiple lies within the order's interval, and the multiple."""
    order = f.parameters.get("order")
    if order is None or order.low is None or order.high is None:
        return None, 0
    for stage in sorted((g for g in s.view.rig.stages if g.period), key=lambda g: g.period or 0.0):
        at, low, high = (x * (stage.period or 0.0) / s.turn for x in (order.value, order.low, order.high))
        if high - low < NARROW and low <= (harmonic := max(round(at), 1)) <= high:
            return stage, harmonic
    return None, 0


def _called(stage: Stage | None, f: Finding) -> str:
    """What a stage's line is called in this balance."""
    effect = REGISTRY.get((stage.declared if stage else None) or SHAFT)
    return effect.name if effect is not None and effect.channel == f.channel else SHAFT


NAME = Name(
    name="bearing_pass",
    searched=True,
    channels=(FORCE, SENSORS, SPEED),
    # lines that stand out of the residual's spectrum over position; of a pair of its torque
    columns=lambda s: free_lines(s) if s.pair is None or s.force else [],
    # the motors give A cos(x + phase); the axis has minus that
    to_plant=lambda f, facts: Made().added(
        f, facts, amplitude=value(f, "amplitude"), phase=value(f, "phase") - pi / 2, order=f.order or 0.0
    ),
    experiment="twice the travel: the order stands clear of every gear, or declare the gears",
    worth=SEARCHED_WORTH,
)
