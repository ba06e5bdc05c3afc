"""Where a gap stands before it has been crossed: nobody knows, so nothing is judged there."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from calibration.balances.candidate import Candidate
from calibration.balances.filters import by_piece
from calibration.balances.problem import Problem
from calibration.balances.thresholds import STRAY
from calibration.balances.view import View
from calibration.decide.selection import Selection
from calibration.look.delay import Found
from calibration.names.play import columns, travel_of
from calibration.names.scene import Scene


def known(p: Problem, view: View, gap: float) -> Problem:
    """Without the rows before a file has crossed `gap`; the same where none are, or too few others."""
    moved = by_piece(view.x, view.file, lambda x: np.maximum.accumulate(x) - np.minimum.accumulate(x))
    unknown = view.at((~(moved >= gap)).astype(float)) > STRAY
    left = replace(p, valid=p.valid & ~unknown)
    enough = left.train.sum() >= p.train.sum() / 2 and left.test.any()
    return left if unknown.any() and enough else p


def where_known(s: Selection, view: View) -> Selection:
    """Without a file's rows before the gaps that were found are crossed, as `known`; as it is without one."""
    gaps = _gaps(s)
    if not gaps:
        return s
    p = known(s.problem, view, max(gaps))
    return s if p is s.problem else s.on(p)


def crossed_first(found: Found, view: View, search: Callable[[Problem], Found]) -> Found:
    """What is found without the rows before the likeliest gap is crossed, or `found` as it is.

    No gap may have been found on all rows. The new search must find one, and leave less on the same rows.
    """
    s, scene, _ = found
    if scene.force or _gaps(s):
        return found
    gap = _likeliest(s.problem, scene)
    p = known(s.problem, view, gap) if gap else s.problem
    if p is s.problem:
        return found
    again = search(p)
    return again if _gaps(again[0]) and again[0].held.after < s.on(p).held.after else found


def _likeliest(p: Problem, scene: Scene) -> float:
    """The gap that leaves least on the rows beyond all that are tried; 0 where none can be."""
    gaps = [(travel, c) for c in columns(scene) if (travel := travel_of(c)) is not None]
    if not gaps:
        return 0.0
    beyond = known(p, scene.view, max(travel for travel, _ in gaps))

    def left(gap: tuple[float, Candidate]) -> float:
        fit = beyond.fit(beyond.design([gap[1]]))
        return float(np.mean(fit.residual[beyond.train] ** 2))

    return min(gaps, key=left)[0]


def _gaps(s: Selection) -> list[float]:
    """Gaps between two sensors that are chosen, position units."""
    return [travel for c in s.candidates if (travel := travel_of(c)) is not None]
