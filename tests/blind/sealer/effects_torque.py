"""Torques over angle, gears, structure, wind: how each is drawn."""

import math

import numpy as np

from tests.blind.sealer import declared as d
from tests.blind.sealer.draw import Drive
from tests.blind.sealer.drawn import Drawn
from tests.blind.sealer.effects_friction import beyond

Rng = np.random.Generator


def gravity_imbalance(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """A weight off the axis."""
    fixed = {"GRAV_PH": rng.uniform(0, d.TURN)}
    names = {"amplitude": ("GRAV_A", 1.0, "N m"), "phase": ("GRAV_PH", 1.0, "rad")}
    return Drawn("gravity_imbalance", "T", ("axis_angle",), {"GRAV_A": 3.0}, fixed, names, "axis", 1, 1.0)


def line(rng: Rng, name: str, stage: str) -> Drawn:
    """Sine at a stage's order: torque on the axis and kinematic error of train A, first or second
    harmonic."""
    harmonic = 1 if rng.random() < 0.7 else 2
    order = d.ORDERS[stage] * harmonic
    kin = rng.uniform(0.3, 1.0) * 0.36 * d.ARCSEC
    fixed = {"L1_ORDER": order, "L1_PH": rng.uniform(0, d.TURN)}
    names = {"amplitude": ("L1_T", 1.0, "N m"), "kinematic": ("L1_K", 1.0 / d.ARCSEC, "arcsec")}
    return Drawn(
        name,
        "T",
        ("motor_angle", "axis_angle"),
        {"L1_T": 1.5, "L1_K": kin},
        fixed,
        names,
        stage,
        harmonic,
        order,
    )


def gear_eccentricity(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Eccentric gear on one shaft."""
    return line(rng, "gear_eccentricity", str(rng.choice(["shaft2", "shaft1", "motor"])))


def gear_mesh(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Error at a tooth-mesh order."""
    return line(rng, "gear_mesh", str(rng.choice(["mesh3", "mesh2", "mesh1"])))


def damaged_tooth(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """One bad tooth: a pulse per turn of its shaft."""
    stage = str(rng.choice(["shaft2", "shaft1", "motor"]))
    scaled = {"TOOTH_T": 8.0 * float(rng.choice([-1.0, 1.0])), "TOOTH_K": rng.uniform(0.3, 1.0) * d.ARCSEC}
    fixed = {
        "TOOTH_ORDER": d.ORDERS[stage],
        "TOOTH_WIDTH": 1.5 / d.TEETH[stage],
        "TOOTH_PH": rng.uniform(0, 1),
    }
    names = {"amplitude": ("TOOTH_T", 1.0, "N m"), "width": ("TOOTH_WIDTH", 1.0, "turn")}
    return Drawn(
        "damaged_tooth",
        "T",
        ("motor_angle", "axis_angle"),
        scaled,
        fixed,
        names,
        stage,
        None,
        d.ORDERS[stage],
    )


def bearing_pass(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """A line at an order that belongs to no shaft (at least 2 % from every harmonic up to 6 of every
    stage)."""
    taken = np.array([h * o for stage, o in d.ORDERS.items() if stage != "axis" for h in range(1, 7)])
    while True:
        order = math.exp(rng.uniform(math.log(20.0), math.log(3000.0)))
        if np.min(np.abs(taken / order - 1.0)) > 0.02:
            break
    fixed = {"L1_ORDER": order, "L1_PH": rng.uniform(0, d.TURN)}
    names = {"amplitude": ("L1_T", 1.0, "N m"), "order": ("L1_ORDER", 1.0, "1")}
    return Drawn("bearing_pass", "T", ("axis_angle", "motor_angle"), {"L1_T": 1.5}, fixed, names, order=order)


def cable_wrap(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Spring and loop over the angle."""
    scale = math.radians(rng.uniform(3.0, 8.0))
    fixed = {"CABLE_TH0": drive.values["TH_START"] + rng.uniform(-0.3, 0.3), "CABLE_SCALE": scale}
    scaled = {"CABLE_K": 4.0 * rng.uniform(0.7, 1.5), "CABLE_H": 1.0 * rng.uniform(0.7, 1.5)}
    names = {"stiffness": ("CABLE_K", 1.0, "N m/rad"), "loop": ("CABLE_H", 1.0, "N m")}
    return Drawn("cable_wrap", "T", ("axis_angle", "reversal"), scaled, fixed, names)


def shaft_compliance(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Stiffness of both trains below (or above) the declared."""
    size = 1.0 + d.TOLERANCE * ratio
    factor = 1.0 / size if rng.random() < 0.7 else size
    values = {"KGEAR": drive.declared["KGEAR"] * factor}
    return Drawn(
        "shaft_compliance",
        "K",
        ("current",),
        {},
        values,
        {"stiffness": ("KGEAR", 1.0, "N m/rad")},
        how="tolerance",
    )


def structural_mode(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Part of the load hangs on a spring of its own."""
    f0 = rng.uniform(2.0, 14.0)
    fixed = {"W2": d.TURN * f0, "Z2": rng.uniform(0.005, 0.03)}
    scaled = {"J2": 0.02 * drive.values["J"]}
    names = {
        "frequency": ("W2", 1.0 / d.TURN, "Hz"),
        "damping": ("Z2", 1.0, "1"),
        "inertia_2": ("J2", 1.0, "kg m2"),
    }
    return Drawn("structural_mode", "T", ("time",), scaled, fixed, names, frequency_hz=f0)


def wind_torque(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Mean and low-passed noise."""
    fixed = {"WIND_CORNER": rng.uniform(0.1, 0.6), "WIND_MEAN": rng.uniform(0.0, 1.0)}
    names = {"sigma": ("WIND", 1.0, "N m"), "corner": ("WIND_CORNER", 1.0, "Hz")}
    return Drawn("wind_torque", "T", ("time",), {"WIND": 1.5}, fixed, names)


def backlash_loss(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """The lagging motor hardly pulls, so its rotor runs on when the axis slows: teeth part, a gap at the
    reversal.

    (Steady motion keeps the flanks together by the rotor's own drag; what parts them is inertia.)
    """
    loss = 1.0 - 0.05 / ratio**2
    fixed = {"COUNTER_LOSS": loss, "ROTOR_DRAG": 0.001}
    names = {"counter_loss": ("COUNTER_LOSS", 1.0, "1"), "drag": ("ROTOR_DRAG", 1.0, "N m")}
    return Drawn("backlash_loss", "K", ("reversal",), {}, fixed, names, how="fraction")


__all__ = [
    "backlash_loss",
    "bearing_pass",
    "beyond",
    "cable_wrap",
    "damaged_tooth",
    "gear_eccentricity",
    "gear_mesh",
    "gravity_imbalance",
    "shaft_compliance",
    "structural_mode",
    "wind_torque",
]
