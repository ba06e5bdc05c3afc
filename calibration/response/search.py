"""The search of a balance: its names round by round, lines again under what was found, and the signs that
masses and friction must keep."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.channels.problem import Problem
from calibration.channels.view import View
from calibration.decide.select import Selection, select
from calibration.names import NAMES
from calibration.names.name import FORCE, SENSORS
from calibration.names.scene import Scene
from calibration.names.unknown import flexible, lost_motion, moving_scale, spring
from calibration.response.prune import (
    above,
    more_than_an_offset,
    prune,
    remainders,
    signed,
    sound,
    within_bounds,
)

MOST = 14  # effects: a cogging motor shows several orders
MARGIN = 0.02  # of the cross-validated mean square (effects.md, lesson 3)
ROUNDS = 3  # of search: lines come out when larger things are gone


def find(
    view: View, problem: Problem, seed: int, tell: Callable[[str], None]
) -> tuple[Selection, Scene, list[str]]:
    """What is selected on a balance, the scene it was selected in, and the declared terms that were taken
    out of the balance because they came out negative."""
    s, scene = _search(view, problem, np.random.default_rng(seed), tell)
    bounds = _bound(s)
    if bounds:
        s, scene = _search(view, problem, np.random.default_rng(seed), tell)
    return s, scene, bounds


def _bound(s: Selection) -> list[str]:
    """Masses and friction are not negative: a term that the final fit wants so is taken out of the balance,
    and said."""
    problem, out = s.problem, []
    for k, (name, _) in enumerate(problem.base_labels):
        value, error = float(s.after.beta[k]), float(np.sqrt(max(s.after.covariance[k, k], 0.0)))
        if name in ("inertia", "viscous", "coulomb") and value < 0 and problem.base[:, k].any():
            why = "" if value < -2 * error else ", within its error"
            out.append(f"{name}: the fit gives {value:.4g}{why}; a negative one feeds energy: kept at zero")
            problem.base = problem.base.copy()
            problem.base[:, k] = 0.0
    return out


def scene_of(view: View, problem: Problem) -> Scene:
    """The declared terms' coefficients, and what a flexible fit leaves."""
    rows = problem.train
    beta = np.linalg.lstsq(problem.base[rows], problem.y[rows], rcond=None)[0]
    declared = {n: float(b) for (n, _), b in zip(problem.base_labels, beta, strict=True)}
    declared |= view.rig.constants
    scene = Scene(view, problem, declared, problem.y - problem.base @ beta, np.zeros((len(problem.y), 0)))
    scene.wander = flexible(scene)
    return scene


def _flatten(scene: Scene, extra: np.ndarray) -> None:
    """Residual of base, what is chosen and a flexible fit, on which lines are looked for."""
    p = scene.problem
    x = np.hstack([p.base, extra, scene.wander])
    size = np.linalg.norm(x[p.train], axis=0)
    x = x[:, size > 0] / size[size > 0]
    beta = np.linalg.lstsq(x[p.train], p.y[p.train], rcond=1e-8)[0]
    scene.residual = p.y - x @ beta


def lines_over_place(scene: Scene) -> np.ndarray:
    """Columns (n_fitted, k) of the lines that stand out over the position: along one motion teeth and slots
    look late or early."""
    _flatten(scene, np.zeros((len(scene.problem.y), 0)))
    return np.hstack(
        [np.zeros((len(scene.problem.y), 0)), *[c.columns for c in NAMES["bearing_pass"].columns(scene)]]
    )


def _search(
    view: View, problem: Problem, rng: np.random.Generator, tell: Callable[[str], None]
) -> tuple[Selection, Scene]:
    """Select; look again for lines under what was found; select again from all."""
    kind = FORCE if view.response.is_force else SENSORS
    scene = scene_of(view, problem)
    lines = {"bearing_pass", "command_disturbance"}
    named = [
        c
        for n in NAMES.values()
        if kind in n.channels and n.name not in lines and not (n.name == "channel_delay" and kind == FORCE)
        for c in n.columns(scene)
    ]
    named += [*moving_scale(scene), *spring(scene), *lost_motion(scene)]
    found: list[Candidate] = []
    s: Selection | None = None
    extra = np.zeros((len(problem.y), 0))
    for k in range(ROUNDS):
        tell(f"{view.response.channel}: names, round {k + 1}")
        _flatten(scene, extra)
        fresh = [
            c
            for name in sorted(lines)
            if kind in NAMES[name].channels
            for c in NAMES[name].columns(scene)
            if not _known(c, found, scene)
        ]
        if s is not None and not fresh:
            break
        found += fresh
        s = _select(problem, named, found, rng)
        extra = np.hstack([np.zeros((len(problem.y), 0)), *[x.candidate.columns for x in s.chosen]])
        if not any(x.candidate.name in lines for x in s.chosen) and k > 0:
            break
    assert s is not None
    s = remainders(prune(signed(within_bounds(s, view.resolved))))
    return above(
        more_than_an_offset(sound(signed(s)), view)
    ), scene  # what was left out moves the sizes of the others


def _select(
    problem: Problem, named: list[Candidate], found: list[Candidate], rng: np.random.Generator
) -> Selection:
    """A lightly damped mode rings along with any fixed frequency: it is offered only where no disturbance of
    one is taken."""
    if any(c.name == "command_disturbance" for c in found):
        without = [c for c in named if c.name != "structural_mode"]
        s = select(problem, [*without, *found], rng, most=MOST, margin=MARGIN)
        if any(x.candidate.name == "command_disturbance" for x in s.chosen):
            return s
    return select(problem, [*named, *found], rng, most=MOST, margin=MARGIN)


def _known(c: Candidate, found: list[Candidate], scene: Scene) -> bool:
    """A line that is on the list already."""
    for f in found:
        for name in ("order", "frequency"):
            a, b = getattr(c, name), getattr(f, name)
            reach = 1.0 / max(scene.span if name == "order" else float(scene.view.t.max()), 1e-12)
            if a is not None and b is not None and abs(a - b) < reach and c.columns.shape == f.columns.shape:
                return True
    return False
