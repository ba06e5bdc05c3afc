"""A brake that rubs from some time on."""

from dataclasses import replace

import numpy as np

from calibration.finding import UNKNOWN, Parameter
from calibration.names.name import Beside, Facts, Finding, Made, Name, Scene, as_found, value
from calibration.names.onsets import steps

FOREVER_S = 1e6  # s: longer than any log. ASSUMPTION
LESS = ("friction_warmup", "preload_change")  # friction that falls from some time on
CHANGES = ("brake_drag", "preload_change")  # friction that is another from some time on
VARIES = 0.3  # of the mean speed, rms, beyond which friction is no offset. ASSUMPTION
IN_TIME = ("brake_drag", "friction_warmup")  # forces against the motion that come or go


def to_plant(f: Finding, facts: Facts) -> Made:
    """A drag that goes away is one that was there from the start, of friction that was less."""
    torque, name = value(f, "torque"), next(k for k in f.parameters if k.startswith("start"))
    begins, lasts = value(f, name), FOREVER_S
    if torque < 0.0:
        begins, lasts = -FOREVER_S, FOREVER_S + begins
    values = {"torque": (abs(torque), "N m"), name: (begins, "s"), "duration": (lasts, "s")}
    made = as_found(replace(f, parameters={k: Parameter(*x) for k, x in values.items()}), facts)
    if torque < 0.0:
        made.numbers = {"friction.coulomb": torque, "friction.stiction": torque}
        made.remarks.append("brake_drag: it lets go, so Tc and Ts of the plant are those without it")
    return made


def one_way(f: Finding, s: Scene) -> Finding:
    """Where all goes one way, or held-out rows say no more (decide/twins.py), a sensor's offset that changes
    looks the same. Less drag has other names."""
    offset = f.name in CHANGES and UNKNOWN in f.equivalent
    if s.pair is not None or not (offset or f.name in IN_TIME):
        return f
    if f.name == NAME.name and f.parameters["torque"].value < 0.0:
        f = replace(f, equivalent=tuple(dict.fromkeys([*f.equivalent, *LESS])))
    speed = np.abs(s.view.speed[s.view.ok])
    tells = f.name != NAME.name and np.std(speed) > VARIES * np.mean(speed)  # friction changes with speed
    if (s.both or tells) and not offset:
        return f
    alike = (f.name, *(x for x in f.equivalent if x != UNKNOWN))
    why = f"{'' if s.both else 'one way only, '}an offset of the column that changes looks the same"
    sizes = f.parameters if f.name in CHANGES else {}  # a depth is friction's
    return replace(f, name=UNKNOWN, equivalent=alike, parameters=sizes).noted(why)


NAME = Name(
    name="brake_drag",
    # a constant force against the motion, from an onset on
    columns=lambda s: steps(s, "brake_drag", ("torque", s.unit), s.answer),
    to_plant=to_plant,
    experiment="repeat at two speeds: a brake adds the same force at both, a preload scales all friction",
    beside=Beside(consequences={"T": ("friction_warmup",)}),
)
