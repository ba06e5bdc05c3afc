"""From coefficients to parameters with 95 % intervals."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.special import chndtrix

from calibration.arrays import Array
from calibration.balances.candidate import pairs_by_section
from calibration.decide import thresholds as limits
from calibration.decide.accept import tied_at_last
from calibration.decide.refine import slopes, unseen
from calibration.decide.scan import Contender
from calibration.decide.selection import Selection
from calibration.finding import UNKNOWN, Finding, Parameter
from calibration.statistics.tails import student_reach


def interval(value: float, error: float, blocks: int, model: float | None = None) -> tuple[float, float]:
    """Student's 95 % interval, as free as there are blocks; `model` error: MODEL_ERROR unless given."""
    error = float(np.hypot(error, limits.MODEL_ERROR * value if model is None else model))
    reach = student_reach(max(blocks - 2, limits.FEWEST_FREEDOM)) * error
    return value - reach, value + reach


def parameters_of(s: Selection, k: int) -> dict[str, Parameter]:
    """Parameters of the chosen effect `k`, from the joint fit of all of them."""
    c = s.candidates[k]
    if c.kind == "line" or c.per_run:
        return _waves(s, k) | _nonlinear(s, k)
    sizes = {
        name: Parameter(float(value), unit, *interval(float(value), float(error), s.problem.blocks))
        for (name, unit), value, error in zip(c.labels, s.sizes(k), s.after.errors[s.at(k)], strict=False)
    }
    return sizes | _nonlinear(s, k)


def _nonlinear(s: Selection, k: int) -> dict[str, Parameter]:
    """Intervals of refined parameters from a joint fit with their slopes; grid parameters have none."""
    p, c = s.problem, s.candidates[k]
    out = {name: Parameter(value, unit) for name, (value, unit) in c.fixed.items()}
    if not c.steps:
        return out
    fit = p.fit(np.hstack([s.columns, slopes(c, s.sizes(k))]))
    for name, error, step in zip(c.free, fit.errors[-len(c.steps) :], c.steps, strict=True):
        value, unit = c.fixed[name]
        out[name] = Parameter(value, unit, *interval(value, float(error), p.blocks, limits.STEP_ERROR * step))
    if "duration" in out and out["duration"].value < 0.0:  # any length below a second is a step of one
        out["duration"] = Parameter(0.0, out["duration"].unit)
    stretch = unseen(p, c)
    if stretch is not None:
        out["start"] = Parameter(*c.fixed["start"], *stretch)
        out |= {"duration": Parameter(*c.fixed["duration"])} if "duration" in out else {}
    return out


def _waves(s: Selection, k: int) -> dict[str, Parameter]:
    """Amplitude of every harmonic; its phase too where there is one section, else it is a nuisance."""
    labels, sections = s.candidates[k].labels, pairs_by_section(s.candidates[k].columns)
    beta, cov = s.sizes(k), s.covariance(k)
    out: dict[str, Parameter] = {}
    for h in range(min(max(len(x) for x in sections), limits.MOST_WAVES)):
        name, unit = labels[min(h, len(labels) - 1)]
        word = "" if h < len(labels) else f"_{h + 1}"
        pairs = [slice(x[h], x[h] + 2) for x in sections if len(x) > h]
        if len(pairs) > 1:
            found = [amplitude_interval(beta[at], cov[at, at], s.problem.blocks) for at in pairs]
            out[name + word] = _common(found, labels[0][1])
            continue
        phase_name = f"{name}_phase" if 0 < h < len(labels) else "phase" + word
        at = pairs[0]
        out[name + word], out[phase_name] = _wave(beta[at], cov[at, at], s.problem.blocks, unit)
    return out


def _wave(
    beta: Array, cov: Array, blocks: int, unit: str, model: float | None = None
) -> tuple[Parameter, Parameter]:
    """Amplitude and phase of a sine pair; `model` error of the phase as in `interval`."""
    value, low, high = amplitude_interval(beta, cov, blocks)
    phase = float(np.arctan2(-beta[1], beta[0]))
    around = interval(phase, min(_spread(cov) / max(value, 1e-300), 2.0), blocks, model)
    return Parameter(value, unit, low, high), Parameter(phase, "rad", *around)


