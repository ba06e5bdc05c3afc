"""Smooth functions of every domain: what an effect outside the catalogue enters the plant as."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from calibration.balances.candidate import waves
from calibration.balances.frame import Frame
from calibration.balances.recursions import stop_operator
from calibration.balances.view import View
from calibration.finding import UNKNOWN, Finding, of_columns
from calibration.names.gravity_imbalance import gravity
from calibration.names.lines import ON_CLOCK, SLOWEST_HZ, on_clock
from calibration.names.name import FORCE, SENSORS, VOLTS, Array, Beside, Candidate, Name, Scene, candidate
from calibration.names.unknown_volts import followed, of_volts
from calibration.names.unnamed import LOOPS, to_plant
from calibration.statistics.orders import PER_ROW, order_spectrum, peaks
from calibration.statistics.tails import middle

# knots of a smooth function. ASSUMPTION: names against what only looks smooth
KNOTS = 8
# knots over time of a scale that moves. ASSUMPTION
SLOW = 4
# part of the usual stroke, of the widest of several loops. ASSUMPTION
WIDTHS = (0.02, 0.05, 0.1, 0.2, 0.4)
# part of the usual stroke, of the loops in a flexible fit. ASSUMPTION
RADII = (0.002, 0.01, 0.05, 0.2)
# rad/s, of an axis with two motors, 10 arcsec/s: quicker, the logarithm of the speed counts. ASSUMPTION
SLOW_RATE = 5e-5
# knots over that logarithm. ASSUMPTION
SPEED_KNOTS = 9
# times 1 / time that lies between them. ASSUMPTION
APART = 3.0
# cycles of such a line within the log, at least. ASSUMPTION
FEWEST_CYCLES = 4
# cycles likewise, at most, for its memory. ASSUMPTION
MOST_CYCLES = 2e5
# harmonics of such a line. ASSUMPTION
HARMONICS = 5


def spline_columns(x: Array, knots: int) -> Array:
    """Cubic B-splines of x over its range, `knots` columns without the constant."""
    from scipy.interpolate import BSpline

    low, high = float(np.min(x)), float(np.max(x))
    if high <= low:
        return np.zeros((len(x), 0))
    inner = np.linspace(low, high, knots - 2)
    full = np.concatenate([[low] * 3, inner, [high] * 3])
    columns = BSpline.design_matrix(np.clip(x, low, high), full, 3).toarray()
    return np.asarray(columns[:, 1:])


def domains(s: Scene) -> list[tuple[str, Array]]:
    """Name and fitted-row values of everything that an effect may be a smooth function of. No domain is the
    response itself, which explains it without saying why. No domain is a place that along one speed is a
    time."""
    v, at = s.view, s.view.rows
    speed = [] if v.response.is_speed else [("velocity", v.speed[at])]
    place = [] if s.span > 0 and on_clock(s, KNOTS / s.span) else [("axis_angle", v.x[at])]
    out: list[tuple[str, Array]] = [*place, *speed, ("time", v.clock[at])]
    if s.both:
        since = v.since[at]
        unit = float(np.quantile(np.abs(since), 0.5)) * 0.05 + 1e-30
        out.append(("reversal", np.sign(since) * np.log1p(np.abs(since) / unit)))
    if s.temperature is not None:
        out.append(("temperature", s.temperature[at]))
    if s.force and s.view.dynamic and v.response.channel != "current":
        out.append(("current", _declared_force(s)))
    efforts = [c for c in ("effort", "current", "force") if c in v.columns and not s.force]
    return out + [("current", s.at(v.columns[c])) for c in efforts]


def _declared_force(s: Scene) -> Array:
    """The response as declared terms and names have it (n_fitted,): a gain that depends on the effort is a
    function of it. Not the response itself, whose noise it would share."""
    return s.declared_part if s.model is None else s.model


def smooth_functions(s: Scene) -> list[Candidate]:
    """`unknown` over every domain; over position and time also odd in direction."""
    out = []
    for domain, x in domains(s):
        columns = spline_columns(x, KNOTS)
        if columns.shape[1] == 0:
            continue
        shapes = [columns]
        if s.both and domain in ("axis_angle", "time"):
            shapes.append(columns * s.view.direction[s.view.rows][:, None])
        if s.force and s.view.dynamic and domain == "axis_angle":
            shapes.append(columns * _declared_force(s)[:, None])
        out += [_over(domain, one, *_each("knot", one, s.unit)) for one in shapes]
    return out


def _over(domain: str, columns: Array, *sizes: tuple[str, str], **more: Any) -> Candidate:
    return candidate(UNKNOWN, columns, *sizes, domain=domain, **more)


def _each(label: str, columns: Array, unit: str) -> list[tuple[str, str]]:
    """A size for every column."""
    return [(f"{label}_{k}", unit) for k in range(columns.shape[1])]


def columns(s: Scene) -> list[Candidate]:
    """Columns beside the names because they would follow it: a scale that moves with time, a spring, lost
    motion. Of a pair: any function of speed and travel, and lines at fixed Hz. Of volts: brushes."""
    if s.windings is not None:
        return of_volts(s)
    if s.pair is None:
        return [*moving_scale(s), *spring(s), *lost_motion(s), *bend(s)]
    return [*_torques(s), *_fixed_lines(s)] if s.force else []


def moving_scale(s: Scene) -> list[Candidate]:
    """Two sensors whose ratio moves with time, steadily or by a smooth function. Thermal growth errs in
    proportion to the distance from where it is held (ISO 230-3). No sensor knows that place, so a drift goes
    with it. A gap and a delay together follow it, too."""
    if s.force:
        return []
    x = s.view.x[s.view.rows]
    x = x - x.mean()
    t = s.problem.t
    span = float(np.ptp(t)) or 1.0
    drift, knots = ((t - t.min()) / span)[:, None], spline_columns(t, SLOW)
    per_place = f"{s.unit}/{s.angle_unit}"
    return [
        _over(
            "time",
            np.hstack([shape * x[:, None], shape]),
            *_each(f"scale_{name}", shape, per_place),
            *_each(f"offset_{name}", shape, s.unit),
        )
        for name, shape in (("drift", drift), ("knot", knots))
        if shape.shape[1]
    ]


def lost_motion(s: Scene) -> list[Candidate]:
    """Two sensors: elastoplastic elements of several widths together (Prandtl-Ishlinskii), the lost motion of
    a strain wave gear (Ruderman, Hoffmann, Bertram 2009). One gap alone is `play`, and cheaper."""
    if s.force or not s.both or s.view.response.ratio == 0:
        return []
    out = []
    for part in WIDTHS:
        radii = [part * s.stroke * f for f in (1.0, 1 / 3, 1 / 9)]
        if radii[-1] >= s.view.resolved:
            sizes = [(f"loop_of_{r:.3g}", s.unit) for r in radii]
            out.append(_over("reversal", s.at(_loops(s.view, radii)), *sizes, searched=1))
    return out


def _loops(v: View, radii: Sequence[float]) -> Array:
    """(n, k) of height 1."""
    return np.column_stack([stop_operator(v.x, v.file, r) / r for r in radii])


def spring(s: Scene) -> list[Candidate]:
    """A force in proportion to the place of a slide (a cable chain, a bellows): wide loops follow it, too."""
    if not s.force or s.view.turn or "stiffness" in (*s.view.rig.estimate, *s.view.rig.constants):
        return []
    size = ("stiffness", f"{s.unit}/{s.angle_unit}")
    return [_over("axis_angle", s.at(s.view.x - s.view.x.mean()), size)]


def bend(s: Scene) -> list[Candidate]:
    """Friction that bends with the speed, as grease and strain wave gears have it: odd, of second order."""
    if not s.force or s.view.response.is_speed or "viscous" not in s.declared:
        return []
    part = s.view.speed / (s.view.top or 1.0)
    return [_over("velocity", s.at(part * np.abs(part)), ("square", s.unit))]


def flexible(s: Scene) -> Array:
    """Columns (n_fitted, k) of a fit that follows anything smooth: what lines are looked for beside."""
    parts = [c.columns for c in smooth_functions(s) if c.domain != "time"]
    return np.hstack([*parts, plain(s)])


def plain(s: Scene) -> Array:
    """Columns (n_fitted, k) of loops, asymmetry and a weight, but nothing that is free over the speed. Along
    one kind of ramp a delay is a function of the speed, too."""
    v = s.view
    parts = [np.zeros((len(s.problem.y), 0))]
    if s.force and s.both:
        parts.append(s.at(np.column_stack([np.abs(v.direction), np.abs(v.speed)])))
        parts.append(s.at(_loops(v, [r * s.stroke for r in RADII])))
    if s.force and v.turn:
        parts.append(s.at(gravity(s)))
    return np.hstack(parts)


def any_friction_curve(s: Scene) -> Array:
    """Columns (n_fitted, 4): powers of the speed, even and odd, for a friction curve of any smooth shape."""
    z = s.view.speed / (float(np.quantile(np.abs(s.view.speed[s.view.ok]), 0.98)) or 1.0)
    return s.at(np.column_stack([z**k for k in (2, 3, 4, 5)]))


def _torques(s: Scene) -> list[Candidate]:
    """Of an axis with two motors: smooth functions of the speed, loops over the travel."""
    assert s.pair is not None
    x, speed = s.view.x[s.view.rows], s.view.speed[s.view.rows]
    session = s.pair.motion.frame.session[s.view.rows]
    w = speed / (float(np.quantile(np.abs(speed), 0.95)) or 1.0)
    knots = spline_columns(np.sign(speed) * np.log1p(np.abs(speed) / SLOW_RATE), SPEED_KNOTS)
    loops = np.column_stack([stop_operator(x, session, r) / r for r in LOOPS])
    return [
        _over("velocity", np.column_stack([w * np.abs(w), w**3]), ("square", s.unit), ("cube", s.unit)),
        _over("velocity", knots, *_each("knot", knots, s.unit)),
        _over("reversal", loops, *_each("loop", loops, s.unit)),
        *(
            _over("reversal", one, ("loop", s.unit), fixed={"travel": (r, "rad")})
            for r, one in zip(LOOPS, loops.T, strict=True)
        ),
    ]


def _fixed_lines(s: Scene) -> list[Candidate]:
    """The strongest lines at fixed Hz, alone and with their harmonics: periodic in time, at every speed."""
    rows, clock = s.problem.train, s.view.clock[s.view.rows]
    span, period_s = float(np.ptp(clock)), s.problem.period_s
    top = min(0.5 / period_s, MOST_CYCLES / max(span, 1.0))
    hertz, power = order_spectrum(np.where(rows, s.residual, 0.0), clock, rows.astype(float), top)
    power = np.where(hertz < max(SLOWEST_HZ, FEWEST_CYCLES / span), 0.0, power)
    out = []
    for f0 in peaks(hertz, power, ON_CLOCK, APART / span):
        most = HARMONICS if f0 * HARMONICS < PER_ROW / period_s else 1
        for count in sorted({1, most}):
            wave = waves(2 * np.pi * f0 * clock, range(1, count + 1))
            at: dict[str, Any] = {"frequency": f0, "fixed": {"frequency": (f0, "Hz")}}
            out.append(_over("time", wave, ("amplitude", s.unit), kind="line", **at))
    return out


def clock_jumps(frame: Frame) -> Finding | None:
    """Stamps that jump while the motion goes on: no effect of the catalogue, and no row that was lost."""
    if not frame.jumps:
        return None
    sizes = np.abs(frame.jumps)
    note = (
        f"{len(sizes)} stamps jump while the position goes on by one row: the clock's fault, no row is lost"
    )
    # of one row's travel in place of so many: the chance of each is one in as many rows
    evidence = float(np.log10(sizes / frame.period_s + 1.0).sum())
    return of_columns(UNKNOWN, {"jump": middle(sizes, "s")}, evidence, note=note)


NAME = Name(
    name=UNKNOWN,
    channels=(FORCE, SENSORS, VOLTS),
    columns=columns,
    experiment="repeat the run: what is fixed to angle, to time or to neither tells where to look",
    told=followed,
    stamps=clock_jumps,
    to_plant=to_plant,
    beside=Beside(consequences={"T": ("wind_torque",)}),
)
