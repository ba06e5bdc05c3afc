"""Lines over angle, from the cosine of a residual to the sine of a plant file.

A torque residual A cos(x + phase) is what the motors must add: the torque on the axis is minus that. An
encoder residual (motors less axis) is minus the axis encoder's error, and minus the twist of the trains.
Plant files write sine(x + phase); a wave of the torque constant and of friction is a cosine there.
"""

from __future__ import annotations

import numpy as np

from calibration.corrected.making import Facts, Made, motor_of, value
from calibration.finding import Finding
from plant.gears import ORDERS

TURN = np.pi / 2
ARCSEC_PER_RAD = 206264.80625
#: mesh -> (shaft that carries one of its wheels, teeth): mesh order = teeth * shaft order
SHAFT_OF_MESH = {"mesh1": ("motor", 27), "mesh2": ("shaft1", 21), "mesh3": ("shaft2", 17)}
MISPLACED = 0.1  # rad by which a line of the nearest possible order may walk off within half the travel


def gear(f: Finding, facts: Facts) -> Made:
    """gear_eccentricity and gear_mesh: torque from channel T, twist of the trains from channel K."""
    made = Made()
    stage, harmonic = f.stage or "axis", f.harmonic or 1
    if f.channel == "T":
        made.add(
            f.name,
            facts,
            {"amplitude": value(f, "amplitude"), "phase": value(f, "phase") - TURN},
            stage,
            harmonic,
        )
        twist = facts.twists.get((stage, harmonic))
        if twist is not None:
            _twist(made, facts, stage, harmonic, *twist)
        elif "kinematic" in f.parameters:
            made.remarks.append(
                f"{f.name} on {stage}: its twist shows in one train, the plant's acts on both: left out"
            )
    else:
        _twist(made, facts, stage, harmonic, value(f, "amplitude"), value(f, "phase"))
    return made


def _twist(made: Made, facts: Facts, stage: str, harmonic: int, arcsec: float, phase: float) -> None:
    if stage in SHAFT_OF_MESH:
        shaft, teeth = SHAFT_OF_MESH[stage]
        made.remarks.append(f"the twist at {stage} is written as harmonic {teeth * harmonic} of {shaft}")
        stage, harmonic = shaft, teeth * harmonic
    made.add("gear_eccentricity", facts, {"kinematic": arcsec, "phase": phase - TURN}, stage, harmonic)


def imbalance(f: Finding, facts: Facts) -> Made:
    """gravity_imbalance: A cos(angle - phase) on the axis."""
    made = Made()
    made.add(
        "gravity_imbalance", facts, {"amplitude": value(f, "amplitude"), "phase": np.pi - value(f, "phase")}
    )
    return made


def bearing(f: Finding, facts: Facts) -> Made:
    """bearing_pass: a sine at any order."""
    made = Made()
    values = {"order": f.order or 0.0, "amplitude": value(f, "amplitude"), "phase": value(f, "phase") - TURN}
    made.add("bearing_pass", facts, values)
    return made


def motor(f: Finding, facts: Facts) -> Made:
    """motor_cogging and torque_ripple: over the angle of a motor, which lies half the play off the axis'.

    A finding without a motor has motor A's wave first and motor B's second.
    """
    made, number, cycles = Made(), motor_of(f), float(f.harmonic or 1)
    size = "amplitude" if f.name == "motor_cogging" else "ripple"
    turn = -TURN if f.name == "motor_cogging" else np.pi
    second = f"{size}_2" in f.parameters
    for motor, word in ((0, ""), (1, "_2")) if number is None and second else ((number, ""),):
        side = 0.0 if motor is None else 1.0 - 2.0 * motor
        phase = value(f, "phase" + word) + turn - cycles * side * facts.half_play
        values = {"cycles": cycles, size: value(f, size + word), "phase": phase}
        made.add(f.name, facts, values | {"motor": 0.0 if motor is None else motor + 1.0})
    if number is None and not second:
        made.remarks.append(f"{f.name}: the log does not say on which motor, written to both")
    return made


def friction(f: Finding, facts: Facts) -> Made:
    """position_friction: the stage and harmonic whose order is nearest, its phase right at mid travel."""
    made = Made()
    order = f.order or ORDERS[f.stage or "axis"] * (f.harmonic or 1)
    stage, harmonic = nearest_place(order)
    written = ORDERS[stage] * harmonic
    phase = -value(f, "phase") + (written - order) * facts.middle
    made.add(
        "position_friction", facts, {"amplitude": value(f, "amplitude"), "phase": phase}, stage, harmonic
    )
    off = abs(written - order) * facts.span / 2
    if off > MISPLACED:
        made.remarks.append(
            f"position_friction: order {order:.5g} is written as {stage}, harmonic {harmonic} "
            f"({written:.5g}): {off:.2f} rad off at the ends of the travel"
        )
    return made


def nearest_place(order: float) -> tuple[str, int]:
    """Stage and harmonic (1 to 1000) whose order is nearest; of equals, the lowest harmonic."""
    best = [
        (abs(per_turn * h - order), h, stage)
        for stage, per_turn in ORDERS.items()
        for h in {int(np.clip(round(order / per_turn), 1, 1000))}
    ]
    _, harmonic, stage = min(best)
    return stage, harmonic


def encoder(f: Finding, facts: Facts) -> Made:
    """encoder_eccentricity: of the absolute encoder (stage axis) or of the roller's."""
    made = Made()
    a, b = value(f, "amplitude"), value(f, "amplitude_2")
    p, q = value(f, "phase"), value(f, "phase_2")
    stage, harmonic = f.stage or "axis", f.harmonic or 1
    if f.channel == "K":  # motors less axis: minus the absolute encoder's error, arcsec
        values = {"amplitude": a, "phase": p - TURN, "second": b, "second_phase": q - TURN}
    elif stage == "roller":  # its rate error is order * A cos(...)
        values = {"amplitude": a / (f.order or 1.0) * ARCSEC_PER_RAD, "phase": p}
    else:  # minus the absolute encoder's rate error, per rate; the second harmonic turns twice
        values = {"amplitude": a * ARCSEC_PER_RAD, "phase": p + np.pi}
        values |= {"second": 0.5 * b * ARCSEC_PER_RAD, "second_phase": q + np.pi}
    made.add("encoder_eccentricity", facts, values, stage, harmonic if stage != "axis" else 1)
    return made


def subdivision(f: Finding, facts: Facts) -> Made:
    """encoder_subdivision of the absolute encoder: minus its rate error is in the residual."""
    made = Made()
    values = {"lines": f.order or 32768.0, "encoder": 1.0}
    for k, name, phase in (("", "amplitude", "phase"), ("_2", "second", "second_phase")):
        if "amplitude" + k in f.parameters:
            values |= {name: value(f, "amplitude" + k), phase: value(f, "phase" + k) + np.pi}
    made.add("encoder_subdivision", facts, values)
    return made


def tooth(f: Finding, facts: Facts) -> Made:
    """damaged_tooth: a raised cosine of full width w turns is a Gaussian of the same height and area."""
    made = Made()
    values = {
        "amplitude": value(f, "amplitude"),
        "phase": 2 * np.pi * value(f, "phase"),
        "width": 2 * np.pi * value(f, "width") / (2 * np.sqrt(2 * np.pi)),
    }
    made.add("damaged_tooth", facts, values, f.stage, 1)
    return made
