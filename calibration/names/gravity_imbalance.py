"""A weight that hangs off the axis."""

from collections.abc import Iterable
from dataclasses import replace
from math import pi

import numpy as np

from calibration.inputs.declaration import GUESSED, Stage
from calibration.inputs.train import OF_A_GUESS, SHAFT
from calibration.names.lines import SAME, line
from calibration.names.name import Array, Beside, Candidate, Finding, Made, Name, Scene, value
from plant.effects import REGISTRY
from plant.effects.signals import ANGLE
from plant.evaluate import evaluate, signals

LEAST_TURN = 1 / 12  # of a turn that is travelled: on less, a sine is a slope and an offset. ASSUMPTION
SWUNG = 2.0  # turns: what carries a weight is hardly swung round more often. ASSUMPTION
# likewise, on less than which it is not even a slope of its own beside an offset. ASSUMPTION
SLOPE_TURN = 1 / 72


def gravity(s: Scene, x: Array | None = None) -> Array:
    """cos and sin (n_full, 2) of the angle, or of angles `x` (n_full,): the effect's own formula at phases 0
    and 90 degrees. Those of a load that is declared are per unit of it."""
    rows = signals(len(s.view.t), {ANGLE: (s.view.x if x is None else x) / s.turn * 2 * pi})
    carried = s.view.columns.get("load", 1.0)
    sizes = ({"amplitude": 1.0, "phase": phase} for phase in (0.0, pi / 2))
    return np.column_stack([carried * evaluate(NAME.name, rows, p) for p in sizes])


def forces_once_a_turn(stages: Iterable[Stage], turn: float) -> tuple[str, ...]:
    """Names of forces that stages of this period (position units) have; a kind of shaft is no effect."""
    once = [g for g in stages if g.period and abs(g.period / turn - 1) < SAME]
    kinds = [k for g in once for k in (OF_A_GUESS if g.kind == GUESSED else (g.declared or "",))]
    shown = (REGISTRY.get(kind, REGISTRY[SHAFT]) for kind in kinds)
    return tuple(dict.fromkeys(effect.name for effect in shown if effect.channel == "T"))


def once_a_turn(f: Finding, s: Scene) -> Finding:
    """A force once per turn: a weight first; of a declared motor that turns on and on, its own force."""
    if not s.force or s.view.response.is_speed or s.pair is not None:
        return f
    if f.harmonic != 1 or abs((f.order or 0.0) - 1) > SAME:
        return f
    turning = s.view.rig.stages if s.span > SWUNG * s.turn else ()
    motors = [g for g in turning if g.of_motor and forces_once_a_turn([g], s.turn)]
    name = forces_once_a_turn(motors, s.turn)[0] if motors else NAME.name if not lacks(s) else f.name
    if f.name not in (NAME.name, *forces_once_a_turn(s.view.rig.stages, s.turn)) or f.name == name:
        return f
    alike = [x for x in dict.fromkeys((f.name, *f.equivalent)) if x != name]
    return replace(f, name=name, stage=motors[0].name if motors else "axis", equivalent=alike)


def columns(s: Scene) -> list[Candidate]:
    """One sine per turn, its phase fixed to the place: sessions share it when they share the zero.

    Behind a joint whose axis is parallel the weight lies over the sum of both angles.
    """
    if (s.pair is None and lacks(s)) or s.weighed:
        return []
    wound = ("cable_wrap",) if s.span < LEAST_TURN * s.turn else ()
    twins = (*forces_once_a_turn(s.view.rig.stages, s.turn), *wound)
    one = line(s, NAME.name, 1.0 / s.turn, stage="axis", harmonic=1, twins=twins)
    carried = replace(one, columns=s.at(gravity(s)))
    if "joint" not in s.view.columns:
        return [carried]
    both = s.at(gravity(s, s.view.x + s.view.columns["joint"]))
    return [carried, replace(one, columns=both, note="over the sum of this joint's angle and the other's")]


def lacks(s: Scene) -> str:
    """An angle, and enough of it."""
    if not s.view.turn:
        return "an angle: give position in rad, deg or turns, or 'turn' (position units per turn)"
    if s.span < SLOPE_TURN * s.view.turn:
        return f"a motion over at least {SLOPE_TURN:.2g} turns"
    return ""


NAME = Name(
    name="gravity_imbalance",
    scaled=True,
    columns=columns,
    # the motors give A cos(angle + phase); the axis has minus that, A cos(angle - phase)
    to_plant=lambda f, facts: Made().added(
        f, facts, amplitude=value(f, "amplitude"), phase=pi - value(f, "phase")
    ),
    experiment="move through at least 60 degrees slowly, there and back, another weight changes it, a "
    "spring stays",
    lacks=lacks,
    beside=Beside(single=True),
)
