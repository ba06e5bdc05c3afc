"""The regression of a drive's response: a balance of forces, or one sensor against another."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from calibration.arrays import Array, Mask
from calibration.balances.friction import sliding_of
from calibration.balances.problem import Problem, Term, labels_of
from calibration.balances.slowoffset import with_slow_offset
from calibration.balances.thresholds import FEWEST_FILES
from calibration.balances.view import View
from calibration.inputs.declaration import JOINTS
from calibration.inputs.run import Run

LOADED = 0.5  # of the median divisor: below, the ratio says nothing. ASSUMPTION
STANDS = 0.2  # of a row's filter, that may lie where the drive stands. ASSUMPTION
BLOCKS = 60  # of the logged time, for the block-robust covariance. ASSUMPTION
BLOCK_ROWS = 20  # rows of a block at least, where no filter tells how long a row is remembered. ASSUMPTION
# memories of the filter in a block: 2 sqrt(pi) standard deviations each, the sum over a Gaussian's
# autocorrelation (arithmetic). ASSUMPTION: blocks are then all but independent
MEMORIES = 2.0
PER_FILE = "offset_per_file"  # term of a rig file. definition
COVER = 0.02  # of its own quantile range that a held-out file may exceed the others. ASSUMPTION
# of the others' range that the end of a file may go beyond them before another part is held out. ASSUMPTION:
# half; loads that grow step by step are first seen at the end
BEYOND = 0.5
# rms, of the largest, of a principal part of the weights' columns: what shows less would have to be three
# hundred times as heavy as what shows most. ASSUMPTION
LEAST_SEEN = 0.003
CHANGES = 0.01  # of its size, by which a column changes at least: else it has one value. ASSUMPTION
# first letters of terms that a part of a file may go beyond, as the speed may
TOLD_BY = ("gravity", "applied")


def problem_of(view: View, records: list[Run], hold_out: list[str], delay_s: float = 0.0) -> Problem:
    """The response and its declared terms on the fitted rows; the force's column is late by `delay_s`."""
    rig, response, at = view.rig, view.response, view.rows
    driven = "applied" in view.columns
    if driven and response.channel == "acceleration":
        late = view.delayed(view.columns["applied"], delay_s)
        view = replace(view, columns={**view.columns, "applied": late})
    y, ok = response_of(view, delay_s)
    terms = _terms(view)
    for name, value in rig.constants.items():
        y = y - value * term_of(view, name)[0][2]
    valid = (view.ok & ok)[at]
    if view.dynamic and (driven or response.channel != "acceleration"):
        valid &= view.at((np.abs(view.speed) < view.slow).astype(float)) < STANDS
    if not view.dynamic and response.is_force:
        valid &= np.abs(view.direction[at]) > 0
    shown = [np.abs(view.speed), *(x for name, _, x in terms if name.startswith(TOLD_BY))]
    # an acceleration behind the filter: it is noisy
    quick = [np.abs(view.at(x)) for name, _, x in terms if name == "inertia"]
    held = _held(view, records, hold_out, valid, [*(x[at] for x in shown), *quick])
    period, session = view.period_s * view.step, view.file[at]
    problem = Problem(
        channel="T" if response.is_force else "K",
        unit=response.unit,
        y=view.at(y),
        base=view.at(np.column_stack([x for _, _, x in terms])),
        base_labels=labels_of(terms),
        t=view.clock[at],
        run=view.run[at],
        session=session,
        valid=valid & _apart(held, view),
        held=held,
        period_s=period,
        ar_order=0,
        known=rig.constants,
        block_s=max(_memory(view) * period, float(np.sum(valid)) * period / BLOCKS),
    )
    if _own_offsets(view):
        problem.fresh = np.column_stack([(session == k).astype(float) for k in np.unique(session)])
    problem = with_slow_offset(problem, view, view.slow_offset)
    return problem.told() if hold_out or len(records) < FEWEST_FILES else problem.in_turn()


def _memory(view: View) -> float:
    """Fitted rows that a block has at least."""
    if not view.dynamic:
        return BLOCK_ROWS
    return float(np.ceil(MEMORIES * 2 * np.sqrt(np.pi) * max(view.sigma / view.step, 1.0)))


