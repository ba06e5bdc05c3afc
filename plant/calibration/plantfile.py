"""plant.yaml: the calibrated numbers and the effects found, as a plant that the emulator runs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from plant.calibration.decide.finding import Finding, Parameter

#: calibrated name -> (path below axes.<axis>, factor to SI is handled by the plant's units)
PATHS = {
    "coulomb": "friction.coulomb",
    "stiction": "friction.stiction",
    "viscous": "friction.viscous",
    "stribeck_speed": "friction.stribeck_rate",
    "sigma_0": "friction.bristle_stiffness",
    "torque_constant": "motor.torque_constant",
    "resistance": "motor.resistance",
}
#: effect -> {plant parameter: (finding parameter, factor)}
MAPS: dict[str, dict[str, tuple[str, float]]] = {
    "gear_eccentricity": {
        "amplitude": ("amplitude", 1),
        "kinematic": ("kinematic", 1),
        "phase": ("phase", 1),
    },
    "gear_mesh": {"amplitude": ("amplitude", 1), "phase": ("phase", 1)},
    "gravity_imbalance": {"amplitude": ("amplitude", 1), "phase": ("phase", 1)},
    "bearing_pass": {"amplitude": ("amplitude", 1), "phase": ("phase", 1)},
    "motor_cogging": {"amplitude": ("amplitude", 1), "phase": ("phase", 1)},
    "torque_ripple": {"ripple": ("ripple", 1), "phase": ("phase", 1)},
    "friction_asymmetry": {
        "coulomb_asymmetry": ("coulomb_asymmetry", 1),
        "viscous_asymmetry": ("viscous_asymmetry", 1),
    },
    "load_friction": {"coefficient": ("mu", 1)},
    "friction_warmup": {"depth": ("amplitude", -1), "time_constant": ("tau", 1)},
    "preload_change": {"change": ("fraction", 1), "start": ("onset", 1), "duration": ("ramp", 1)},
    "brake_drag": {"torque": ("torque", 1), "start": ("onset", 1)},
    "cable_wrap": {
        "stiffness": ("stiffness", 1),
        "hysteresis": ("loop", 1),
        "width": ("loop_travel", 180 / np.pi),
    },
    "structural_mode": {
        "frequency": ("frequency", 1),
        "damping": ("damping", 1),
        "inertia": ("inertia_2", 1),
    },
    "damaged_tooth": {"amplitude": ("amplitude", 1), "width": ("width", 2 * np.pi * 0.2)},
    "supply_sag": {"resistance": ("resistance", 1)},
    "winding_heating": {"thermal_resistance": ("thermal_resistance", 1), "time_constant": ("tau", 1)},
    "diode_braking": {"share": ("fraction", 1)},
    "pwm_deadband": {"deadband": ("u0", 1)},
    "backlash_loss": {"loss": ("counter_loss", 1)},
    "adc_offset": {"offset": ("offset", 0.0061)},
    "magnet_weakening": {"loss": ("fraction", 1)},
    "roller_ratio": {"error": ("scale", 1e6)},
    "encoder_thermal_drift": {"drift": ("drift", 1)},
    "encoder_eccentricity": {
        "amplitude": ("amplitude", 1),
        "phase": ("phase", 1),
        "second": ("amplitude_2", 1),
    },
    "clock_jitter": {"deviation": ("sigma", 1)},
    "channel_delay": {"delay": ("delay", 1)},
    "sample_loss": {"packet_loss": ("fraction", 1)},
    "wind_torque": {"deviation": ("sigma", 1)},
    "command_disturbance": {"amplitude": ("amplitude", 1 / 3000), "frequency": ("frequency", 1)},
}

#: effect -> (sign, shift). The residual A cos(x + phase) is the torque the motors must add, the effect's is
#: minus that, written as a sine of x + phase, a cosine of x - phase (imbalance), a factor's cosine (ripple)
PHASES: dict[str, tuple[float, float]] = {
    **dict.fromkeys(("gear_eccentricity", "gear_mesh", "bearing_pass", "motor_cogging"), (1.0, -np.pi / 2)),
    "gravity_imbalance": (-1.0, np.pi),
    "torque_ripple": (1.0, np.pi),
}


def write_plant(
    out: Path,
    axis: str,
    preload: str,
    calibrated: dict[str, Parameter],
    effects: list[Finding],
    base: Path | None,
    name: str,
    keep: bool = False,
) -> list[str]:
    """Write `out` and return remarks on what could not be put into it.

    The base is `base`, or the project's plant file of that preload without its declared effects on this axis
    unless `keep` says that they were part of the declared model.
    """
    from plant.model import ModelError, default_files, dump, load, numbers, with_effects, with_value
    from plant.units import to_si

    remarks: list[str] = []
    files = default_files()
    model = load(base if base is not None else files.get(f"{preload}_preload", next(iter(files.values()))))
    for key, path in PATHS.items():
        if key not in calibrated:
            continue
        full = f"axes.{axis}.{path}"
        old = numbers(model)[full]
        try:
            model = with_value(model, full, calibrated[key].value / to_si(1.0, old.unit), f"fitted to {name}")
        except ModelError as error:
            remarks.append(f"{key}: {error}")
    if "inertia" in calibrated:
        part = getattr(model.axes, axis)
        rotors = 2 * part.motor.rotor_inertia.si * 129952.06  # both rotors at the axis, ratio squared
        full = f"axes.{axis}.inertia"
        old = numbers(model)[full]
        load_inertia = max(calibrated["inertia"].value - rotors, 10.0)
        model = with_value(
            model, full, load_inertia / to_si(1.0, old.unit), f"fitted to {name}, less the rotors"
        )
    declared = list(getattr(model.axes, axis).effects) if base is not None or keep else []
    made = []
    for f in effects:
        effect, remark = effect_model(f, name)
        if effect is None:
            remarks.append(remark)
        else:
            made.append(effect)
    try:
        model = with_effects(model, axis, [*declared, *made])
        dump(model, out)
        load(out)
    except (ModelError, ValueError) as error:
        remarks.append(f"effects left out of the plant: {error}")
        dump(with_effects(model, axis, declared), out)
    return remarks


def effect_model(f: Finding, name: str) -> tuple[Any | None, str]:
    """A finding as an effect of the plant file, its numbers inside the effect's bounds; or None and why."""
    from plant.effects import REGISTRY
    from plant.parts import EffectModel, Number

    if f.name not in REGISTRY or f.name not in MAPS:
        return None, f"{f.name}: described in the report, not a number of the plant file"
    spec = REGISTRY[f.name]
    parameters: dict[str, Number] = {}
    for target, (source, factor) in MAPS[f.name].items():
        if source in f.parameters:
            p = spec.parameter(target)
            raw = f.parameters[source].value * factor
            if target == "phase" and f.channel == "T" and f.name in PHASES:
                sign, shift = PHASES[f.name]
                raw = float(np.angle(np.exp(1j * (sign * raw + shift))))
            value = float(np.clip(raw, p.low, p.high))
            parameters[target] = Number(value, p.unit, f"fitted to {name}")
    if "cycles" in [p.name for p in spec.parameters] and f.harmonic:
        parameters["cycles"] = Number(float(f.harmonic), "1", f"found in {name}")
    if f.name in ("bearing_pass",) and f.order:
        parameters["order"] = Number(float(f.order), "1", f"found in {name}")
    stage = f.stage if spec.stages else None
    return EffectModel(f.name, stage=stage, harmonic=f.harmonic or 1, parameters=parameters), ""
