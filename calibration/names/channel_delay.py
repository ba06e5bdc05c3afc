"""One column that is late against the others."""

from typing import Any

import numpy as np

from calibration.finding import NORMAL, normal, of_columns
from calibration.names.inplant import Facts, Made, as_found, value
from calibration.names.name import OF_CLOCKS, Array, Beside, Candidate, Finding, Name, candidate, tried
from calibration.names.scene import FORCE, SENSORS, Scene

# fitted rows, by which a column is more than a little late: each refined. ASSUMPTION
ROWS = (1.0, 2.0, 4.0, 8.0)
# fitted rows, beyond which a column that is late is no more its rate times the delay. ASSUMPTION
LINEAR = 2.0
PART = 0.01  # of the log's time at most. ASSUMPTION
STEP = 0.2  # of a fitted row, a small step of its refinement. ASSUMPTION
#: number of a log's column in a plant file
COLUMNS = {"effort": 0, "position": 1, "velocity": 2, "current": 3, "adc_a": 3, "adc_b": 3}
COLUMNS |= {"tachometers": 4, "tach_a": 4, "tach_b": 4}


def columns(s: Scene) -> list[Candidate]:
    """The rate of change of the column. A late one falls behind by its rate times the delay, over many rows
    by what it was then. A force's is settled before its names (look/delay.py); a pair's base holds it."""
    if s.pair is not None or s.force:
        return []
    v = s.view
    ratio, step = ("ratio", f"{s.unit}/{s.angle_unit}"), v.period_s * max(v.step, 1)

    def behind(p: Array) -> Array:
        return s.at(v.delayed(v.x, -max(float(p[0]), 0.0)) - v.x)[:, None]

    starts = [k * step for k in ROWS if k * step < PART * float(np.ptp(v.t))]
    more: dict[str, Any] = {"steps": (STEP * step,), "sign": 1, "searched": 1}
    late = [tried(NAME.name, behind, ratio, at={"delay": (d, "s")}, **more) for d in starts]
    reads = s.declared.get("scale", 1.0) if v.response.ratio is None else v.response.ratio
    return [candidate(NAME.name, s.at(-reads * v.rate(v.x)), "delay", most=LINEAR * step), *late]


def late_column(note: str, delay: float, error: float, share: float = 1.0, reach: float = NORMAL) -> Finding:
    """A column that is late by `delay` s, standard error `error`; its 95 % interval is `reach` errors."""
    z = delay / max(error, 1e-300)
    found = {"delay": normal(delay, error, "s", reach)}
    return of_columns(NAME.name, found, z * z / 2 / float(np.log(10)), share, note)


def against_position(channel: str, delay: float) -> str:
    """What is said of a column that is compared with the position."""
    return f"the {channel} column is {'late' if delay > 0 else 'early'} against the position"


def to_plant(f: Finding, facts: Facts) -> Made:
    """A plant's columns are late, and known."""
    if "column" not in f.parameters:
        return Made(remarks=[f"{f.name}: left out, the log does not say which column is late ({f.note})"])
    if value(f, "delay") < 0.0:
        early = f"{-value(f, 'delay'):.4g} s early"
        return Made(remarks=[f"{f.name}: left out, a column is {early} and a plant is never early"])
    return as_found(f, facts)


NAME = Name(
    name="channel_delay",
    channels=(FORCE, SENSORS),
    columns=columns,
    experiment="one quick step, and compare the columns row by row",
    lacks=lambda s: "a balance with accelerations ('inertia')" if s.force and not s.view.dynamic else "",
    to_plant=to_plant,
    beside=Beside(consequences={"S": ("structural_mode", *OF_CLOCKS, "wind_torque")}, single=True),
)
