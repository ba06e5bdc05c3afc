"""One line of readings for the sensor log and the status window, in units people read (H2, H5)."""

import math
from typing import Final

from bus.protocol import AGE_UNIT_NS, Device, Motion, Position, unpack_tach
from host.auxiliary import BOARDS, auxiliary, combine
from host.client import Client
from host.rates import CURRENT_A_PER_COUNT, rate_arcsec_s
from host.sky.mount import STEP_ARCSEC, AxisScale, Mount

_AXES: Final = (
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
        words += _auxiliary(client, name, position, motion, scale)
        for letter, motor in zip("ab", motors, strict=True):
            data = client.link.measurements.get(motor)
            if data is not None:
                words.append(f"{name}_tach_{letter}={unpack_tach(data).delta}")
    focus = client.focus()
    if focus is not None:
        words.append(f"focus={focus.position} focus_encoder={focus.encoder} focus_lvdt={focus.lvdt}")
    return " ".join(words)


def _auxiliary(
    client: Client, name: str, position: Position | None, motion: Motion | None, scale: AxisScale
) -> list[str]:
    """The auxiliary encoder's difference and the combined position with its standard deviation, ″ (H5)."""
    if position is None or BOARDS[name] not in client.link.measurements:
        return []
    board = _AXES[0 if name == "ra" else 1][2]
    latched_s = (client.link.measured_ns[board] - position.age * AGE_UNIT_NS) * 1e-9
    rate = rate_arcsec_s(motion.velocity) if motion else 0.0
    other = auxiliary(client.link, name, position.position, latched_s, rate)
    if other is None:
        return []
    found = combine(position.position, *other)
    steps = round((found.estimate_arcsec or 0.0) / STEP_ARCSEC)
    return [
        f"{name}_aux_difference={found.difference_arcsec:.3f}",
        f"{name}_combined_deg={math.degrees(scale.angle_rad(steps)):.6f}",
        f"{name}_combined_sigma={found.sigma_arcsec:.3f}",
    ]
