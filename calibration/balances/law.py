"""A controller's law, and the command of a rig against the one that its controller is declared to have.

    pid      u = p e + i int(e) + d de/dt          e = reference - position
    cascade  u = velocity (position e - v)

Columns go through the balance's filter. Gains are fitted to what follows the reference, beside the rate's
lateness; what is left acts in front of the logged effort.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import lfilter

from calibration.arrays import Array
from calibration.balances.filters import by_piece
from calibration.balances.problem import Estimate, Problem
from calibration.balances.thresholds import FEWEST_MOVING, STRAY
from calibration.balances.view import View
from calibration.inputs.declaration import Controller
from calibration.statistics.regression import block_covariance, solve

# of the command's rms: less is rounding. ASSUMPTION; EMPS, whose law is published, is left with 0.0003
LEAST = 0.003
CLEARLY = 0.5  # of what another explanation leaves: more decides nothing. ASSUMPTION
AT_LIMIT = 0.97  # of the limit: noise is on it. ASSUMPTION
# of the moving rows, below whose speed gains may be others (development seeds 1055, 1056 and 1062)
PARTS = (0.03, 0.06, 0.1, 0.15, 0.2, 0.25, 0.35, 0.5, 0.75)
# rows of the lags that the reference is seen through: loops answer in three to a thousand. ASSUMPTION
LAGS = (3, 10, 30, 100, 300, 1000)


@dataclass(frozen=True)
class Rate:
    """Speeds (n,) below one of `limits` of which a law may have other gains; all in `unit`."""

    speed: Array
    limits: Sequence[float]
    unit: str


@dataclass(frozen=True, kw_only=True)
class Law:
    """A command less its law: `terms` (n, k), `labels` of their gains, `rates` by their limit's name."""

    problem: Problem
    labels: list[tuple[str, str]]
    terms: Array
    rates: Mapping[str, Rate]


@dataclass(frozen=True, kw_only=True)
class Command(Law):
    """Of a rig: the base is an offset per file, or per piece where the law integrates.

    `gains` (k,) by `labels`, `sizes` with their errors. `follows` (n, k): terms that follow the reference.
    `forward` (n, 3): feed-forward of rate, acceleration and friction; `rms` of the fitted residual.
    """

    gains: Array
    sizes: list[Estimate]
    follows: Array
    forward: Array
    rms: float


def command_of(view: View, balance: Problem, law: Controller) -> Command:
    """The law with the position of the row, or of one beside it, that the command was made of: the log
    writer's choice. Where the residual does not tell, the one whose gains are the declared ones."""
    known = view.at(_known(view, view.columns["reference"]))
    tried = [_command_of(view, balance, law, known, rows) for rows in (0, 1, -1)]
    least = min(c.rms for c in tried)
    declared = np.array(list(declared_terms(law).values()))
    scale = np.where(declared != 0, declared, 1.0)
    good = [c for c in tried if c.rms <= least / CLEARLY]
    return min(good, key=lambda c: float(np.sum((c.gains / scale - declared / scale) ** 2)))


def _command_of(view: View, balance: Problem, law: Controller, known: Array, before: int) -> Command:
    """Two-stage least squares with the position `before` rows earlier and instruments `known` (n_fitted, m).

    A disturbance of the command moves the drive, and the error that the law sees has it, too. Least squares
    would read it into the gains. The reference does not know of it, so only what follows the reference
    counts. These are instruments (Van den Hof 1998; Janot, Gautier, Brunot 2019 for a drive's own
    parameters).
    """
    moved = {**view.columns, "position": view.delayed(view.x, -before * view.period_s)}
    view = replace(view, columns=moved)
    reference = view.columns["reference"]
    labels, full = _terms(view, law, reference - view.x)
    sizes = np.array(list(declared_terms(law).values()))
    terms_at = view.at(np.column_stack([full, *_late(view, law, full @ sizes)]))
    p = _against_the_law(view, balance, law)
    nuisances, train = p.base, p.valid & ~p.held
    z = np.hstack([known, nuisances])
    follows = z @ np.column_stack([solve(z[train], c[train]) for c in terms_at.T])
    design = np.hstack([follows, nuisances])
    beta = solve(design[train], p.y[train])
    k, own, rate = len(labels), terms_at.shape[1], view.rate(reference)
    left = p.y - np.hstack([terms_at, nuisances]) @ beta
    others = np.hstack([terms_at[:, k:], nuisances])
    y = p.y - terms_at[:, :k] @ sizes
    if np.std((y - others @ solve(others[train], y[train]))[train]) < CLEARLY * np.std(left[train]):
        # the reference says too little of the gains: with a disturbance the declared ones would leave as much
        follows, design = terms_at, np.hstack([terms_at, nuisances])
        beta = solve(design[train], p.y[train])
        left = p.y - design @ beta
    variances = np.diag(block_covariance(design[train], left[train], p.block))
    errors = np.sqrt(np.maximum(variances[:k], 0.0))
    p.y = p.y - terms_at @ beta[:own]
    forward = view.at(np.column_stack([rate, view.rate(rate), np.sign(rate)]))
    rms = float(np.sqrt(np.mean(left[train] ** 2))) if train.any() else np.inf
    return Command(
        problem=p,
        labels=labels,
        terms=terms_at[:, :k],
        rates=_rates(view, p),
        gains=beta[:k],
        sizes=[Estimate(float(g), float(e)) for g, e in zip(beta[:k], errors, strict=True)],
        follows=follows[:, :k],
        forward=forward,
        rms=rms,
    )


