"""What no name explains: where it lives, what it does to the names, smooth functions and quick lines."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from calibration.arrays import Array, Mask
from calibration.balances.candidate import Candidate
from calibration.balances.pickup import TOP, pick_up
from calibration.balances.view import View
from calibration.decide import thresholds as limits
from calibration.decide.drive import (
    EXPECTED,
    clear,
    displaced,
    larger_than_the_response,
    within_own_errors,
)
from calibration.decide.parameters import finding_of
from calibration.decide.rules import leave_out
from calibration.decide.select import select
from calibration.decide.selection import Selection
from calibration.finding import UNKNOWN, Finding, Parameter
from calibration.names import NAMES
from calibration.names.name import OWN_ERRORS
from calibration.names.scene import Scene
from calibration.names.unknown import domains, smooth_functions
from calibration.statistics.tails import rms
from calibration.statistics.whitening import APART, coherence

# of the mean square above the floor: names, or a gap, that leave more than they take are not what the log
# mostly holds. ASSUMPTION by that reasoning; looked at on development seeds and the opened seed 20261122
MOST_LEFT = 0.5
# floors of a force beyond which a domain is looked for: sound drives stay below 1.4 (seeds 1036 and 1038)
TELLING = 1.6
# share of the mean square of what is left, over the turn of a stage or over time alone: most. ASSUMPTION
OVER_ITS_TURN = 0.5
# of what neighbouring rows share: a domain that holds less of it is not where the residual lives. ASSUMPTION
OF_WHAT_REPEATS = 0.5
ALONE = "over time alone"
IN_SIZE = ", in size"  # louder in places: noise is, too, and no function of the place takes it away
# smooth functions at most: of a force one; of two sensors one over the place, one of a flank of teeth
MOST = {True: 1, False: 2}


@dataclass(frozen=True)
class Left:
    """Remainder of a balance: `times` the floor, `part` of what was above it before. The domain it is a
    function of (None: of none that was tried) is in words, with the share of its mean square there.

    effect: so large that it is an effect without a name, or a reason not to say "nothing".
    noise: it is only louder in places, and no row tells of another one beyond the filter.
    """

    times: float
    part: float
    domain: str | None = None
    where: str = "in no domain that was tried"
    share: float = 0.0
    effect: bool = True
    noise: bool = False


class Place(NamedTuple):
    """What a residual may hang on: in words, the plant's domain (None: none), values (n,) on the rows."""

    words: str
    domain: str | None
    x: Array


def left_over(s: Selection, scene: Scene, floor: float | None) -> Left | None:
    """What is left beyond TELLING floors of a force, STILL_MISSING of sensors; of a force first where coarse
    steps do not raise the floor. None where it is less, or no floor is known."""
    held, p = s.held, s.problem
    if not floor or not np.isfinite(held.after):
        return None
    if scene.force and p.resolved is not None:
        rows, noise = p.resolved
        test = p.test & rows
        if test.sum() >= limits.FEWEST_TOLD:
            before, after = (rms(m.left_out(p)[rows[p.test]]) for m in (s.bare, s.model))
            if after > limits.STILL_MISSING * noise:
                return _where(s, scene, rows, Left(after / noise, part_left(before, after, noise)))
    if held.after <= (TELLING if scene.force else limits.STILL_MISSING) * floor:
        return None
    return _where(s, scene, p.valid, Left(held.after / floor, part_left(held.before, held.after, floor)))


def part_left(before: float, after: float, floor: float) -> float:
    """Part of the mean square above the floor that is left."""
    return (after**2 - floor**2) / max(before**2 - floor**2, floor**2)


def _where(s: Selection, scene: Scene, rows: Mask, found: Left) -> Left:
    """`found` with the domain whose bin means take most of `rows`, file by file from the others' means."""
    e, p = s.residual(), s.problem
    rows = rows & p.valid
    files = [p.session == k for k in np.unique(p.session[rows])]
    test = rows & p.held
    by_file = [(rows & ~f, rows & f) for f in files] if len(files) > 2 else []
    against = e * np.sign(scene.view.direction[scene.view.rows])

    def share(z: Array, x: Array) -> float:
        weight = [float(np.sum(z[test] ** 2)) for _, test in by_file]
        each = [domain_share(z, x, *fold) for fold in by_file]
        over = float(np.average(each, weights=weight)) if sum(weight) > 0 else 0.0
        return max(domain_share(z, x, p.once.train & rows, test), over)

    shapes = {"": e, ", against the motion": against, IN_SIZE: _size(e, rows, p.session)}
    v: View = scene.view
    places = [Place(name.replace("_", " "), name, x) for name, x in domains(scene)]
    turns = [(g.name, g.period) for g in v.rig.stages if g.period]
    places += [Place(f"the turn of {name}", "axis_angle", v.x[v.rows] % turn) for name, turn in turns]
    most, place, how = _most(shapes, places, share)
    alone = coherence(e, rows, p.session, int(np.ceil(APART * v.sigma / v.step)) or 1)
    if alone > OVER_ITS_TURN and most <= OF_WHAT_REPEATS * alone:
        return replace(found, domain="time", where=ALONE, share=alone)
    if most <= limits.LEAST_SHARE:
        return found
    # what the declared terms' own errors leave over a place, where nothing has a name, is no effect
    nameless = scene.force and all(c.name == UNKNOWN for c in s.candidates)
    own = nameless and np.sqrt(most) * np.std(e[rows]) < OWN_ERRORS * np.std((p.y - e)[rows])
    where, noise = f"over {place.words}{how}", how == IN_SIZE and alone < limits.LEAST_SHARE
    return replace(found, domain=None if own else place.domain, where=where, share=most, noise=noise)


