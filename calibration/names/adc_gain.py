"""A current that reads too much or too little."""

import numpy as np

from calibration.names.name import FORCE, MOTOR, VOLTS, Beside, Candidate, Made, Name, Scene, candidate, value

# share of a current: one motor's torque is most of the torque, and would explain itself. ASSUMPTION
LARGEST = 0.5


def columns(s: Scene) -> list[Candidate]:
    """Of two motors, volts like one's current, or its torque; of a single one that is the resistance."""
    w, pair = s.windings, s.pair
    if pair is None:
        return []
    if w is not None:
        volts = -w.resistance * w.at(w.current)
        return [candidate(NAME.name, volts * rows, "gain", fixed=motor) for rows, motor in s.motors]
    torques = ((one, {"motor": (float(k), MOTOR)}) for k, one in enumerate(pair.torque, 1))
    return [candidate(NAME.name, one, "gain", most=LARGEST, fixed=motor) for one, motor in torques]


NAME = Name(
    name="adc_gain",
    channels=(FORCE, VOLTS),
    columns=columns,
    experiment="lock the rotor and step the duty of each motor: a reading that is too large shows "
    "there, a weak magnet does not",
    # a motor draws no more than its current really is
    torque_kept=lambda _, size, clock, __: np.full(len(clock), 1.0 - size),
    torque_doubt=0.5,  # volts show that two readings differ, and hardly which of them is right
    # the residual g i is what the reading has too much
    to_plant=lambda f, facts: Made().added(
        f, facts, gain=1.0 / (1.0 - value(f, "gain")), motor=value(f, "motor")
    ),
    beside=Beside(settled_by=("magnet_weakening",)),
)
