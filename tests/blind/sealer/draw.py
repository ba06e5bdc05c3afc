"""Drawing a drive: which axis, which preload, how far every figure is from the declared one."""

import math
from dataclasses import dataclass, field

import numpy as np

from tests.blind.sealer import declared as d


@dataclass
class Drive:
    """One drawn drive: kernel values by slot name, and what the log's header says."""

    axis: str
    preload: str
    values: dict[str, float]
    noise: dict[str, float]
    declared: dict[str, float]
    header: dict[str, str] = field(default_factory=dict)


def off(rng: np.random.Generator, low: float, high: float) -> float:
    """A factor between 1/(1+high) and 1+high, at least `low` away from 1, either side."""
    size = 1.0 + rng.uniform(low, high)
    return float(size if rng.random() < 0.5 else 1.0 / size)


def drive(rng: np.random.Generator, kind: str) -> Drive:
    """Draw a drive. kind: "pure" (as declared), "off" (5-20 % off), "gains" (other gains and clock),
    "mixed"."""
    axis = "ra" if rng.random() < 0.8 else "dec"
    preload = "low" if rng.random() < 0.85 else "high"
    low, high = {"pure": (0.0, 0.0), "off": (0.05, 0.20), "gains": (0.0, 0.02), "mixed": (0.0, 0.12)}[kind]
    table = d.FRICTION[preload]
    inertia = d.AXES[axis].inertia
    if axis == "ra" and preload == "high":
        inertia = d.RA_BEFORE_WEIGHTS  # the weights came off together with the preload
    k = d.TORQUE_CONSTANT * (1.0 if kind == "pure" else rng.uniform(0.92, 1.12))
    r = d.RESISTANCE * (1.0 if kind == "pure" else rng.uniform(0.88, 1.1))
    if preload == "high":  # must break away: 24 V through R against Ts
        k, r = max(k, 0.42), min(r, 1.95)
    stiffness = d.AXES[axis].stiffness * off(rng, low, high)
    rotor_at_axis = d.ROTOR * d.GEAR_RATIO**2
    damping = 2.0 * 0.3 * math.sqrt(stiffness * rotor_at_axis)  # A: 30 % of critical, grease and supports
    scale = inertia / 1760.0
    kp = scale * (rng.uniform(1.6, 3.0) if kind in ("gains", "mixed") else 2.4)
    ki = scale * (rng.uniform(0.04, 0.14) if kind in ("gains", "mixed") else 0.08)
    ppm = 0.0 if kind == "pure" else rng.uniform(-80.0, 80.0)
    start = rng.uniform(0.25, 5.6)
    values = {
        "J": inertia * off(rng, low, high),
        "SIG0": d.SIGMA_0 * (1.0 if kind == "pure" else math.exp(rng.uniform(-1, 1) * d.SIGMA_0_TOLERANCE)),
        "SIG1": d.SIGMA_1 * off(rng, low, high),
        "SIG2": table.viscous * off(rng, low, high),
        "TC": table.coulomb * off(rng, low, high),
        "TS": table.breakaway * off(rng, low, high),
        "VS": table.stribeck * off(rng, low, high),
        "DELTA": d.DELTA,
        "RATIO": d.GEAR_RATIO,
        "KGEAR": stiffness,
        "CGEAR": damping,
        "HALF_GAP": math.radians(d.BACKLASH_MOTOR_DEG) / d.GEAR_RATIO / 2.0,
        "JM": d.ROTOR,
        "KA": k,
        "KB": k,
        "RA": r,
        "RB": r,
        "L": r * d.TAU_ELECTRIC_S,
        "V0": d.SUPPLY_V,
        "COUNTER": 0.10 if preload == "high" else float(rng.choice([0.10, 0.15, 0.20])),
        "KP_Q12": float(round(kp * 4096)),
        "KI_Q12": float(round(ki * 4096)),
        "TICK": d.TICK_S * (1.0 + ppm * 1e-6),
        "ROLLER_SCALE": d.ROLLER_COUNTS / d.TURN,
        "ROLLER_NOISE": 0.2 * rng.uniform(0.5, 1.5),
        "TH_START": start,
        "WARM_TAU": 100.0,
        "HEAT_TAU": 100.0,
        "CABLE_SCALE": 0.1,
    }
    noise = {  # standard deviations: counts of the column
        "position": 0.5 * rng.uniform(0.5, 1.5),
        "adc": 0.7 * rng.uniform(0.5, 1.5),
        "ppm": ppm,
        "stamp_s": 5e-6 * rng.uniform(0.3, 1.5),  # A: interrupt latency in every board's time stamp
    }
    named = {
        "J": inertia,
        "SIG2": table.viscous,
        "TC": table.coulomb,
        "TS": table.breakaway,
        "VS": table.stribeck,
        "KGEAR": d.AXES[axis].stiffness,
        "SIG0": d.SIGMA_0,
        "SIG1": d.SIGMA_1,
    }
    return Drive(axis, preload, values, noise, named)
