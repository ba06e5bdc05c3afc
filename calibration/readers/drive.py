"""The declared scales of the telescope's axis logs.

Sources: paper.txt sections 3.2-3.4 (encoders, log period); log-format.md (scales of the columns). The drive
behind the logs is declared in calibration/rigs.
A log's header may override every scale by its key.
"""

from __future__ import annotations

import math

from plant.gears import RATIO

ARCSEC = math.pi / 648000.0  # rad per arcsec

#: header key -> (declared value, what it is)
SCALES: dict[str, tuple[float, str]] = {
    "sample_period_s": (0.010, "s between rows; log-format.md"),
    "velocity_window_s": (0.005, "s over which `velocity` counts; paper 3.3, 5 ms interrupt"),
    "tach_window_s": (0.010, "s over which `tach_a/b` count; log-format.md"),
    "position_arcsec_per_count": (1296000.0 / 2**29, "arcsec; 29-bit absolute encoder"),
    "velocity_arcsec_per_count": (
        1296000.0 / (4.608e6 * 735.0 / 30.0),
        "arcsec; roller 735:30, 4.608 M counts",
    ),
    "adc_A_per_count": (0.0061, "A; log-format.md"),
    "tach_counts_per_turn": (4096.0, "counts per motor turn; log-format.md"),
    "aux_arcsec_per_count": (1296000.0 / (2**17 * 10.8), "arcsec; 17 bit through 10.8:1"),
    "effort_full_scale": (3000.0, "effort counts at full supply; log-format.md"),
    "supply_V": (24.0, "V; paper 3.2"),
    "counter_torque": (0.10, "fraction of the effort on the other motor; paper 3.3 says 0.10 to 0.25"),
    "gear_ratio": (RATIO, "motor turns per axis turn; paper 3.2"),
}

#: header key of a declared number that Table 1 gives in a way that can be read twice, and what it is
TRAIN_STIFFNESS = "train_stiffness_Nm_per_rad"
DECLARABLE: dict[str, str] = {TRAIN_STIFFNESS: "N m/rad at the axis of one motor's gear train"}

#: counter lengths, in counts, of the columns that wrap
WRAPS: dict[str, int] = {"position": 2**29, "aux": 2**17}
