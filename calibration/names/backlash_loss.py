"""A motor that loses its counter torque: its teeth leave their face."""

from calibration.finding import UNKNOWN
from calibration.inputs.train import SHAFT
from calibration.names.name import VOLTS, Beside, Candidate, Name, Scene, candidate

#: what teeth that part look like: a change of friction, a fault of the trains, a fault of the volts
OF_FRICTION = (
    *("coulomb_change", "stribeck_change", "viscous_change", "presliding", "friction_asymmetry"),
    *("position_friction", "load_friction", "preload_change", "brake_drag"),
)
OF_TRAINS = ("structural_mode", "shaft_compliance", "damaged_tooth", "cable_wrap", SHAFT)
OF_VOLTS = ("pwm_deadband", "supply_sag", "adc_gain")


def columns(s: Scene) -> list[Candidate]:
    """A share of the volts of the one of two motors that holds the counter torque."""
    w = s.windings
    if w is None or w.counter is None:
        return []
    return [candidate(NAME.name, w.at(w.duty * w.supply) * w.counter.lagging, "loss", sign=1)]


NAME = Name(
    name="backlash_loss",
    channels=(VOLTS,),
    columns=columns,
    experiment="raise the counter torque from 10 to 25 %: lost teeth come back",
    beside=Beside(consequences={"E": (*OF_FRICTION, *OF_TRAINS, *OF_VOLTS, UNKNOWN)}),
)
