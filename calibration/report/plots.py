"""The report's plots as embedded PNG: residual over its domain, spectrum over order or Hz, held-out trace."""

from __future__ import annotations

import base64
import io
from typing import Any

import numpy as np

from calibration.candidates.orders import order_spectrum
from calibration.decide.heldout import predict_residual
from calibration.decide.judge import design, phases
from calibration.decide.select import Selection
from calibration.readers.run import Array
from calibration.statistics.whitening import Mask

BLUE, RED, GREY, GREEN = "#1f5fa8", "#c0392b", "#8a8f98", "#2e8b57"
BINS, BINS_OF_A_PULSE = 80, 8


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
            "axes.formatter.limits": (-6, 6),  # beyond, a power of ten stands where the legend is
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


def finish(ax: Any, title: str) -> None:
    """Title above, the legend between it and the axes: it never hides a curve."""
    handles, _ = ax.get_legend_handles_labels()
    ax.set_title(title, loc="left", pad=20 if handles else 6)
    if handles:
        ax.legend(frameon=False, fontsize=8, loc="lower left", bbox_to_anchor=(-0.01, 0.98), ncols=3)


def nothing_to_draw(title: str, why: str) -> str:
    """An empty figure that says why it is empty."""
    fig, ax = figure(9.0, 1.2)
    ax.axis("off")
    ax.text(0.0, 0.5, why, color=GREY)
    finish(ax, title)
    return png(fig)


