"""Two sensors whose ratio is not the declared one."""

from calibration.names.name import RATES, SENSORS, Candidate, Name, Scene, candidate
from plant.units import ARCSEC

PPM = 1e-6  # share. definition


def columns(s: Scene) -> list[Candidate]:
    """The position less its mean: an error in proportion to the way."""
    if lacks(s):
        return []
    x = s.at(s.view.x - s.view.x.mean())
    if s.pair is None:
        return [candidate("roller_ratio", x, ("error", f"{s.unit}/{s.angle_unit}"))]
    return [candidate("roller_ratio", x / ARCSEC * PPM, "error", stage=s.pair.train.one("roller"))]


def lacks(s: Scene) -> str:
    """A ratio that is declared and not estimated."""
    r = s.view.response
    declared = r.channel == "position2" and r.ratio is not None
    return "" if declared or (s.rates and s.view.rig.stages) else "a declared ratio of two sensors"


NAME = Name(
    name="roller_ratio",
    channels=(SENSORS, RATES),
    columns=columns,
    experiment="several turns the same way: a ratio's error grows, an eccentricity comes back",
    lacks=lacks,
)
