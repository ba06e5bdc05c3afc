"""The scene of one drive without a file: every row is fitted as it is, behind no filter."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from calibration.balances.filters import Filter
from calibration.balances.problem import Problem
from calibration.balances.view import View
from calibration.inputs.declaration import Column, Response, Rig, Stage
from calibration.names.scene import Scene

PERIOD_S = 0.01
NOISE = 1e-9  # position units: what moves is far above it


def drive(
    x: np.ndarray,
    *,
    response: Response | None = None,
    unit: str = "m",
    declared: Mapping[str, float] | None = None,
    files: np.ndarray | None = None,
    y: np.ndarray | None = None,
    base: np.ndarray | None = None,
    held: np.ndarray | None = None,
    residual: np.ndarray | None = None,
    columns: Mapping[str, np.ndarray] | None = None,
    rig: Mapping[str, Any] | None = None,
    **more: Any,
) -> Scene:
    """Of a position (n,) in `unit`, which turns where its sign of motion does; `more`: `View`'s fields.

    `files` (n,): labels, each begins at its own time 0. The response is a force in N unless given.
    """
    n, response = len(x), response or Response("force", "N")
    file = np.zeros(n, dtype=np.int64) if files is None else files
    first = np.searchsorted(file, file)
    t = PERIOD_S * (np.arange(n) - first)
    y = np.zeros(n) if y is None else y
    base = np.zeros((n, 1)) if base is None else base
    given = {"stages": tuple[Stage, ...](), **(rig or {})}
    speed = np.gradient(x, PERIOD_S)
    way = np.sign(speed)
    turns = np.concatenate([[True], (np.diff(way) != 0) | (np.diff(file) != 0)])
    last = np.maximum.accumulate(np.where(turns, np.arange(n), 0))
    fields: dict[str, Any] = {
        "rig": Rig("made", Path("made.yaml"), {"position": Column(unit)}, (response,), **given),
        "response": response,
        "period_s": PERIOD_S,
        "filter": Filter(0.0),
        "t": t,
        "clock": PERIOD_S * np.arange(n),
        "file": file,
        "segment": file,
        "run": file,
        "columns": {"position": x, **(columns or {})},
        "ok": np.ones(n, dtype=bool),
        "rows": np.arange(n),
        "dynamic": response.is_force,
        "turn": None,
        "speed": speed,
        "direction": way,
        "since": x - x[last],
        **more,
    }
    view = View(**fields)
    view.__dict__["noise"] = NOISE
    problem = Problem(
        channel="T" if response.is_force else "K",
        unit=response.unit,
        y=y,
        base=base,
        base_labels=[(f"term_{k}", response.unit) for k in range(base.shape[1])],
        t=t,
        run=file,
        session=file,
        valid=np.ones(n, dtype=bool),
        held=np.zeros(n, dtype=bool) if held is None else held,
        period_s=PERIOD_S,
    )
    left = np.zeros(n) if residual is None else residual
    return Scene(view, problem, dict(declared or {}), left, np.zeros((n, 0)))


def back_and_forth(strokes: int = 4, rows: int = 500, travel: float = 1.0) -> np.ndarray:
    """Straight strokes over `travel`, one way and the other, `rows` each."""
    one = travel * np.arange(rows) / rows
    return np.concatenate([one if k % 2 == 0 else travel - one for k in range(strokes)])
