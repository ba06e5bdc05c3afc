"""A response before its names are looked for: its filter, its sign, and how sharply friction turns."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from calibration.arrays import Array
from calibration.balances.balance import TOLD_BY, response_of
from calibration.balances.candidate import sine_columns, waves
from calibration.balances.filters import Filter
from calibration.balances.problem import Problem
from calibration.balances.view import STANDSTILLS, View, choose_rows, fade
from calibration.balances.width import NYQUIST
from calibration.decide.heldout import cross_validate
from calibration.look.delay import Make, Timed, force_delay, left_by_the_declared
from calibration.look.looked import Balance
from calibration.names.unknown import KNOTS
from calibration.names.unknown_shapes import spline_columns
from calibration.statistics.regression import solve

# times what is left, from where on a floor is said to hide it. ASSUMPTION: a factor of four in the square
ABOVE = 2.0
# of the rows one way, that go the other way at least, of a drive that goes both. ASSUMPTION
BOTH_WAYS = 0.2
# correlation of two sensors of one motion, at least. ASSUMPTION: late or loose, they still follow
FOLLOWS = 0.5
LITTLE = 0.05  # of the effort's variation, for friction that is none. ASSUMPTION
# amplitude behind a filter, below which a wave is not seen there. ASSUMPTION: as little as half is still seen
HARDLY = 0.5


def one_filter(view: View, made: Callable[[], Problem]) -> None:
    """Filter the response like the rates, unless a declared wave shows that this filter would take away.

    A narrower filter lets quick waves through that the position's rates cannot follow. Where the drive
    accelerates as quickly, the response then holds what its inertia's column lacks, and every term is biased.
    """
    if view.rates > view.sigma and not _quick_waves_show(view, made()):
        view.filter = Filter(view.rates)
        choose_rows(view)


def _quick_waves_show(view: View, p: Problem) -> bool:
    """Whether waves that the wider filter takes away explain rows that they were not fitted to.

    Of slower rows it leaves them. The drive follows such waves, and its acceleration lacks them behind the
    narrow one.
    """
    wide, top = Filter(view.rates), view.top * view.period_s
    quick = [
        h / g.period
        for g in view.rig.stages
        if g.period
        for h in g.orders
        if wide.gain(min(top * h / g.period, NYQUIST)) < HARDLY
    ]
    if not quick:
        return False
    session = np.zeros_like(view.file) if view.rig.runs.get("origin") == "shared" else view.file
    waved = np.hstack([sine_columns(view.x * k, session) for k in quick])
    known, second = p.base, view.second(view.x)
    if view.response.channel != "acceleration":  # else the waves are in it
        # what the wider filter takes off the acceleration is no wave
        known = np.column_stack([known, view.at(second - view.smoothed(second))])
    both = np.hstack([known, waved[view.rows]])
    own = waved @ solve(both[p.train], p.y[p.train])[known.shape[1] :]
    kept = np.std(wide(own, view.segment)[view.ok]) > HARDLY * np.std(own[view.ok])
    return not kept and cross_validate(p, known, both, p.fit(known).whitener).sure


def sharpest(view: View, made: Make, known: Timed | None = None) -> float:
    """How sharply friction turns with the speed, of STANDSTILLS. It follows from what the declared terms
    leave on fitted rows, beside the effects of `known` and a delay, where there are any."""
    shown = (view.standstill, view.direction)
    delay = known.first.parameters["delay"].value if known is not None and known.first is not None else 0.0
    s = known.found[0] if known is not None else None
    effects = sum(s.effect(k) for k in range(len(s.chosen))) if s is not None else 0.0
    left = []
    for part in STANDSTILLS:
        fade(view, part)
        p = made(delay)
        late = view.at(view.rate(response_of(view, delay)[0]))
        p = replace(p, y=p.y - effects, base=np.column_stack([p.base, late]))
        left.append(left_by_the_declared(view, p))
    view.standstill, view.direction = shown
    return STANDSTILLS[int(np.argmin(left))]


def _no_sign(y: Array) -> bool:
    """Whether `y` (n,) has one sign and comes near zero, where a signed one would go through it.

    What a weight pulls one way stays away from it.
    """
    return bool(np.ptp(np.sign(y)) == 0 and np.min(np.abs(y)) < np.std(y))


def doubts(view: View, told: Balance) -> list[str]:
    """What makes an answer worth little: a floor far above what is left, an effort without its sign."""
    channel, s, unit = view.response.channel, told.selection, view.unit
    out = []
    if told.floor and not told.findings and told.floor > ABOVE * s.held.after > 0:
        rest = f"{told.floor:.3g} {unit}, {told.floor / s.held.after:.1f} times what is left"
        out.append(f"{channel}: its floor is {rest}: what is smaller than that does not show")
    y, way = view.columns.get(channel), view.direction[view.ok]
    there, back = sorted((int(np.sum(way > 0)), int(np.sum(way < 0))))
    one_sign = y is not None and there > BOTH_WAYS * back and _no_sign(y[view.ok])
    brakes = s.problem.named(s.after).get("coulomb")
    pulled = any(n.startswith(TOLD_BY) for n, _ in s.problem.base_labels)
    if one_sign and not pulled and brakes is not None and brakes.value <= LITTLE * float(np.std(s.problem.y)):
        out.append(f"{channel} never changes its sign, though the drive goes both ways: is it a size?")
    return out


def _together(p: Problem) -> float:
    """Correlation of a second sensor with the first, beside the files' own constants.

    It is 0 below FOLLOWS, as of a column that is the two sensors' difference, and where no ratio is fitted.
    """
    names = [name for name, _ in p.base_labels]
    if "scale" not in names:
        return 0.0
    x = p.base[p.train]
    others, first = np.delete(x, names.index("scale"), axis=1), x[:, names.index("scale")]
    both = np.column_stack([p.y[p.train], first])
    left = both - others @ np.linalg.lstsq(others, both, rcond=1e-8)[0]
    size = float(np.prod(np.linalg.norm(left, axis=0)))
    found = float(left[:, 0] @ left[:, 1]) / size if size > 0 else 0.0
    return found if abs(found) > FOLLOWS else 0.0


def turned(view: View, problem: Problem, made: Make) -> list[str]:
    """Turn the response's sign, in place, where masses and friction together come out negative, or a second
    sensor falls as the first one rises.

    The sign convention is then the other one; a note says so.
    """
    r = view.response
    if r.channel == "position2" and (r.ratio or _together(problem)) < 0.0:
        view.response = replace(r, gain=-r.gain, ratio=None if r.ratio is None else -r.ratio)
        return [
            f"{r.channel}: falls as the position rises. Its sign, and that of what is found, is turned here"
        ]
    if not r.is_force or r.channel == "acceleration" or not _against(view, problem):
        return []
    # half a period late, a force is against the motion, too
    delay, _ = force_delay(view, problem.once, r.channel)
    if delay is not None and not _against(view, made(delay.parameters["delay"].value)):
        return []
    view.response = replace(r, gain=-r.gain)
    return [
        f"{r.channel}: points against the motion, so it is what acts on the drive, or the position"
        " counts the other way. Its sign is turned here, and so are the signs of what is found in it"
    ]


def _against(view: View, p: Problem) -> bool:
    """Whether masses and friction together come out negative.

    Neither a weight that nobody declared does that, nor a spring or a stop.
    """
    x, rows = np.column_stack([p.base, spline_columns(view.x[view.rows], KNOTS)]), p.train
    if view.turn:
        x = np.column_stack([x, waves(view.x[view.rows] / view.turn * 2 * np.pi, (1,))])
    beta = np.linalg.lstsq(x[rows], p.y[rows], rcond=1e-8)[0]
    heavy = [k for k, (n, _) in enumerate(p.base_labels) if n in ("inertia", "viscous", "coulomb")]
    share = [float(beta[k] * np.std(x[rows, k])) for k in heavy]
    return bool(share) and sum(share) < 0 and max(share) < -0.2 * min(share)
