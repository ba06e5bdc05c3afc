"""From coefficients to parameters with 95 % intervals."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import chndtrix

from calibration.candidates.candidate import Candidate
from calibration.decide.accept import MODEL_ERROR
from calibration.decide.refine import slopes
from calibration.decide.scan import Contender
from calibration.decide.select import Selection
from calibration.decide.unseen import unseen
from calibration.finding import Finding, Parameter
from calibration.readers.run import Array
from calibration.statistics.regression import gls
from calibration.statistics.tails import student_reach

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
    if candidate.kind == "line" or candidate.per_run:
        sections = pairs_by_section(candidate.columns)
        out = _waves(candidate, beta, cov, blocks, sections)
    else:
        for k, (name, unit) in enumerate(candidate.labels):
            low, high = interval(float(beta[k]), float(np.sqrt(cov[k, k])), blocks)
            out[name] = Parameter(float(beta[k]), unit, low, high)
    return out | _nonlinear(selection, index, blocks)


def _nonlinear(selection: Selection, index: int, blocks: int) -> dict[str, Parameter]:
    """Intervals of refined parameters from a joint fit with their slopes; grid parameters have none."""
    problem, candidate = selection.problem, selection.chosen[index].candidate
    out = {name: Parameter(value, unit) for name, (value, unit) in candidate.fixed.items()}
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
    if "ramp" in out and out["ramp"].value < 0.0:  # any length below a second is a step of one
        out["ramp"] = Parameter(0.0, out["ramp"].unit)
    stretch = unseen(problem, candidate)
    if stretch is not None:
        out["onset"] = Parameter(*candidate.fixed["onset"], *stretch)
        out |= {"ramp": Parameter(*candidate.fixed["ramp"])} if "ramp" in out else {}
    return out


MOST_WAVES = 6  # sine pairs of one section that are told


def pairs_by_section(columns: Array) -> list[list[int]]:
    """First columns of the sine pairs of every section: pairs that live on the same rows are harmonics of
    one section, a pair on rows of its own is the same sine in another one."""
    rows: list[Array] = []
    out: list[list[int]] = []
    for k in range(0, columns.shape[1] - 1, 2):
        here = np.flatnonzero(np.any(columns[:, k : k + 2] != 0, axis=1))
        ends = here[[0, -1]].astype(float) if len(here) else np.zeros(2)
        for j, other in enumerate(rows):
            if ends[0] <= other[1] and other[0] <= ends[1]:
                out[j].append(k)
                break
        else:
            rows.append(ends)
            out.append([k])
    return out


def _waves(
    candidate: Candidate, beta: Array, cov: Array, blocks: int, sections: list[list[int]]
) -> dict[str, Parameter]:
    """Amplitude of every harmonic, one for all sections, and its phase where there is one section only: a
    section's phase is a nuisance."""
    out: dict[str, Parameter] = {}
    name, unit = candidate.labels[0]
    for h in range(min(max(len(s) for s in sections), MOST_WAVES)):
        word = "" if h == 0 else f"_{h + 1}"
        here = [s[h] for s in sections if len(s) > h]
        if len(here) > 1:
            out[name + word] = _common_amplitude(candidate, beta, cov, blocks, here)
            continue
        pair = slice(here[0], here[0] + 2)
        amplitude, low, high = amplitude_interval(beta[pair], cov[pair, pair], blocks)
        out[name + word] = Parameter(amplitude, unit, low, high)
        phase = float(np.arctan2(-beta[pair][1], beta[pair][0]))
        spread = float(np.sqrt(np.trace(cov[pair, pair]) / 2)) / max(amplitude, 1e-300)
        low, high = interval(phase, min(spread, 2.0), blocks)
        out["phase" + word] = Parameter(phase, "rad", low, high)
    return out


def _common_amplitude(
    candidate: Candidate, beta: Array, cov: Array, blocks: int, pairs: Sequence[int]
) -> Parameter:
    """One amplitude of a line whose phase is every section's own; sections that hardly show it do not
    count."""
    found = []
    top = max(float(np.hypot(beta[k], beta[k + 1])) for k in pairs)
    for k in pairs:
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
        c.fixed["order"][0] if "order" in c.fixed else c.order,
        c.frequency,
        equivalent,
        parameters_of(selection, index),
        contender.evidence,
        step.share,
    )
