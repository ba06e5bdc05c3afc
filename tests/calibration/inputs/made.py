"""Runs and rigs without files: columns as they are given, a rig whose every unit is the file's."""

from pathlib import Path
from typing import Any

import numpy as np

from calibration.inputs.declaration import Column, Response, Rig
from calibration.inputs.run import Run

PERIOD_S = 0.01


def run(position: np.ndarray, t: np.ndarray | None = None, **columns: np.ndarray) -> Run:
    """A run of 10 ms whose columns are those given; `t` (n,) s, else even."""
    stamps = PERIOD_S * np.arange(len(position)) if t is None else t
    given: dict[str, Any] = {"t": stamps, "position": np.array(position, dtype=float), **columns}
    return Run("a", Path("a.csv"), "a", given, period_s=PERIOD_S)


def rig(*channels: str, **columns: Column) -> Rig:
    """Of the channels (without unit) and columns, with a response of the effort."""
    plain = {name: Column("", name) for name in channels}
    return Rig("bench", Path("rig.yaml"), plain | columns, (Response("effort", "V"),), ())


def uneven_motion(rows: int) -> np.ndarray:
    """Travel of every row (rows,): about 10, never a multiple of a step."""
    return 10.0 + 0.5 * np.sin(np.arange(rows) / 30.0)
