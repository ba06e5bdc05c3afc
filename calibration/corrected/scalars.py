"""Effects that are one or two numbers: friction, electrical parts, sensors, slow changes."""

from __future__ import annotations

import numpy as np

from calibration.corrected.making import Facts, Made, motor_of, value
from calibration.finding import Finding

#: effect -> {plant parameter: (finding parameter, factor)}, where nothing else is to be known
PLAIN: dict[str, dict[str, tuple[str, float]]] = {
    "friction_asymmetry": {
        "coulomb_asymmetry": ("coulomb_asymmetry", 1.0),
        "viscous_asymmetry": ("viscous_asymmetry", 1.0),
    },
    "load_friction": {"coefficient": ("mu", 1.0)},
    "supply_sag": {"resistance": ("resistance", 1.0)},
    "diode_braking": {"share": ("fraction", 1.0)},
    "pwm_deadband": {"deadband": ("u0", 1.0)},
    "backlash_loss": {"loss": ("counter_loss", 1.0)},
    "roller_ratio": {"error": ("scale", 1e6)},
    "clock_jitter": {"deviation": ("sigma", 1.0)},
}


def plain(f: Finding, facts: Facts) -> Made:
    """An effect whose numbers are the finding's."""
    made = Made()
    table = PLAIN[f.name]
    made.add(f.name, facts, {k: value(f, name) * factor for k, (name, factor) in table.items()})
    if value(f, "of_the_sum"):
        made.remarks.append(f"{f.name}: found with the motors' currents, the plant draws duty times current")
    if value(f, "before_split"):
        made.remarks.append(f"{f.name}: found before the split between the motors, the plant has it behind")
    return made


def warmup(f: Finding, facts: Facts) -> Made:
    """friction_warmup: F (1 + a e^(-t/tau)) is the plant's depth -a."""
    made = Made()
    tau = value(f, "tau", value(f, "tau_in_run"))
    made.add(f.name, facts, {"depth": -value(f, "amplitude"), "time_constant": tau})
    _comes_in_every_run(f, made)
    if "stiction_rise" in f.parameters:
        made.remarks.append("friction_warmup: the plant scales Tc, Ts and sigma2 alike, by the rise of Tc")
    return made


def preload(f: Finding, facts: Facts) -> Made:
    """preload_change: a step is a ramp of the shortest duration; time runs from the log's first row."""
    made = Made()
    values = {
        "change": value(f, "fraction"),
        "start": value(f, "onset", value(f, "onset_in_run")),
        "duration": value(f, "ramp", 0.01),
    }
    made.add(f.name, facts, values)
    _comes_in_every_run(f, made)
    return made


def _comes_in_every_run(f: Finding, made: Made) -> None:
    if {"onset_in_run", "tau_in_run"} & set(f.parameters):
        made.remarks.append(f"{f.name}: it comes in every run, the plant has it from its own start on")


def brake(f: Finding, facts: Facts) -> Made:
    """brake_drag: a drag that goes away is one that was there from the start, of friction that was less."""
    made = Made()
    torque, onset = value(f, "torque"), value(f, "onset", value(f, "onset_in_run"))
    _comes_in_every_run(f, made)
    if torque >= 0.0:
        made.add(f.name, facts, {"torque": torque, "start": onset, "duration": 1e6})
    else:
        made.add(f.name, facts, {"torque": -torque, "start": -1e6, "duration": 1e6 + onset})
        made.numbers = {"friction.coulomb": torque, "friction.stiction": torque}
        made.remarks.append("brake_drag: it lets go, so Tc and Ts of the plant are those without it")
    return made


def cable(f: Finding, facts: Facts) -> Made:
    """cable_wrap: the loop's travel is the Dahl width with the same area."""
    made = Made()
    stiffness = value(f, "stiffness")
    centre = facts.middle - value(f, "neutral_torque") / stiffness if stiffness else facts.middle
    values = {
        "stiffness": stiffness,
        "centre": centre,
        "hysteresis": value(f, "loop"),
        "width": float(np.degrees(value(f, "loop_travel", 0.01))),
    }
    made.add(f.name, facts, values)
    return made


def mode(f: Finding, facts: Facts) -> Made:
    """structural_mode: the second mass is part of the plant's inertia, not of the calibrated one."""
    made = Made()
    inertia = value(f, "inertia_2")
    values = {"frequency": value(f, "frequency"), "damping": value(f, "damping"), "inertia": inertia}
    made.add(f.name, facts, values)
    made.numbers = {"inertia": inertia}
    return made


