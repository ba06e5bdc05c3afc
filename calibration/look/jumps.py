"""Jumps of a position at constant rate: a mirror that tips over, a cable that slips. They never come back."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calibration.arrays import Array, by_median
from calibration.balances.problem import Problem
from calibration.decide.parameters import finding_of
from calibration.decide.scan import fit_with
from calibration.decide.selection import Selection
from calibration.finding import UNKNOWN, Finding
from calibration.names.name import candidate
from calibration.statistics.regression import solve

# cells before a jump and as many behind it, over which it is measured beside a slope: quiet air shows it over
# few, seeing over many. ASSUMPTION
SIDES = (6, 12, 24, 48, 96)
# robust standard errors of a jump that is tried; held-out rows decide. Jumps of 40 sound logs of the sky
# take 0.8 % of the held-out square at most, real ones 28 to 97 % (seeds 1969 to 1982)
CLEAR = 4.0
# of the held-out square, that jumps take together. ASSUMPTION, a quarter: gusts of two measured nights take
# 15 and 23 % as pairs of jumps
LEAST_SHARE = 0.25
# of a jump's size, that few rows show at least, their own error aside, and LASTS times as many. ASSUMPTION
SHARP = 0.5
# times the rows, over which a jump is still there: two outliers of heavy tails are not. ASSUMPTION
LASTS = 4
# rows on either side of a jump in which no second one is looked for. ASSUMPTION: as many as it must last
BETWEEN = LASTS * SIDES[0] // 2
MOST = 12  # of one log. More are no events but a way of moving. ASSUMPTION


def with_jumps(s: Selection, when: Callable[[int], str]) -> tuple[Selection, list[Finding]]:
    """The selection with its jumps as one more effect, where it has some, and the finding that it is.

    Held-out rows lie between fitted ones: a jump is not seen again. One that is not clear beside the others
    is left out. when: the time of a row, told.
    """
    return _beside(s, jumps_of(s, CLEAR), when)


def _beside(s: Selection, places: list[int], when: Callable[[int], str]) -> tuple[Selection, list[Finding]]:
    """`with_jumps` with jumps at some places, rows, of which those stay that are clear beside each other."""
    p, k = s.problem, len(s.chosen)
    if not places:
        return s, []
    steps, sizes = np.column_stack(_steps_at(p, places)), [("size", p.unit)] * len(places)
    one = fit_with(p, s.columns, candidate(UNKNOWN, steps, *sizes, domain="time"))
    if one is None:
        return s, []
    again = s.keep([*s.chosen, one])
    clear = np.abs(again.sizes(k)) > CLEAR * np.sqrt(np.diag(again.covariance(k)))
    if not clear.all():
        return _beside(s, [at for at, stays in zip(places, clear, strict=True) if stays], when)
    last = s.held.after if s.chosen else again.held.before
    share = 1 - (again.held.after / last) ** 2
    if not share > LEAST_SHARE:
        return s, []
    again = s.keep([*s.chosen, replace(one, held=replace(again.held, share=share))])
    told = (f"{size:.3g} {p.unit} at {when(at)}" for size, at in zip(again.sizes(k), places, strict=True))
    return again, [replace(finding_of(again, k), parameters={}, note=f"jumps: {', '.join(told)}")]


def _steps_at(p: Problem, places: list[int]) -> list[Array]:
    """A step (n,) of its run from each place, a row, on."""
    rows = np.arange(len(p.y))
    return [((rows >= at) & (p.run == p.run[at])).astype(float) for at in places]


def jumps_of(s: Selection, least: float) -> list[int]:
    """Rows where what is left jumps by `least` robust standard errors or more, found one by one; none, where
    there are more than MOST."""
    p, places = s.problem, list[int]()
    while len(places) <= MOST:
        x = np.column_stack([s.columns, *_steps_at(p, places)])
        rest = np.where(p.valid, p.y - x @ solve(x[p.valid], p.y[p.valid]), np.nan)
        for at in places:  # it jumped in one of them; a second one as near would be the way back
            rest[max(at - BETWEEN, 0) : at + BETWEEN] = np.nan
        steps = {side: _steps(rest, p.run, side) for side in SIDES}
        clear, at = max(_clearest(steps, side) for side in SIDES)
        if clear < least:
            return sorted(places)
        places.append(at)
    return []


def _clearest(steps: Mapping[int, Array], side: int) -> tuple[float, int]:
    """The largest step that few rows show as well, and many more, over what is usual, and its row.

    Waves have steps, too, which grow with the rows that are looked at.
    """
    sizes, near, far = (steps[rows] for rows in (side, SIDES[0], min(LASTS * side, SIDES[-1])))
    if not np.isfinite(sizes).any():
        return 0.0, 0
    usual, own = (by_median(x[np.isfinite(x)]) or np.inf for x in (sizes, near))
    least = SHARP * np.abs(sizes)
    sharp, lasts = near * np.sign(sizes) + own > least, ~(far * np.sign(sizes) < least)
    told = np.where(sharp & lasts, np.abs(np.nan_to_num(sizes)), 0.0) / usual
    return float(told.max()), int(told.argmax())


def _steps(rest: Array, run: NDArray[np.int64], side: int) -> Array:
    """Step before every row (n,), beside an offset and a slope; NaN where rows are missing."""
    at = np.arange(-side, side) + 0.5
    weights = np.linalg.pinv(np.column_stack([np.ones(2 * side), at, at > 0]))[2]
    out = np.full(len(rest), np.nan)
    if len(rest) > 2 * side:
        one_run = run[2 * side - 1 :] == run[: len(run) - 2 * side + 1]
        found = np.correlate(rest, weights, mode="valid")
        out[side : side + len(found)] = np.where(one_run, found, np.nan)
    return out
