"""The figure of an autoguide step: what the guide camera saw, and the pulses."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from scenarios.run.outcome import Outcome
from scenarios.run.report.style import COLOURS, axes, new_figure, title

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def guiding(outcome: Outcome) -> Figure | None:
    """Of every such step, star less its place in the first exposure, and what the pulses did."""
    records = [each for each in outcome.records if each.guided]
    if not records:
        return None
    figure = new_figure(2.9 * len(records))
    for number, record in enumerate(records, 1):
        t = np.array([each.t_s for each in record.guided]) - (record.start_s or 0.0)
        off, sent = (np.array([getattr(each, name) for each in record.guided]) for name in ("off", "sent"))
        view = axes(figure, len(records), 1, number, ylabel="arcsec on the sky", xlabel="time in step, s")
        for axis, name in enumerate(("ra", "dec")):
            rms = float(np.sqrt(np.mean(off[:, axis] ** 2)))
            label = f"{name.upper()}, rms {rms:.2f}″"
            view.plot(t, off[:, axis], color=COLOURS[name], lw=0.9, label=label)
            view.vlines(t, 0.0, sent[:, axis], color=COLOURS[name], alpha=0.35, lw=1.5)
        view.legend(ncols=2, loc="upper right")
        title(view, f"{record.step.name}: star less its first place; bars: pulses")
    return figure