def response_of(view: View, delay_s: float) -> tuple[Array, Mask]:
    """The response (n,) at full rate, its column late by `delay_s`, and the rows where it says anything."""
    r, ok = view.response, np.ones(len(view.t), dtype=bool)
    if r.channel == "acceleration":
        x = view.columns.get("acceleration")
        y = -(view.second(view.x) if x is None else x)  # what forces per unit of inertia overcome
    else:
        y = view.delayed(view.columns[r.channel], delay_s)
    y = y * r.gain
    if r.ratio:
        y = y - r.ratio * view.x
    if r.divide_by:
        below = view.columns[r.divide_by]
        if r.divide_by == "supply":
            y = y * (float(np.mean(below)) / np.where(below != 0, below, np.inf))
        else:
            ok = np.abs(below) > LOADED * np.median(np.abs(below))
            y = y / np.where(ok, below, np.inf)
    return y, ok


def default_terms(view: View) -> tuple[str, ...]:
    """The declared model's terms: those of the rig file, and what every response of its kind needs."""
    if view.response.is_speed:
        return ("offset",)
    if view.response.is_force:
        return view.rig.estimate or ("viscous", "coulomb", "offset")
    drift = ("drift",) if "drift" in view.rig.estimate else ()
    scale = ("scale",) if view.response.channel == "position2" and view.response.ratio is None else ()
    return ("offset", *scale, *drift)


def _terms(view: View) -> list[Term]:
    """The declared model at full rate."""
    return [term for name in default_terms(view) for term in term_of(view, name)]


def _own_offsets(view: View) -> bool:
    """Whether every file has its own offset: an incremental sensor starts anywhere, and a weight or a load
    cell's zero may be declared to differ."""
    return not view.response.is_force or PER_FILE in default_terms(view)


def term_of(view: View, name: str) -> list[Term]:
    """A term of the declared model at full rate."""
    unit, x = view.unit, view.angle_unit
    if name.startswith("gravity"):
        return [term for term in _gravity(view) if term[0].startswith(name)]
    files = np.unique(view.file)
    drives = -1.0 if view.response.channel == "acceleration" else 1.0
    if name == PER_FILE or (name == "offset" and len(files) > 1 and _own_offsets(view)):
        return [(f"offset_{int(k) + 1}", unit, (view.file == k).astype(float)) for k in files]
    known: dict[str, tuple[str, Callable[[], Array]]] = {
        "inertia": (
            f"{unit} s2/{x}",
            lambda: view.columns.get("acceleration", view.smoothed(view.second(view.x))),
        ),
        # a rate that no filter follows is as noisy as the sensor's steps, which would hide its coefficient
        "viscous": (
            f"{unit} s/{x}",
            lambda: view.smoothed(view.rate(view.x)) if view.dynamic else view.speed,
        ),
        "coulomb": (unit, lambda: sliding_of(view).shape),
        "offset": (unit, lambda: np.ones(len(view.t))),
        "applied": (f"{unit}/{_unit_of(view, name)}", lambda: drives * view.columns[name]),
        "drift": (f"{unit}/s", lambda: view.clock - view.clock.mean()),
        "stiffness": (f"{unit}/{x}", lambda: view.x - view.x.mean()),
        "scale": (f"{unit}/{x}", lambda: view.x - view.x.mean()),
    }
    own, column = known[name]
    return [(name, own, np.asarray(column()))]


def _gravity(view: View) -> list[Term]:
    """cos and sin of the angle; of a joint in front of it, whose axis is parallel, those of their sum, too.

    Of several joints their cosines and sines multiply this one's. The torque of a weight is the slope of its
    height, a sum of such products however the joints lie.
    """
    turn, carried = (view.turn or 1.0) / (2 * np.pi), view.columns.get("load", 1.0)
    joints = [c for c in JOINTS if c in view.columns]
    angles = {"": view.x} if len(joints) != 1 else {"": view.x, "_joint": view.x + view.columns[joints[0]]}
    sides = (("cos", np.cos), ("sin", np.sin))
    out = [(f"{side}{which}", of(x / turn)) for which, x in angles.items() for side, of in sides]
    for joint in joints if len(joints) > 1 else []:
        both = [(side, of(view.columns[joint] / turn)) for side, of in sides]
        out += [(f"{name}_{side}_{joint}", x * wave) for side, wave in both for name, x in out]
    if len(joints) > 1:
        out = _seen_parts(np.column_stack([x for _, x in out]), view.ok)
    return [(f"gravity_{name}", view.unit, carried * x) for name, x in out]


