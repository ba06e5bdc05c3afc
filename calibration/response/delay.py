"""When the effort acts: a late column, and the hold of a sampled loop. Both are settled before any name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from calibration.channels.balance import problem_of
from calibration.channels.problem import Problem
from calibration.channels.view import View
from calibration.decide.accept import PLAINLY
from calibration.decide.select import Selection
from calibration.finding import Finding
from calibration.inputs.record import Record
from calibration.names.lateness import effort_delay, is_hold
from calibration.names.scene import Scene
from calibration.names.unknown import plain
from calibration.readers.run import Array
from calibration.response.prune import REMAINDER, dominant
from calibration.response.search import lines_over_place, scene_of
from calibration.statistics.whitening import Mask

Found = tuple[Selection, Scene, list[str]]
Find = Callable[[Problem], Found]
# A floor that coarse steps made is what they may hide: below it a delay must take PLAINLY of the held-out
# mean square, by itself. No log without an effect of development seeds 1031 to 1038, 1062 and 1063 had one
# that came so far: theirs took less than MATTERS (names/lateness.py)
EARNS = 0.05  # of the held-out mean square, that a delay must take off beside the names found without it


@dataclass
class Timed:
    """A balance whose effort is where it belongs: `delay` when that is an effect, `before` its held-out
    error without; `note` when it is a sound loop's hold."""

    problem: Problem
    found: Found
    delay: Finding | None = None
    before: float | None = None
    note: str = ""
    close: str = ""  # a delay that the log can neither name nor leave out, and what would tell


def timed(
    view: View, records: list[Record], hold_out: list[str], problem: Problem, channel: str, find: Find
) -> Timed:
    """Look for a delay; keep it only when names without it do not explain as much."""
    scene = scene_of(view, problem)
    delay, close = effort_delay(scene, lines_over_place(scene))
    if delay is not None and is_hold(delay, view.period_s):
        value = delay.parameters["delay"].value
        held = problem_of(view, records, hold_out, value)
        return Timed(
            held, find(held), note=f"{channel}: acts {-value:.2g} s after its row: the hold of a sampled loop"
        )
    plain_loop = _held_loop(view, records, hold_out, problem)
    found = find(plain_loop)
    if delay is None:
        return Timed(plain_loop, found, close=close)
    moved = problem_of(view, records, hold_out, delay.parameters["delay"].value)
    late = find(moved)
    now, was = late[0].held.after, found[0].held.after
    simpler = len(late[0].chosen) < len(found[0].chosen)
    before = _held_rms(problem)
    # beside a name that explains nearly everything a delay may be what its formula leaves
    least = REMAINDER * (before**2 - now**2) if dominant(found[0]) else 0.0
    alone = late[0].held.before
    if before <= plain_loop.floor and alone**2 > (1 - PLAINLY) * before**2:  # names are for what is above it
        p = delay.parameters["delay"]
        what = f"channel_delay of {channel}, {1e3 * p.value:.2g} ms, was close"
        why = "the declared model is at the floor without it"
        return Timed(plain_loop, found, close=f"{what} ({why}): quicker turns and a quieter effort")
    telling = was**2 - now**2 > max(EARNS * was**2, least)
    if telling or (simpler and now < was):
        if before > 0:  # of what the declared model leaves, as every other effect's
            delay.share = max(1 - (alone / before) ** 2, 0.0)
        return Timed(moved, late, delay, before)
    return Timed(plain_loop, found)


def _rms_of(p: Problem, x: Array, rows: Mask) -> float:
    """rms on `rows` of a fit of columns x (n, k) to the training rows."""
    beta = np.linalg.lstsq(x[p.train], p.y[p.train], rcond=None)[0]
    return float(np.sqrt(np.mean((p.y - x @ beta)[rows] ** 2)))


def _held_loop(view: View, records: list[Record], hold_out: list[str], problem: Problem) -> Problem:
    """The balance in which the effort acts half a period after its row, before it, or at it: whichever fits
    best, since no log tells which row an effort that is held for a period was written to."""
    half = view.period_s / 2
    return min(
        (problem, *(problem_of(view, records, hold_out, d) for d in (-half, half))),
        key=lambda p: left_by_the_declared(view, p),
    )


def left_by_the_declared(view: View, p: Problem) -> float:
    """Mean square on fitted rows beside the declared terms, loops, asymmetry and weight."""
    x = np.hstack([p.base, plain(scene_of(view, p))])[p.train]
    x = x / np.maximum(np.linalg.norm(x, axis=0), 1e-300)
    beta = np.linalg.lstsq(x, p.y[p.train], rcond=1e-8)[0]
    return float(np.mean((p.y[p.train] - x @ beta) ** 2))


def _held_rms(problem: Problem) -> float:
    rows = problem.test
    return _rms_of(problem, problem.base, rows) if rows.any() else float("nan")
