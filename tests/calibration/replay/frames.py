"""Frames of an axis whose every column is given: 10 ms, one session, SI."""

from pathlib import Path
from typing import Any

import numpy as np

from calibration.balances.frame import COLUMNS, Frame
from calibration.inputs.rigfile import telescope
from calibration.inputs.run import Run

PERIOD_S = 0.01
ARCSEC = np.pi / 648_000
SCALE = {
    "sample_period_s": PERIOD_S, "velocity_window_s": 0.005, "position_arcsec_per_count": 0.0024,
    "velocity_arcsec_per_count": 0.0115, "adc_A_per_count": 0.0061, "effort_full_scale": 3000.0,
    "adc_end_A": 6.0, "supply_V": 24.0, "counter_torque": 0.1,
}  # fmt: skip


def frame(*rows: int, missing: tuple[int, ...] = (), **columns: Any) -> Frame:
    """Runs of so many rows one after the other, at rest but for the columns; `missing` rows are no log's."""
    n = sum(rows)
    t = PERIOD_S * np.arange(float(n))
    starts = np.concatenate([[0], np.cumsum(rows)])
    headers = [
        Run(
            f"run{k + 1}",
            Path("a.log"),
            "a",
            {},
            header={"axis": "ra"},
            scales=dict(SCALE),
            start_s=float(t[a]),
        )
        for k, a in enumerate(starts[:-1])
    ]
    given: dict[str, Any] = {name: np.zeros(n) for name in COLUMNS} | columns
    clock = np.zeros(n)
    clock[list(missing)] = np.nan
    for x in given.values():
        x[list(missing)] = np.nan
    return Frame(
        runs=headers, period_s=PERIOD_S, t=t, clock=clock, run=np.repeat(np.arange(len(rows)), rows),
        session=np.zeros(n, dtype=np.int64), columns=given, scale=dict(SCALE), rig=telescope("ra"),
    )  # fmt: skip
