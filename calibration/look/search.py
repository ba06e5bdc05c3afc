"""The search of a balance: names round by round, lines under what was found, signs of the base."""

import numpy as np

from calibration.arrays import Array
from calibration.balances.candidate import Candidate
from calibration.balances.problem import Problem
from calibration.balances.view import View
from calibration.decide import drive
from calibration.decide.energy import feeds_energy, signed
from calibration.decide.rules import leave_out
from calibration.decide.select import select
from calibration.decide.selection import Selection
from calibration.decide.thresholds import AS_MUCH, NOISE_SHARE, STILL_MISSING
from calibration.decide.twins import beside_a_stage, one_line
from calibration.names import NAMES
from calibration.names.bearing_pass import free_lines
from calibration.names.scene import Scene
from calibration.names.unknown import flexible
from calibration.names.unknown_alone import alone

MOST = 14  # effects: a cogging motor shows several orders. ASSUMPTION
ROUNDS = 3  # of search: lines come out when larger things are gone. ASSUMPTION


def find(view: View, problem: Problem) -> tuple[Selection, Scene, list[str]]:
    """What is selected, in what scene, and the declared terms left out because they came out negative."""
    s, scene = _search(view, problem)
    bounds = _bound(s)
    if bounds:
        s, scene = _search(view, problem)
    return s, scene, bounds


def _bound(s: Selection) -> list[str]:
    """Masses and friction that the final fit wants negative are taken out of the balance, and said."""
    problem, out = s.problem, []
    for k, (name, _) in enumerate(problem.base_labels):
        value, error = float(s.after.beta[k]), float(s.after.errors[k])
        if name in ("inertia", "viscous", "coulomb") and value < 0 and problem.base[:, k].any():
            why = "" if value < -2 * error else ", within its error"
            out.append(f"{name}: the fit gives {value:.4g}{why}; a negative one feeds energy: kept at zero")
            problem.base = problem.base.copy()
            problem.base[:, k] = 0.0
    return out


def scene_of(view: View, problem: Problem) -> Scene:
    """The declared terms' coefficients, and what a flexible fit leaves."""
    declared, residual = problem.plain_fit(problem.train)
    declared |= view.rig.constants
    scene = Scene(view, problem, declared, residual, np.zeros((len(problem.y), 0)))
    scene.wander = flexible(scene)
    return scene


def lines_over_place(scene: Scene) -> np.ndarray:
    """Columns (n_fitted, k) of lines over the position: along one motion teeth look late or early."""
    scene.residual = scene.problem.y - scene.fitted(scene.wander)[1]
    return np.hstack([np.zeros((len(scene.problem.y), 0)), *[c.columns for c in free_lines(scene)]])


def _search(view: View, problem: Problem) -> tuple[Selection, Scene]:
    """Select; look again for lines under what was found; select again from all."""
    rng = np.random.default_rng(0)
    scene = scene_of(view, problem)
    kind = scene.channel
    searched = sorted(n.name for n in NAMES.values() if n.searched and kind in n.channels)
    named = [c for n in NAMES.values() if kind in n.channels and not n.searched for c in n.columns(scene)]
    shapes, found = alone(scene), list[Candidate]()
    s: Selection | None = None
    extra: list[Array] = []
    for k in range(ROUNDS):
        scene.residual = problem.y - scene.fitted(*extra, scene.wander)[1]
        lines = (c for name in searched for c in NAMES[name].columns(scene))
        fresh = [c for c in lines if not _known(c, found, scene)]
        if s is not None and not fresh:
            break
        found += fresh
        s = _select(problem, named, found, rng)
        if shapes and k == 0:  # beside further lines names only leave less
            one = _best_alone(problem, shapes, rng, s.looked_at)
            if _takes_more(one, s):
                named += [*one.candidates, *shapes]  # refined: on its grid a bend may look better
                s = _select(problem, named, found, rng)
        extra = [c.columns for c in s.candidates]
        if not any(c.name in searched for c in s.candidates) and k > 0:
            break
    assert s is not None
    s = beside_a_stage(one_line(s, scene), scene)
    s = signed(leave_out(s, drive.within_bounds(view.resolved), drive.cancelled, drive.within_own_errors))
    # again: what was left out moves the sizes of the others
    s = signed(leave_out(s, drive.remainder, drive.worth_little))
    return leave_out(s, feeds_energy, drive.harmful, drive.below_floor, drive.of_the_steps), scene


def _select(
    problem: Problem, named: list[Candidate], found: list[Candidate], rng: np.random.Generator
) -> Selection:
    """A mode rings along with any fixed frequency: it is offered where no disturbance of one is taken."""
    if any(c.frequency for c in found):
        without = [c for c in named if not c.frequency]
        s = select(problem, [*without, *found], rng, most=MOST, margin=NOISE_SHARE)
        if any(c.frequency for c in s.candidates):
            return s
    return select(problem, [*named, *found], rng, most=MOST, margin=NOISE_SHARE)


def _best_alone(
    problem: Problem, shapes: list[Candidate], rng: np.random.Generator, before: int
) -> Selection:
    """The shape that leaves least, of the best of each domain: unrefined, a stop may look worse."""
    by_domain = [[c for c in shapes if c.domain == domain] for domain in sorted({c.domain for c in shapes})]
    each = [select(problem, x, rng, most=1, margin=NOISE_SHARE, before=before) for x in by_domain]
    return min(each, key=lambda s: s.held.after if s.chosen else np.inf)


def _takes_more(one: Selection, other: Selection) -> bool:
    """Whether a shape alone takes clearly more off the held-out error than all names, or more with fewer
    coefficients. It would replace them where they leave more than the floor, or where it shows below a floor
    that coarse steps make."""
    more = AS_MUCH * one.held.taken > other.held.taken
    fraction = other.held.after > STILL_MISSING * one.held.after
    few, many = (sum(c.cost for c in s.candidates) for s in (one, other))
    fewer = few < many and one.held.after < other.held.after
    shows = other.held.after > other.problem.floor or drive.clear(one)
    return bool(one.chosen) and (more or fraction or fewer) and shows


def _known(c: Candidate, found: list[Candidate], scene: Scene) -> bool:
    """A line that is on the list already."""
    alike = [f for f in found if f.columns.shape == c.columns.shape]
    orders, hertz = [(c.order, f.order) for f in alike], [(c.frequency, f.frequency) for f in alike]
    pairs = ((scene.span, orders), (float(scene.view.t.max()), hertz))
    near = ((a, b, 1.0 / max(reach, 1e-12)) for reach, both in pairs for a, b in both)
    return any(a is not None and b is not None and abs(a - b) < cell for a, b, cell in near)
