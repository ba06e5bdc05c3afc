"""Friction that grows with the speed, more or less than was declared."""

from calibration.names.name import Changed, Name, beside_stated

NAME = Name(
    name="viscous_change",
    columns=lambda s: beside_stated(s, "viscous", s.view.speed, f"{s.unit} s/{s.angle_unit}"),
    experiment="two speeds that differ by a factor of ten",
    changed=Changed(numbers={"viscous": "factor"}, seen="spread"),
)
