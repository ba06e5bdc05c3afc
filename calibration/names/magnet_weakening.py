"""A torque constant that falls at some time, steeply or slowly: seen in the volts of a motor that turns."""

import numpy as np

from calibration.balances.candidate import ramp
from calibration.names.inplant import Facts, Made, value
from calibration.names.name import Array, Beside, Candidate, Finding, Name, Scene, candidate
from calibration.names.onsets import steps
from calibration.names.scene import FORCE, VOLTS

# part of the time, that the fall may take at first. ASSUMPTION, as of every slow change
LENGTHS = (0.02, 0.2, 0.5, 1.0)
# part of the time likewise, where volts show it: from a shorter one the search ends at a step. ASSUMPTION
VOLTS_LENGTHS = (0.05, 0.4)
STEP = 0.02  # part of the time: volts show an onset and a length no better. ASSUMPTION


def columns(s: Scene) -> list[Candidate]:
    """Back-EMF that one of two motors lacks all along, or that all lack from an onset over a ramp. For an
    axis' torque, a share of all that currents promise and the magnets do not give."""
    w, pair = s.windings, s.pair
    if w is not None:
        lost = -w.constant * w.rate
    elif pair is not None:
        lost = pair.load
    else:
        return []
    of_one = s.motors if w is not None and pair is not None else []
    lengths, surely = (LENGTHS, 0.0) if w is None else (VOLTS_LENGTHS, STEP)
    size, all_runs = ("loss", "1"), pair is None

    def weigh(x: Array) -> Array:
        return lost * s.at(x)

    out = [candidate(NAME.name, lost * rows, "loss", sign=1, fixed=motor) for rows, motor in of_one]
    return [*out, *steps(s, NAME.name, size, weigh, lengths, all_runs, surely, sign=1, most=1.0)]


def torque_kept(c: Candidate, size: float, clock: Array, quotient: float) -> Array:
    """What the magnets have left."""
    at = c.fixed
    shape = ramp(clock, at["start"][0], at["duration"][0]) if "start" in at else np.ones(len(clock))
    return np.asarray(1.0 - quotient * size * shape)


def to_plant(f: Finding, facts: Facts) -> Made:
    """Of one motor, or of both from some time on."""
    made = Made().added(f, facts, loss=value(f, "loss"), motor=value(f, "motor"))
    if "start" in f.parameters:
        since = f"the loss found from {value(f, 'start'):.0f} s on is there from the start"
        made.remarks.append(f"magnet_weakening: the plant's magnets do not know the time, {since}")
    return made


NAME = Name(
    name="magnet_weakening",
    channels=(FORCE, VOLTS),
    columns=columns,
    experiment="turn the motor by hand or by another one at a known speed and read the volts of its "
    "open leads",
    torque_kept=torque_kept,
    relative={"loss": ("torque_constant", 1)},  # of the constant before it fell
    to_plant=to_plant,
    beside=Beside(consequences={"E": ("adc_gain",)}, of_constant=True),
)
