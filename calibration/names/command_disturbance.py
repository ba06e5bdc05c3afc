"""Something that is added to the command behind the logged effort: a line of its own frequency."""

from collections.abc import Callable, Sequence
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration.balances.candidate import sine_columns
from calibration.balances.repeats import repeat_lag
from calibration.finding import UNKNOWN
from calibration.inputs.train import SHAFT
from calibration.names.lines import (
    ENOUGH,
    ON_CLOCK,
    SLOWEST_HZ,
    STEP_OF_CELL,
    has_train,
    on_clock,
    spectral_lines,
)
from calibration.names.name import (
    OWN_ERRORS,
    SEARCHED_WORTH,
    Array,
    Candidate,
    Facts,
    Finding,
    Made,
    Name,
    tried,
    value,
)
from calibration.names.scene import FORCE, SPEED, VOLTS, Scene
from calibration.names.structural_mode import NAME as MODE
from calibration.statistics.orders import Wanted, standing_out
from calibration.statistics.regression import solve

PASSED = "bearing_pass"  # at an order of no stage
EFFORTS = ("effort", "current", "force", "voltage")  # responses behind which something may be added
TURNS = 6.0  # cycles within the log before a frequency is a frequency. ASSUMPTION
IN_A_FILE = 3.0  # likewise within the longest file: fewer are a walk. ASSUMPTION
ODD = (1, 3, 5, 7, 9)  # harmonics of a square wave. definition
# times that a file repeats its motion: with fewer no frequency lies between two of its multiples. ASSUMPTION
FEWEST_REPEATS = 2.5
# harmonics of such a motion that are left out: friction's corners fall off with the multiple. ASSUMPTION
STRONG = 50
FEWEST_ROWS = 1000  # rows, half a minute, that volts are searched in. ASSUMPTION
STEP_CELLS = 0.05  # share of such a line's resolution cell, for its refinement. ASSUMPTION
EDGE_CELLS = 0.25  # likewise of a square, which rows between its edges do not tell. ASSUMPTION
# count of phases tried in each of three searches, each within a step of the one before. ASSUMPTION
PHASES = 17
NEIGHBOURS = 3  # multiples of a repeated motion on either side, that one is compared with. ASSUMPTION
ALONE = 10.0  # times their power, from where on it stands alone. ASSUMPTION: a motion's fall off slowly
SHAKEN = 0.01  # part of the motion's rms, below which nobody commanded such a wave. ASSUMPTION
FEW = 4  # files: with more, every file's own phase costs too many columns for more than a sine. ASSUMPTION


def columns(s: Scene) -> list[Candidate]:
    """Sines of a fixed frequency, alone and with a square wave's overtones; every file has its own phase.

    Multiples of the frequency at which the motion repeats itself are left out, where the declared force has
    more of them than what it leaves. Whatever follows the motion has them.
    """
    if s.windings is not None:
        return _of_volts(s)
    if s.pair is not None:  # its volts say more
        return []
    return lines(s, s.declared_part, large_first=False)


def lines(s: Scene, follows: Array, large_first: bool = True) -> list[Candidate]:
    """`columns` without multiples of the motion's frequency that `follows` (n_fitted,) has more of."""
    v = s.view
    files = s.problem.session
    t = v.t[v.rows]
    train = s.problem.train
    lengths = [float(t[files == k].max()) for k in np.unique(files[train])]
    length = max(lengths, default=0.0)
    fitted = max((float(np.ptp(t[train & (files == k)])) for k in np.unique(files[train])), default=0.0)
    if fitted <= 0:
        return []
    top, lag = 0.5 / (v.period_s * max(v.step, 1)), repeat_lag(v)
    repeats = 1.0 / (lag * v.period_s) if lag else 0.0  # Hz
    most = int(top / repeats) if repeats else 0
    if repeats * length < FEWEST_REPEATS:
        most = min(most, STRONG)
    multiples: Array = np.arange(1, most + 1) * np.float64(repeats)
    x = v.x[v.rows]
    driven, left, moved = _powers(s, (follows, s.residual, x), repeats, most)
    commanded = float(np.var(x[train])) * (SHAKEN * float(train.sum())) ** 2 / 2
    avoid = multiples[(driven > left) & ~(_alone(driven) & (moved < commanded))]
    least = max(TURNS / sum(lengths), IN_A_FILE / length)
    want = Wanted(span=length, least=least, most=5, avoid=avoid, large_first=large_first)
    out, count = [], len(np.unique(files))
    few, more = count <= FEW, {"kind": "line", "per_run": count > 1}
    for f in spectral_lines(s, t, want):
        places = over_the_place(s, f)
        if places is None or _of_the_motion(s, t, follows, f):
            continue
        for overtones in ((1,), ODD) if few and 3 * f < top else ((1,),):

            def shape(p: Array, overtones: tuple[int, ...] = overtones) -> Array:
                hertz = [k * p[0] for k in overtones if k * p[0] < top]
                return np.hstack([sine_columns(t * f, files) * v.filter.gain(f * v.period_s) for f in hertz])

            rings = len(overtones) == 1 and not MODE.lacks(s)
            # other joints may move along: sums of their frequencies are multiples, too
            along = repeats * length >= TURNS and np.min(np.abs(multiples - f), initial=np.inf) * length < 0.5
            more["twins"] = (*((MODE.name,) if rings else ()), *places, *((UNKNOWN,) if along else ()))
            at, step, size = {"frequency": (f, "Hz")}, STEP_OF_CELL / fitted, ("amplitude", s.unit)
            out.append(tried(NAME.name, shape, size, at=at, steps=(step,), frequency=f, **more))
    return out


