"""A second mass on a spring: it answers accelerations at its own frequency."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calibration.balances.filters import by_piece
from calibration.balances.view import HALF
from calibration.finding import UNKNOWN, Parameter
from calibration.names.inplant import Facts, Made, as_found, value
from calibration.names.name import Array, Beside, Candidate, Finding, Name, Scene, tried

DAMPING = 0.05  # ASSUMPTION: of a lightly damped metal structure, refined once the mode is chosen
# part of critical, of a mode: metal structures have 0.01 to 0.1 (Altintas, Manufacturing Automation, 2012)
LEAST_DAMPED = 0.001
STRUCTURES_DAMPED = 0.1  # part of critical, of the most damped structures (Altintas 2012)
MOST_DAMPED = 0.2  # part of critical, at most: twice that, where it is not well told. ASSUMPTION
BELOW = 0.5  # part of the filter's corner: above it nothing remains to be seen. ASSUMPTION
# periods within the log: one frequency that fits less often is a slow change. ASSUMPTION
FEWEST_PERIODS = 8.0
# share of the moving time in moves that are shorter than one in which a mode rings: a sweep begins with long
# ones. ASSUMPTION
LONG_MOVES = 0.9
# Hz. ASSUMPTION: slower than the first mode of a steerable structure; antennas of 70 to 100 m begin above it
SLOWEST_HZ = 0.5
# Hz, on a telescope's axis: 4.5 % apart, as wide as a mode of 2 % damping
AXIS_HZ = np.geomspace(1.8, 14.2, 48)
# part of critical, tried there: either side of what structures have (Altintas 2012)
AXIS_DAMPINGS = (0.008, 0.03)
# of a turn, rms, that a structure's second mass is off its foot at most. ASSUMPTION: a degree
BENDS = 1 / 360
SEEN = 0.4  # part of the rate of the analysed rows, for a frequency: quicker is not seen. ASSUMPTION
# part of the rate of the rows, for a frequency: where the bilinear transform still holds. arithmetic
QUICKEST = 0.45


def columns(s: Scene) -> list[Candidate]:
    """Columns of a second mass. Of any drive they are what it takes beyond moving along rigidly. Of an axis
    with two motors they are all that it takes, so that the declared inertia is the first mass's."""
    v = s.view
    if s.pair is not None:
        m = s.pair.motion  # where it is not sound (a gap, the seam between two runs) nothing excites a mode
        a, lowest = np.where(m.ok, m.acceleration, 0.0), 0.3
        modes = [(f, z) for f in AXIS_HZ if f < SEEN / m.cell_s for z in AXIS_DAMPINGS]
    elif lacks(s):
        return []
    else:
        a, way = np.asarray(v.second(v.x)), np.sign(v.direction[np.abs(v.direction) > HALF])
        # half a period lies within one of the longer moves, and many in the log; slower, it is the motion
        moves = np.diff(np.flatnonzero(np.diff(way)), prepend=-1, append=len(way) - 1)
        moves = np.sort(moves)
        longest = float(moves[np.searchsorted(np.cumsum(moves), LONG_MOVES * np.sum(moves))]) * v.period_s
        often = FEWEST_PERIODS / max(len(v.t) * v.period_s, 1e-9)
        lowest = min(max(often, 0.5 / max(longest, v.period_s), SLOWEST_HZ), SEEN / v.period_s)
        corner = 1 / (2 * np.pi * max(v.wide, 1.0) * v.period_s)
        top = max(BELOW * corner, 2 * lowest)
        count = 1 + int(np.ceil(np.log(top / lowest) / (2 * DAMPING)))  # every resonance's width holds one
        modes = [(f, DAMPING) for f in np.geomspace(lowest, top, count)]

    def shape(p: Array) -> Array:
        frequency = min(max(float(p[0]), lowest), QUICKEST / v.period_s)
        damping = float(np.clip(p[1], LEAST_DAMPED, MOST_DAMPED))
        second = second_mass(a, v.file, v.period_s, frequency, damping)
        return (second[v.rows] if s.pair is not None else s.at(second - a))[:, None]

    out, size = [], "inertia" if s.pair is not None else ("inertia", f"{s.unit} s2/{s.angle_unit}")
    for f, damping in ((float(f), z) for f, z in modes):
        at = {"frequency": (f, "Hz"), "damping": (damping, "1")}
        steps = (0.05 * f, 0.02) if s.pair is None else (0.01 * f, 0.3 * damping)
        out.append(tried(NAME.name, shape, size, at=at, steps=steps, sign=1, frequency=f))
    return out


def another_body(f: Finding, s: Scene) -> Finding:
    """A second mass that turns further on its spring than a structure bends has no name."""
    v = s.view
    if f.name != NAME.name or s.pair is not None or not v.turn:
        return f
    hertz, damping = (f.parameters[k].value for k in ("frequency", "damping"))
    a = second_mass(v.second(v.x), v.file, v.period_s, hertz, max(damping, LEAST_DAMPED))
    off = float(np.std(a[v.ok])) / (2 * np.pi * hertz) ** 2
    if off <= BENDS * v.turn:
        return f
    far = f"{off:.2g} {s.angle_unit} rms off its foot, more than a structure bends: a pendulum, another joint"
    return replace(f, name=UNKNOWN, parameters={}).noted(far)


def second_mass(a: Array, file: NDArray[np.int64], dt: float, f: float, damping: float) -> Array:
    """Acceleration (n,) of a mass on a spring whose foot has `a` (n,); at rest where a file starts."""
    from scipy.signal import bilinear, lfilter

    x = np.pi * f * dt
    # the bilinear transform narrows a resonance by this factor, and lowers it by the same
    narrow = np.sin(2 * x) / (2 * x)
    w, zeta = np.tan(x) * 2 / dt, damping / narrow
    num, den = bilinear([2 * zeta * w, w * w], [1.0, 2 * zeta * w, w * w], fs=1 / dt)
    return np.asarray(by_piece(a, file, lambda x: np.asarray(lfilter(num, den, x))) / narrow)


def rings(damping: Parameter) -> bool:
    """Whether a damping is one that structures have: its interval holds no bound, and not energy alone."""
    high = damping.high if damping.high is not None else damping.value
    return damping.value <= STRUCTURES_DAMPED and 0.0 <= high < MOST_DAMPED


def to_plant(f: Finding, facts: Facts) -> Made:
    """The second mass is part of the plant's inertia, not of the calibrated one."""
    made = as_found(f, facts)
    made.numbers = {"inertia": value(f, "inertia")}
    return made


def lacks(s: Scene) -> str:
    """A balance with accelerations of a driven axis."""
    if not s.view.dynamic or s.view.response.channel == "acceleration":
        return "a balance with accelerations ('inertia') and a measured force"
    return ""


NAME = Name(
    name="structural_mode",
    columns=columns,
    experiment="repeat at another speed: a mode keeps its frequency",
    lacks=lacks,
    to_plant=to_plant,
    beside=Beside(
        consequences={"T": ("damaged_tooth",)},
        single=True,
        plausible=lambda f: rings(f.parameters["damping"]),
    ),
)