def wind(f: Finding, facts: Facts) -> Made:
    """wind_torque: its corner is the correlation time; the mean is friction's business."""
    made = Made()
    values = {"deviation": value(f, "sigma"), "correlation_time": 1 / (2 * np.pi * value(f, "corner", 0.1))}
    made.add(f.name, facts, values)
    return made


def offset(f: Finding, facts: Facts) -> Made:
    """adc_offset: counts of a motor's reading, or N m of both readings' difference."""
    made, number = Made(), motor_of(f)
    if "offset" in f.parameters:
        ampere = value(f, "offset") * facts.ampere_per_count
        made.add(f.name, facts, {"offset": ampere, "motor": 0.0 if number is None else number + 1.0})
    else:
        made.add(f.name, facts, {"offset": value(f, "offset_torque") / facts.per_ampere, "motor": 1.0})
        made.remarks.append("adc_offset: the torque does not tell the motors apart, written to motor A")
    return made


def gain(f: Finding, facts: Facts) -> Made:
    """adc_gain: the residual g i is what the reading has too much."""
    made, number = Made(), motor_of(f)
    for k, name in enumerate(("gain_a", "gain_b")):
        if name in f.parameters:
            number = k
    g = value(f, "gain", value(f, "gain_a", value(f, "gain_b")))
    made.add(f.name, facts, {"gain": 1.0 / (1.0 - g), "motor": 0.0 if number is None else number + 1.0})
    return made


def magnets(f: Finding, facts: Facts) -> Made:
    """magnet_weakening of one motor, or of both from some time on."""
    made, number = Made(), motor_of(f)
    values = {"loss": value(f, "fraction"), "motor": 0.0 if number is None else number + 1.0}
    made.add(f.name, facts, values)
    if "onset" in f.parameters:
        made.remarks.append(
            f"magnet_weakening: the plant's magnets do not know the time, the loss found from "
            f"{value(f, 'onset'):.0f} s on is there from the start"
        )
    return made


def heating(f: Finding, facts: Facts) -> Made:
    """winding_heating: fitted with the whole loop's resistance, of which the winding warms."""
    made = Made()
    share = facts.resistance / facts.winding
    values = {
        "thermal_resistance": value(f, "thermal_resistance") * share**2,
        "time_constant": value(f, "tau"),
    }
    made.add(f.name, facts, values)
    return made


def drift(f: Finding, facts: Facts) -> Made:
    """encoder_thermal_drift: per kelvin, or arcsec over the log through the plant's own warming."""
    made = Made()
    found = f.parameters["drift"]
    if found.unit == "arcsec/K":
        made.add(f.name, facts, {"drift": found.value, "encoder": 1.0})
    elif facts.warming:
        per_kelvin = -found.value / (facts.duration_s * facts.warming)
        made.add(f.name, facts, {"drift": per_kelvin, "encoder": 1.0})
        made.remarks.append(
            "encoder_thermal_drift: the log has no temperature, the plant's own warming is used"
        )
    else:
        made.remarks.append("encoder_thermal_drift: left out, the plant's temperature does not change")
    return made


def slip(f: Finding, facts: Facts) -> Made:
    """roller_slip: a share of the rate (creep in the report), or seconds of acceleration beyond the limit."""
    made = Made()
    values = {"threshold": value(f, "limit"), "slip": value(f, "creep"), "creep": value(f, "slip")}
    made.add(f.name, facts, values)
    return made


def play(f: Finding, facts: Facts) -> Made:
    """play: K compares the motors with the absolute encoder, so its coupling has the gap."""
    made = Made()
    made.add(f.name, facts, {"gap": value(f, "gap"), "encoder": value(f, "encoder", 1.0)})
    return made


def disturbance(f: Finding, facts: Facts) -> Made:
    """command_disturbance: its phase is the first run's, every run has one of its own."""
    made = Made()
    values = {
        "amplitude": value(f, "amplitude") / 3000.0,
        "frequency": value(f, "frequency", f.frequency or 0.0),
        "phase": value(f, "phase") + np.pi / 2,
        "shape": value(f, "shape"),
    }
    made.add(f.name, facts, values)
    made.remarks.append(
        "command_disturbance: every run has a phase of its own, the plant has the first run's"
    )
    return made
