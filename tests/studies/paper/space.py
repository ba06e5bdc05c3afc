"""The numbers the paper leaves open, their bounds, and how a point of that space becomes two plant models."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import exp, log

import numpy as np

from plant.model import PlantModel, with_effects, with_value
from plant.parts import EffectModel, Number
from scenarios.studies.paper.measures import Array
from scenarios.studies.paper.scales import GEAR_RATIO, INERTIA, TABLE_2


@dataclass(frozen=True)
class Free:
    """One free number: bounds in `unit`, and why these."""

    name: str
    unit: str
    low: float
    high: float
    why: str


SPACE: tuple[Free, ...] = (
    Free("bristle_stiffness", "N m/rad", 1e6, 1e8, "hardware.md 1.1"),
    Free(
        "stiffness_ratio",
        "1",
        1.0,
        7.0,
        "high over low preload; bristles stiffen with the load, Ts itself by 2.4",
    ),
    Free(
        "bristle_damping", "1", 0.1, 1.0, "share of the passivity bound sigma2 Tc/(Ts - Tc), hardware.md 1.1"
    ),
    Free("exponent", "1", 0.5, 2.0, "hardware.md 1.1: 2, 1 and 0.5"),
    Free("torque_constant", "N m/A", 0.2, 1.24, "hardware.md 1.2, 2.3"),
    Free("resistance", "ohm", 0.3, 4.0, "hardware.md 2.3: loop resistance"),
    Free(
        "electrical_time",
        "s",
        0.5e-3,
        8e-3,
        "L/R; hardware.md 1.2: L of 2 to 20 mH",
    ),
    Free(
        "rotor_inertia",
        "kg m2",
        3e-4,
        1.5e-3,
        "hardware.md 1.2, upper part left out: 6e-3 alone would be 780 kg m2",
    ),
    Free(
        "gear_damping", "N m s/rad", 1e3, 1.5e4, "ASSUMPTION: 1 to 15 % of critical of the axis on its trains"
    ),
    Free("kp", "steps/count", 0.02, 10.0, "hardware.md 1.4: 20 and more is unstable"),
    Free("ki", "steps/count", 5e-4, 1.0, "hardware.md 1.4"),
    Free("twice", "N m", 0.5, 120.0, "gear_eccentricity, motor, 2nd harmonic; design.md: 15 to 25"),
    Free("once", "N m", 0.1, 60.0, "gear_eccentricity, motor, 1st harmonic"),
    Free("mesh", "N m", 0.1, 15.0, "gear_mesh, mesh 1: ASSUMPTION"),
    Free(
        "imbalance",
        "N m",
        5.0,
        150.0,
        "gravity_imbalance: ASSUMPTION, below half of the drive's 336 N m (Table 1)",
    ),
)
"""Searched on a logarithmic scale. Table 2, Table 1, encoders, supply, counter split and PWM stay as they
are."""


BALANCED = "ASSUMPTION: balanced in the middle of the absolute encoder's range, 180 deg"


def bounds() -> list[tuple[float, float]]:
    """Return the bounds of the search vector: logarithms."""
    return [(log(free.low), log(free.high)) for free in SPACE]


def values(x: Sequence[float] | Array) -> dict[str, float]:
    """Return the free numbers at a search vector."""
    return {free.name: float(exp(v)) for free, v in zip(SPACE, x, strict=True)}


def vector(found: Mapping[str, float]) -> Array:
    """Return the search vector of free numbers."""
    return np.array([log(found[free.name]) for free in SPACE])


DIODE_DROP = Number(
    0.7, "V", "ASSUMPTION: forward voltage of a silicon diode; hardware.md 2.3: a bridge needs one"
)
"""Of the freewheel diodes: with it, the power stage is solved period by period."""
DEC_SHARE = 316.0 / 933.0
"""Declination over RA: ratio of the load torques of Table 1. What is fitted on RA, the paper's axis, is
carried over."""


def _effects(found: Mapping[str, float], source: str, share: float) -> tuple[EffectModel, ...]:
    def torque(name: str) -> dict[str, Number]:
        return {"amplitude": Number(_rounded(found[name] * share, 3), "N m", source)}

    return (
        EffectModel("gear_eccentricity", "motor", 2, torque("twice")),
        EffectModel("gear_eccentricity", "motor", 1, torque("once")),
        EffectModel(
            "gravity_imbalance", None, 1, torque("imbalance") | {"phase": Number(90.0, "deg", BALANCED)}
        ),
        EffectModel("gear_mesh", "mesh1", 1, torque("mesh")),
    )


def _rounded(value: float, digits: int = 4) -> float:
    return float(f"{value:.{digits}g}")


def _switched(model: PlantModel, axis: str) -> PlantModel:
    """Return the model with diodes in the power stage of an axis."""
    part = getattr(model.axes, axis)
    part = replace(part, motor=replace(part.motor, diode_drop=DIODE_DROP))
    return replace(model, axes=replace(model.axes, **{axis: part}))


def models(bases: Mapping[str, PlantModel], found: Mapping[str, float], source: str) -> dict[str, PlantModel]:
    """Return the low and the high preload plant at a point of the space: one drive, one controller, two
    frictions.

    bases: the declared plants by preload; what the space does not name is theirs.
    source: what the plant files shall say about the numbers.
    """
    result = {}
    for preload in ("low", "high"):
        table = TABLE_2[preload]
        stiffness = found["bristle_stiffness"] * (found["stiffness_ratio"] if preload == "high" else 1.0)
        passive = table["viscous"] * table["coulomb"] / (table["stiction"] - table["coulomb"])
        base = bases[preload]
        switch = base.axes.ra.motor.switch_resistance.si + base.axes.ra.motor.sense_resistance.si
        winding = max(0.05, found["resistance"] - switch)
        rotor = _rounded(found["rotor_inertia"])
        model = with_value(base, "axes.ra.inertia", round(INERTIA - 2.0 * rotor * GEAR_RATIO**2, 1), source)
        for axis, share in (("ra", 1.0), ("dec", DEC_SHARE)):
            said = (
                source
                if axis == "ra"
                else f"{source}; on RA, times {share:.2g} where it scales with the load"
            )
            numbers = {
                "friction.bristle_stiffness": _rounded(stiffness * share),
                "friction.bristle_damping": _rounded(found["bristle_damping"] * passive * share),
                "friction.stribeck_exponent": _rounded(found["exponent"]),
                "motor.torque_constant": _rounded(found["torque_constant"]),
                "motor.resistance": _rounded(winding),
                "motor.inductance": _rounded(found["electrical_time"] * (winding + switch) * 1e3),  # mH
                "motor.rotor_inertia": rotor,
                "gear.damping": _rounded(found["gear_damping"]),
            }
            for path, value in numbers.items():
                model = with_value(model, f"axes.{axis}.{path}", value, said)
            model = with_effects(_switched(model, axis), axis, _effects(found, said, share))
        model = with_value(model, "controller.kp", _rounded(found["kp"]), source)
        result[preload] = with_value(model, "controller.ki", _rounded(found["ki"]), source)
    return result
