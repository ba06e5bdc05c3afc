"""All friction scaled by another preload."""

from dataclasses import replace

import numpy as np

from calibration.finding import Parameter
from calibration.names.magnet_weakening import LENGTHS
from calibration.names.name import Array, Beside, Candidate, Facts, Finding, Made, Name, Scene, as_found
from calibration.names.onsets import steps

SHORTEST_S = 0.01  # s, of a change that is sudden: the plant's shortest (docs/reference/effects.md)


def columns(s: Scene) -> list[Candidate]:
    """Stiction and viscous friction times a step in time; of a pair, logged for minutes, times a ramp."""
    f = s.sliding
    if s.pair is None and (lacks(s) or not s.declared.get("coulomb", 0.0) > 0 or not s.speeds):
        return []
    lengths, most = (LENGTHS, 1.0) if s.pair is not None else ((), np.inf)

    def weigh(x: Array) -> Array:
        return s.at(f.answer(f.stiction * x) + f.drag * x)

    return steps(s, NAME.name, ("change", "1"), weigh, lengths, most=most)


def lacks(s: Scene) -> str:
    """Friction of two kinds."""
    if not s.declared.get("viscous", 0.0) > 0:
        return "viscous friction beside Coulomb's, at two speeds: else a brake looks the same"
    return ""


def to_plant(f: Finding, facts: Facts) -> Made:
    """A step is a ramp of the shortest duration; time runs from the log's first row."""
    return as_found(replace(f, parameters={"duration": Parameter(SHORTEST_S, "s"), **f.parameters}), facts)


NAME = Name(
    name="preload_change",
    columns=columns,
    relative={"change": ("viscous", 1)},
    to_plant=to_plant,
    experiment="repeat the same run after a rest: a preload that has changed stays",
    lacks=lacks,
    beside=Beside(single=True),
)
