"""The report's plots as embedded PNG: residual over its domain, spectrum over order or Hz, held-out trace."""

import base64
import io
from typing import Any

import numpy as np

from calibration.arrays import Array
from calibration.decide.selection import Selection
from calibration.finding import UNKNOWN
from calibration.look.looked import Spectrum
from calibration.statistics.orders import order_spectrum

BINS = 80  # bins over a domain. ASSUMPTION
BINS_OF_A_PULSE = 8  # bins over the width of a narrow pulse. ASSUMPTION: its shape shows
FEWEST_DRAWN = 20  # rows, fewest, over a domain. ASSUMPTION
FEWEST_OF_A_TRACE = 3  # rows, fewest, of a trace: a line with a bend. ASSUMPTION
# times the highest order drawn, to which a spectrum is taken: its bins then flatten a line by 2 %. arithmetic
FINER = 4.0
MOST_MARKED = 12  # places of gaps that are marked in a trace; more would hide it. ASSUMPTION
BLUE, RED, GREY, GREEN = "#1f5fa8", "#c0392b", "#8a8f98", "#2e8b57"

GATE = "The largest score of all candidates, in this log and in copies of its residual that hold nothing"


def figure(width: float = 9.0, height: float = 3.4, rows: int = 1, **more: Any) -> tuple[Any, Any]:
    """A figure and its axes without the interactive back end."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.rcParams.update({"font.size": 9, "axes.titlesize": 10, "axes.titleweight": "bold"})
    plt.rcParams.update({"axes.spines.top": False, "axes.spines.right": False})
    plt.rcParams["axes.formatter.limits"] = (-6, 6)  # beyond, a power of ten stands where the legend is
    return plt.subplots(rows, figsize=(width, height), constrained_layout=True, **more)


def drawn(fig: Any) -> bytes:
    """The figure as a PNG; closes it."""
    import matplotlib.pyplot as plt

    buffer = io.BytesIO()
    fig.savefig(buffer, format="png", dpi=110)
    plt.close(fig)
    return buffer.getvalue()


def png(fig: Any) -> str:
    """The figure as a data URI; closes it."""
    return "data:image/png;base64," + base64.b64encode(drawn(fig)).decode()


def finish(ax: Any, title: str) -> str:
    """The axes' figure with the title above, the legend between it and the axes: it never hides a curve."""
    handles, _ = ax.get_legend_handles_labels()
    ax.set_title(title, loc="left", pad=20 if handles else 6)
    if handles:
        ax.legend(frameon=False, fontsize=8, loc="lower left", bbox_to_anchor=(-0.01, 0.98), ncols=3)
    return png(ax.figure)


def nothing_to_draw(title: str, why: str) -> str:
    """An empty figure that says why it is empty."""
    _, ax = figure(9.0, 1.2)
    ax.axis("off")
    ax.text(0.0, 0.5, why, color=GREY)
    return finish(ax, title)


