"""Friction that falls as the motion begins."""

import numpy as np

from calibration.names.name import Candidate, Changed, Name, Scene, grid, unstated
from calibration.names.scene import FEWEST

# part of the top speed: Stribeck speeds that are tried. ASSUMPTION
PARTS = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4)
# times the speed at which the direction fades: below, a dip is only how friction turns. ASSUMPTION
CLEAR = 3.0
# standard errors, of the numbers: a dip that is seen badly moves far at no cost. ASSUMPTION
PRECISE = {"stiction": 0.1, "stribeck_speed": 0.15}
NUMBERS = {"stiction": "stiction_factor", "stribeck_speed": "velocity_factor"}
# share of the held-out mean square that leaving it out must add: less is how friction turns (seed 1011)
AT_REST = 0.2


def columns(s: Scene) -> list[Candidate]:
    """sign(speed) exp(-(speed/vs)^2), for speeds on both sides of vs; only ever more friction at rest."""
    speed = np.abs(s.view.speed)
    top = float(np.quantile(speed[s.view.ok], 0.98)) if s.view.ok.any() else 0.0
    least = CLEAR * s.view.standstill

    def full(p: np.ndarray) -> np.ndarray:
        vs = max(p[0], least, 1e-9 * top)
        return np.asarray(s.view.direction * np.exp(-((s.view.speed / vs) ** 2)))

    def seen(vs: float) -> bool:
        low = np.mean((speed < vs) & (speed > 0.1 * vs))
        return bool(low >= FEWEST and top >= 2.5 * vs and vs >= least)

    along = ("stribeck_speed", filter(seen, (part * top for part in PARTS)), f"{s.angle_unit}/s")
    # friction does not end with its dip: where nobody stated a level it may hold that, too
    level = ("coulomb_change",) if unstated(s, "coulomb") else ()
    return grid(NAME.name, s.shaped(full), ("stribeck_force", s.unit), along=along, sign=1, twins=level)


def lacks(s: Scene) -> str:
    """Speeds of more than one size."""
    speed = np.abs(s.view.speed[s.view.ok])
    if len(speed) and np.quantile(speed, 0.05) > 0.5 * np.quantile(speed, 0.98):
        return "slow motion: ramps through the lowest speeds"
    return ""


NAME = Name(
    name="stribeck_change",
    columns=columns,
    experiment="slow ramps on both sides of the Stribeck speed",
    lacks=lacks,
    changed=Changed(numbers=NUMBERS, seen="dip", precise=PRECISE),
    worth=AT_REST,
)