def _late(view: View, law: Controller, declared: Array) -> list[Array]:
    """Columns (n,) of lags: of a rate's own filter, and of all where no rate's gain would read it as less.
    declared: the law's output (n,)."""
    error = view.columns["reference"] - view.x
    own = [view.second(view.x)] if law.law == "cascade" else [-view.second(error)] * ("d" in law.gains)
    return own if "d" in law.gains or "rate_feedforward" in law.gains else [*own, -view.rate(declared)]


def _against_the_law(view: View, balance: Problem, law: Controller) -> Problem:
    """The effort on the rows of `balance` that are not at the law's limit, beside what is each file's own."""
    effort, unit = view.columns["effort"], view.rig.columns["effort"].unit
    nuisances, names = _per_file(view, balance, "i" in law.gains, unit)
    ok, y = view.ok[view.rows], view.at(effort)
    if law.limit is not None:
        ok &= view.at((np.abs(effort) > AT_LIMIT * law.limit).astype(float)) < STRAY
    train = ok & ~balance.held
    return replace(
        balance,
        channel="S",
        unit=unit,
        y=y,
        base=nuisances,
        base_labels=names,
        valid=ok,
        fresh=nuisances,
        floor=0.0,
        step=LEAST * float(np.std(y[train])) if train.any() else 0.0,
        resolved=None,
    )


def _rates(view: View, p: Problem) -> dict[str, Rate]:
    """Speeds of the reference and of the drive, where it moves for long enough."""
    speeds = {
        "reference_speed_limit": np.abs(view.at(view.rate(view.columns["reference"]))),
        "speed_limit": np.abs(view.speed[view.rows]),
    }
    moving = {name: x[p.train & (x > view.slow)] for name, x in speeds.items()}
    return {
        name: Rate(x, np.quantile(moving[name], PARTS).tolist(), f"{view.angle_unit}/s")
        for name, x in speeds.items()
        if len(moving[name]) >= FEWEST_MOVING
    }


def _per_file(view: View, balance: Problem, integral: bool, unit: str) -> tuple[Array, list[tuple[str, str]]]:
    """(n_fitted, m) and labels: an offset per file; where the law integrates, an offset and a ramp per piece.

    In a gap the integral went on unseen, hence the pieces. The ramp is what the law makes of an offset
    between position and reference.
    """
    label = view.segment[view.rows] if integral else balance.session
    files = np.column_stack([(label == k).astype(float) for k in np.unique(label)])
    names = [("law_offset", unit)] * files.shape[1]
    if not integral:
        return files, names
    ramps = files * (view.t[view.rows] / max(float(view.t.max()), 1e-300))[:, None]
    return np.hstack([files, ramps]), [*names, *[("law_ramp", unit)] * files.shape[1]]


def _terms(view: View, law: Controller, error: Array) -> tuple[list[tuple[str, str]], Array]:
    """Labels with unit, and full-rate columns (n, k), of the gains."""
    unit, place = view.rig.columns["effort"].unit, view.angle_unit
    forward = view.rate(view.columns["reference"])
    terms = {
        "gain_p": (f"{unit}/{place}", error),
        "gain_i": (f"{unit}/({place} s)", _integral(view, error)),
        "gain_d": (f"{unit} s/{place}", view.rate(error)),
        "gain_of_error": (f"{unit}/{place}", error),
        "gain_of_rate": (f"{unit} s/{place}", -view.rate(view.x)),
        "gain_rate_feedforward": (f"{unit} s/{place}", forward),
        "gain_acceleration_feedforward": (f"{unit} s2/{place}", view.rate(forward)),
    }
    used = {k: terms[k] for k in declared_terms(law)}
    return [(k, unit) for k, (unit, _) in used.items()], np.column_stack([x for _, x in used.values()])


def _known(view: View, reference: Array) -> Array:
    """(n, m): reference and friction that follows it, their rates, and both behind lags."""
    rate = view.rate(reference)
    out = [_integral(view, reference)]
    for drive in (reference, np.sign(rate)):
        out += [drive, view.rate(drive), view.second(drive)]
        out += [_lagged(view, drive, rows) for rows in LAGS]
    return np.column_stack(out)


def _lagged(view: View, drive: Array, rows: float) -> Array:
    """Behind a first-order lag, beginning settled."""
    keep = np.exp(-1 / rows)
    b, a = [1.0 - keep], [1.0, -keep]
    return by_piece(drive, view.segment, lambda x: lfilter(b, a, x, zi=[keep * x[0]])[0])


def _integral(view: View, error: Array) -> Array:
    return by_piece(error, view.segment, lambda x: np.cumsum(x) * view.period_s)


def declared_terms(law: Controller) -> dict[str, float]:
    """The declared size of every term of the law, by its label."""
    gains = dict(law.gains)
    if law.law == "cascade":
        velocity = gains.pop("velocity")
        gains = {"of_error": velocity * gains.pop("position"), "of_rate": velocity, **gains}
    return {f"gain_{k}": v for k, v in gains.items()}
