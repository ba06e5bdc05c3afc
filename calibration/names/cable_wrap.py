"""A cable bundle about an axis: a spring over its angle with a loop of its own."""

import numpy as np
from numpy.typing import NDArray

from calibration.balances.recursions import stop_operator
from calibration.names.gravity_imbalance import NAME as WEIGHT
from calibration.names.inplant import Facts, Made, value
from calibration.names.name import Array, Beside, Candidate, Finding, Name, Scene, both_ways, candidate, grid

# of a turn, in which the loop closes: the plant's widths are among them. ASSUMPTION
TRAVELS = (0.002, 0.005, 0.01, 0.02, 0.04)
NARROWEST = 1e-4  # of a turn, the narrowest loop. ASSUMPTION
NARROW_RAD = 0.01  # of a loop whose travel is not known. ASSUMPTION


def columns(s: Scene) -> list[Candidate]:
    """Stiffness over the angle, and a loop that closes within some travel."""
    if s.pair is None and lacks(s):
        return []
    v, turn = s.view, s.turn
    spring = v.x - float(np.mean(v.x[v.ok]))
    memory = v.file if s.pair is None else _memory(v.x, s.pair.motion.frame.session, v.resolved)

    def full(p: Array) -> Array:
        travel = max(float(p[0]), NARROWEST * turn)
        parts = [spring, stop_operator(v.x, memory, travel) / travel]
        return np.column_stack(parts if s.pair is None else [*parts, np.ones(len(v.x))])

    sizes = [("stiffness", f"{s.unit}/{s.angle_unit}"), ("hysteresis", s.unit)]
    sizes += [("neutral_torque", s.unit)] * (s.pair is not None)  # a rig's base has an offset
    travels = [travel for part in TRAVELS if v.resolved < (travel := part * turn) < s.span]
    alone = s.pair is not None or s.span >= turn or s.weighed  # a weight comes round again
    twins = () if alone else (WEIGHT.name,)
    along = ("width", travels, s.angle_unit)
    looped = grid(NAME.name, s.shaped(full), *sizes, along=along, positive=(0, 1), twins=twins)
    # a bundle that hangs freely has hardly a loop; of a weight it has the twin (decide/twins.py)
    if s.pair is None:
        looped.append(candidate(NAME.name, s.at(spring), sizes[0], positive=(0,), twins=twins))
    return looped


def _memory(x: Array, session: NDArray[np.int64], resolved: float) -> NDArray[np.int64]:
    """Labels (n,) of rows through which a bundle is followed. Between runs it stays as it is.

    What the axis moved within a session moved it, too. Another session goes on where it begins at the same
    place."""
    elsewhere = (np.diff(session) != 0) & (np.abs(np.diff(x)) > resolved)
    return np.concatenate([[0], np.cumsum(elsewhere)])


def to_plant(f: Finding, facts: Facts) -> Made:
    """The loop's travel is the Dahl width with the same area."""
    stiffness, hysteresis = value(f, "stiffness"), value(f, "hysteresis")
    centre = facts.middle - value(f, "neutral_torque") / stiffness if stiffness else facts.middle
    width = float(np.degrees(value(f, "width", NARROW_RAD)))
    return Made().added(f, facts, stiffness=stiffness, hysteresis=hysteresis, centre=centre, width=width)


def lacks(s: Scene) -> str:
    """An angle, enough of it, and both ways."""
    return WEIGHT.lacks(s) or both_ways(s)


NAME = Name(
    name="cable_wrap",
    columns=columns,
    to_plant=to_plant,
    experiment="a full turn both ways: a cable pulls back more the further it is wound, a weight comes "
    "round again",
    lacks=lacks,
    a_guess=True,
    beside=Beside(consequences={"T": ("preload_change", "friction_warmup")}, single=True),
)