def lives_in(s: Selection, places: Sequence[Place], stacked: int = 1) -> tuple[str | None, float, str]:
    """The domain whose bin means take most off the residual, or its size; None where none does; the
    share; and in words. Of `stacked` things (two motors) the one that leaves most."""
    e, p = s.after.residual, s.problem.once
    mine = np.arange(len(e)) // (len(e) // stacked)
    worst = max(range(stacked), key=lambda k: float(np.sum(e[p.test & (mine == k)] ** 2)))
    train, test = p.train & (mine == worst), p.test & (mine == worst)
    shapes = {"": e, IN_SIZE: _size(e, train, p.session)}
    most, place, how = _most(shapes, places, lambda z, x: domain_share(z, x, train, test))
    if most < limits.SHOWN:
        return None, 0.0, "in none of " + ", ".join(x.words for x in places)
    return place.domain, most, f"over {place.words}{how}"


def _size(e: Array, rows: Mask, file: NDArray[np.int64]) -> Array:
    """Less its mean over each file's `rows`: a file that is louder says nothing of its one speed."""
    size = np.abs(e)
    for k in np.unique(file):
        mine = file == k
        size[mine] -= float(np.mean(size[mine & rows])) if (mine & rows).any() else 0.0
    return size


def _most(
    shapes: Mapping[str, Array], places: Sequence[Place], share: Callable[[Array, Array], float]
) -> tuple[float, Place, str]:
    """The largest share of a shape of the residual over a place, that place, and which shape."""
    found = ((share(z, place.x), place, how) for place in places for how, z in shapes.items())
    return max(found, key=lambda one: one[0])


