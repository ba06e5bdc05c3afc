"""One line of readings for the sensor log and the status window, in units people read (H2, H5)."""

from __future__ import annotations

import math

from bus.protocol import Device, unpack_tach
from host.client import Client
from host.rates import CURRENT_A_PER_COUNT, rate_arcsec_s
from host.sky.mount import AxisScale, Mount

_AXES = (
    ("ra", Device.AXIS_RA, Device.POSITION_RA, (Device.MOTOR_RA_A, Device.MOTOR_RA_B)),
    ("dec", Device.AXIS_DEC, Device.POSITION_DEC, (Device.MOTOR_DEC_A, Device.MOTOR_DEC_B)),
)


def readings(client: Client, mount: Mount) -> str:
    """Everything the last frames say; what has never been received is left out."""
    words: list[str] = []
    for name, axis, encoder, motors in _AXES:
        scale: AxisScale = getattr(mount, name)
        position = client.position(encoder)
        if position is not None:
            words.append(f"{name}_deg={math.degrees(scale.angle_rad(position.position)):.6f}")
        motion = client.motion(axis)
        if motion is not None:
            words.append(
                f"{name}_rate={rate_arcsec_s(motion.velocity):.2f} {name}_effort={motion.effort}"
                f" {name}_current_a={motion.adc_a * CURRENT_A_PER_COUNT:.3f}"
                f" {name}_current_b={motion.adc_b * CURRENT_A_PER_COUNT:.3f}"
            )
        for letter, motor in zip("ab", motors, strict=True):
            data = client.link.measurements.get(motor)
            if data is not None:
                words.append(f"{name}_tach_{letter}={unpack_tach(data).delta}")
    focus = client.focus()
    if focus is not None:
        words.append(f"focus={focus.position} focus_encoder={focus.encoder} focus_lvdt={focus.lvdt}")
    return " ".join(words)