def domain_plot(
    selection: Selection, x: Array, label: str, title: str, index: int = 0, odd: Array | None = None
) -> str:
    """Residual without effect `index` over the domain that explains it, binned means with errors, and the
    effect. `odd` is the direction of motion for an effect that changes sign with it: both are multiplied."""
    p = selection.problem
    rows = p.train
    if rows.sum() < 20:
        return nothing_to_draw(title, "too few fitted rows to draw")
    at = p.base.shape[1] + sum(c.candidate.width for c in selection.chosen[:index])
    columns = selection.chosen[index].candidate.columns if selection.chosen else np.zeros((len(p.y), 0))
    model = (
        columns @ selection.after.beta[at : at + columns.shape[1]] if selection.chosen else np.zeros(len(p.y))
    )
    e = selection.after.residual + model
    if odd is not None:
        e, model = e * odd, model * odd
    if selection.chosen and selection.chosen[index].candidate.name == "unknown":
        level = float(np.mean(model[rows]))  # the declared offset moves against the function's own level
        e, model = e - level, model - level
    fig, ax = figure()
    step = max(int(rows.sum() / 6000), 1)
    xs, es, ms = x[rows], e[rows], model[rows]
    ax.plot(xs[::step], es[::step], ".", ms=1.5, color=GREY, alpha=0.4)
    ax.plot([], [], ".", ms=6, color=GREY, label="residual without the effect")
    order = np.argsort(xs)
    cells = np.array_split(order, min(max(len(xs) // 20, 8), _bins(selection, index)))
    mid = np.array([np.median(xs[c]) for c in cells])
    mean = np.array([np.mean(es[c]) for c in cells])
    error = np.array([np.std(es[c]) / np.sqrt(max(len(c) / 10, 1)) for c in cells])
    ax.errorbar(mid, mean, error, fmt="o", ms=3, color=BLUE, lw=1, label="mean of a bin, standard error")
    if selection.chosen:
        ax.plot(mid, [np.mean(ms[c]) for c in cells], color=RED, lw=1.8, label="effect as fitted")
    low, high = np.quantile(es, [0.002, 0.998])
    ax.set_ylim(low - 0.2 * (high - low), high + 0.2 * (high - low))
    times = " × direction" if odd is not None else ""
    ax.set(xlabel=label, ylabel=f"residual{times}, {p.unit}")
    finish(ax, title)
    return png(fig)


def _bins(selection: Selection, index: int) -> int:
    """Bins over a domain: BINS, and for a narrow pulse as many as put BINS_OF_A_PULSE on its width."""
    fixed = selection.chosen[index].candidate.fixed if selection.chosen else {}
    return max(BINS, round(BINS_OF_A_PULSE / fixed["width"][0])) if "width" in fixed else BINS


def order_plot(
    selection: Selection, turns: Array, stages: dict[str, float], title: str, unit: str = "cycles per turn"
) -> str:
    """Amplitude over order, before and after, with the gear table and the orders that were found drawn in."""
    p = selection.problem
    rows = p.train
    found = [c.candidate.order for c in selection.chosen if c.candidate.kind == "line" and c.candidate.order]
    top = max([*stages.values(), *found], default=0.0) * 1.3 or 100.0
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
    plain_ticks(ax)
    _mark(ax, {n: o for n, o in stages.items() if 1.0 / span <= o <= top}, [o for o in found if o <= top])
    ax.set(xlabel=unit, ylabel=f"amplitude, {p.unit}")
    finish(ax, title)
    return png(fig)


def period_plot(selection: Selection, stages: dict[str, float], title: str) -> str:
    """Amplitude over period in s, mean of the sections, before and after, with the known periods drawn in."""
    p = selection.problem
    rows = p.train
    spans = {int(k): np.flatnonzero(rows & (p.run == k)) for k in np.unique(p.run[rows])}
    longest = max((float(np.ptp(p.t[at])) for at in spans.values()), default=0.0)
    if longest < 10 * p.period_s:
        return nothing_to_draw(title, "too few fitted frames for a spectrum")
    periods = np.geomspace(4 * p.period_s, longest, 600)
    fig, ax = figure(9.0, 3.8)
    for e, color, name in (
        (selection.before.residual, GREY, "before"),
        (selection.after.residual, BLUE, "after"),
    ):
        power = np.zeros(len(periods))
        for at in spans.values():
            wave = np.exp(-2j * np.pi * np.outer(1 / periods, p.t[at]))
            power += np.abs(wave @ e[at] * 2 / len(at)) ** 2 * len(at) / rows.sum()
        ax.plot(periods, np.sqrt(power), color=color, lw=1.0, label=name)
    ax.set_xscale("log")
    plain_ticks(ax)
    known = {n: 1 / r for n, r in stages.items() if 4 * p.period_s < 1 / r < longest}
    chosen = [c.candidate.frequency for c in selection.chosen if c.candidate.frequency]
    many = [1 / (h * f) for f in chosen for h in range(2, 9) if 1 / (h * f) > 4 * p.period_s]
    _mark(ax, known, many)
    ax.set(xlabel="period, s (dotted: known parts; short marks: harmonics of what was found)")
    ax.set(ylabel=f"amplitude, {p.unit}")
    finish(ax, title)
    return png(fig)


def plain_ticks(ax: Any) -> None:
    """1, 2, 5, 10 … in place of powers of ten: most spectra here span less than two decades."""
    from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

    ax.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    ax.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    ax.xaxis.set_minor_formatter(NullFormatter())


def _mark(ax: Any, lines: dict[str, float], ticks: list[float]) -> None:
    """Named places as dotted lines, further ones as short marks at the bottom."""
    y1 = ax.get_ylim()[1]
    ax.set_ylim(0.0, y1)
    for name, at in lines.items():
        ax.axvline(at, color=RED, lw=0.7, ls=":")
        ax.text(at, y1, f" {name}", rotation=90, va="top", ha="right", fontsize=7, color=RED)
    for at in ticks:
        ax.axvline(at, ymax=0.05, color=RED, lw=1.2)


def held_residuals(selection: Selection, rows: Mask) -> tuple[Array, Array]:
    """What the declared model and what the effects with it leave on `rows`; a line whose phase is every run's
    own has that run's, as in the error table."""
    p, chosen = selection.problem, [c.candidate for c in selection.chosen]
    before = predict_residual(p, p.base, selection.before.beta, rows)
    x = design(p, chosen)
    return before, predict_residual(p, x, selection.after.beta, rows, phases(p, chosen))


def trace_plot(selection: Selection, title: str) -> str:
    """Held-out residual before and after over time; gaps between held-out spans are closed and marked."""
    p = selection.problem
    rows = p.test if p.test.any() else p.valid
    if rows.sum() < 3:
        return nothing_to_draw(title, "no held-out rows in this channel")
    before, after = held_residuals(selection, rows)
    t, run = p.t[rows], p.run[rows]
    gap = (np.diff(t) > 5 * p.period_s) | (np.diff(t) < 0) | (np.diff(run) != 0)
    step = np.where(gap, 0.0, np.diff(t))
    space = min(0.02, 0.1 / max(gap.sum(), 1)) * float(step.sum())
    at = np.concatenate([[0.0], np.cumsum(np.where(gap, space, step))])
    fig, ax = figure()
    for e, color, name in ((before, GREY, "before"), (after, BLUE, "after")):
        label = f"{name}, rms {np.sqrt(np.mean(e**2)):.3g} {p.unit}"
        for k, part in enumerate(np.split(np.arange(len(t)), np.flatnonzero(gap) + 1)):
            thin = part[:: max(len(t) // 5000, 1)]
            ax.plot(at[thin], e[thin], color=color, lw=0.8, label=label if k == 0 else None)
    if gap.sum() <= 12:
        for place in np.flatnonzero(gap):
            ax.axvline((at[place] + at[place + 1]) / 2, color=GREY, lw=0.7, ls=":")
    closed = " (rows left out are not drawn to scale)" if gap.any() else ""
    ax.set(xlabel=f"time in the held-out span{'s' if gap.any() else ''}, s{closed}")
    ax.set(ylabel=f"residual, {p.unit}")
    finish(ax, title)
    return png(fig)


def gate_plot(selection: Selection, title: str) -> str:
    """Surrogate maxima, threshold, and where the log's own maximum fell."""
    fig, ax = figure(9.0, 2.4)
    s = selection.scores
    ax.hist(s.surrogate_max, bins=30, color=GREY, label=f"{len(s.surrogate_max)} surrogates of the residual")
    ax.axvline(s.threshold, color=GREEN, lw=1.5, label=f"99 % threshold, {s.threshold:.2f}")
    top = selection.statistic
    limit = max(2.5 * s.threshold, float(s.surrogate_max.max()) * 1.2 if len(s.surrogate_max) else 1.0)
    ax.axvline(
        min(top, limit),
        color=RED,
        lw=2,
        label=f"this log, {top:.4g}" + (" (off scale)" if top > limit else ""),
    )
    ax.set_xlim(0, max(limit * 1.02, 1.0))
    ax.set(xlabel="largest score, -log10 p", ylabel="surrogates")
    finish(ax, title)
    return png(fig)
