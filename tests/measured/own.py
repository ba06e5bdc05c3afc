"""A least squares of one's own: the physically right terms, fitted and tested on the finder's rows."""

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import numpy as np

from calibration.arrays import Array
from calibration.balances.balance import problem_of
from calibration.balances.guide import guide_problem, usable
from calibration.balances.problem import Problem
from calibration.balances.view import View, view_of
from calibration.inputs.counters import align_counters
from calibration.inputs.logs import read_drive
from calibration.inputs.rigfile import load_rig

Terms = Callable[[View], list[Array]]
"""Columns (n,) at full rate beside the declared terms."""


def held_out_rms(logs: list[Path], rig: Path | None, terms: Terms, hold_out: list[str]) -> float:
    """Of the first response, with `terms` beside the declared ones, in its unit."""
    assert rig is not None
    declared = load_rig(rig)
    records = read_drive(logs, declared).records
    align_counters(records, declared)
    view = view_of(records, declared, declared.responses[0])
    p = problem_of(view, records, hold_out)
    x = np.column_stack([p.base, *[view.at(c) for c in terms(view)]])
    return _rms(_left(p.y, x, part) for part in (p.turns if p.turned is not None else [p]))


def guide_rms(logs: list[Path], rig: Path | None, periods_s: Sequence[float], harmonics: int) -> float:
    """The same of a guide log, with a wave of every period and its harmonics in every section."""
    declared = load_rig(rig) if rig else None
    runs, _ = usable(read_drive(logs, declared).runs, [])
    p, _ = guide_problem(runs, [], max(periods_s), min(periods_s))
    waves = [
        np.where(p.run == k, f(2 * np.pi * h * p.t / period), 0.0)
        for k in np.unique(p.run)
        for period in periods_s
        for h in range(1, harmonics + 1)
        for f in (np.cos, np.sin)
    ]
    both = np.column_stack([p.y, *waves])[p.valid]  # beside the finder's drift of all frames
    both -= p.base[p.valid] @ np.linalg.lstsq(p.base[p.valid], both, rcond=1e-9)[0]
    y, x, piece = both[:, 0], both[:, 1:], p.session[p.valid]
    pieces = (piece == k for k in np.unique(piece))
    return _rms(y[m] - x[m] @ np.linalg.lstsq(x[~m], y[~m], rcond=1e-9)[0] for m in pieces)


def _left(y: Array, x: Array, p: Problem) -> Array:
    """What is left on held-out rows, where the nuisances `fresh` are fitted anew."""
    size = np.maximum(np.linalg.norm(x[p.train], axis=0), 1e-300)
    beta = np.linalg.lstsq(x[p.train] / size, y[p.train], rcond=1e-9)[0] / size
    e = (y - x @ np.where(np.linalg.norm(x[p.train], axis=0) > 0, beta, 0.0))[p.test]
    if p.fresh is not None:
        f = p.fresh[p.test]
        e = e - f @ np.linalg.lstsq(f, e, rcond=1e-9)[0]
    return np.asarray(e)


def _rms(parts: Iterable[Array]) -> float:
    return float(np.sqrt(np.mean(np.concatenate(list(parts)) ** 2)))


def orders(*which: float) -> Terms:
    """Waves of so many cycles per position unit."""
    return lambda v: [f(2 * np.pi * k * v.x) for k in which for f in (np.cos, np.sin)]


def weight(v: View) -> list[Array]:
    """Gravity, and friction of teeth that carry it."""
    angle = 2 * np.pi * v.x / (v.turn or 1.0)
    return [np.cos(angle), np.sin(angle), np.cos(angle) * v.direction, np.sin(angle) * v.direction]


def bends(v: View) -> list[Array]:
    """Friction that falls near rest and bends with the speed."""
    part = v.speed / max(v.top, 1e-300)
    return [v.direction * np.exp(-np.abs(part) / k) for k in (0.03, 0.1, 0.3)] + [part * np.abs(part)]


def sides(v: View) -> list[Array]:
    """Friction of one direction."""
    return [(v.direction > 0).astype(float), np.where(v.direction > 0, v.speed, 0.0)]


def bristles(v: View) -> list[Array]:
    """Loops of several widths after a reversal."""
    reach = float(np.ptp(v.x))
    return [v.direction * np.exp(-v.since / (k * reach)) for k in (0.02, 0.05, 0.1, 0.2, 0.4)]


def places(v: View) -> list[Array]:
    """Slow waves along the stroke, as they are and turning with the motion, and the load on the slide."""
    z = 2 * np.pi * (v.x - v.x.min()) / float(np.ptp(v.x))
    waves = [f(k * z / 2) for k in range(1, 7) for f in (np.cos, np.sin)]
    return [*waves, *(w * v.direction for w in waves)]


def friction_waves(v: View) -> list[Array]:
    """Friction over the angle of a motor, to its twelfth order."""
    return [f(2 * np.pi * k * v.x) * v.direction for k in range(1, 13) for f in (np.cos, np.sin)]


def late_by(delay_s: float) -> Terms:
    """The position of some time ago, in the place of the one at the row."""
    return lambda v: [v.delayed(v.x, -delay_s), v.rate(v.delayed(v.x, -delay_s))]


def gap(v: View) -> list[Array]:
    """Which side the flanks are on."""
    return [v.direction]


def both(*terms: Terms) -> Terms:
    """All of them."""
    return lambda v: [c for t in terms for c in t(v)]
