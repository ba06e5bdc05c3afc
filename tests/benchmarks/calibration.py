"""Calibration beside two peers on the same ten-minute log: time and held-out torque error of each.

Peers: PySINDy on the residual with a library of angle, rate and direction, and scipy least squares of the
whole parameter vector (inertia, LuGre, one sine of free order). Run `python -m tests.benchmarks.calibration`.
"""

from __future__ import annotations

import json
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from plant.calibration.axis import analyse
from plant.calibration.channels.friction import bristle
from plant.calibration.command import calibrate
from plant.calibration.readers.axis import read_axis_log
from plant.calibration.statistics.regression import gls, solve
from tests.calibration.logs import effect, write_logs

KINDS = ("steps", "sweep", "ramp") * 5  # 15 runs, 54 000 rows of 10 ms


def measure() -> dict[str, Any]:
    """Time in s and held-out rms torque error in N m of the tool and the peers."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        paths = write_logs(folder, [effect("gear_mesh", "mesh3", amplitude=(6.0, "N m"))], KINDS)
        begin = time.perf_counter()
        calibrate(paths, None, [], folder / "out")
        spent = time.perf_counter() - begin
        report = json.loads((folder / "out" / "report.json").read_text())
        result = analyse([read_axis_log(p) for p in paths], [])
    rows = sum(int(r.rows) for r in result.frame.runs)
    out: dict[str, Any] = {
        "rows": rows,
        "floor_Nm": report["error"]["torque"]["floor"],
        "before_Nm": report["error"]["torque"]["before"],
        "schmidt": {"seconds": spent, "held_out_Nm": report["error"]["torque"]["after"]},
    }
    out["pysindy"] = _sindy(result)
    out["least_squares"] = _least_squares(result)
    return out


def _sindy(result: Any) -> dict[str, float | str]:
    try:
        from pysindy.optimizers import STLSQ
    except ImportError:
        return {"skipped": "pysindy is not installed (pip install schmidt[bench])"}
    p, c = result.selections["T"].problem, result.torque.context
    begin = time.perf_counter()
    null = gls(p.y, p.base, p.train, p.ar_order, p.block)
    x = c.angle - c.angle.mean()
    w = c.speed / np.abs(c.speed).max()
    library = np.column_stack(
        [
            np.ones_like(x),
            x,
            x**2,
            x**3,
            w,
            w**2,
            w**3,
            np.sign(w),
            x * w,
            x * np.sign(w),
            *[f(k * x) for k in range(1, 11) for f in (np.sin, np.cos)],
        ]
    )
    model = STLSQ(threshold=0.05).fit(library[p.train], null.residual[p.train][:, None])
    left = null.residual[p.test] - library[p.test] @ np.asarray(model.coef_).ravel()
    return {"seconds": time.perf_counter() - begin, "held_out_Nm": float(np.sqrt(np.mean(left**2)))}


def _least_squares(result: Any) -> dict[str, float]:
    from scipy.optimize import least_squares

    t, m = result.torque, result.motion
    p = result.selections["T"].problem
    begin = time.perf_counter()

    def columns(q: np.ndarray) -> np.ndarray:
        shape = bristle(m.theta, m.fresh, m.period_s / m.width, *np.exp(q[:3]))
        x = t.context.angle * q[3] * 100
        return np.column_stack([p.base[:, :2], m.at(shape), np.cos(x), np.sin(x)])

    def left(q: np.ndarray) -> np.ndarray:
        x = columns(q)[p.train]
        return np.asarray(p.y[p.train] - x @ solve(x, p.y[p.train]))

    start = [*np.log([2.5, 0.0004, 26000.0]).tolist(), 1.0]
    q = least_squares(left, start, x_scale=[0.3, 0.3, 0.5, 0.05], diff_step=1e-3, max_nfev=60).x
    x = columns(q)
    beta = solve(x[p.train], p.y[p.train])
    e = p.y[p.test] - x[p.test] @ beta
    return {"seconds": time.perf_counter() - begin, "held_out_Nm": float(np.sqrt(np.mean(e**2)))}


if __name__ == "__main__":
    print(json.dumps(measure(), indent=1))
