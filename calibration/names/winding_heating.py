"""A winding that its own loss heats: copper's resistance rises by 0.39 % per kelvin."""

import numpy as np

from calibration.balances.recursions import lowpass
from calibration.balances.volts import Windings
from calibration.names.name import VOLTS, Array, Candidate, Facts, Finding, Made, Name, Scene, grid, value
from plant.effects.winding_heating import COPPER

# s: small motors' windings have 5 to 400 s by their datasheets, the telescope's are heavier
TAUS_S = (10.0, 20.0, 40.0, 80.0, 160.0, 320.0)
STEP = 0.05  # part of a time constant, for its refinement. ASSUMPTION
COOLED_S = 1e5  # s, between two files that each begin cold: many times the longest of TAUS_S. ASSUMPTION


def columns(s: Scene) -> list[Candidate]:
    """R alpha R i (i^2 low-passed): cold at the first row of the first file, or of every file of a rig."""
    w = s.windings
    if w is None:
        return []
    out = _heated(w, w.clock, "time_constant")
    if w.since_run is not None:
        out += _heated(w, w.clock + COOLED_S * s.problem.session, "time_constant_in_run")
    return out


def _heated(w: Windings, clock: Array, name: str) -> list[Candidate]:
    """By this clock, in whose pauses the windings cool; `name` is the time constant's."""
    volts = COPPER * w.resistance**2 * w.at(w.current)
    motors = list(zip(np.split(w.at(w.current**2), w.count), np.split(clock, w.count), strict=True))

    def shape(p: Array) -> Array:
        heat = [lowpass(power, t, max(float(p[0]), 1.0)) for power, t in motors]
        return np.asarray(volts * np.concatenate(heat))[:, None]

    along = (name, [tau for tau in TAUS_S if tau < 2 * float(w.clock.max())], "s")
    return grid(NAME.name, shape, "thermal_resistance", along=along, step=STEP, sign=1)


def to_plant(f: Finding, facts: Facts) -> Made:
    """Fitted with the whole loop's resistance, of which the winding warms."""
    warms = value(f, "thermal_resistance") * (facts.resistance / facts.winding) ** 2
    return Made().added(f, facts, thermal_resistance=warms, time_constant=value(f, "time_constant"))


NAME = Name(
    name="winding_heating",
    channels=(VOLTS,),
    columns=columns,
    experiment="hold the rotor at a steady current for some minutes: R i rises with the winding, K v is "
    "not there",
    relative={"thermal_resistance": ("resistance", 2)},  # of the cold one
    to_plant=to_plant,
)
