"""The report's plots as embedded PNG: residual over its domain, spectrum over order or Hz, held-out trace."""

from __future__ import annotations

import base64
import io
from typing import Any

import numpy as np

from plant.calibration.candidates.orders import order_spectrum
from plant.calibration.decide.select import Selection
from plant.calibration.readers.run import Array

BLUE, RED, GREY, GREEN = "#1f5fa8", "#c0392b", "#8a8f98", "#2e8b57"


def figure(width: float = 9.0, height: float = 3.4) -> tuple[Any, Any]:
    """A figure and its axes without the interactive back end."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.rcParams.update(
        {
            "font.size": 9,
            "axes.spines.top": False,
            "axes.spines.right": False,
            "axes.titlesize": 10,
            "axes.titleweight": "bold",
        }
    )
    return plt.subplots(figsize=(width, height), constrained_layout=True)


def png(fig: Any) -> str:
    """The figure as a data URI; closes it."""
    import matplotlib.pyplot as plt

    buffer = io.BytesIO()
    fig.savefig(buffer, format="png", dpi=110)
    plt.close(fig)
    return "data:image/png;base64," + base64.b64encode(buffer.getvalue()).decode()


def domain_plot(selection: Selection, x: Array, label: str, title: str, index: int = 0) -> str:
    """Residual without effect `index` over the domain that explains it, binned means with errors, and the
    effect."""
    p = selection.problem
    rows = p.train
    at = p.base.shape[1] + sum(c.candidate.width for c in selection.chosen[:index])
    columns = selection.chosen[index].candidate.columns if selection.chosen else np.zeros((len(p.y), 0))
    model = (
        columns @ selection.after.beta[at : at + columns.shape[1]] if selection.chosen else np.zeros(len(p.y))
    )
    e = selection.after.residual + model
    fig, ax = figure()
    step = max(int(rows.sum() / 6000), 1)
    xs, es, ms = x[rows], e[rows], model[rows]
    ax.plot(xs[::step], es[::step], ".", ms=1.5, color=GREY, alpha=0.4, label="residual")
    order = np.argsort(xs)
    cells = np.array_split(order, 80)
    mid = np.array([np.median(xs[c]) for c in cells])
    mean = np.array([np.mean(es[c]) for c in cells])
    error = np.array([np.std(es[c]) / np.sqrt(max(len(c) / 10, 1)) for c in cells])
    ax.errorbar(mid, mean, error, fmt="o", ms=3, color=BLUE, lw=1, label="mean of the bin")
    if selection.chosen:
        ax.plot(mid, [np.mean(ms[c]) for c in cells], color=RED, lw=1.8, label="effect as fitted")
    low, high = np.quantile(es, [0.002, 0.998]) if len(es) else (-1, 1)
    ax.set_ylim(low - 0.2 * (high - low), high + 0.2 * (high - low))
    ax.set(xlabel=label, ylabel=f"residual, {p.unit}", title=title)
    ax.legend(frameon=False, loc="best", fontsize=8)
    return png(fig)


def order_plot(
    selection: Selection, turns: Array, stages: dict[str, float], title: str, unit: str = "cycles per turn"
) -> str:
    """Amplitude over order, before and after, with the gear table drawn in."""
    p = selection.problem
    rows = p.train
    top = max(list(stages.values()), default=0.0) * 1.3 or 100.0
    span = float(np.ptp(turns)) or 1.0
    top = min(top, 0.5 * rows.sum() / span)
    fig, ax = figure(9.0, 3.8)
    for e, color, name in (
        (selection.before.residual, GREY, "before"),
        (selection.after.residual, BLUE, "after"),
    ):
        orders, power = order_spectrum(np.where(rows, e, 0.0), turns, rows.astype(float), top)
        if len(orders) == 0:
            continue
        amplitude = 2 * np.sqrt(power * np.mean(e[rows] ** 2) * rows.sum()) / max(rows.sum(), 1)
        edges = np.unique(np.geomspace(max(orders[0], 1e-9), orders[-1], 1500))
        cell = np.digitize(orders, edges)
        best = np.array(
            [amplitude[cell == k].max() if np.any(cell == k) else np.nan for k in np.unique(cell)]
        )
        place = np.array([orders[cell == k][np.argmax(amplitude[cell == k])] for k in np.unique(cell)])
        ax.plot(place, best, color=color, lw=0.9, label=name)
    ax.set_xscale("log")
    y1 = ax.get_ylim()[1]
    for name, order in stages.items():
        if 1.0 / span <= order <= top:
            ax.axvline(order, color=RED, lw=0.7, ls=":")
            ax.text(order, y1, f" {name}", rotation=90, va="top", ha="right", fontsize=7, color=RED)
    ax.set(xlabel=unit, ylabel=f"amplitude, {p.unit}", title=title)
    ax.legend(frameon=False, fontsize=8)
    return png(fig)


def trace_plot(selection: Selection, title: str) -> str:
    """Held-out residual before and after over time."""
    p = selection.problem
    rows = p.test if p.test.any() else p.valid
    n = p.base.shape[1]
    from plant.calibration.decide.heldout import predict_residual

    x = np.hstack([p.base, *[c.candidate.columns for c in selection.chosen]])
    before = predict_residual(p, p.base, selection.before.beta, rows)
    after = predict_residual(p, x, selection.after.beta, rows)
    del n
    t = p.t[rows]
    fig, ax = figure()
    step = max(len(t) // 5000, 1)
    ax.plot((t - t[0])[::step], before[::step], color=GREY, lw=0.8, label=f"before, rms {np.std(before):.3g}")
    ax.plot((t - t[0])[::step], after[::step], color=BLUE, lw=0.8, label=f"after, rms {np.std(after):.3g}")
    ax.set(xlabel="time in the held-out span, s", ylabel=f"residual, {p.unit}", title=title)
    ax.legend(frameon=False, fontsize=8)
    return png(fig)


def gate_plot(selection: Selection, title: str) -> str:
    """Surrogate maxima, threshold, and where the log's own maximum fell."""
    fig, ax = figure(9.0, 2.4)
    s = selection.scores
    ax.hist(s.surrogate_max, bins=30, color=GREY, label=f"largest score of {len(s.surrogate_max)} surrogates")
    ax.axvline(s.threshold, color=GREEN, lw=1.5, label=f"99 % threshold, {s.threshold:.2f}")
    top = selection.statistic
    limit = max(2.5 * s.threshold, float(s.surrogate_max.max()) * 1.2 if len(s.surrogate_max) else 1.0)
    ax.axvline(
        min(top, limit),
        color=RED,
        lw=2,
        label=f"this log, {top:.4g}" + (" (off scale)" if top > limit else ""),
    )
    ax.set_xlim(0, limit * 1.02)
    ax.set(xlabel="-log10 p of the best candidate", title=title)
    ax.legend(frameon=False, fontsize=8)
    return png(fig)
