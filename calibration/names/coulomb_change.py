"""Friction that does not depend on the speed, more or less than was declared."""

from calibration.names.name import Candidate, Changed, Name, Scene, beside_stated, both_ways


def columns(s: Scene) -> list[Candidate]:
    """Of a drive whose rig file does not estimate it; one way only it is an offset."""
    return [] if both_ways(s) else beside_stated(s, "coulomb", s.view.direction, s.unit)


NAME = Name(
    name="coulomb_change",
    columns=columns,
    experiment="slow motion in both directions",
    changed=Changed(numbers={"coulomb": "factor"}, seen="sliding"),
)
