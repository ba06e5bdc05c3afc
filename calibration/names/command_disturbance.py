"""Something that is added to the command behind the logged effort: a line of its own frequency."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate, sine_columns
from calibration.channels.repeats import repeat_frequency
from calibration.channels.view import View
from calibration.names.name import FORCE, Name
from calibration.names.scene import Scene
from calibration.names.sines import peaks
from calibration.readers.run import Array

TURNS = 6.0  # cycles within a file before a frequency is a frequency
ODD = (1, 3, 5, 7, 9)  # of a square wave
# repeats of the motion in a file, below which no frequency lies between two of its multiples; then only those
# that a repeated motion makes large are left out. ASSUMPTION: friction's corners fall off with the multiple
FEWEST_REPEATS, STRONG = 2.5, 50
FEW = 4  # files: with more, every file's own phase costs too many columns for more than a sine


def columns(s: Scene) -> list[Candidate]:
    """Sines of a fixed frequency, alone and with a square wave's overtones; every file has its own phase.

    Multiples of the frequency at which the motion repeats itself are left out, where the declared force has
    more of them than what it leaves: whatever follows the motion has them.
    """
    p = s.problem
    beta = np.linalg.lstsq(p.base[p.train], p.y[p.train], rcond=1e-8)[0]
    return lines(s, p.base @ beta, large_first=False)


def lines(s: Scene, follows: Array, large_first: bool = True) -> list[Candidate]:
    """`columns` without multiples of the motion's frequency that `follows` (n_fitted,), what follows the
    motion, has more of."""
    v = s.view
    files = s.problem.session
    t = v.t[v.rows]
    length = min(float(t[files == k].max()) for k in np.unique(files))
    if length <= 0:
        return []
    top = 0.5 / (v.period_s * max(v.step, 1))
    multiples = multiples_of_the_motion(v, length, top)
    avoid = multiples[[_power(s, follows, f) > _power(s, s.residual, f) for f in multiples]]
    out = []
    few = len(np.unique(files)) <= FEW
    for f in peaks(s, t, length, TURNS / length, 5, avoid, large_first):
        for overtones in ((1,), ODD) if few and 3 * f < top else ((1,),):

            def shape(p: Array, overtones: tuple[int, ...] = overtones) -> Array:
                at = [k for k in overtones if k * p[0] < top]
                return np.hstack([sine_columns(t * k * p[0], files) * passed(v, k * p[0]) for k in at])

            out.append(
                Candidate(
                    "command_disturbance",
                    "time",
                    shape(np.array([f])),
                    (("amplitude", s.unit),),
                    kind="line",
                    frequency=f,
                    fixed={"frequency": (f, "Hz")},
                    shape=shape,
                    steps=(0.1 / length,),
                    searched=1,
                    per_run=len(np.unique(files)) > 1,
                    twins=() if len(overtones) > 1 else ("structural_mode",),
                )
            )
    return out


def _power(s: Scene, y: Array, hertz: float) -> float:
    """Of a line of `y` (n_fitted,) in the training rows, any phase in every file."""
    p, t = s.problem, s.view.t[s.view.rows]
    wave = np.where(p.train, y, 0.0) * np.exp(-2j * np.pi * hertz * t)
    _, file = np.unique(p.session, return_inverse=True)
    return float(np.sum(np.abs(np.bincount(file, wave.real) + 1j * np.bincount(file, wave.imag)) ** 2))


def multiples_of_the_motion(v: View, length_s: float, top_hz: float) -> Array:
    """Frequencies, Hz, that whatever follows the motion has."""
    f0 = repeat_frequency(v)
    multiples = int(top_hz / f0) if f0 else 0
    if f0 * length_s < FEWEST_REPEATS:
        multiples = min(multiples, STRONG)
    return np.asarray(np.arange(1, multiples + 1) * f0, dtype=np.float64)


def passed(v: View, frequency: float) -> float:
    """What the balance's filter leaves of a sine of this frequency, Hz: its columns go through it, too."""
    return float(np.exp(-2 * (np.pi * frequency * v.sigma * v.period_s) ** 2))


def lacks(s: Scene) -> str:
    """An effort."""
    return "" if s.view.response.channel in ("effort", "current", "force") else "a column of the effort"


NAME = Name(
    "command_disturbance",
    (FORCE,),
    columns,
    ("structural_mode",),
    "the same motion at another speed: a disturbance keeps its frequency and size; at rest it stays",
    lacks,
)
