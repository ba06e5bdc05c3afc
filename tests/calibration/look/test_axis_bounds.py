"""A size far beyond what the plant lets an effect have is none (plant/effects: 60 arcsec of eccentricity)."""

from types import SimpleNamespace
from typing import Any

import pytest

from calibration.finding import Parameter
from calibration.look import axis_channels
from plant.effects import REGISTRY


@pytest.mark.parametrize(
    ("low", "unit", "beyond"),
    [(357.1, "arcsec", True), (37.2, "arcsec", False), (None, "arcsec", False), (357.1, "rad", False)],
)
def test_an_eccentricity_of_minutes_of_arc_is_a_scale(
    monkeypatch: pytest.MonkeyPatch, low: float | None, unit: str, beyond: bool
) -> None:
    (amplitude,) = (p for p in REGISTRY["encoder_eccentricity"].parameters if p.name == "amplitude")
    assert (amplitude.unit, amplitude.high) == ("arcsec", 60.0)
    told = {"amplitude": Parameter(420.0, unit, low, 483.0), "phase": Parameter(3.0, "rad", 2.9, 3.1)}
    monkeypatch.setattr(axis_channels, "parameters_of", lambda s, k: told)
    s: Any = SimpleNamespace(candidates=[SimpleNamespace(name="encoder_eccentricity")])
    assert axis_channels._beyond_the_plant(s, 0) is beyond