def _spread(cov: Array) -> float:
    """Standard error of either coefficient of a sine pair."""
    return float(np.sqrt(max(np.trace(cov) / 2, 0.0)))


def _common(found: Sequence[tuple[float, float, float]], unit: str) -> Parameter:
    """One amplitude of several sections' (value, low, high); those that hardly show it do not count."""
    least = limits.SHOWN_SECTION * max(value for value, _, _ in found)
    seen = np.array([x for x in found if x[0] > least]).reshape(-1, 3)
    value = float(seen[:, 0].mean()) if len(seen) else 0.0
    half = float(np.linalg.norm(seen[:, 2] - seen[:, 1])) / 2 / max(len(seen), 1)
    return Parameter(value, unit, max(value - half, 0.0), value + half)


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


def finding_of(s: Selection, k: int) -> Finding:
    """The chosen effect as a finding, with the names, or the own name elsewhere, that tie with it."""
    x, c = s.chosen[k], s.candidates[k]
    confounded = tied_at_last(s, k)
    tied = [e for e in confounded if e.candidate.key == c.key]
    others = [*(e.candidate.name for e in confounded), *c.twins]
    return Finding(
        c.name,
        s.problem.channel,
        c.domain,
        stage=c.stage,
        harmonic=c.harmonic,
        order=c.at_order,
        frequency=c.at_frequency,
        equivalent=[*(e.candidate.name for e in tied[:1]), *dict.fromkeys(n for n in others if n != c.name)],
        parameters=parameters_of(s, k),
        evidence=x.evidence,
        share=x.held.share,
        note="; ".join(filter(None, [c.note, *(f"fits exactly as well: {_told(e)}" for e in tied)])),
    )


def _told(x: Contender) -> str:
    """Sizes and place of an effect, for people, in its parameters' units."""
    sizes = {name: size for (name, _), size in zip(x.candidate.labels, x.fit.beta[x.at], strict=False)}
    return ", ".join(f"{name} {value:.3g}" for name, value in {**sizes, **x.candidate.place}.items())


def _helps(s: Selection, k: int, part: slice) -> bool:
    """Whether these columns of the chosen effect `k` take something off the rows that are held out."""
    test = s.problem.test
    mine = s.candidates[k].columns[test, part] @ s.sizes(k)[part]
    return not test.any() or float(mine @ (2 * s.model.left_out(s.problem) + mine)) > 0


def findings_of(s: Selection, k: int) -> list[Finding]:
    """The chosen effect as findings: one, or each harmonic of a stage that was taken as one candidate."""
    c, whole = s.candidates[k], finding_of(s, k)
    sections = pairs_by_section(c.columns) if c.kind == "line" else [[]]
    pairs = min(len(section) for section in sections)
    if c.name == UNKNOWN:  # of its order is the first harmonic alone
        return [replace(whole, order=None) if pairs > 1 else whole]
    if c.harmonic is not None or c.stage is None or pairs < 2:
        return [whole]
    beta, cov, (size, unit) = s.sizes(k), s.covariance(k), c.labels[0]
    out = []
    for h in range(pairs):
        pair = [slice(section[h], section[h] + 2) for section in sections]
        waves = [(*_wave(beta[x], cov[x, x], s.problem.blocks, unit, 0.0), _spread(cov[x, x])) for x in pair]
        # the phase is the section's that shows the line best: one that is held out shows none
        amplitude, phase, spread = max(waves, key=lambda w: w[0].value)
        seen = pairs <= limits.MOST_WAVES or amplitude.value >= limits.CLEAR_Z * spread
        if seen and (len(pair) > 1 or _helps(s, k, pair[0])):
            order = c.order * (h + 1) if c.order else None
            sizes = {size: amplitude, "phase": phase}
            out.append(replace(whole, harmonic=h + 1, order=order, parameters=sizes))
    out.sort(key=lambda f: -f.parameters[size].value)
    sizes_of = [f.parameters[size] for f in out]
    # neither a trifle nor one whose interval holds zero is told beside those that show
    good = [
        (x.low or 0.0) > 0.0 and (x.high or x.value) ** 2 > limits.ROUNDING * sizes_of[0].value ** 2
        for x in sizes_of
    ]
    return [f for f, shows in zip(out, good, strict=True) if shows] or out[:1] or [whole]
