"""Where a gap stands before it has been crossed: nobody knows, so nothing is judged there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from calibration.channels.view import View, pieces
from calibration.decide.select import Selection
from calibration.response.prune import beside
from calibration.statistics.regression import gls
from calibration.statistics.whitening import Mask

TRAVEL = "closing_travel"  # of a play between two sensors: how far one moves until the other follows
STRAY = 1e-3  # of a row's filter that may lie where the gap's place is not known. ASSUMPTION


def crossed(view: View, travel: float) -> Mask:
    """(n,) at full rate: rows of a file that has moved by `travel` before."""
    out = np.zeros(len(view.x), dtype=bool)
    for a, b in pieces(view.file):
        x = view.x[a:b]
        out[a:b] = np.maximum.accumulate(x) - np.minimum.accumulate(x) >= travel
    return out


def where_known(s: Selection, view: View) -> Selection:
    """The selection without the first rows of a file, as long as a gap that was found has not been crossed in
    it; as it is where no gap was found, or too few rows would be left."""
    gaps = [abs(x.candidate.fixed[TRAVEL][0]) for x in s.chosen if TRAVEL in x.candidate.fixed]
    if not gaps:
        return s
    unknown = view.at((~crossed(view, max(gaps))).astype(float)) > STRAY
    p = replace(s.problem, valid=s.problem.valid & ~unknown)
    if not unknown.any() or p.train.sum() < s.problem.train.sum() / 2 or not p.test.any():
        return s
    before = gls(p.y, p.base, p.train, p.ar_order, p.block)
    bare = replace(s, problem=p, before=before, chosen=[], classes=[], steps=[])
    return beside(bare, s)
