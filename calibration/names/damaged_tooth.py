"""A short pulse once per turn of one part: a damaged tooth."""

from typing import Any

import numpy as np

from calibration.inputs.declaration import Stage
from calibration.inputs.train import MESH, SHAFT
from calibration.names.name import Array, Beside, Candidate, Facts, Finding, Made, Name, Scene, tried, value
from calibration.names.scene import FORCE, SPEED

ENOUGH = 0.9  # turns of the part. ASSUMPTION
SWEPT = 0.12  # of a turn per fitted row: quicker, a tooth is not seen. ASSUMPTION
KEEP = 3  # pulses of a part that are tried. ASSUMPTION
LEAST = 14.0  # -log10 p: a place and a width are searched for on every part. ASSUMPTION
# parts of a turn, full width of a raised cosine. ASSUMPTION
WIDTHS = (0.006, 0.0085, 0.012, 0.018, 0.027, 0.04, 0.06, 0.085)
BINS = 240  # bins of a turn, in which the residual is folded. ASSUMPTION
STEP_TURN = 0.003  # of a turn, step of a pulse's place in its refinement. ASSUMPTION
STEP_WIDTH = 0.1  # part of its width, likewise. ASSUMPTION
LEAST_WEIGHT = 3  # rows, as a pulse weighs them: fewer are a spike. ASSUMPTION
FEWEST_ROWS = 50  # that are slow enough: fewer have no tooth's shape. ASSUMPTION


def columns(s: Scene) -> list[Candidate]:
    """The best few pulses on every declared part that turns about once in the log."""
    stages = [g for g in s.view.rig.stages if g.period]
    if s.pair is not None:
        stages = [g for g in stages if g.name in s.pair.train.toothed]
    return [c for g in stages for c in _on(s, g, 1.0 / (g.period or 1.0))]


def _on(s: Scene, stage: Stage, rate: float) -> list[Candidate]:
    """On one part, of `rate` turns per position unit."""
    v, p = s.view, s.problem
    of_motor = stage.of_motor if s.pair is None else stage.name == s.pair.train.motor
    if s.span * rate < ENOUGH:
        return []
    phase = v.x * rate
    row = np.abs(v.speed) * rate * v.period_s  # turns that a full-rate row sweeps
    ok = p.train & (row[v.rows] * max(v.step, v.sigma) < SWEPT)
    if ok.sum() < FEWEST_ROWS:
        return []

    def full(q: Array) -> Array:  # what the response has beside it is minus what acts on the axis
        return -pulse(phase, float(q[0]), max(float(q[1]), 0.002), row)

    place: dict[str, Any] = {"stage": stage.name, "order": rate * s.turn, "least": LEAST}
    place["domain"] = "motor_angle" if of_motor else None
    out, size = [], ("amplitude", s.unit)
    for centre, width in folded(phase[v.rows][ok], s.residual[ok], KEEP):
        at = {"phase": (centre, "turn"), "width": (width, "turn")}
        steps = (STEP_TURN, STEP_WIDTH * width)
        out.append(tried(NAME.name, s.shaped(full), size, at=at, steps=steps, **place))
    return out


def pulse(phase_turns: Array, centre: float, width: float, reach: Array) -> Array:
    """Raised cosine of full width `width` turns at `centre`, widened to what one row sweeps (`reach`)."""
    away = np.abs((phase_turns - centre + 0.5) % 1.0 - 0.5)
    wide = np.maximum(width, reach)
    return np.asarray(
        np.where(away < wide / 2, 0.5 * (1 + np.cos(2 * np.pi * away / wide)), 0.0) * width / wide
    )


def folded(phase: Array, e: Array, keep: int) -> list[tuple[float, float]]:
    """Centre and width, turns, of the `keep` pulses that take most off the residual e(phase), both (n,)."""
    from scipy.ndimage import correlate1d

    ranked = []
    place = (phase % 1.0 * BINS).astype(np.int64) % BINS
    total, count = np.bincount(place, e, BINS), np.bincount(place, minlength=BINS).astype(float)
    for width in WIDTHS:
        kernel = pulse((np.arange(BINS) + 0.5) / BINS, 0.5, width, np.full(BINS, 1.5 / BINS))
        hit, weight = (correlate1d(x, k, mode="wrap") for x, k in ((total, kernel), (count, kernel**2)))
        score = np.where(weight > LEAST_WEIGHT, hit**2 / np.maximum(weight, LEAST_WEIGHT), 0.0)
        k = int(np.argmax(score))
        ranked.append((float(score[k]), k / BINS, width))
    return [(centre, width) for _, centre, width in sorted(ranked, reverse=True)[:keep]]


def to_plant(f: Finding, facts: Facts) -> Made:
    """A raised cosine of full width w turns is a Gaussian of the same height and area."""
    phase, width = 2 * np.pi * value(f, "phase"), 2 * np.pi * value(f, "width") / (2 * np.sqrt(2 * np.pi))
    return Made().added(f, facts, amplitude=value(f, "amplitude"), phase=phase, width=width)


def lacks(s: Scene) -> str:
    """A part, and a turn of it."""
    turns = [s.span / g.period for g in s.view.rig.stages if g.period]
    return "" if turns and max(turns) >= ENOUGH else "a declared stage with its period, and a turn of it"


NAME = Name(
    name="damaged_tooth",
    channels=(FORCE, SPEED),
    columns=columns,
    to_plant=to_plant,
    experiment="turn the part slowly, both ways: a tooth is a pulse at one place, an eccentric part a sine",
    lacks=lacks,
    beside=Beside(single=True, shadows={"K": (SHAFT, MESH)}),
)
