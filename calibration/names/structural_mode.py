"""A second mass on a spring: it answers accelerations at its own frequency."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from calibration.candidates.candidate import Candidate
from calibration.names.name import FORCE, Name
from calibration.names.scene import Scene
from calibration.readers.run import Array

COUNT = 14  # frequencies that are tried
DAMPING = 0.05  # ASSUMPTION: of a lightly damped metal structure, refined once the mode is chosen
MOST_DAMPED = 0.2  # of a mode: metal structures have 0.01 to 0.1 (Altintas, Manufacturing Automation, 2012)
BELOW = 0.5  # of the filter's corner: above it nothing is left to see


def columns(s: Scene) -> list[Candidate]:
    """What an oscillator of frequency f takes from the acceleration beyond moving along rigidly."""
    v = s.view
    if lacks(s):
        return []
    a = np.asarray(v.second(v.x))
    corner = 1 / (2 * np.pi * max(v.sigma, 1.0) * v.period_s)
    lowest = 8.0 / max(float(v.t.max()), 1e-9)
    out = []

    def full(p: Array) -> Array:
        return oscillator(
            a, v.file, v.period_s, max(float(p[0]), lowest / 2), float(np.clip(p[1], 0.002, MOST_DAMPED))
        )

    shape = s.shaped(full)
    for f in np.geomspace(lowest, max(BELOW * corner, 2 * lowest), COUNT):
        out.append(
            Candidate(
                "structural_mode",
                "time",
                shape(np.array([f, DAMPING])),
                (("second_inertia", f"{s.unit} s2/{s.angle_unit}"),),
                sign=1,
                fixed={"frequency": (float(f), "Hz"), "damping": (DAMPING, "1")},
                frequency=float(f),
                shape=shape,
                steps=(0.05 * float(f), 0.02),
                searched=2,
            )
        )
    return out


def oscillator(a: Array, file: NDArray[np.int64], dt: float, f: float, damping: float) -> Array:
    """Acceleration of a mass on a spring relative to its foot, whose acceleration is `a`; rest at the
    start."""
    from scipy.signal import cont2discrete, lfilter

    w = 2 * np.pi * f
    num, den, _ = cont2discrete(([1.0, 0.0, 0.0], [1.0, 2 * damping * w, w * w]), dt, method="bilinear")
    out = np.zeros(len(a))
    for k in np.unique(file):
        m = file == k
        out[m] = -lfilter(np.ravel(num), np.ravel(den), a[m])
    return out


def lacks(s: Scene) -> str:
    """A balance with accelerations of a driven axis."""
    if not s.view.dynamic or s.view.response.channel == "acceleration":
        return "a balance with accelerations ('inertia') and a measured force"
    return ""


NAME = Name(
    "structural_mode",
    (FORCE,),
    columns,
    ("channel_delay",),
    "repeat at another speed: a mode keeps its frequency",
    lacks,
)
