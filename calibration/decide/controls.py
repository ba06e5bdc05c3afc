"""Negative controls: the accepted effect made wrong on purpose, which must not be accepted."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from calibration.arrays import Array
from calibration.balances.candidate import Candidate, sine_columns
from calibration.decide.heldout import Model
from calibration.decide.selection import Selection
from calibration.decide.thresholds import FEWEST_HELD, REVERSIBLE, ROUNDING, TOOTH_TURNS
from calibration.names import NAMES
from calibration.names.scene import Scene
from calibration.statistics.regression import under
from plant.gears import ROLLER, TRAIN

(_MOTOR, _SHAFT1), (_MESH2, _SHAFT2), (_, _BULL) = TRAIN
#: teeth of the larger gear on each shaft, and of a mesh's pinion, but of the bull gear
TEETH = {"shaft1": _SHAFT1, "shaft2": _SHAFT2, "motor": _MOTOR, "roller": ROLLER[1]}
TEETH |= {"mesh1": _MOTOR, "mesh2": _MESH2, "mesh3": _BULL}
# resolution cells (1 / travel) by which a line's order is made wrong: beyond one they are apart (ASSUMPTION)
CELLS = 1.5
# effects of a drive whose order is made wrong: the weaker ones are close to nothing anyway (ASSUMPTION)
MOST_LINES = 6


@dataclass(frozen=True, kw_only=True)
class Wrong:
    """A wrong version of an effect in words, and its columns; None, and why, where the log cannot try it."""

    what: str
    columns: Array | None = None
    note: str = ""


def controls(
    s: Selection, wrong_of: Callable[[int, Candidate], Sequence[Wrong]], reversed_time: bool = True
) -> list[dict[str, Any]]:
    """The wrong versions of every chosen effect, its columns in reversed time, and its sign flipped."""
    out = []
    for k, c in enumerate(s.candidates):
        place = {"name": c.name, "stage": c.stage, "harmonic": c.harmonic}
        tests = list(wrong_of(k, c))
        if reversed_time:
            back = c.columns[::-1].copy()
            what = f"time reversed ({c.say()})"
            same = Wrong(what=what, note="no test here: this motion reads the same backwards")
            known = np.hstack([s.problem.base, c.columns])
            tests.insert(0, same if _alike(known, back) else Wrong(what=what, columns=back))
        for x in tests:
            accepted = x.columns is not None and _better(s, k, replace(c, columns=x.columns, shape=None))
            note = {"note": x.note} if x.note else {}
            out.append({"what": x.what, "accepted": accepted, **note, **place})
        out.append({"what": f"sign flipped ({c.say()})", "accepted": _flipped(s, k), **place})
    return out


def tooth_more_or_less(angle: Array | None, span: float) -> Callable[[int, Candidate], list[Wrong]]:
    """Lines of a stage with one tooth more and less, over the axis' angle (n,) and its span in turns."""

    def wrong_of(_: int, c: Candidate) -> list[Wrong]:
        if c.stage not in TEETH or c.kind != "line" or not c.order or angle is None:
            return []
        out = []
        for step, word in ((1, "more"), (-1, "less")):
            order = c.order * (TEETH[c.stage] + step) / TEETH[c.stage]
            what = f"one tooth {word} on {c.stage}"
            if abs(order - c.order) * span < TOOTH_TURNS:
                out.append(Wrong(what=what, note="this travel cannot tell one tooth from the next"))
                continue
            columns = sine_columns(angle * order, np.zeros(len(angle)))
            out.append(Wrong(what=f"{what} ({c.say()})", columns=columns))
        return out

    return wrong_of


def order_beside(s: Selection, scene: Scene) -> Callable[[int, Candidate], list[Wrong]]:
    """Lines of a drive at an order beside their own."""
    span, turn, x = scene.span, scene.turn, scene.view.x[scene.view.rows]

    def wrong_of(k: int, c: Candidate) -> list[Wrong]:
        whole_stage = c.harmonic is None and c.stage is not None
        order = c.at_order
        if k >= MOST_LINES or c.kind != "line" or not order or NAMES[c.name].scaled or whole_stage:
            return []
        label = s.problem.session if c.per_run else np.zeros_like(s.problem.session)
        # a negative order is the positive one the other way round
        rates = [r for r in (order / turn + CELLS / span, order / turn - CELLS / span) if r > 0]
        what = f"in place of {order:.4g} ({c.say()})"
        return [Wrong(what=f"order {r * turn:.4g} {what}", columns=sine_columns(x * r, label)) for r in rates]

    return wrong_of


def _alike(a: Array, b: Array) -> bool:
    """True when b's columns lie mostly in the span of a's: the control is then what is known already."""
    q, _ = np.linalg.qr(a)
    return bool(np.sum((q.T @ b) ** 2) > REVERSIBLE * np.sum(b**2))


def _better(s: Selection, k: int, wrong: Candidate) -> bool:
    """True when the wrong candidate fits training rows at least as well, through the same filter."""
    p, right = s.problem, s.candidates
    others = [*right[:k], wrong, *right[k + 1 :]]
    true, false = (under(p.y, p.design(x), p.train, s.after.whitener) for x in (right, others))
    return false >= true


def _flipped(s: Selection, k: int) -> bool:
    """True when the effect with its sign turned leaves less on held-out rows than no effect.

    Less by more than rounding of the declared model's error there: the declared terms alone may make that."""
    p, x = s.problem, s.columns
    if p.test.sum() < FEWEST_HELD:
        return False
    left = []
    for factor in (-1.0, 0.0):
        beta = s.after.beta.copy()
        beta[s.at(k)] *= factor
        left.append(float(np.mean(Model(x=x, beta=beta).residual(p.once, p.once.test) ** 2)))
    return left[0] < left[1] - ROUNDING * max(left[1], s.held.before**2)
