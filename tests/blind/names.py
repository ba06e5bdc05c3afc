"""Where the true value of a reported parameter is: names differ between sealer and finder, quantities do not.

Every entry maps a name of the report to values of the truth file; several values are readings that all count
(an angle and the same angle a turn earlier; inertia with and without the rotors). A name that is not here is
not scored: it has no truth.
"""

import math
from collections.abc import Callable
from typing import Any

from tests.blind.sealer.declared import ADC_A_PER_COUNT

Truth = dict[str, Any]
ARCSEC = math.pi / 648000.0
GEAR_RATIO = (113 / 27) * (123 / 21) * (250 / 17)

_DRIVE = {
    "coulomb": "TC",
    "breakaway": "TS",
    "stiction": "TS",
    "viscous": "SIG2",
    "stribeck_velocity": "VS",
    "sigma_0": "SIG0",
    "sigma_1": "SIG1",
    "sigma_2": "SIG2",
    "torque_constant": "KA",
    "resistance": "RA",
    "stiffness": "KGEAR",
}


def calibrated_truths(truth: Truth) -> dict[str, list[float]]:
    """True values of calibrated figures by name."""
    drive = truth["drive"]
    out = {name: [float(drive[slot])] for name, slot in _DRIVE.items()}
    rotors = 2.0 * drive["JM"] * GEAR_RATIO**2
    out["inertia"] = [float(drive["J"]), float(drive["J"] + rotors)]
    return out


Read = Callable[[dict[str, float], Truth], list[float]]


def raw(key: str, factor: float = 1.0, size: bool = False) -> Read:
    """A raw sealer value times a factor; its absolute value when `size`."""

    def read(values: dict[str, float], _truth: Truth) -> list[float]:
        if key not in values:
            return []
        value = values[key] * factor
        return [abs(value)] if size else [value]

    return read


def either(*keys: str, plus: float = 0.0, factor: float = 1.0) -> Read:
    """Whichever of the keys the case has."""
    return lambda values, _truth: [values[key] * factor + plus for key in keys if key in values]


def relative(slot: str) -> Read:
    """Value over its declared value."""
    return lambda _values, truth: [truth["drive"][slot] / truth["declared"][slot]]


def angle(key: str) -> Read:
    """An angle, and the same a turn earlier or later."""
    return lambda values, _truth: (
        [values[key] + turn * 2.0 * math.pi for turn in (-1, 0, 1)] if key in values else []
    )


def counter_phase(key: str) -> Read:
    """A cos(theta - p) on the axis is A cos(theta + pi - p) for the motors to do, a turn more or less."""
    return lambda values, _truth: (
        [math.pi - values[key] + turn * 2.0 * math.pi for turn in (-1, 0, 1)] if key in values else []
    )


def relative_gain(values: dict[str, float], _truth: Truth) -> list[float]:
    """One motor's reading too large, or the other's as much too small: with R and K free both say the
    same."""
    return [
        x
        for key in ("ADC_GAIN_A", "ADC_GAIN_B")
        if key in values
        for x in (values[key], -values[key] / (1.0 + values[key]))
    ]


def compliance(_values: dict[str, float], truth: Truth) -> list[float]:
    """arcsec per N m: of one train, of both, and what is beyond the declared."""
    real, said = 1.0 / truth["drive"]["KGEAR"], 1.0 / truth["declared"]["KGEAR"]
    return [x / ARCSEC for x in (real, real / 2.0, real - said, (real - said) / 2.0)]


