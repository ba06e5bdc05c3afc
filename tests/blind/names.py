"""Where the true value of a reported parameter is: names differ between sealer and finder, quantities do not."""

from typing import Any

GEAR_RATIO = 360.48864

# reported name of a calibrated figure -> how to read it from the truth's drive (several readings are allowed)
_DRIVE = {
    "coulomb": "TC", "breakaway": "TS", "viscous": "SIG2", "stribeck_velocity": "VS", "sigma_0": "SIG0",
    "sigma_1": "SIG1", "sigma_2": "SIG2", "torque_constant": "KA", "resistance": "RA", "stiffness": "KGEAR",
}  # fmt: skip


def calibrated_truths(truth: dict[str, Any]) -> dict[str, list[float]]:
    """True values of calibrated figures by name; inertia with and without the two rotors at the axis."""
    drive = truth["drive"]
    out = {name: [float(drive[slot])] for name, slot in _DRIVE.items()}
    rotors = 2.0 * drive["JM"] * GEAR_RATIO**2
    out["inertia"] = [float(drive["J"]), float(drive["J"] + rotors)]
    return out


def parameter_truths(effect: dict[str, Any], truth: dict[str, Any]) -> dict[str, list[float]]:
    """True values of one effect's parameters by name, in the unit of the truth file."""
    return {name: [float(item["value"])] for name, item in effect["parameters"].items()}
