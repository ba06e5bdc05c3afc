"""A sensor's disc that runs out of true."""

from dataclasses import replace

from calibration.balances.candidate import waves
from calibration.finding import UNKNOWN
from calibration.inputs.train import SHAFT
from calibration.names.inplant import OF_ABSOLUTE, Facts, Made, value
from calibration.names.lines import SAME, line, over_place, stage_lines
from calibration.names.name import RATES, SENSORS, Beside, Candidate, Finding, Name, Scene, candidate

LEAST_TURN = 0.4  # of a turn of the position, before a line of its own turn is looked for. ASSUMPTION


def columns(s: Scene) -> list[Candidate]:
    """Sines at the stages of this kind and at one turn of the position, where no stage is as long. An axis'
    absolute encoder, which all the others are compared with, has both harmonics as one."""
    out = stage_lines(s, "encoder_eccentricity", default=True)
    if s.pair is not None:
        out = [replace(c, labels=(("amplitude", "arcsec"),)) for c in out]
        both = s.at(waves(s.view.x, (1, 2)))
        own = candidate("encoder_eccentricity", both, "amplitude", "second", kind="line")
        return [*out, replace(own, stage="axis", harmonic=1, order=1.0)]
    turn, have = s.view.turn, [c.order for c in out if c.order is not None]
    if turn and s.span > LEAST_TURN * turn:
        for h in (1, 2):
            if not any(abs(order - h) < SAME for order in have):
                one = line(s, "encoder_eccentricity", h / turn, stage="axis", harmonic=h)
                out += over_place(s, one, h / turn)
    return [replace(c, twins=(*(c.twins if c.name == UNKNOWN else ()), SHAFT)) for c in out]


def to_plant(f: Finding, facts: Facts) -> Made:
    """Of the roller's encoder, or of the absolute one."""
    stage = f.stage or "axis"
    turned = OF_ABSOLUTE if stage != "roller" else -OF_ABSOLUTE
    values = {name: value(f, name) for name in ("amplitude", "second")}
    values |= {name: value(f, name) + turned for name in ("phase", "second_phase")}
    return Made().add(f.name, facts, values, stage, f.harmonic or 1 if stage != "axis" else 1)


NAME = Name(
    name="encoder_eccentricity",
    channels=(SENSORS, RATES),
    columns=columns,
    a_guess=True,
    experiment="turn one sensor's disc against its shaft: the error turns with it, a gear's does not",
    to_plant=to_plant,
    beside=Beside(consequences={"K": ("roller_ratio",)}, single=True),
)
