"""One finding into a plant file's terms: effects, changed numbers, remarks on what cannot be said there."""

from __future__ import annotations

from collections.abc import Callable

from calibration.corrected import lines, recorded, scalars
from calibration.corrected.making import Facts, Made
from calibration.corrected.unnamed import unnamed
from calibration.finding import Finding
from calibration.names import NAMES

Converter = Callable[[Finding, Facts], Made]
CONVERTERS: dict[str, Converter] = {
    **dict.fromkeys(scalars.PLAIN, scalars.plain),
    **dict.fromkeys(recorded.CALIBRATED, recorded.change),
    "gear_eccentricity": lines.gear,
    "gear_mesh": lines.gear,
    "gravity_imbalance": lines.imbalance,
    "bearing_pass": lines.bearing,
    "motor_cogging": lines.motor,
    "torque_ripple": lines.motor,
    "position_friction": lines.friction,
    "encoder_eccentricity": lines.encoder,
    "encoder_subdivision": lines.subdivision,
    "damaged_tooth": lines.tooth,
    "friction_warmup": scalars.warmup,
    "preload_change": scalars.preload,
    "brake_drag": scalars.brake,
    "cable_wrap": scalars.cable,
    "structural_mode": scalars.mode,
    "wind_torque": scalars.wind,
    "adc_offset": scalars.offset,
    "adc_gain": scalars.gain,
    "magnet_weakening": scalars.magnets,
    "winding_heating": scalars.heating,
    "encoder_thermal_drift": scalars.drift,
    "roller_slip": scalars.slip,
    "play": scalars.play,
    "command_disturbance": scalars.disturbance,
    "channel_delay": recorded.late,
    "sample_loss": recorded.lost,
    "log_wrap": recorded.wrap,
    "unknown": unnamed,
}


def convert(f: Finding, facts: Facts) -> Made:
    """What `f` becomes in the plant file."""
    if f.name in NAMES and NAMES[f.name].own is not None:  # its parameters are the plant's
        made = Made()
        made.add(f.name, facts, {name: p.value for name, p in f.parameters.items()})
        return made
    if f.name not in CONVERTERS:
        return Made(remarks=[f"{f.name}: described in the report, not a number of the plant file"])
    return CONVERTERS[f.name](f, facts)
