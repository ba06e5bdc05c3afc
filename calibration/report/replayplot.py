"""The closed loop run again: measured, declared and corrected on the held-out run."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from calibration.replay.compare import residual
from calibration.replay.held import Replay
from calibration.report.plots import BLUE, GREY, RED, figure, png
from calibration.report.thresholds import WHOLE, WINDOW_S


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
    top.plot(t[part], before[part], color=RED, lw=0.8, label="declared model, closed loop run again")
    top.plot(t[part], after[part], color=BLUE, lw=0.8, label="corrected plant, closed loop run again")
    top.set(xlabel="time in the run, s", ylabel=f"motor {channel}, {unit}", title=f"Held-out run {again.run}")
    top.margins(y=0.25)
    top.legend(frameon=False, fontsize=8, loc="upper center", ncol=3)
    for trace, color, name in ((again.before, RED, "declared"), (again.after, BLUE, "corrected")):
        e = residual("velocity", again.log, trace, use)
        said = f"rms {np.sqrt(np.mean(e**2)):.3g}" if len(e) else "no row usable"
        low.plot(t[use][: len(e)], e, ".", ms=1.2, color=color, label=f"{name}, {said}")
    low.set(xlabel="time in the run, s", ylabel="velocity error, arcsec/s")
    low.legend(frameon=False, fontsize=8, markerscale=6)
    return {
        "image": png(fig),
        "alt": f"Closed loop run again on {again.run}: measured, declared and corrected",
    }
