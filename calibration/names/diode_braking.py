"""A motor that is dragged backwards brakes through its freewheel diode."""

from calibration.names.name import VOLTS, Candidate, Name, Scene, candidate


def columns(s: Scene) -> list[Candidate]:
    """Back-EMF of one of two motors that is dragged backwards."""
    w = s.windings
    if w is None or w.counter is None or not w.counter.dragged.any():
        return []
    return [candidate(NAME.name, -w.constant * w.counter.dragged, "share", sign=1)]


NAME = Name(
    name="diode_braking", channels=(VOLTS,), columns=columns, experiment="coast from speed with the drive off"
)
