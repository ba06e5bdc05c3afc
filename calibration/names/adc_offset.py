"""A current that reads something while none flows."""

import numpy as np

from calibration.names.inplant import Facts, Made, value
from calibration.names.name import FORCE, VOLTS, Candidate, Finding, Name, Scene, candidate

EACH = ("offset_a", "offset_b")  # of two motors' readings at once: one effect of the plant each


def columns(s: Scene) -> list[Candidate]:
    """R times a constant of either sign, a reading's or both motors'; of a pair's torque just a constant."""
    w = s.windings
    if w is None:
        one = np.ones(len(s.problem.y))
        return [candidate(NAME.name, one, ("offset_torque", "N m"))] if s.pair is not None else []
    alone = [candidate(NAME.name, -w.resistance * rows, "offset", fixed=motor) for rows, motor in s.motors]
    each = np.hstack([c.columns for c in alone])
    return alone if s.pair is None else [candidate(NAME.name, each, *((n, "A") for n in EACH)), *alone]


def to_plant(f: Finding, facts: Facts) -> Made:
    """Of a motor's reading, of both, or N m of both readings' difference."""
    made = Made()
    if "offset" in f.parameters:
        made.add(f.name, facts, {"offset": value(f, "offset"), "motor": value(f, "motor")})
    elif EACH[0] in f.parameters:
        for motor, name in enumerate(EACH, 1):
            made.add(f.name, facts, {"offset": value(f, name), "motor": float(motor)})
    else:
        made.add(f.name, facts, {"offset": value(f, "offset_torque") / facts.per_ampere, "motor": 1.0})
        made.remarks.append("adc_offset: the torque does not tell the motors apart, written to motor A")
    return made


NAME = Name(
    name="adc_offset",
    channels=(FORCE, VOLTS),
    columns=columns,
    experiment="read the current with the bridge switched off",
    to_plant=to_plant,
)
