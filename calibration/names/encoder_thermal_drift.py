"""A sensor that moves with the temperature."""

import numpy as np

from calibration.names.name import SENSORS, Candidate, Facts, Finding, Made, Name, Scene, candidate
from calibration.names.scene import LEAST_K

# of change, before a coefficient means anything of an axis' log, whose fit is finer. ASSUMPTION
AXIS_LEAST_K = 0.3


def columns(s: Scene) -> list[Candidate]:
    """The temperature less its mean. An axis' absolute encoder, which is subtracted, has minus that, and the
    time, in which a log without a temperature may have warmed."""
    out, sense = [], 1.0 if s.pair is None else -1.0
    if not lacks(s):
        t = s.view.columns["temperature"]
        drift = s.at(sense * (t - t.mean()))
        out.append(candidate("encoder_thermal_drift", drift, ("drift", f"{s.unit}/K")))
    if s.pair is not None:
        t = s.problem.t
        steady = (t - t.mean()) / (np.ptp(t) or 1.0)
        out.append(candidate("encoder_thermal_drift", steady, ("drift", s.unit), domain="time"))
    return out


def lacks(s: Scene) -> str:
    """A temperature that changes."""
    t, least = s.view.columns.get("temperature"), LEAST_K if s.pair is None else AXIS_LEAST_K
    if t is None:
        return "a temperature column"
    return "" if float(np.ptp(t)) > least else f"a temperature that changes by more than {least} K"


def to_plant(f: Finding, facts: Facts) -> Made:
    """Per kelvin, or arcsec over the log through the plant's own warming."""
    found = f.parameters["drift"]
    if found.unit == "arcsec/K":
        return Made().added(f, facts, drift=found.value, encoder=1.0)
    if not facts.warming:
        return Made(remarks=[f"{f.name}: left out, the plant's temperature does not change"])
    told = Made(remarks=[f"{f.name}: the log has no temperature, the plant's own warming is used"])
    return told.added(f, facts, drift=-found.value / (facts.duration_s * facts.warming), encoder=1.0)


NAME = Name(
    name="encoder_thermal_drift",
    channels=(SENSORS,),
    columns=columns,
    experiment="the same motion warm and cold",
    lacks=lacks,
    to_plant=to_plant,
)