def _alone(driven: Array) -> NDArray[np.bool_]:
    """Which multiples (k,) no repeated motion has: a disturbance shakes the drive there.

    Its power in what follows the motion, `driven` (k,), stands alone among its neighbours'. The harmonics of
    a motion fall off.
    """
    beside = np.pad(driven, NEIGHBOURS)
    around = [np.roll(beside, k)[NEIGHBOURS:-NEIGHBOURS] for k in range(-NEIGHBOURS, NEIGHBOURS + 1) if k]
    return np.asarray(driven > ALONE * np.max(around, axis=0))


def _of_the_motion(s: Scene, t: Array, follows: Array, hertz: float) -> bool:
    """Whether errors of what `follows` the motion (n_fitted,) leave such a line, as steps of a stair do."""
    driven = left = 0.0
    files, train = s.problem.session, s.problem.train
    for k in np.unique(files[train]):
        rows = np.flatnonzero(train & (files == k))
        window = np.hanning(len(rows)) * np.exp(-2j * np.pi * hertz * t[rows])
        for_each = [float(np.abs(window @ (y[rows] - y[rows].mean())) ** 2) for y in (follows, s.residual)]
        driven, left = driven + for_each[0], left + for_each[1]
    return left < OWN_ERRORS**2 * driven


def over_the_place(s: Scene, hertz: float) -> tuple[str, ...] | None:
    """Names that a line on the clock may have instead, where the log's one speed does not tell it from a line
    over the place. None where a declared stage has that line."""
    speed = abs(s.one_speed[0])
    rate = hertz / speed if speed else np.inf
    if not on_clock(s, rate):
        return ()
    for g in s.view.rig.stages:
        own = [h / g.period for h in g.orders if g.period and s.span * h / g.period >= ENOUGH]
        if any(abs(rate - one) * s.span < 1.0 for one in own):
            return None
    return (PASSED,) if has_train(s) else (SHAFT, PASSED)


def _of_volts(s: Scene) -> list[Candidate]:
    """Between the logged effort of two motors and the amplifier: sines and squares that stand out of what is
    added to the effort. The amplitude is a share of full effort."""
    w, p = s.windings, s.problem
    if w is None or w.counter is None:
        return []
    n = len(p.y) // 2
    # the motor that leads pulls the way of its effort, A in +
    side = np.where(np.repeat([True, False], n) == (w.counter.lagging > 0), 1.0, -1.0)
    volts = side * w.at(w.counter.share * w.supply)
    weight = np.where(p.valid, volts, 0.0)
    power = w.together(weight**2)[:n]
    seen, run = power > 0, p.run[:n]
    rows = seen & ~p.held[:n]
    if rows.sum() < FEWEST_ROWS:
        return []
    added = np.where(seen, w.together(weight * s.residual)[:n], 0.0) / np.where(seen, power, 1)
    since = p.t[:n] - p.t[:n][np.searchsorted(run, run)]
    want = Wanted(span=float(since.max()), least=SLOWEST_HZ, most=ON_CLOCK)
    out = []
    for f0, square in product(standing_out(added[rows], since[rows], run[rows], want), (False, True)):
        at = {"frequency": (f0, "Hz"), "shape": (float(square), "0 sine, 1 square")}
        more: dict[str, Any] = {
            "frequency": f0,
            "sign": 1,
            "searched": 1 + len(np.unique(run)),
            "open": square,
        }
        wave, step = _wave(s, added, volts, square), (EDGE_CELLS if square else STEP_CELLS) / want.span
        out.append(tried(NAME.name, wave, "amplitude", at=at, steps=(step,), **more))
    return out