def domain_share(e: Array, x: Array, train: Mask, test: Mask) -> float:
    """Share of `e` (n,) that bin means over `x` (n,) of `train` rows take on `test` rows; 0 of too few."""
    bins = int(min(limits.DOMAIN_BINS, train.sum() // limits.ROWS_PER_BIN, test.sum() // limits.ROWS_PER_BIN))
    if bins < limits.FEWEST_DOMAIN_BINS or np.ptp(x[train]) == 0:
        return 0.0
    edges = np.unique(np.quantile(x[train], np.linspace(0, 1, bins + 1)[1:-1]))
    place = np.searchsorted(edges, x)
    count = np.maximum(np.bincount(place[train], minlength=len(edges) + 1), 1)
    means = np.bincount(place[train], e[train], len(edges) + 1) / count
    return float(1 - np.mean((e - means[place])[test] ** 2) / max(float(np.mean(e[test] ** 2)), 1e-300))


def settle(findings: list[Finding], left: Left | None, channel: str) -> list[Finding]:
    """Findings without names that leave most of the log above its floor; what has no name is `unknown`.

    Friction that nobody stated is there in every drive, and keeps its name.
    """
    if left is None:
        return findings
    expected = [f for f in findings if f.name in EXPECTED]
    findings = [f for f in findings if f.name not in EXPECTED]
    named = [f for f in findings if f.name != UNKNOWN]
    size = f"{left.times:.1f} floors are left {left.where}"
    if not findings:
        much = not left.where.endswith(IN_SIZE) and (not expected or left.part > MOST_LEFT)
        return [*expected, *([_unknown(left.domain, channel, left, size)] if left.domain and much else [])]
    if not named or left.part <= MOST_LEFT:
        return expected + findings
    first = max(named, key=lambda f: f.share)
    names = list(dict.fromkeys(f.name for f in named))
    taken = f"{100 * (1 - left.part):.0f} % of what is above the floor"
    note = f"{', '.join(names)} would take {taken} only: {size}"
    shapes = [f for f in findings if f.name == UNKNOWN]
    if shapes:  # a function that stays says more than names that do not
        return [*expected, shapes[0].noted(note), *shapes[1:]]
    theirs = left.domain if left.part * left.share > first.share else None  # of the whole
    return [*expected, replace(_unknown(theirs or first.domain, channel, left, note), equivalent=names)]


def of_one_domain(findings: list[Finding], left: Left | None) -> list[Finding]:
    """Guesses at a function of the place or of time, where that has more of it: together they are it.

    A smooth function of the place beside them says so. So does a residual that lives over the turn of their
    own stage, or over time alone beside a line of a fixed frequency.
    """
    smooth = any(f.name == UNKNOWN and f.domain == "axis_angle" and f.stage is None for f in findings)
    where = left.where if left is not None and left.share > OVER_ITS_TURN else ""
    turn = where.removesuffix(", against the motion").removesuffix(IN_SIZE)
    out: list[Finding] = []
    for f in findings:
        own = f.stage is not None and turn == f"over the turn of {f.stage}"
        much = left is not None and left.part * left.share > limits.PLAINLY * f.share  # of the whole
        more = turn == ALONE and much if f.domain == "time" else smooth or own
        if f.name not in NAMES or not NAMES[f.name].a_guess or not more:
            out.append(f)
            continue
        alike = [f.name, *(x for x in f.equivalent if x != UNKNOWN)]
        one = replace(f, name=UNKNOWN, harmonic=None, order=None, equivalent=alike)
        if not any(x.name == UNKNOWN and x.stage == f.stage and x.equivalent == alike for x in out):
            what = "time" if f.domain == "time" else "the place"
            out.append(one.noted(f"{what} has more of it than this form"))
    return out


def _unknown(domain: str, channel: str, left: Left, note: str) -> Finding:
    return Finding(UNKNOWN, channel, domain, share=left.share, note=note)


def beyond_names(s: Selection, scene: Scene) -> tuple[Selection, Selection, list[Finding]]:
    """The named effects that stay, the same with smooth functions, these as findings; refusals are added."""
    together = s
    findings: list[Finding] = []
    floor = s.problem.floor
    little = bool(floor) and left_over(s, scene, floor) is None
    within = scene.force and bool(floor) and s.held.after <= floor
    if little and (s.chosen or within):  # what the names leave, or the floor holds, is not called missing
        return s, s, []
    for _ in range(MOST[scene.force]):
        scene.model = np.asarray(together.columns @ together.after.beta)
        offered = [beside(c, together) for c in smooth_functions(scene)]
        if scene.force:  # one by one; of two sensors what is left of the best is no second function
            offered = [replace(c, apart=float(k)) for k, c in enumerate(offered)]
        own = tuple(together.model.phases)
        beside_names = replace(s.problem, base=together.columns, base_phases=own)
        more = select(beside_names, offered, most=1, before=s.looked_at)
        while more.chosen and larger_than_the_response(more, 0):
            offered = [c for c in offered if c.key != more.candidates[0].key]
            more = select(beside_names, offered, most=1, before=s.looked_at)
        if not s.chosen:
            more = leave_out(more, within_own_errors)
        s.refused += more.refused
        # what is little is no function of anything, unless most of it goes with that
        if not more.chosen or (scene.force and little and not clear(more)):
            break
        kept = leave_out(s, displaced(more.chosen[0])) if not findings else s
        s, names = kept, together if kept is s else kept
        together = names.keep([*names.chosen, *more.chosen])
        findings.append(finding_of(together, len(names.chosen)))
    return s, together, findings


def beside(c: Candidate, s: Selection) -> Candidate:
    """The candidate, less all that the fit has of it where that holds a function of the same domain.

    The fit predicts the same; two functions of one domain would cancel each other, each far too large.
    """
    if not any((x.name, x.domain) == (UNKNOWN, c.domain) for x in s.candidates):
        return c
    rows = s.problem.train
    x, y = s.columns[rows], c.columns[rows]
    return replace(c, columns=c.columns - s.columns @ np.linalg.lstsq(x, y, rcond=None)[0])


def quick_lines(view: View, channel: str, top: float = TOP) -> list[Finding]:
    """A line in the response's column that the filter takes away before any name is looked for; `top` as in
    `pick_up`."""
    line = pick_up(view, top) if view.dynamic else None
    if line is None:
        return []
    frequency, amplitude = line
    note = f"{frequency:.5g} Hz in the column itself: the filter takes it away, no error shows it"
    size = {"amplitude": Parameter(amplitude, view.unit)}
    return [Finding(UNKNOWN, channel, "time", frequency=frequency, note=note, parameters=size)]
