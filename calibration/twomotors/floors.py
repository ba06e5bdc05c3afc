"""What an axis log's sensors leave in every channel."""

from __future__ import annotations

from calibration.channels import noise
from calibration.channels.torque import Transmission
from calibration.twomotors.result import AxisResult


def sensor_floors(result: AxisResult, drive: Transmission) -> dict[str, float]:
    """Per channel, what the sensors' noise and quanta leave (channels/noise.py)."""
    frame, m = result.frame, result.motion
    n = noise.column_noise(frame)
    inertia = result.calibrated["inertia"].value if "inertia" in result.calibrated else 0.0
    resistance = result.electrical.resistance if result.electrical is not None else 0.0
    rows = result.held[m.pick] & m.trusted[m.pick]
    found = {
        "T": noise.torque_floor(n, drive, inertia, m.period_s),
        "E": noise.electrical_floor(n, resistance, frame.scale["supply_V"], frame.scale["counter_torque"]),
        "K": noise.encoder_floor(n, frame, m, rows, drive),
        "S": noise.roller_floor(n),
    }
    return {key: value for key, value in found.items() if value is not None}