EFFECTS: dict[str, dict[str, Read]] = {
    "stribeck_change": {"stiction_factor": relative("TS"), "velocity_factor": relative("VS")},
    "presliding": {"stiffness_factor": relative("SIG0")},
    "viscous_change": {"factor": relative("SIG2")},
    "coulomb_change": {"factor": relative("TC")},
    "friction_asymmetry": {"coulomb_asymmetry": raw("ASYM_C"), "viscous_asymmetry": raw("ASYM_V")},
    "position_friction": {"amplitude": raw("POSF_A", size=True)},
    "load_friction": {"coefficient": raw("LOADF")},
    "friction_warmup": {"depth": raw("WARM_A", -1.0), "time_constant": raw("WARM_TAU")},
    "preload_change": {"change": raw("PRELOAD_A"), "start": raw("PRELOAD_T0")},
    "gravity_imbalance": {"amplitude": raw("GRAV_A", size=True), "phase": counter_phase("GRAV_PH")},
    "gear_eccentricity": {
        "amplitude": raw("L1_T", size=True),
        "kinematic": raw("L1_K", 1 / ARCSEC, size=True),
    },
    "gear_mesh": {"amplitude": raw("L1_T", size=True)},
    "damaged_tooth": {"amplitude": raw("TOOTH_T")},
    "motor_cogging": {"cycles": raw("COG_N"), "amplitude": raw("COG_A", size=True)},
    "torque_ripple": {"cycles": raw("RIP_N"), "ripple": raw("RIP_A", size=True)},
    "play": {"gap": raw("PLAY")},
    "backlash_loss": {"loss": raw("COUNTER_LOSS")},
    "shaft_compliance": {"compliance": compliance},
    "structural_mode": {"frequency": raw("W2", 0.5 / math.pi), "damping": raw("Z2"), "inertia": raw("J2")},
    "encoder_eccentricity": {"amplitude": raw("ECC_1", size=True), "second": raw("ECC_2", size=True)},
    "encoder_subdivision": {"amplitude": raw("SUB_1", size=True), "second": raw("SUB_2", size=True)},
    "roller_slip": {"creep": raw("SLIP_C"), "threshold": raw("SLIP_A0")},
    "roller_ratio": {"error": raw("ROLLER_EPS", 1e6)},
    "adc_offset": {"offset": either("ADC_OFF_A", "ADC_OFF_B", factor=ADC_A_PER_COUNT)},
    "adc_gain": {"gain": relative_gain},
    "pwm_deadband": {"deadband": raw("DEADBAND")},
    "diode_braking": {"share": raw("DIODE")},
    "supply_sag": {"resistance": raw("SAG")},
    "winding_heating": {"thermal_resistance": raw("HEAT"), "time_constant": raw("HEAT_TAU")},
    "magnet_weakening": {"loss": raw("MAG_A"), "start": raw("MAG_T0")},
    "wind_torque": {"deviation": raw("WIND")},
    "cable_wrap": {"stiffness": raw("CABLE_K"), "hysteresis": raw("CABLE_H")},
    "brake_drag": {"torque": raw("BRAKE_T"), "start": raw("BRAKE_T0")},
    "bearing_pass": {"order": raw("L1_ORDER"), "amplitude": raw("L1_T", size=True)},
    "encoder_thermal_drift": {"drift": raw("DRIFT")},
    "channel_delay": {"delay": either("DELAY_POS", "DELAY_TACH", "DELAY_ADC", "DELAY_VEL")},
    "clock_jitter": {"deviation": raw("JITTER")},
    "command_disturbance": {"amplitude": raw("UPSET", 1 / 3000, size=True), "frequency": raw("UPSET_F")},
}


#: names of the truth file that are another parameter's in a report
OTHERWISE = {"roller_slip": ("slip",)}


def parameter_truths(effect: dict[str, Any], truth: Truth) -> dict[str, list[float]]:
    """True values of one effect's parameters by the report's name; also under the truth file's own names."""
    out = {name: [float(item["value"])] for name, item in effect["parameters"].items()}
    for name in OTHERWISE.get(effect["name"], ()):
        out.pop(name, None)
    raws = effect.get("raw", {})
    for name, read in EFFECTS.get(effect["name"], {}).items():
        values = read(raws, truth)
        if values:
            out[name] = values
    return out
