"""Which rows are held out: nothing is ever fitted there."""

from __future__ import annotations

import numpy as np

from calibration.channels.frame import Frame, fill
from calibration.statistics.whitening import Mask


def choose_held_out(frame: Frame, names: list[str]) -> tuple[Mask, list[str]]:
    """Held-out rows: the runs named, else one whole run whose speeds the others cover, else the end of a
    single run."""
    n = len(frame.runs)
    if names:
        chosen = [k for k, r in enumerate(frame.runs) if {r.name, r.path.name, str(r.path)} & set(names)]
        return np.isin(frame.run, chosen), [frame.runs[k].name for k in chosen]
    if n >= 3:
        reach = []
        for k in range(n):
            w = np.abs(np.gradient(fill(frame.columns["position"], frame.run)[0]))[frame.run == k]
            reach.append(float(np.quantile(w, 0.9)))
        order = sorted(range(n), key=lambda k: reach[k])
        closed = [k for k in order[1:-1] if frame.runs[k].header.get("loop") == "closed"] or order[1:-1]
        sessions = [r.session for r in frame.runs]
        shared = [k for k in closed if sessions.count(sessions[k]) > 1] or closed
        pick = max(shared)
        return frame.run == pick, [frame.runs[pick].name]
    held = np.zeros(len(frame.t), dtype=bool)
    names_out = []
    for k, r in enumerate(frame.runs):
        rows = np.flatnonzero(frame.run == k)
        cut = rows[int(0.7 * len(rows))]
        held[cut : rows[-1] + 1] = True
        names_out.append(f"{r.name} from {frame.t[cut] - frame.t[rows[0]]:.0f} s")
    return held, names_out
