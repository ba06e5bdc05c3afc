"""Pictures of any drive's report: of every balance that shows something, and the closed loop run again."""

from dataclasses import replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from calibration.balances.candidate import pairs_by_section
from calibration.decide.accept import tied_at_last
from calibration.decide.selection import Selection
from calibration.look.looked import Balance, Looked
from calibration.names.position_friction import NAME as FRICTION
from calibration.replay.compare import residual
from calibration.replay.held import Replay
from calibration.report import plots
from calibration.report.plots import BLUE, GREY, RED, figure, png

MOST_PICTURES = 4  # pictures of effects in a balance. ASSUMPTION
WINDOW_S = 2.0  # s that a page can show of a trace at 10 ms. ASSUMPTION
WHOLE = 0.99  # share of a window's rows that must be usable. ASSUMPTION: single rows may be missing
Picture = dict[str, str]
TRACE = "Rows that nothing was fitted to: parameters, a law's gains among them, are those of the fitted rows"
SPECTRUM = "Fitted rows; dotted: known parts, short marks: what was found"


def pictures(found: Looked, again: Replay) -> list[Picture]:
    """Image and alternative text of each; of a drive in which nothing was accepted, the first balance's."""
    shown = [b for b in found.balances if b.selection.chosen] or list(found.balances[:1])
    out = [p for b in shown for p in of_balance(b)]
    return out if again.log is None else [*out, replay_picture(again)]


def of_balance(b: Balance) -> list[Picture]:
    """Its effects over their domains, the spectrum, the held-out residual, the gate."""
    s, name = b.selection, b.row or f"channel {b.key}"
    out = [_effect(b, k) for k in _worth_drawing(s)] if b.over is not None else []
    if b.spectrum is not None:
        over = "period" if b.spectrum.periods else "order"
        image = plots.spectrum_plot(s, b.spectrum, f"Amplitude over {over}, {name}")
        out.append({"image": image, "alt": SPECTRUM})
    trace = plots.trace_plot(s, b.declared or s, f"Held-out residual before and after, {name}")
    out.append({"image": trace, "alt": TRACE})
    if len(s.scores.surrogate_max):  # something was looked for
        out.append({"image": plots.gate_plot(s, f"Is anything there at all? {name}"), "alt": plots.GATE})
    return out


def _effect(b: Balance, k: int) -> Picture:
    """An effect over the domain that explains it, the other effects taken away. A line whose phase is every
    section's own is drawn for the first."""
    s, c = b.selection, b.selection.chosen[k].candidate
    alt = "Fitted rows, the declared model and the other effects removed"
    assert b.over is not None
    values, label = b.over(c)
    if c.kind == "line" and len(sections := pairs_by_section(c.columns)) > 1:
        first = np.any(c.columns[:, sections[0]] != 0, axis=1)
        s = replace(s, problem=replace(s.problem, valid=s.problem.valid & first))
        alt += "; of the first section: the phase of every further one is its own"
    alike = [e.candidate.name for e in tied_at_last(s, k) if e.candidate.name != c.name]
    more = f" (or {', '.join(dict.fromkeys(alike[:2]))})" if alike else ""
    odd = b.direction if c.name == FRICTION.name else None
    title = f"{c.say()}{more}, {b.row or f'channel {b.key}'}"
    return {"image": plots.domain_plot(s, values, label, title, k, odd), "alt": alt}


def _worth_drawing(s: Selection) -> list[int]:
    """One picture per name, the strongest first; an unnamed function is always drawn."""
    names = [x.candidate.name for x in s.chosen]
    first = [k for k, name in enumerate(names) if name not in names[:k]]
    more = [k for k in range(len(names)) if k not in first]
    return sorted([*first, *more[: max(MOST_PICTURES - len(first), 0)]])


def replay_picture(again: Replay) -> dict[str, str]:
    """Torque where the declared model is furthest off, and the velocity errors of all of the run."""
    assert again.log is not None and again.before is not None and again.after is not None
    t, use = again.time, again.use
    fig, (top, low) = figure(9.0, 5.6, rows=2)
    torque = np.isfinite(again.log.torque).any()
    channel, unit = ("torque", "N m") if torque else ("velocity", "arcsec/s")
    measured, before, after = (getattr(x, channel) for x in (again.log, again.before, again.after))
    off = np.where(use, np.nan_to_num(before - measured), 0.0)
    step = max(float(np.median(np.diff(t))), 1e-3)
    size = max(min(round(WINDOW_S / step), len(t)), 1)
    spread, whole = sliding_window_view(off, size).var(axis=1), sliding_window_view(use, size).mean(axis=1)
    first = int(np.argmax(np.where(whole > WHOLE, spread, 0.0)))
    part = slice(first, first + size)
    top.plot(t[part], measured[part], color=GREY, lw=2.6, alpha=0.7, label="measured")
    top.plot(t[part], before[part], color=RED, lw=0.8, label="declared model, closed loop replayed")
    top.plot(t[part], after[part], color=BLUE, lw=0.8, label="corrected plant, closed loop replayed")
    top.set(xlabel="time in the run, s", ylabel=f"motor {channel}, {unit}", title=f"Held-out run {again.run}")
    top.margins(y=0.25)
    top.legend(frameon=False, fontsize=8, loc="upper center", ncol=3)
    for trace, color, name in ((again.before, RED, "declared"), (again.after, BLUE, "corrected")):
        e = residual("velocity", again.log, trace, use)
        said = f"rms {np.sqrt(np.mean(e**2)):.3g}" if len(e) else "no row usable"
        low.plot(t[use][: len(e)], e, ".", ms=1.2, color=color, label=f"{name}, {said}")
    low.set(xlabel="time in the run, s", ylabel="velocity error, arcsec/s")
    low.legend(frameon=False, fontsize=8, markerscale=6)
    alt = f"Closed loop replayed on {again.run}: measured, declared and corrected"
    return {"image": png(fig), "alt": alt}
