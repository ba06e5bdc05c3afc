"""Smooth functions of every domain: what an effect outside the catalogue enters the plant as."""

from dataclasses import replace
from typing import Any

import numpy as np

from calibration.balances.candidate import waves
from calibration.balances.frame import Frame
from calibration.balances.recursions import stop_operator
from calibration.finding import UNKNOWN, Finding, of_columns
from calibration.names import unknown_shapes as shapes
from calibration.names.command_disturbance import lines
from calibration.names.coupling import coupling
from calibration.names.gravity_imbalance import gravity
from calibration.names.lines import ON_CLOCK, SLOWEST_HZ, on_clock
from calibration.names.name import FORCE, SENSORS, VOLTS, Array, Beside, Candidate, Name, Scene
from calibration.names.unnamed import LOOPS, to_plant
from calibration.statistics.orders import PER_ROW, order_spectrum, peaks
from calibration.statistics.tails import middle

KNOTS = 8  # knots of a smooth function. ASSUMPTION: names against what only looks smooth
RADII = (0.002, 0.01, 0.05, 0.2)  # part of the usual stroke, of the loops in a flexible fit. ASSUMPTION
# rad/s, of an axis with two motors, 10 arcsec/s: quicker, the logarithm of the speed counts. ASSUMPTION
SLOW_RATE = 5e-5
SPEED_KNOTS = 9  # knots over that logarithm. ASSUMPTION
APART = 3.0  # times 1 / time that lies between them. ASSUMPTION
FEWEST_CYCLES = 4  # cycles of such a line within the log, at least. ASSUMPTION
MOST_CYCLES = 2e5  # cycles likewise, at most, for its memory. ASSUMPTION
HARMONICS = 5  # harmonics of such a line. ASSUMPTION
#: of a function of the response, as the model has it
OWN_FORCE = "of the force that the model makes: its gain is not one number, as of an amplifier or a magnet"


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
    if s.force and s.view.dynamic and v.response.channel not in ("current", "force"):
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
        columns = shapes.spline_columns(x if domain == "time" else _where_files_meet(s, x), KNOTS)
        if columns.shape[1] == 0:
            continue
        forms = [columns]
        if s.both and domain in ("axis_angle", "time"):
            forms.append(columns * s.view.direction[s.view.rows][:, None])
        if s.force and s.view.dynamic and domain == "axis_angle":
            forms.append(columns * _declared_force(s)[:, None])
        note = OWN_FORCE if domain == "current" and s.force else ""
        out += [shapes.over(domain, one, *shapes.each("knot", one, s.unit), note=note) for one in forms]
    return out


def _where_files_meet(s: Scene, x: Array) -> Array:
    """`x` kept within what two files have of it, where files are held out in turn: else no other tells it."""
    p = s.problem
    if p.turned is None:
        return x
    mine = [x[p.valid & (p.session == k)] for k in np.unique(p.session[p.valid])]
    low, high = np.partition([z.min() for z in mine], 1)[1], np.partition([z.max() for z in mine], -2)[-2]
    return np.clip(x, low, max(low, high))


def columns(s: Scene) -> list[Candidate]:
    """Columns beside the names because they would follow it: a scale that moves with time, a spring, lost
    motion, a sensor's bracket that swings. Of a pair: any function of speed and travel, and lines at fixed
    Hz. Of volts: brushes."""
    if s.windings is not None:
        return shapes.of_volts(s)
    if s.pair is None:
        found = [*shapes.moving_scale(s), *shapes.spring(s), *shapes.lost_motion(s), *shapes.bend(s)]
        return [*found, *coupling(s), *_swings(s)]
    return [*_torques(s), *_fixed_lines(s)] if s.force else []


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
        parts.append(s.at(shapes.loops(v, [r * s.stroke for r in RADII])))
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
    knots = shapes.spline_columns(np.sign(speed) * np.log1p(np.abs(speed) / SLOW_RATE), SPEED_KNOTS)
    held = np.column_stack([stop_operator(x, session, r) / r for r in LOOPS])
    return [
        shapes.over("velocity", np.column_stack([w * np.abs(w), w**3]), ("square", s.unit), ("cube", s.unit)),
        shapes.over("velocity", knots, *shapes.each("knot", knots, s.unit)),
        shapes.over("reversal", held, *shapes.each("loop", held, s.unit)),
        *(
            shapes.over("reversal", one, ("loop", s.unit), fixed={"travel": (r, "rad")})
            for r, one in zip(LOOPS, held.T, strict=True)
        ),
    ]


def _swings(s: Scene) -> list[Candidate]:
    """Lines at a fixed frequency between two sensors: a bracket that swings."""
    if s.force or not s.both:
        return []
    sines = 2 * len(np.unique(s.problem.session))
    found = (c for c in lines(s, s.declared_part) if c.width == sines)
    return [replace(c, name=UNKNOWN, domain="time", twins=()) for c in found]


def _fixed_lines(s: Scene) -> list[Candidate]:
    """The strongest lines at fixed Hz, alone and with their harmonics: periodic in time, at every speed."""
    rows, clock = s.problem.train, s.view.clock[s.view.rows]
    span, period_s = float(np.ptp(clock)), s.problem.period_s
    top = min(0.5 / period_s, MOST_CYCLES / max(span, 1.0))
    hertz, power = order_spectrum(s.residual, clock, rows.astype(float), top)
    power = np.where(hertz < max(SLOWEST_HZ, FEWEST_CYCLES / span), 0.0, power)
    out = []
    for f0 in peaks(hertz, power, ON_CLOCK, APART / span):
        most = HARMONICS if f0 * HARMONICS < PER_ROW / period_s else 1
        for count in sorted({1, most}):
            wave = waves(2 * np.pi * f0 * clock, range(1, count + 1))
            at: dict[str, Any] = {"frequency": f0, "fixed": {"frequency": (f0, "Hz")}}
            out.append(shapes.over("time", wave, ("amplitude", s.unit), kind="line", **at))
    return out


def clock_jumps(frame: Frame) -> Finding | None:
    """Stamps that jump while the motion goes on: no effect of the catalogue, and no row that was lost."""
    if not frame.jumps:
        return None
    sizes = np.abs(frame.jumps)
    jumps = f"{len(sizes)} stamps jump while the position goes on by one row"
    note = f"{jumps}: the clock's fault, no row is lost"
    # of one row's travel in place of so many: the chance of each is one in as many rows
    evidence = float(np.log10(sizes / frame.period_s + 1.0).sum())
    return of_columns(UNKNOWN, {"jump": middle(sizes, "s")}, evidence, note=note)


NAME = Name(
    name=UNKNOWN,
    channels=(FORCE, SENSORS, VOLTS),
    columns=columns,
    experiment="repeat the run: what is fixed to angle, to time or to neither tells where to look",
    stamps=clock_jumps,
    to_plant=to_plant,
    beside=Beside(consequences={"T": ("wind_torque",)}),
)
