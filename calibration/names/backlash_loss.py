"""A motor that loses its counter torque: its teeth leave their face."""

from calibration.names.name import VOLTS, Candidate, Name, Scene, candidate


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
)
