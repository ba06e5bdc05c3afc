"""Friction that does not depend on the speed, more or less than was declared."""

from calibration.names.name import Changed, Name, beside_stated

NAME = Name(
    name="coulomb_change",
    columns=lambda s: beside_stated(s, "coulomb", s.view.direction, s.unit),
    experiment="slow motion in both directions",
    changed=Changed(numbers={"coulomb": "factor"}, seen="sliding"),
)