def _seen_parts(columns: Array, rows: Mask) -> list[tuple[str, Array]]:
    """Principal parts of `columns` (n, k) along a motion, without those that it hardly moves.

    A weight would have to be many times what the log holds before it showed in these.
    """
    size, parts = np.linalg.eigh(columns[rows].T @ columns[rows])
    seen = size > LEAST_SEEN**2 * size.max()
    return [(str(k + 1), x) for k, x in enumerate((columns @ parts[:, seen]).T[::-1])]


def _unit_of(view: View, channel: str) -> str:
    return view.rig.columns[channel].unit if channel in view.rig.columns else "1"


def _held(view: View, records: list[Run], names: list[str], valid: Mask, shown: list[Array]) -> Mask:
    """Named files; of three and more one that the others cover; else the end of every run's `valid` rows.

    Its middle or beginning, where the end goes far beyond the others in columns of `shown`, all together.
    """
    session = view.file[view.rows]
    if names:
        return np.isin(session, [k for k, r in enumerate(records) if r.among(names)])
    if len(records) >= FEWEST_FILES:
        return np.asarray(session == _covered(view, session, len(records)))
    share = 1 - view.rig.hold_out
    parts = [_part(view, valid, first) for first in (share, share / 2, 0.0)]
    excess = [_excess(shown, held & valid, ~held & valid) for held in parts]
    return parts[0 if excess[0] <= BEYOND else int(np.argmin(excess))]


def _part(view: View, valid: Mask, first: float) -> Mask:
    """A contiguous part of the `valid` rows of every run, from a share of them on."""
    run = view.run[view.rows]
    held = np.zeros(len(run), dtype=bool)
    for label in np.unique(run):
        rows = np.flatnonzero((run == label) & valid)  # a rest has none to hold
        begin, count = int(len(rows) * first), len(rows) - int(len(rows) * (1 - view.rig.hold_out))
        every = np.flatnonzero(run == label)
        if count:  # with the rows of the run at its side that say nothing
            low = rows[begin] if begin else every[0]
            high = rows[begin + count] if begin + count < len(rows) else every[-1] + 1
            held[low:high] = run[low:high] == label
    return held


def _excess(columns: Sequence[Array], mine: Mask, others: Mask) -> float:
    """How far the rows `mine` of some columns go beyond the `others`, in parts of these' ranges."""
    total = 0.0
    if not mine.any() or not others.any():
        return float("inf")
    for z in columns:
        low, high = np.quantile(z[others], [0.01, 0.99])
        a, b = np.quantile(z[mine], [0.02, 0.98])
        span = max(high - low, CHANGES * float(np.median(np.abs(z))), 1e-300)
        total += (max(low - a, 0.0) + max(b - high, 0.0)) / span
    return float(total)


def _covered(view: View, session: NDArray[np.int64], count: int) -> int:
    """The file that leaves the ranges of the others least; of those the middle one in time."""
    columns = (view.x[view.rows], np.abs(view.speed[view.rows]))
    excess = np.array([_excess(columns, session == k, session != k) for k in range(count)])
    good = np.flatnonzero(excess <= excess.min() + COVER)
    clock = np.array([view.clock[view.rows][session == k].mean() for k in good])
    return int(good[np.argsort(clock)[len(good) // 2]])


def _apart(held: Mask, view: View) -> Mask:
    """False where the filter reaches over a border between fitted and held-out rows."""
    reach = int(np.ceil(3 * view.sigma / max(view.step, 1)))
    border = np.append(held[1:] != held[:-1], False) & (reach > 0)
    return np.asarray(~maximum_filter1d(border, 2 * (reach // 2) + 1))
