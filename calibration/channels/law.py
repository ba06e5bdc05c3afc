"""The command of a rig: its effort against the law that its controller is declared to have.

    pid      u = p e + i int(e) + d de/dt          e = reference - position
    cascade  u = velocity (position e - v)

Columns go through the balance's filter, so that law and effort lose the same. The gains are fitted anew from
what follows the reference, beside the lateness of the rate, which a controller takes from positions that have
passed; what the law cannot make of reference and position acts in front of the logged effort.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import lfilter

from calibration.channels.problem import Problem
from calibration.channels.view import View, pieces
from calibration.inputs.declaration import Controller
from calibration.readers.run import Array
from calibration.statistics.regression import block_covariance, solve

# of the command's rms: less is the rounding of a log's numbers and the order of a law's own sums. ASSUMPTION;
# EMPS, whose law is published, is left with 0.0003
LEAST = 0.003
CLEARLY = 0.5  # of what another explanation leaves: more decides nothing. ASSUMPTION
AT_LIMIT, STRAY = (
    0.97,
    1e-3,
)  # of the limit (noise is on it); of a row's filter that may lie there. ASSUMPTION
# rows: of the first-order lags that the reference is seen through; loops answer within three to a thousand
# samples. ASSUMPTION: what they miss makes the intervals wider, not the gains wrong
LAGS = (3, 10, 30, 100, 300, 1000)


@dataclass(frozen=True)
class Command:
    """The command less its law, as a problem whose base is an offset per file, or per piece where the law
    integrates; `gains` (k,) with their covariance (k, k) in the law's order of `labels`; `terms` (n_fitted,
    k): the law's, `follows` as far as they follow the reference; `forward` (n_fitted, 3): what a feed-forward
    of rate, acceleration and friction would add; `left`: rms of what the law leaves of the fitted rows."""

    problem: Problem
    labels: list[tuple[str, str]]
    gains: Array
    covariance: Array
    follows: Array
    terms: Array
    forward: Array
    left: float


def command_of(view: View, balance: Problem, law: Controller) -> Command:
    """The law with the position of that row, the one before or the one after, that the command was made of:
    which one stands beside it is the log writer's choice. Where what is left does not tell, because a late
    position looks like another gain of the rate, it is the one that makes the gains the declared ones."""
    known = view.at(_known(view, view.columns["reference"]))
    tried = [_command_of(view, balance, law, known, rows) for rows in (0, 1, -1)]
    least = min(c.left for c in tried)
    declared = np.array(list(declared_terms(law).values()))
    scale = np.where(declared != 0, declared, 1.0)
    good = [c for c in tried if c.left <= least / CLEARLY]
    return min(good, key=lambda c: float(np.sum((c.gains / scale - declared / scale) ** 2)))


def _command_of(view: View, balance: Problem, law: Controller, known: Array, before: int) -> Command:
    """The law's gains from two-stage least squares, and what it leaves of the effort; with the position
    `before` rows earlier; `known` (n_fitted, m) are the instruments.

    A disturbance of the command moves the drive, and the error that the law sees has it, too: least squares
    would read it into the gains. The reference does not know of it, so only what follows the reference counts
    (instruments: Van den Hof 1998; Janot, Gautier, Brunot 2019 for a drive's own parameters).
    """
    moved = {**view.columns, "position": view.delayed(view.x, -before * view.period_s)}
    view = replace(view, columns=moved)
    effort, x, reference = view.columns["effort"], view.x, view.columns["reference"]
    labels, full = _terms(view, law, reference - x)
    declared = sum((g * c for g, c in zip(declared_terms(law).values(), full, strict=True)), np.zeros(len(x)))
    late = []
    if law.law == "cascade":
        late = [view.second(x)]
    elif "d" in law.gains:
        late = [-view.second(reference - x)]
    # the rates of position and reference hold a delay of all: it is read as a smaller gain of the rate
    if not ("d" in law.gains or "rate_feedforward" in law.gains):
        late.append(-view.rate(declared))
    terms_at = view.at(np.column_stack([*full, *late]))
    unit = view.rig.columns["effort"].unit
    nuisances, names = _per_file(view, balance, "i" in law.gains, unit)
    ok = view.ok[view.rows]
    if law.limit is not None:
        ok &= view.at((np.abs(effort) > AT_LIMIT * law.limit).astype(float)) < STRAY
    train = ok & ~balance.held
    p = replace(
        balance,
        channel="S",
        unit=unit,
        y=view.at(effort),
        base=nuisances,
        base_labels=names,
        valid=ok,
        fresh=nuisances,
        floor=0.0,
        step=LEAST * float(np.std(view.at(effort)[train])) if train.any() else 0.0,
        resolved=None,
        sensor="command",
    )
    z = np.hstack([known, nuisances])
    follows = z @ np.column_stack([solve(z[train], c[train]) for c in terms_at.T])
    design = np.hstack([follows, nuisances])
    beta = solve(design[train], p.y[train])
    k, own, rate = len(labels), terms_at.shape[1], view.rate(reference)
    left = p.y - np.hstack([terms_at, nuisances]) @ beta
    others = np.hstack([terms_at[:, k:], nuisances])
    y = p.y - terms_at[:, :k] @ np.array(list(declared_terms(law).values()))
    if np.std((y - others @ solve(others[train], y[train]))[train]) < CLEARLY * np.std(left[train]):
        # the reference says too little of the gains: with a disturbance the declared ones would leave as much
        follows, design = terms_at, np.hstack([terms_at, nuisances])
        beta = solve(design[train], p.y[train])
        left = p.y - design @ beta
    covariance = block_covariance(design[train], left[train], p.block)[:k, :k]
    p.y = p.y - terms_at @ beta[:own]
    forward = view.at(np.column_stack([rate, view.rate(rate), np.sign(rate)]))
    rms = float(np.sqrt(np.mean(left[train] ** 2))) if train.any() else np.inf
    return Command(p, labels, beta[:k], covariance, follows[:, :k], terms_at[:, :k], forward, rms)


def _per_file(view: View, balance: Problem, integral: bool, unit: str) -> tuple[Array, list[tuple[str, str]]]:
    """(n_fitted, m) and labels: an offset per file; where the law integrates one per piece, because in a gap
    the integral went on unseen, and what it makes of an offset between position and reference."""
    label = view.segment[view.rows] if integral else balance.session
    files = np.column_stack([(label == k).astype(float) for k in np.unique(label)])
    names = [("law_offset", unit)] * files.shape[1]
    if not integral:
        return files, names
    ramps = files * (view.t[view.rows] / max(float(view.t.max()), 1e-300))[:, None]
    return np.hstack([files, ramps]), [*names, *[("law_ramp", unit)] * files.shape[1]]


def _terms(view: View, law: Controller, error: Array) -> tuple[list[tuple[str, str]], list[Array]]:
    """Labels with unit, and full-rate columns, of the gains."""
    unit, place = view.rig.columns["effort"].unit, view.angle_unit
    per = {"p": f"{unit}/{place}", "i": f"{unit}/({place} s)", "d": f"{unit} s/{place}"}
    per |= {"of_error": per["p"], "of_rate": per["d"]}
    per |= {"rate_feedforward": per["d"], "acceleration_feedforward": f"{unit} s2/{place}"}
    forward = view.rate(view.columns["reference"])
    terms = {
        "p": error,
        "i": _integral(view, error),
        "d": view.rate(error),
        "of_error": error,
        "of_rate": -view.rate(view.x),
        "rate_feedforward": forward,
        "acceleration_feedforward": view.rate(forward),
    }
    names = [name.removeprefix("gain_") for name in declared_terms(law)]
    return [(f"gain_{k}", per[k]) for k in names], [terms[k] for k in names]


def _known(view: View, reference: Array) -> Array:
    """(n, m): what a loop makes of its reference and of friction that follows it: both, their rates, and both
    behind lags."""
    rate = view.rate(reference)
    out = [_integral(view, reference)]
    for drive in (reference, np.sign(rate)):
        out += [drive, view.rate(drive), view.second(drive)]
        out += [_lagged(view, drive, steps * view.period_s) for steps in LAGS]
    return np.column_stack(out)


def _lagged(view: View, drive: Array, lag_s: float) -> Array:
    """Behind a first-order lag, beginning settled."""
    keep = np.exp(-view.period_s / lag_s)
    out = np.zeros_like(drive)
    for a, b in pieces(view.segment):
        out[a:b] = lfilter([1.0 - keep], [1.0, -keep], drive[a:b], zi=[keep * drive[a]])[0]
    return out


def _integral(view: View, error: Array) -> Array:
    out = np.zeros(len(error))
    for a, b in pieces(view.segment):
        out[a:b] = np.cumsum(error[a:b]) * view.period_s
    return out


def declared_terms(law: Controller) -> dict[str, float]:
    """The declared size of every term of the law, by its label."""
    gains = dict(law.gains)
    if law.law == "cascade":
        velocity = gains.pop("velocity")
        gains = {"of_error": velocity * gains.pop("position"), "of_rate": velocity} | gains
    return {f"gain_{k}": v for k, v in gains.items()}
