"""An equatorial mount at the sky's rate: the axis less the sky, an hour of it, as a table of s and arcsec.

Sources of the numbers: wheels of 130 to 435 teeth and their periods (PHD2 project's wiki, "Mount Worm Period
Info"); periodic errors of 5 to 40 arcsec peak to peak (makers' claims, owners' measurements, the PHD2 logs of
the measured data); seeing of 0.5 to 2 arcsec in an exposure of 1 to 4 s. Harmonics, wander and drift are
ASSUMPTIONS.
"""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from tests.blind.drives.families import Rng, near
from tests.blind.drives.order import Order
from tests.blind.drives.slots import Array

SIDEREAL_DAY_S = 86164.0905
TURN = 2 * np.pi
FILES = 3


@dataclass
class Mount:
    """One mount and its sky: what its owner knows, and what the log shows of it when nothing is hidden."""

    worm_s: float
    gear_s: float  # the wheel before the worm
    exposure_s: float
    seeing: float  # arcsec, rms of an exposure
    wander: float  # arcsec per root s
    drift: float  # arcsec per hour
    bend: float  # arcsec, of the drift within an hour


@dataclass
class Hidden:
    """What is added to the error (arcsec over s), its name, and where it counts."""

    name: str
    stage: str | None
    domain: tuple[str, ...]
    add: Callable[[Array], Array]
    raw: dict[str, float] = field(default_factory=dict)


def draw(rng: Rng) -> Mount:
    """A mount within a factor of published ones."""
    worm = SIDEREAL_DAY_S / float(rng.choice([130, 135, 144, 180, 192, 216, 225, 288, 360, 435]))
    driven, driving = float(rng.integers(36, 60)), float(rng.integers(9, 17))
    return Mount(
        worm, worm * driving / driven, float(rng.choice([1.0, 2.0, 2.5, 4.0])), near(rng, 1.0, 2.0),
        near(rng, 0.03), float(rng.uniform(-15, 15)), float(rng.uniform(0, 3)),
    )  # fmt: skip


def worm_error(rng: Rng, m: Mount, amplitude: float) -> Hidden:
    """A worm's error: its turn, and a third and a tenth of that at twice and three times."""
    parts = [(h, a * rng.uniform(0.3, 1.0), rng.uniform(0, TURN)) for h, a in ((2, 0.35), (3, 0.15))]
    parts.append((1, 1.0, rng.uniform(0, TURN)))

    def add(t: Array) -> Array:
        return amplitude * np.sum([a * np.cos(TURN * h * t / m.worm_s + p) for h, a, p in parts], axis=0)

    return Hidden("gear_eccentricity", "worm", ("axis_angle",), add, {"amplitude": amplitude})


def gear_error(rng: Rng, m: Mount, amplitude: float) -> Hidden:
    """A wheel before the worm that sits off its centre."""
    phase = rng.uniform(0, TURN)

    def add(t: Array) -> Array:
        return np.asarray(amplitude * np.cos(TURN * t / m.gear_s + phase))

    return Hidden("gear_eccentricity", "gear", ("axis_angle",), add, {"amplitude": amplitude})


def belt_tooth(rng: Rng, m: Mount, amplitude: float) -> Hidden:
    """A period of no part that the owner knows."""
    phase, part = rng.uniform(0, TURN), rng.uniform(1.3, 1.7)

    def add(t: Array) -> Array:
        return np.asarray(amplitude * np.cos(TURN * t / m.worm_s * part + phase))

    return Hidden("outside_period", None, ("time", "axis_angle"), add, {"amplitude": amplitude, "part": part})


DRAWS = {d.__name__: d for d in (worm_error, gear_error, belt_tooth)}


def rig(m: Mount) -> str:
    """The rig file that the owner would write from the documentation."""
    return (
        "rig: equatorial mount\n"
        "columns:\n  time: {column: t, unit: s}\n  position: {column: error, unit: arcsec}\n"
        "response: {channel: position, unit: arcsec}\n"
        f"stages:\n  - {{name: worm, period_s: {m.worm_s:.6g}}}\n"
        f"  - {{name: gear, period_s: {m.gear_s:.6g}}}\n"
    )


def night(rng: Rng, m: Mount, hidden: Hidden | None, noise: str, start_s: float, seconds: float) -> Array:
    """(n, 2): t s and error arcsec of one file; the drift starts anew, the parts turn on."""
    t = np.arange(0.0, seconds, m.exposure_s)
    n = len(t)
    white = rng.standard_t(3, n) / np.sqrt(3.0) if noise == "heavy" else rng.standard_normal(n)
    x = t / 3600.0
    y = m.seeing * white + m.drift * x + m.bend * np.cos(np.pi * x + rng.uniform(0, TURN))
    walk = 3.0 if noise == "drift" else 1.0
    y = y + walk * m.wander * np.sqrt(m.exposure_s) * np.cumsum(rng.standard_normal(n))
    if hidden is not None:
        y = y + hidden.add(start_s + t)
    return np.column_stack([t, np.round(y, 2)])


def make(order: Order, seed: int, folder: Path) -> dict[str, Any]:
    """Write run1..3.csv and rig.yaml; the truth's effects and drive."""
    number = int.from_bytes(hashlib.sha256(f"drives/{seed}/{order.key}".encode()).digest()[:4], "little")
    rng = np.random.default_rng(number)
    m = draw(rng)
    amplitude = order.ratio * m.seeing * np.sqrt(2.0)  # rms over the seeing's
    hidden = DRAWS[order.names[0]](rng, m, float(amplitude)) if order.names else None
    for k in range(FILES):
        table = night(rng, m, hidden, order.noise, k * (order.seconds + 120.0), order.seconds)
        if order.spoil == "gaps":
            first = int(rng.integers(len(table) // 4, len(table) // 2))
            table = np.delete(table, slice(first, first + int(0.03 * len(table))), axis=0)
        np.savetxt(folder / f"run{k + 1}.csv", table, "%.6g", ",", header="t,error", comments="")
    (folder / "rig.yaml").write_text(rig(m))
    effects = []
    if hidden is not None:
        effects.append({
            "name": hidden.name, "class": [hidden.name], "stage": hidden.stage, "channel": "K",
            "domain": list(hidden.domain), "ratio": order.ratio, "measured_ratio": order.ratio,
            "parameters": {}, "reached": order.ratio, "raw": hidden.raw,
            "in_catalogue": not hidden.name.startswith("outside"),
        })  # fmt: skip
    return {"effects": effects, "drive": vars(m), "number": number}
