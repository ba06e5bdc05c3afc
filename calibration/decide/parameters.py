"""From coefficients to parameters with 95 % intervals."""

from __future__ import annotations

import numpy as np
from scipy.special import chndtrix

from calibration.candidates.candidate import Candidate
from calibration.decide.finding import Finding, Parameter
from calibration.decide.refine import slopes
from calibration.decide.scan import Contender
from calibration.decide.select import Selection
from calibration.readers.run import Array
from calibration.statistics.regression import gls
from calibration.statistics.tails import student_reach

# of a value, standard error: what the declared model itself is wrong by along a measured motion. From
# development logs,
# where estimates scatter by this much about the truth when the noise alone would allow a tenth of it
MODEL_ERROR = 0.03
STEP_ERROR = 0.15  # of a nonlinear parameter's small step, likewise


def interval(value: float, error: float, blocks: int, model: float | None = None) -> tuple[float, float]:
    """Student's 95 % interval with as many degrees of freedom as there are blocks; `model` is the model's own
    error, MODEL_ERROR of the value unless given."""
    error = float(np.hypot(error, MODEL_ERROR * value if model is None else model))
    reach = student_reach(max(blocks - 2, 3)) * error
    return value - reach, value + reach


def parameters_of(selection: Selection, index: int) -> dict[str, Parameter]:
    """Parameters of the selection's chosen effect `index`, from the joint fit of all of them."""
    problem = selection.problem
    at = problem.base.shape[1] + sum(c.candidate.width for c in selection.chosen[:index])
    candidate = selection.chosen[index].candidate
    where = slice(at, at + candidate.width)
    beta, cov = selection.after.beta[where], selection.after.covariance[where, where]
    blocks = int(problem.train.sum() / problem.block)
    out: dict[str, Parameter] = {}
    if candidate.per_run:
        out["amplitude"] = _common_amplitude(candidate, beta, cov, blocks)
    elif candidate.kind == "line":
        for k in range(min(candidate.width // 2, 6)):
            name, unit = candidate.labels[0]
            pair = slice(2 * k, 2 * k + 2)
            amplitude, low, high = amplitude_interval(beta[pair], cov[pair, pair], blocks)
            out[name if k == 0 else f"{name}_{k + 1}"] = Parameter(amplitude, unit, low, high)
            phase = float(np.arctan2(-beta[2 * k + 1], beta[2 * k]))
            spread = float(np.sqrt(np.trace(cov[pair, pair]) / 2)) / max(amplitude, 1e-300)
            low, high = interval(phase, min(spread, 2.0), blocks)
            out["phase" if k == 0 else f"phase_{k + 1}"] = Parameter(phase, "rad", low, high)
    else:
        for k, (name, unit) in enumerate(candidate.labels):
            low, high = interval(float(beta[k]), float(np.sqrt(cov[k, k])), blocks)
            out[name] = Parameter(float(beta[k]), unit, low, high)
    return out | _nonlinear(selection, index, blocks)


def _nonlinear(selection: Selection, index: int, blocks: int) -> dict[str, Parameter]:
    """Intervals of refined parameters from a joint fit with their slopes; grid parameters are given as they
    are."""
    problem, candidate = selection.problem, selection.chosen[index].candidate
    out = {name: Parameter(value, unit, value, value) for name, (value, unit) in candidate.fixed.items()}
    if not candidate.steps:
        return out
    at = problem.base.shape[1] + sum(c.candidate.width for c in selection.chosen[:index])
    extra = slopes(candidate, selection.after.beta[at : at + candidate.width])
    x = np.hstack([problem.base, *[c.candidate.columns for c in selection.chosen], extra])
    fit = gls(problem.y, x, problem.train, problem.ar_order, problem.block)
    for k, name in enumerate(list(candidate.fixed)[: len(candidate.steps)]):
        value, unit = candidate.fixed[name]
        error = float(np.sqrt(fit.covariance[-len(candidate.steps) + k, -len(candidate.steps) + k]))
        low, high = interval(value, error, blocks, STEP_ERROR * candidate.steps[k])
        out[name] = Parameter(value, unit, low, high)
    return out


def _common_amplitude(candidate: Candidate, beta: Array, cov: Array, blocks: int) -> Parameter:
    """One amplitude of a line whose phase is every run's own; runs that hardly show it do not count."""
    found = []
    top = max(float(np.hypot(beta[k], beta[k + 1])) for k in range(0, candidate.width, 2))
    for k in range(0, candidate.width, 2):
        pair = slice(k, k + 2)
        if float(np.hypot(*beta[pair])) > 0.2 * top:
            value, low, high = amplitude_interval(beta[pair], cov[pair, pair], blocks)
            found.append((value, high - low))
    value = float(np.mean([v for v, _ in found])) if found else 0.0
    half = float(np.sqrt(np.sum([w**2 for _, w in found]))) / 2 / max(len(found), 1)
    return Parameter(value, candidate.labels[0][1], value - half, value + half)


def amplitude_interval(beta: Array, cov: Array, blocks: int) -> tuple[float, float, float]:
    """Amplitude of a sine pair with an interval that does not pretend a small line is a sure one."""
    amplitude = float(np.hypot(beta[0], beta[1]))
    variance = float(beta @ cov @ beta) / max(amplitude**2, 1e-300)
    error = float(np.sqrt(max(variance, 1e-300)))
    low, high = interval(amplitude, error, blocks)
    if low <= 0:
        low = 0.0
        high = max(high, error * float(np.sqrt(chndtrix(0.95, 2, (amplitude / error) ** 2))))
    return amplitude, low, high


def finding_of(selection: Selection, index: int, name: str | None = None) -> Finding:
    """The chosen effect as a finding, with the names the log cannot separate from it."""
    contender: Contender = selection.chosen[index]
    c: Candidate = contender.candidate
    names = [e.candidate.name for e in selection.classes[index]] + list(c.twins)
    equivalent = [n for n in dict.fromkeys(names) if n != c.name]
    step = selection.steps[index] if index < len(selection.steps) else selection.held
    return Finding(
        name or c.name,
        selection.problem.channel,
        c.domain,
        c.stage,
        c.harmonic,
        c.order,
        c.frequency,
        equivalent,
        parameters_of(selection, index),
        contender.evidence,
        step.share,
    )
