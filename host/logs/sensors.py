"""One line of readings for the sensor log and the status window, in units people read (H2, H5)."""

import math

from bus.protocol import unpack_tach
from host.auxiliary import combine
from host.client import Client
from host.rates import CURRENT_A_PER_COUNT, rate_arcsec_s
from host.sky.mount import STEP_ARCSEC, AxisScale, Mount
from host.telescope.state import AXES, axis_state


def readings(client: Client, mount: Mount) -> str:
    """Everything the last frames say; what has never been received is left out."""
    words: list[str] = []
    for name, (board, _, *motors) in AXES.items():
        scale: AxisScale = getattr(mount, name)
        axis = axis_state(client, name)
        if axis.steps is not None:
            words.append(f"{name}_deg={math.degrees(scale.angle_rad(axis.steps)):.6f}")
        motion = client.motion(board)
        if motion is not None:
            words.append(
                f"{name}_rate={rate_arcsec_s(motion.velocity):.2f} {name}_effort={motion.effort}"
                f" {name}_current_a={motion.adc_a * CURRENT_A_PER_COUNT:.3f}"
                f" {name}_current_b={motion.adc_b * CURRENT_A_PER_COUNT:.3f}"
            )
        if axis.auxiliary is not None:  # H5: its difference; both combined, arcsec
            found = combine(axis.steps, *axis.auxiliary)
            steps = round((found.estimate_arcsec or 0.0) / STEP_ARCSEC)
            words += [
                f"{name}_aux_difference={found.difference_arcsec:.3f}",
                f"{name}_combined_deg={math.degrees(scale.angle_rad(steps)):.6f}",
                f"{name}_combined_sigma={found.sigma_arcsec:.3f}",
            ]
        for letter, motor in zip("ab", motors, strict=True):
            data = client.link.measurements.get(motor)
            if data is not None:
                words.append(f"{name}_tach_{letter}={unpack_tach(data).delta}")
    focus = client.focus()
    if focus is not None:
        words.append(f"focus={focus.position} focus_encoder={focus.encoder} focus_lvdt={focus.lvdt}")
    return " ".join(words)