def _wave(s: Scene, added: Array, volts: Array, square: bool) -> Callable[[Array], Array]:
    """Volts (2 n_analysis, 1) per effort count of a wave at p[0] Hz, its phase as each run's rows show."""
    v = s.view
    n = len(added)
    run, t = s.problem.run[:n], s.problem.t[:n]

    def shape(p: Array) -> Array:
        x = 2 * np.pi * float(p[0]) * t
        phase = np.zeros(len(v.t))
        for k in np.unique(run):
            rows = (run == k) & (added != 0)
            if rows.any():
                phase[v.run == k] = _phase(x[rows], added[rows], square)
        wave = np.sin(2 * np.pi * float(p[0]) * v.t + phase)
        return np.asarray(volts * s.at(np.sign(wave) if square else wave))[:, None]

    return shape


def _phase(x: Array, y: Array, square: bool) -> float:
    """Phase of sin(x + phase), or of its sign, that explains most of y beside a constant on uneven rows."""
    fit = solve(np.column_stack([np.ones(len(x)), np.cos(x), np.sin(x)]), y)
    best = float(np.arctan2(fit[1], fit[2]))
    if not square:
        return best
    y = y - np.mean(y)

    def explained(phase: float) -> float:
        wave = np.sign(np.sin(x + phase))
        wave = wave - np.mean(wave)
        return float(wave @ y) * abs(float(wave @ y)) / max(float(wave @ wave), 1e-300)

    reach = np.pi / 2
    for _ in range(3):  # the fundamental of uneven rows can be off by a good part of a quarter
        tried = best + reach * np.linspace(-1, 1, PHASES)
        gains = np.array([explained(phase) for phase in tried])
        best = float(np.mean(tried[gains == gains.max()]))  # its edges may lie anywhere between two rows
        reach *= 2.0 / PHASES
    return best


def _powers(s: Scene, ys: Sequence[Array], hertz: float, most: int) -> Array:
    """(len(ys), most): powers of lines of `ys` (n_fitted,) at multiples of `hertz`, any phase in a file."""
    p, t = s.problem, s.view.t[s.view.rows]
    starts = np.flatnonzero(np.diff(p.session, prepend=p.session[0] - 1))
    rows, turn = np.where(p.train, np.array(ys), 0.0), np.exp(-2j * np.pi * hertz * t)
    out, wave = np.zeros((len(ys), most)), np.ones(len(t), dtype=complex)
    for k in range(most):
        wave = wave * turn
        out[:, k] = np.sum(np.abs(np.add.reduceat(rows * wave, starts, axis=1)) ** 2, axis=1)
    return out


def to_plant(f: Finding, facts: Facts) -> Made:
    """Its phase is the first run's, every run has one of its own."""
    made, unit = Made(), f.parameters["amplitude"].unit
    steps = float(unit.removeprefix("1/")) if unit.startswith("1/") else 1.0  # of the logged effort
    values = {"amplitude": value(f, "amplitude") / steps, "phase": value(f, "phase") + np.pi / 2}
    values |= {"frequency": value(f, "frequency", f.frequency or 0.0), "shape": value(f, "shape")}
    made.add(f.name, facts, values)
    made.remarks.append(f"{f.name}: every run has a phase of its own, the plant has the first run's")
    return made


NAME = Name(
    name="command_disturbance",
    searched=True,
    scaled=True,
    random=True,
    a_guess=True,
    channels=(FORCE, VOLTS, SPEED),
    columns=columns,
    experiment="the same motion at another speed: a disturbance keeps its frequency and size, at rest "
    "it stays",
    lacks=lambda s: "" if s.view.response.channel in EFFORTS else "a column of the effort",
    to_plant=to_plant,
    worth=SEARCHED_WORTH,
)
