"""Guide logs made up from numbers: drift, a random walk, slow quasi-periodic wander, and a worm or none."""

import numpy as np
from numpy.typing import NDArray

SIDEREAL_DAY_S = 86164.0905
TOP = "PHD2 version 2.6.13 [Windows], Log version 2.5. Log enabled at 2026-01-01 20:00:00\n\n"
HEAD = (
    "Frame,Time,mount,dx,dy,RARawDistance,DECRawDistance,RAGuideDistance,DECGuideDistance,"
    "RADuration,RADirection,DECDuration,DECDirection,XStep,YStep,StarMass,SNR,ErrorCode\n"
)
WHEELS: dict[str, tuple[int, ...]] = {
    "EQMOD HEQ5/6": (180, 135),
    "AstroPhysicsV2": (225,),
    "ZWO AM5": (130, 144, 360),  # no wheel is known for this name
    "Losmandy Gemini": (360,),
}
Array = NDArray[np.float64]


def section(start: str, t: Array, error: Array, mount: str = "EQMOD HEQ5/6", dither: int = 0) -> str:
    """A guiding section whose corrections take away half of every raw distance; `error` in px of 1 arcsec.

    `dither`: every so many frames the lock position moves by 1 px in RA, and the raw distance with it.
    """
    out = [
        f"Guiding Begins at {start}",
        "Pixel scale = 1.00 arc-sec/px, Binning = 1, Focal length = 800 mm",
        f"Mount = {mount}, connected, guiding enabled, xAngle = -81.6",
        HEAD.strip(),
    ]
    total, lock = 0.0, 0.0
    for k, (at, e) in enumerate(zip(t, error, strict=True)):
        if dither and k and k % dither == 0:
            lock += 1.0
            out.append(f"INFO: DITHER by 1.000, 0.000, new lock pos = {lock:.3f}, 5.000")
        raw = e - total - lock
        out.append(f'{k + 1},{at:.3f},"Mount",0,0,{raw:.3f},0,{0.5 * raw:.3f},0,10,W,0,,,,999,20.0,0')
        total += round(0.5 * raw, 3)
    return "\n".join([*out, "Guiding Ends at 2026-01-01 09:00:00", "", ""])


def wander(rng: np.random.Generator, rows: int, frame_s: float) -> Array:
    """Narrow-band noise of a period between 60 and 400 s that keeps its phase for about 50 frames."""
    turn = 2 * np.pi * frame_s / rng.uniform(60, 400)
    e = rng.normal(0, 0.05, rows)
    for k in range(2, rows):
        e[k] += 2 * 0.98 * np.cos(turn) * e[k - 1] - 0.98**2 * e[k - 2]
    return e


def night(seed: int, amplitude: float, turns: float = np.inf) -> tuple[str, str, int]:
    """Log text, mount name and wheel: one to three sections of 40 to 120 minutes, `amplitude` in arcsec.

    Of every section, so many turns of the worm are kept.
    """
    rng = np.random.default_rng(seed)
    mount = str(rng.choice(list(WHEELS)))
    teeth = int(rng.choice(WHEELS[mount]))
    text = TOP
    for k in range(int(rng.integers(1, 4))):
        frame = rng.uniform(2, 5)
        t = np.arange(0, rng.uniform(2400, 7000), frame)
        t += rng.uniform(0, 0.2, len(t))
        walk = np.cumsum(rng.normal(0, rng.uniform(0.02, 0.12), len(t))) * np.sqrt(frame)
        drift = rng.normal(0, 3e-3) * t + rng.normal(0, 3e-7) * t**2
        turn = 2 * np.pi * teeth / SIDEREAL_DAY_S * t
        worm = np.sin(turn + rng.uniform(0, 6)) + 0.3 * np.sin(2 * turn + rng.uniform(0, 6))
        seeing = rng.normal(0, rng.uniform(0.2, 0.6), len(t))
        error = drift + walk + wander(rng, len(t), frame) + amplitude * worm + seeing
        dither = int(rng.choice([0, 60, 200]))
        kept = t < turns * SIDEREAL_DAY_S / teeth
        text += section(f"2026-01-01 2{k}:00:00", t[kept], error[kept], mount, dither)
    return text, mount, teeth
