"""When the effort acts: a late column, and the hold of a sampled loop. Both are settled before any name."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize_scalar

from calibration.balances.problem import Problem
from calibration.balances.view import View
from calibration.decide.drive import dominant
from calibration.decide.residual import MOST_LEFT, part_left
from calibration.decide.selection import Selection
from calibration.decide.thresholds import AS_MUCH, CLEAR_SHARE, PLAINLY, REMAINDER
from calibration.finding import NORMAL, Finding
from calibration.inputs.declaration import Response
from calibration.look.search import lines_over_place, scene_of
from calibration.names.channel_delay import late_column
from calibration.names.lateness import STARTS, effort_delay, is_hold
from calibration.names.scene import Scene
from calibration.names.unknown import plain

Found = tuple[Selection, Scene, list[str]]
Find = Callable[[Problem], Found]
Make = Callable[[float], Problem]
# A floor that coarse steps made is what they may hide: below it a delay must take CLEAR_SHARE of the held-out
# mean square, by itself. No log without an effect of development seeds 1031 to 1038, 1062 and 1063 had one
# that came so far: theirs took less than MATTERS (names/lateness.py)
# of the held-out mean square, that a delay must take off beside the names found without it
EARNS = 0.05
# times the delay beside a friction curve, within which it is looked for beside the declared terms. ASSUMPTION
WIDE = 2.0


@dataclass
class Timed:
    """The search once the effort is where it belongs, or slips are apart. Such an effect is `first`, and
    `declared` the declared model without it, or without `offsets` of the files' own. `note`: of a hold."""

    problem: Problem
    found: Found
    first: Finding | None = None
    declared: Selection | None = None
    offsets: Finding | None = None
    note: str = ""
    close: str = ""  # a delay that the log can neither name nor leave out, and what would tell


def timed(view: View, made: Make, problem: Problem, channel: str, find: Find) -> Timed:
    """A delay, only where names without it do not explain as much; `made`: the balance by its delay, s."""
    delay, close = force_delay(view, problem.once, channel)
    hold = None
    if delay is not None and is_hold(delay, view.period_s):
        value, delay = delay.parameters["delay"].value, None
        held = made(value)
        note = f"{channel}: acts {-value:.2g} s after its row: the hold of a sampled loop"
        hold = Timed(held, find(held), note=note)
        if left_by_the_declared(view, held) < left_by_the_declared(view, problem):
            return hold
    # no log tells which row an effort that is held for a period was written to: whichever fits best
    half = view.period_s / 2
    plain_loop = min((problem, made(-half), made(half)), key=lambda p: left_by_the_declared(view, p))
    found = find(plain_loop)
    if hold is not None and hold.found[0].held.after < found[0].held.after:
        return hold
    if delay is None:
        return Timed(plain_loop, found, close=close)
    declared = Selection.of(problem)
    delay, moved, late = _settled(delay, declared, made, find)
    now, was = late[0].held.after, found[0].held.after
    simpler = len(late[0].chosen) < len(found[0].chosen)
    before = declared.held.before
    # beside a name that explains nearly everything a delay may be what its formula leaves
    least = REMAINDER * (before**2 - now**2) if dominant(found[0]) else 0.0
    alone, floor = late[0].held.before, plain_loop.floor
    why = ""
    if before <= floor and alone**2 > (1 - CLEAR_SHARE) * before**2:
        why = "the declared model is at the floor without it"
    elif floor and part_left(before, now, floor) > MOST_LEFT:
        why = "it leaves most of what is above the floor"
    elif _no_inertia(late, found) and was**2 - now**2 < PLAINLY * was**2:
        why = "beside it the drive has no inertia: along a sine either is the other"
    if why:
        what = f"channel_delay of {channel}, {1e3 * delay.parameters['delay'].value:.2g} ms, was close"
        return Timed(plain_loop, found, close=f"{what} ({why}): quicker turns and a quieter effort")
    telling = was**2 - now**2 > max(EARNS * was**2, least)
    if telling or (simpler and now < was):
        if before > 0:  # of what the declared model leaves, as every other effect's
            delay = replace(delay, share=max(1 - (alone / before) ** 2, 0.0))
        return Timed(moved, late, delay, declared)
    return Timed(plain_loop, found)


def _settled(delay: Finding, declared: Selection, made: Make, find: Find) -> tuple[Finding, Problem, Found]:
    """The delay beside any friction curve, or beside the declared terms alone; its balance; what is found.

    Whichever leaves less once names are found, or as much with fewer. Their distance is an error of both.
    """
    p = delay.parameters["delay"]
    moved = made(p.value)
    late = find(moved)
    tried = np.linspace(-WIDE * abs(p.value), WIDE * abs(p.value), STARTS)
    step, start = float(tried[1] - tried[0]), float(min(tried, key=lambda d: _left(made(float(d)))))
    best = minimize_scalar(lambda d: _left(made(d)), bounds=(start - step, start + step), method="bounded")
    other, error = float(best.x), abs((p.high or p.value) - (p.low or p.value)) / 2
    if abs(other - p.value) <= max(error, step):
        return delay, moved, late
    again = made(other)
    found = find(again)
    (one, _, _), (rival, _, _), before = found, late, declared.held.before**2
    less, few = one.held.after < rival.held.after, len(one.chosen) < len(rival.chosen)
    if not less and not (few and before - one.left > AS_MUCH * (before - rival.left)):
        return delay, moved, late
    spread = float(np.hypot(error / NORMAL, (other - p.value) / 2))
    return late_column(delay.note, other, spread, delay.share), again, found


def _left(p: Problem) -> float:
    """Mean square on fitted rows beside the declared terms."""
    return float(np.mean(p.plain_fit(p.train)[1][p.train] ** 2))


def force_delay(view: View, p: Problem, channel: str) -> tuple[Finding | None, str]:
    """How late the column of a force is, and what would tell it, as `effort_delay` has it."""
    scene = _scene_of_the_force(view, p, channel)
    return effort_delay(scene, lines_over_place(scene))


def _scene_of_the_force(view: View, p: Problem, channel: str) -> Scene:
    """Where a force is the response, which alone may be late: turned round, if it is what is applied."""
    if view.response.channel == channel:
        return scene_of(view, p)
    k = p.place(channel)
    base = p.base.copy()
    base[:, k] = -p.y
    seen = replace(view, response=Response(channel, view.rig.columns[channel].unit))
    return scene_of(seen, replace(p, y=-p.base[:, k], base=base))


def _no_inertia(late: Found, found: Found) -> bool:
    """Whether the inertia comes out negative beside the delay alone."""
    return not found[2] and any(x.startswith("inertia:") for x in late[2])


def left_by_the_declared(view: View, p: Problem) -> float:
    """Mean square on fitted rows beside the declared terms, loops, asymmetry and weight."""
    scene = scene_of(view, p)
    return float(np.mean((p.y - scene.fitted(plain(scene))[1])[p.train] ** 2))
