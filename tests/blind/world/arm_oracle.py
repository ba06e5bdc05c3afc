"""What an arm's log can tell: least squares with the true columns, and with those of the log alone."""

import numpy as np
from scipy.ndimage import gaussian_filter1d

from tests.blind.world import arm_kernel as kernel
from tests.blind.world import oracle
from tests.blind.world.arm import Arm
from tests.blind.world.made import Array, Rng

Runs = list[tuple[Array, Array]]
WIDTHS = (1.0, 2.0, 4.0, 8.0, 16.0)  # rows, of the smoothing
MOVES = 0.02  # of the typical speed: slower rows may stand


def columns_of(a: Arm, runs: Runs, weight: bool) -> tuple[Array, Array, Array]:
    """Rows that move (all files), the declared terms' columns, and the effort's torque."""
    rows = np.concatenate([r for r, _ in runs])
    loads = np.concatenate([np.full(len(r), a.loads[k] if a.loads else 1.0) for k, (r, _) in enumerate(runs)])
    beyond = np.concatenate([angle for _, angle in runs])
    way = np.sign(rows[:, kernel.V]) * (np.abs(rows[:, kernel.V]) > MOVES * a.speed)
    keep = np.abs(np.convolve(way, np.ones(3), "same")) == 3.0  # nor do its neighbours stand or turn
    rows, loads, beyond = rows[keep], loads[keep], beyond[keep]
    v, x = rows[:, kernel.V], rows[:, kernel.X]
    base = [rows[:, kernel.A], v, np.sign(v), np.ones(len(v))]
    if weight:
        base += [loads * np.sin(x), loads * np.cos(x), np.sin(x + beyond), np.cos(x + beyond)]
    if a.values["STIC"] > a.values["COUL"]:
        base.append(np.sign(v) * np.exp(-((v / a.values["VS"]) ** 2)))
    return rows, np.column_stack(base), a.values["GAIN"] * rows[:, kernel.EFFORT]


def logged(a: Arm, rows: Array, rng: Rng) -> Array:
    """The effort as its column has it: a current or a torque is measured, a duty is what was sent."""
    effort, step = rows[:, kernel.EFFORT], a.values["EFFORT_STEP"]
    if a.sensor_noise:
        effort = np.round((effort + a.sensor_noise * rng.standard_normal(len(rows))) / step) * step
    return np.asarray(effort)


def seen(a: Arm, runs: Runs, weight: bool, number: int) -> list[float]:
    """What the declared terms leave of the logged effort, N m, with rates from the logged counts; for each of
    several widths of smoothing. No column of the truth is used."""
    out = []
    for width in WIDTHS:
        parts = []
        for k, (rows, angle) in enumerate(runs):
            effort = logged(a, rows, np.random.default_rng([number, 6, k]))
            at = np.floor(rows[:, kernel.X] / a.values["STEP"]) * a.values["STEP"]
            x, u, beyond = (gaussian_filter1d(y, width, mode="nearest") for y in (at, effort, angle))
            v = np.gradient(x, a.period_s)
            load = a.loads[k] if a.loads else 1.0
            base = [np.gradient(v, a.period_s), v, np.sign(v), np.ones(len(v))]
            if weight:
                base += [load * np.sin(x), load * np.cos(x), np.sin(x + beyond), np.cos(x + beyond)]
            way = np.sign(v) * (np.abs(v) > 2 * MOVES * a.speed)
            span = 2 * int(np.ceil(2 * width)) + 1
            keep = np.abs(np.convolve(way, np.ones(span), "same")) == span
            parts.append(np.column_stack([*base, a.values["GAIN"] * u])[keep])
        rows_ = np.concatenate(parts)
        enough = len(rows_) > 20 * rows_.shape[1]
        out.append(oracle.rms(oracle.left(rows_[:, -1], rows_[:, :-1])) if enough else np.nan)
    return out


def confounded(name: str, rows: Array, base: Array, torque: Array) -> tuple[str, ...]:
    """Names over the same domain that these moves cannot tell from the true one."""
    x, v = rows[:, kernel.X], rows[:, kernel.V]
    turn = np.column_stack([np.sin(x), np.cos(x)])
    columns = {
        "gravity_imbalance": turn, "cable_wrap": x[:, None], "position_friction": np.sign(v)[:, None] * turn,
        "load_friction": (np.sign(v) * np.abs(torque))[:, None],
    }  # fmt: skip
    if name not in ("gravity_imbalance", "cable_wrap"):
        return ()
    return oracle.rivals(torque, base, columns[name], {k: c for k, c in columns.items() if k != name})
