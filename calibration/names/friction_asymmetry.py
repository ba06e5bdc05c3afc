"""More friction one way than the other."""

import numpy as np

from calibration.names.name import Beside, Candidate, Name, Scene, both_ways, candidate

STANDS = 0.02  # part of 1, standard deviation of |direction|: below, nothing stands still. ASSUMPTION
COULOMB, VISCOUS = "coulomb_asymmetry", "viscous_asymmetry"


def columns(s: Scene) -> list[Candidate]:
    """Even in direction, and gone at rest: a constant, with the speed, or both. Of an axis with two motors in
    parts of the declared friction, as in the plant file. More than the friction itself would push one way."""
    if s.pair is not None:
        one, speed = s.answer(s.view.direction * s.sliding.steady), np.abs(s.at(s.sliding.drag))
        both = candidate(NAME.name, np.column_stack([one, speed]), COULOMB, VISCOUS, most=(1.0, 1.0))
        return [both, candidate(NAME.name, one, COULOMB, most=1.0)]
    if not s.both:
        return []
    sizes = ((COULOMB, s.unit), (VISCOUS, f"{s.unit} s/{s.angle_unit}"))
    most = tuple(max(s.declared.get(n, np.inf), 0.0) or np.inf for n in ("coulomb", "viscous"))
    one, speed = s.at(np.abs(s.view.direction)), s.at(np.abs(s.view.speed))
    out = []
    # where nothing stands still, a constant is the offset of the base
    stands, varies = np.std(one) > STANDS, s.speeds
    if stands:
        out.append(candidate(NAME.name, one, sizes[0], most=most[0]))
    if varies:
        out.append(candidate(NAME.name, speed, sizes[1], most=most[1]))
    if stands and varies:
        out.append(candidate(NAME.name, np.column_stack([one, speed]), *sizes, most=most))
    return out


NAME = Name(
    name="friction_asymmetry",
    columns=columns,
    relative={COULOMB: ("coulomb", 1), VISCOUS: ("viscous", 1)},
    experiment="run both directions at two speeds, and read the effort at rest",
    lacks=both_ways,
    beside=Beside(single=True),
)
