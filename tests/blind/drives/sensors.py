"""From rows to the columns of a log: quantum, noise of several kinds, gaps, spikes, wraps, late columns."""

import numpy as np

from tests.blind.drives import slots
from tests.blind.drives.families import Family, Rng
from tests.blind.drives.slots import Array

NOISES = ("gaussian", "heavy", "drift")


def effort_noise(rng: Rng, f: Family, rows: int, kind: str, top: float) -> Array:
    """Noise of the logged effort: Gaussian, Student's t of three degrees, or with a slow walk."""
    sigma = f.noise * top
    if kind == "heavy":
        return np.asarray(sigma * rng.standard_t(3, rows) / np.sqrt(3.0))
    white = sigma * rng.standard_normal(rows)
    if kind == "drift":
        walk = np.cumsum(rng.standard_normal(rows)) * np.sqrt(f.period_s)
        return np.asarray(white + 0.3 * sigma * walk / np.sqrt(30.0))
    return white


def play(x: Array, gap: float) -> Array:
    """The play operator: what is behind a gap."""
    out = np.empty(len(x))
    at = x[0]
    for k, here in enumerate(x):
        at = min(max(at, here - gap / 2), here + gap / 2)
        out[k] = at
    return out


def second(rows: Array, f: Family, s: dict[str, float], t: Array, span: float) -> Array:
    """The second position sensor, position units."""
    x = rows[:, slots.X]
    y = play(x, s["GAP"]) if "GAP" in s else x.copy()
    if "WIND" in s:
        y = y - s["WIND"] * rows[:, slots.EFFORT] / s["WIND_RMS"]
    if "ECC" in s:
        y = y + s["ECC"] * np.cos(s["ECC_K"] * x + s["ECC_P"])
    if "BOW" in s:
        y = y + s["BOW"] * (t / max(span, 1e-9)) * x / f.travel[1]
    return y


def columns(
    rows: Array,
    f: Family,
    s: dict[str, float],
    rng: Rng,
    kind: str,
    start: float,
    span: float,
    top: float,
    two: bool,
) -> dict[str, Array]:
    """Columns of one file in file units: position in counts of the sensor."""
    n = len(rows)
    t = np.arange(n) * f.period_s
    u = rows[:, slots.EFFORT]
    if "LATE" in s:
        u = np.interp(t - s["LATE"], t, u)
    u = u + effort_noise(rng, f, n, kind, top)
    if "MAINS" in s:
        u = u + s["MAINS"] * f.noise * top * np.sin(2 * np.pi * s["MAINS_F"] * (start + t * (1 + 2e-5)))
    u = np.round(u / f.effort_step) * f.effort_step
    counts = np.floor(rows[:, slots.X] / f.step + rng.random())
    if "WRAP" in s:
        bits = 2.0 ** (np.ceil(np.log2(max(float(np.ptp(counts)), 8.0))) - 1)
        counts = np.mod(counts, bits)
    out = {"t": t, "effort": u, "position": counts}
    if two:
        out["load_position"] = np.floor(second(rows, f, s, start + t, span) / f.step + rng.random())
    return out


def spoil(out: dict[str, Array], rng: Rng, what: str) -> dict[str, Array]:
    """Spikes in the position, or lumps of rows that are missing."""
    n = len(out["t"])
    if what == "spikes":
        for k in rng.integers(n // 10, n, 5):
            out["position"][k] += (
                float(rng.choice([-1, 1])) * float(rng.uniform(0.1, 1.0)) * np.ptp(out["position"])
            )
    if what == "gaps":
        keep = np.ones(n, dtype=bool)
        for _ in range(3):
            first = int(rng.integers(n // 10, n - 1))
            keep[first : first + int(rng.uniform(0.005, 0.02) * n)] = False
        out = {name: x[keep] for name, x in out.items()}
    return out
