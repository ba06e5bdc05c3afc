"""Volts that every pulse of a bridge loses, whatever its length: a dead time, or drops of its switches."""

from dataclasses import replace
from typing import Any

import numpy as np

from calibration.finding import UNKNOWN
from calibration.names.name import VOLTS, Array, Candidate, Finding, Name, Scene, candidate, grid, value

MOST = 0.2  # of the supply. ASSUMPTION: a bridge that loses more is broken
# duties where the search for a dead band begins; 0.3 to 5 % of a period is what bridges lose. ASSUMPTION
KNEES = (0.003, 0.006, 0.012, 0.025, 0.05)
ABOVE = 0.5  # quantile of the duties that drive, above which no dead band's knee lies. ASSUMPTION
SHORTEST = 0.01  # of the rows, that may have pulses shorter than a dead band taken for a constant. ASSUMPTION
SMALLEST = 1e-4  # part of a period: a knee is no smaller. arithmetic
REACH = 2.0  # times the dead band, that a knee may be at. ASSUMPTION: switches' resistances bend its corner
SHARP = 0.005  # part of a period beside that. ASSUMPTION


def columns(s: Scene) -> list[Candidate]:
    """The supply in the direction of the duty, in proportion below a knee. A pulse that is shorter than the
    dead band is lost whole, which tells it from an ADC's offset. A knee above every duty would be the supply.

    Of two motors behind the split of the effort, or before it: as much of the lagging motor's duty as it has
    of the effort. Where no pulse is as short, a dead band is a constant, and so is what one converter reads
    wrong of both motors.
    """
    w, p, out = s.windings, s.problem, []
    if w is None or w.measured:
        return []
    places: list[tuple[Array, dict[str, tuple[float, str]]]] = [(np.ones(len(w.duty)), {})]
    if w.counter is not None:
        places.append((w.counter.share, {"before_split": (1.0, "0 behind, 1 before the split")}))
    for share, place in places:
        duty = np.divide(w.duty, share, out=np.zeros_like(share), where=share > 0)
        volts, pulse = w.supply * share, np.abs(w.at(duty))[p.train]
        if w.counter is not None:
            shortest = float(np.quantile(pulse, SHORTEST))
            twins = () if place else ("adc_offset",)
            constant: dict[str, Any] = {"sign": 1, "fixed": place, "most": shortest, "twins": twins}
            out.append(candidate(NAME.name, w.at(volts), "deadband", **constant))
        widest = float(np.quantile(pulse[pulse > 0], ABOVE)) if (pulse > 0).any() else 0.0

        def shape(at: Array, duty: Array = duty, volts: Array = volts, widest: float = widest) -> Array:
            knee = float(np.clip(at[0], SMALLEST, max(widest, SMALLEST)))
            return w.at(volts * np.clip(duty / knee, -1.0, 1.0))[:, None]

        along = ("knee", [k for k in KNEES if k < widest], "1")
        out += grid(NAME.name, shape, "deadband", along=along, beside=place, sign=1, most=MOST)
    return out


def lacks(s: Scene) -> str:
    """A duty."""
    measured = s.windings is None or s.windings.measured
    return "a column of the duty: measured volts have lost it already" if measured else ""


def told(f: Finding) -> Finding:
    """A bridge that loses a part of every pulse loses shorter pulses whole, and no longer ones in part. One
    whose loss grows over far longer pulses is something else over the command."""
    if value(f, "knee") < REACH * value(f, "deadband") + SHARP:
        return f
    note = "volts are lost in proportion to the duty up to the knee: no dead band does so"
    return replace(f, name=UNKNOWN, note=note)


NAME = Name(
    name="pwm_deadband",
    channels=(VOLTS,),
    columns=columns,
    experiment="measure the volts at the motor's leads: brushes drop their volt behind them, a dead "
    "band before",
    lacks=lacks,
    told=told,
    nuisances={
        "knee": "",
        "before_split": "found before the split between the motors, the plant has it behind",
    },
)
