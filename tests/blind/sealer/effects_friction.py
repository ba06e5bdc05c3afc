"""Friction effects of the catalogue: how each is drawn."""

import math

import numpy as np

from tests.blind.sealer import declared as d
from tests.blind.sealer.draw import Drive
from tests.blind.sealer.drawn import Drawn

Rng = np.random.Generator


def beyond(rng: Rng, ratio: float) -> float:
    """Factor whose distance from 1 is `ratio` declared tolerances."""
    size = 1.0 + d.TOLERANCE * ratio
    return float(size if rng.random() < 0.6 else 1.0 / size)


def stribeck_change(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Break-away torque and Stribeck speed away from the declared."""
    ts = beyond(rng, ratio)
    if drive.preload == "high":
        ts = min(ts, 1.0 / ts)  # upwards it would not break away at all
    ts = max(ts, 1.15 * drive.declared["TC"] / drive.declared["TS"])
    vs = beyond(rng, ratio) if rng.random() < 0.5 else 1.0
    values = {"TS": ts * drive.declared["TS"], "VS": vs * drive.declared["VS"]}
    names = {"breakaway": ("TS", 1.0, "N m"), "stribeck_velocity": ("VS", 1.0, "rad/s")}
    return Drawn("stribeck_change", "T", ("velocity",), {}, values, names, how="tolerance")


def presliding(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Bristle stiffness away from the declared by `ratio` of its (logarithmic) tolerance."""
    up = rng.random() < 0.5
    power = min(ratio, 4.5 if up else 3.0)
    factor = math.exp(power * d.SIGMA_0_TOLERANCE * (1.0 if up else -1.0))
    values = {"SIG0": drive.declared["SIG0"] * factor}
    return Drawn(
        "presliding", "T", ("reversal",), {}, values, {"sigma_0": ("SIG0", 1.0, "N m/rad")}, how="tolerance"
    )


def viscous_change(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Viscous friction away from the declared."""
    values = {"SIG2": drive.declared["SIG2"] * beyond(rng, ratio)}
    return Drawn(
        "viscous_change",
        "T",
        ("velocity",),
        {},
        values,
        {"sigma_2": ("SIG2", 1.0, "N m s/rad")},
        how="tolerance",
    )


def coulomb_change(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Coulomb friction away from the declared."""
    values = {"TC": drive.declared["TC"] * beyond(rng, ratio)}
    return Drawn(
        "coulomb_change", "T", ("velocity",), {}, values, {"coulomb": ("TC", 1.0, "N m")}, how="tolerance"
    )


def friction_asymmetry(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Coulomb and viscous friction differ with direction."""
    sign = float(rng.choice([-1.0, 1.0]))
    scaled = {"ASYM_C": sign * 0.005, "ASYM_V": sign * 0.005 * rng.uniform(0.0, 1.0)}
    names = {"coulomb_asymmetry": ("ASYM_C", 1.0, "1"), "viscous_asymmetry": ("ASYM_V", 1.0, "1")}
    return Drawn("friction_asymmetry", "T", ("velocity",), scaled, {}, names)


def position_friction(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Coulomb friction that waves with the axis angle: 2 to 5 waves over the travel."""
    order = rng.uniform(2.0, 5.0) * d.TURN / max(span, 1e-3)
    fixed = {"POSF_ORDER": order, "POSF_PH": rng.uniform(0, d.TURN)}
    names = {"amplitude": ("POSF_A", 1.0, "N m"), "order": ("POSF_ORDER", 1.0, "1")}
    return Drawn("position_friction", "T", ("axis_angle",), {"POSF_A": 2.0}, fixed, names, order=order)


def load_friction(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Friction in proportion to the torque through the trains."""
    return Drawn(
        "load_friction", "T", ("current", "velocity"), {"LOADF": 0.02}, {}, {"mu": ("LOADF", 1.0, "1")}
    )


def friction_warmup(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Friction high at the start of a session, decaying."""
    fixed = {"WARM_TAU": rng.uniform(60.0, 200.0)}
    names = {"amplitude": ("WARM_A", 1.0, "1"), "tau": ("WARM_TAU", 1.0, "s")}
    return Drawn("friction_warmup", "T", ("time", "temperature"), {"WARM_A": 0.01}, fixed, names)


def preload_change(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Break-away and viscous friction scale together, at a time or slowly."""
    ramp = 0.0 if rng.random() < 0.5 else rng.uniform(60.0, 200.0)
    fixed = {"PRELOAD_T0": rng.uniform(140.0, 260.0), "PRELOAD_RAMP": ramp}
    sign = float(rng.choice([-1.0, 1.0])) if drive.preload == "low" else -1.0
    names = {"fraction": ("PRELOAD_A", 1.0, "1"), "onset": ("PRELOAD_T0", 1.0, "s")}
    return Drawn("preload_change", "T", ("time",), {"PRELOAD_A": sign * 0.02}, fixed, names, one_session=True)


def brake_drag(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """A brake begins to drag: constant torque against motion from a time on."""
    fixed = {"BRAKE_T0": rng.uniform(140.0, 260.0)}
    names = {"torque": ("BRAKE_T", 1.0, "N m"), "onset": ("BRAKE_T0", 1.0, "s")}
    return Drawn("brake_drag", "T", ("time",), {"BRAKE_T": 2.0}, fixed, names, one_session=True)
