"""Where a gap stands before it has been crossed: nobody knows, so nothing is judged there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from calibration.channels.problem import Problem
from calibration.channels.view import View, pieces
from calibration.decide.judge import design
from calibration.decide.select import Selection
from calibration.names import NAMES
from calibration.names.scene import Scene
from calibration.response.delay import Found
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


def known(p: Problem, view: View, gap: float) -> Problem:
    """The problem without the rows before a file has crossed `gap`; the same where there are none, or too few
    others are left."""
    unknown = view.at((~crossed(view, gap)).astype(float)) > STRAY
    left = replace(p, valid=p.valid & ~unknown)
    enough = left.train.sum() >= p.train.sum() / 2 and left.test.any()
    return left if unknown.any() and enough else p


def where_known(s: Selection, view: View) -> Selection:
    """The selection without the first rows of a file, as long as a gap that was found has not been crossed in
    it; as it is where no gap was found, or too few rows would be left."""
    gaps = _gaps(s)
    if not gaps:
        return s
    p = known(s.problem, view, max(gaps))
    return s if p is s.problem else _on(p, s)


def crossed_first(found: Found, view: View, search: Callable[[Problem], Found]) -> Found:
    """What is found without the rows before the likeliest gap is crossed, where no gap was found on all rows
    and one is then, that leaves less on the same rows."""
    s, scene, _ = found
    if scene.force or _gaps(s):
        return found
    gap = _likeliest(s.problem, scene)
    p = known(s.problem, view, gap) if gap else s.problem
    if p is s.problem:
        return found
    again = search(p)
    return again if _gaps(again[0]) and again[0].held.after < _on(p, s).held.after else found


def _likeliest(p: Problem, scene: Scene) -> float:
    """The gap, of those that are tried, that leaves least on the rows which lie beyond all of them; 0 where
    none can be."""
    gaps = [c for c in NAMES["play"].columns(scene) if TRAVEL in c.fixed]
    if not gaps:
        return 0.0
    beyond = known(p, scene.view, max(c.fixed[TRAVEL][0] for c in gaps))

    def left(k: int) -> float:
        x = design(beyond, [gaps[k]])
        return float(np.mean(gls(p.y, x, beyond.train, p.ar_order, p.block).residual[beyond.train] ** 2))

    return gaps[min(range(len(gaps)), key=left)].fixed[TRAVEL][0]


def _gaps(s: Selection) -> list[float]:
    """Gaps between two sensors that are chosen, position units."""
    return [abs(x.candidate.fixed[TRAVEL][0]) for x in s.chosen if TRAVEL in x.candidate.fixed]


def _on(p: Problem, s: Selection) -> Selection:
    """The selection's effects fitted and judged on the rows of `p`."""
    before = gls(p.y, p.base, p.train, p.ar_order, p.block)
    bare = replace(s, problem=p, before=before, chosen=[], classes=[], steps=[])
    return beside(bare, s)