def domain_plot(selection: Selection, x: Array, label: str, title: str, index: int, odd: Array | None) -> str:
    """Residual without effect `index` over the domain that explains it, binned means with errors, and the
    effect. `odd` is the direction of motion for an effect that changes sign with it: both are multiplied."""
    p = selection.problem
    rows = p.train
    if rows.sum() < FEWEST_DRAWN:
        return nothing_to_draw(title, "too few fitted rows to draw")
    sense = 1.0 if odd is None else odd
    model = selection.effect(index) * sense
    e = selection.after.residual * sense + model
    if selection.candidates[index].name == UNKNOWN:
        level = float(np.mean(model[rows]))  # the declared offset moves against the function's own level
        e, model = e - level, model - level
    _, ax = figure()
    step = max(int(rows.sum() / 6000), 1)
    xs, es, ms = x[rows], e[rows], model[rows]
    ax.plot(xs[::step], es[::step], ".", ms=1.5, color=GREY, alpha=0.4)
    ax.plot([], [], ".", ms=6, color=GREY, label="residual without the effect")
    width = selection.candidates[index].fixed.get("width")  # of a narrow pulse: BINS_OF_A_PULSE lie on it
    bins = max(BINS, round(BINS_OF_A_PULSE / width[0])) if width else BINS
    cells = np.array_split(np.argsort(xs), min(max(len(xs) // 20, 8), bins))
    mid, mean = ([f(z[c]) for c in cells] for f, z in ((np.median, xs), (np.mean, es)))
    error = [np.std(es[c]) / np.sqrt(max(len(c) / 10, 1)) for c in cells]
    ax.errorbar(mid, mean, error, fmt="o", ms=3, color=BLUE, lw=1, label="mean of a bin, standard error")
    ax.plot(mid, [np.mean(ms[c]) for c in cells], color=RED, lw=1.8, label="effect as fitted")
    low, high = np.quantile(es, [0.002, 0.998])
    ax.set_ylim(low - 0.2 * (high - low), high + 0.2 * (high - low))
    times = " × direction" if odd is not None else ""
    ax.set(xlabel=label, ylabel=f"residual{times}, {p.unit}")
    return finish(ax, title)


def spectrum_plot(selection: Selection, spectrum: Spectrum, title: str) -> str:
    """Amplitude over order, or over the period, before and after, with the known parts and what was found."""
    amplitude = _over_periods if spectrum.periods else _over_orders
    fits = selection.before, selection.after
    before, after = (amplitude(selection, spectrum, fit.residual) for fit in fits)
    if not len(before[0]):
        return nothing_to_draw(title, "too few fitted rows for a spectrum")
    _, ax = figure(9.0, 3.8)
    for (x, y), color, name in ((before, GREY, "before"), (after, BLUE, "after")):
        ax.plot(x, y, color=color, lw=0.9, label=name)
    low, high = float(before[0].min()), float(before[0].max())
    ax.set_xscale("log")
    plain_ticks(ax)
    known = {n: 1 / rate if spectrum.periods else rate for n, rate in spectrum.stages.items()}
    found = [c.candidate for c in selection.chosen if c.candidate.kind == "line"]
    marks = [order for c in found if (order := c.at_order)]
    if spectrum.periods:
        marks = [1 / (h * f) for c in found if (f := c.at_frequency) for h in range(1, 9)]
    _mark(ax, {n: x for n, x in known.items() if low <= x <= high}, [x for x in marks if low <= x <= high])
    ax.set(xlabel=spectrum.label, ylabel=f"amplitude, {selection.problem.unit}")
    return finish(ax, title)


def _over_orders(selection: Selection, spectrum: Spectrum, e: Array) -> tuple[Array, Array]:
    """Orders and amplitudes of the fitted rows, the largest of each cell of a logarithmic axis."""
    rows = selection.problem.train
    turns, fitted = spectrum.turns[rows], int(rows.sum())
    if fitted < FEWEST_DRAWN:
        return np.zeros(0), np.zeros(0)
    found = [c.at_order or 0.0 for c in selection.candidates if c.kind == "line"]
    top = max([*spectrum.stages.values(), *found], default=0.0) * 1.3 or 100.0
    top = min(top, 0.5 * fitted / (float(np.ptp(turns)) or 1.0))
    orders, power = order_spectrum(e[rows], turns, np.ones(fitted), FINER * top)
    orders, power = orders[orders <= top], power[orders <= top]
    if len(orders) == 0:
        return orders, power
    amplitude = 2 * np.sqrt(power * np.mean(e[rows] ** 2) / fitted)
    edges = np.unique(np.geomspace(max(orders[0], 1e-9), orders[-1], 1500))
    cells = np.split(np.arange(len(orders)), np.searchsorted(orders, edges[1:]))
    best = np.array([cell[np.argmax(amplitude[cell])] for cell in cells if len(cell)])
    return orders[best], amplitude[best]


def _over_periods(selection: Selection, spectrum: Spectrum, e: Array) -> tuple[Array, Array]:
    """Seconds per turn and amplitudes of the fitted rows, mean of the sections."""
    p, rows = selection.problem, selection.problem.train
    spans = [np.flatnonzero(rows & (p.run == k)) for k in np.unique(p.run[rows])]
    longest = max((float(np.ptp(spectrum.turns[at])) for at in spans), default=0.0)
    if longest < 10 * p.period_s:
        return np.zeros(0), np.zeros(0)
    periods = np.geomspace(4 * p.period_s, longest, 600)
    power = np.zeros(len(periods))
    for at in spans:
        wave = np.exp(-2j * np.pi * np.outer(1 / periods, spectrum.turns[at]))
        power += np.abs(wave @ e[at] * 2 / len(at)) ** 2 * len(at) / rows.sum()
    return periods, np.sqrt(power)


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


def trace_plot(selection: Selection, declared: Selection, title: str) -> str:
    """Held-out residual before, which is the declared model's, and after over time. Gaps between held-out
    spans are closed and marked. A line whose phase is every run's own has that run's, as in the table."""
    p = selection.problem
    rows = p.test if p.test.any() else p.valid
    if rows.sum() < FEWEST_OF_A_TRACE:
        return nothing_to_draw(title, "no held-out rows in this channel")
    first = declared if np.array_equal(declared.problem.test, p.test) else selection
    models = ((first.bare, first.problem), (selection.model, p))
    before, after = (m.left_out(q) if p.test.any() else m.residual(q, rows) for m, q in models)
    t, run = p.t[rows], p.run[rows]
    gap = (np.diff(t) > 5 * p.period_s) | (np.diff(t) < 0) | (np.diff(run) != 0)
    step = np.where(gap, 0.0, np.diff(t))
    places = np.flatnonzero(gap)
    space = min(0.02, 0.1 / max(len(places), 1)) * float(step.sum())
    at = np.concatenate([[0.0], np.cumsum(np.where(gap, space, step))])
    _, ax = figure()
    for e, color, name in ((before, GREY, "before"), (after, BLUE, "after")):
        label = f"{name}, rms {np.sqrt(np.mean(e**2)):.3g} {p.unit}"
        broken = (np.insert(x, places + 1, np.nan) for x in (at, e))  # a line ends at a gap
        ax.plot(*broken, color=color, lw=0.8, label=label)
    for place in places if len(places) <= MOST_MARKED else ():
        ax.axvline((at[place] + at[place + 1]) / 2, color=GREY, lw=0.7, ls=":")
    closed = " (rows left out are not drawn to scale)" if gap.any() else ""
    spans = f"time in the held-out span{'s' if gap.any() else ''}, s{closed}"
    ax.set(xlabel=spans, ylabel=f"residual, {p.unit}")
    return finish(ax, title)


def gate_plot(selection: Selection, title: str) -> str:
    """Surrogate maxima, threshold, and where the log's own maximum fell."""
    _, ax = figure(9.0, 2.4)
    s = selection.scores
    largest, top = float(np.max(s.surrogate_max, initial=0.0)), selection.statistic
    limit = max(2.5 * s.threshold, 1.2 * largest)
    beyond = " (off scale)" if top > limit else ""
    label = f"{len(s.surrogate_max)} surrogates of the residual"
    # a log of one block has one score, but for rounding: bins between given ends
    ax.hist(s.surrogate_max, bins=30, range=(0.0, max(largest, s.threshold) or 1.0), color=GREY, label=label)
    ax.axvline(s.threshold, color=GREEN, lw=1.5, label=f"99 % threshold, {s.threshold:.2f}")
    ax.axvline(min(top, limit), color=RED, lw=2, label=f"this log, {top:.4g}{beyond}")
    ax.set_xlim(0, max(limit * 1.02, 1.0))
    ax.set(xlabel="largest score, -log10 p", ylabel="surrogates")
    return finish(ax, title)
