"""One axis with its velocity loop in one compiled call: for parameter search and calibration.

Same kernels as the plant, same arithmetic as the axis board; columns as in the axis log. About a thousand
times real time and more; the emulator's boards, bus and clocks are left out.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from plant.evaluate import values_over
from plant.kernels import control as at_control
from plant.kernels import layout as at
from plant.kernels.advance import advance
from plant.kernels.control import control_loop
from plant.kernels.dispatch import TERMS
from plant.kernels.friction import stribeck
from plant.parts import AxisModel, PlantModel
from plant.plant import delays_ns
from plant.units import ARCSEC, TURN
from plant.world import AXES, build, grid_ns

Floats = NDArray[np.float64]
ADC_COUNTS_PER_A = (
    0.1 * 8.0 / 5.0 * 1024.0
)  # 0.1 ohm (paper), gain 8 and 5 V (hardware.md 2.3): 6.1 mA per count
LATENCY_S = 65e-6  # 40 us of interrupt routine and half a PWM period of 50 us, as the axis board takes
SAMPLE_S = 0.010  # paper, section 3.4
TRUTH_COLUMNS = (*at.TRUTH_COLUMNS[1:], "duty_a", "duty_b")
"""As the plant has them (plant/grid.py), but for the time; duties are those before the tick's new effort."""


@dataclass(frozen=True)
class LogColumns:
    """Columns of the axis log (units as in log-format.md: raw counts), and the truth beside them.

    t: s.
    setpoint: arcsec/s, NaN in open loop.
    effort: 1/3000 of the supply.
    position: counts of 29 bits.
    velocity: counts in the last 5 ms.
    adc_a, adc_b: counts of 10 bits.
    tach_a, tach_b: counts in the last 10 ms.
    aux: counts of 17 bits.
    truth: by TRUTH_COLUMNS, SI units.
    """

    t: Floats
    setpoint: Floats
    effort: Floats
    position: Floats
    velocity: Floats
    adc_a: Floats
    adc_b: Floats
    tach_a: Floats
    tach_b: Floats
    aux: Floats
    truth: dict[str, Floats]


LOG_COLUMNS = tuple(LogColumns.__annotations__)[:-1]
"""All but the truth, in the log's order."""


@dataclass(frozen=True, kw_only=True)
class Excitation:
    """What drives an axis, and the state it starts from.

    setpoint: arcsec/s, a number, one value per 10 ms sample or one per 5 ms tick (closed loop where it is not
    NaN). effort: 1/3000 of the supply, a number or one value per sample. It counts where there is no set
    point; between samples it is the mean of two, as a logged effort needs. start_steps: absolute encoder;
    start_rate: arcsec/s, both motors and the bristle following. start_s: time on the plant's clock of the
    first sample, for effects that know the time. history: signal vectors (2 motors, n, VECTOR) of the motion
    before the start (plant/effects/signals.py), which give cables, stops and windings their state. Raises
    ValueError when there is neither set point nor effort.
    """

    setpoint: float | Floats | None = None
    effort: float | Floats | None = None
    start_steps: float = 0.0
    start_rate: float = 0.0
    start_s: float = 0.0
    history: Floats | None = None

    def __post_init__(self) -> None:
        if self.setpoint is None and self.effort is None:
            raise ValueError("simulate: give a set point or an effort")


def simulate(
    model: PlantModel,
    axis: str,
    duration: float,
    excitation: Excitation,
    *,
    seed: int = 0,
    adc_counts_per_A: float = ADC_COUNTS_PER_A,
) -> LogColumns:
    """Return the log of `axis` (`ra` or `dec`) over `duration` s; ValueError for a shape that is wrong."""
    if axis not in AXES:
        raise ValueError(f"simulate: axis '{axis}' is not known; expected ra or dec")
    rows = round(duration / SAMPLE_S)
    if rows < 1:
        raise ValueError("simulate: the duration must be at least one sample of 0.01 s")
    part: AxisModel = getattr(model.axes, axis)
    w = build(model, seed, {axis: excitation.start_steps * TURN / 2 ** int(part.encoders.absolute.si)})[
        AXES.index(axis)
    ]
    if excitation.start_rate:
        _start(w, excitation.start_rate * ARCSEC)
    settings = _settings(model, part, adc_counts_per_A)
    w[at.DELAY_ON] = float(settings[at_control.DELAYS :].any())
    w[at.STEP] = round(excitation.start_s / w[at.GRID])
    if excitation.history is not None:
        _remember(w, excitation.history)
    advance(w.reshape(1, -1), 0)
    ring = w[at.DELAYS : at.DELAYS + at.OUT_SIZE * at.DELAY_ROWS].reshape(at.DELAY_ROWS, at.OUT_SIZE)
    ring[:] = w[at.OUT : at.OUT + at.OUT_SIZE]  # before the start the readings were those of the start
    ring[:, 1 : at.OUT_CURRENT_A : 2] = 0.0

    counts = part.encoders.incremental.si * part.encoders.roller_ratio.si * model.controller.period.si
    wanted = _ticks(excitation.setpoint, rows)
    ticks = np.rint(wanted * ARCSEC / TURN * counts * 65536.0)
    log = np.zeros((rows, at_control.LOG_SIZE))
    truth = np.zeros((rows, at_control.TRUTH_SIZE))
    open_loop = _between(_column(excitation.effort, rows, 0.0, "effort"), model)
    control_loop(w, settings, ticks, open_loop, log, truth)

    mask = 2.0 ** int(part.encoders.absolute.si)
    log[:, at_control.POSITION] %= mask
    log[:, at_control.AUX] %= 2.0 ** int(part.encoders.auxiliary.si)
    log[:, at_control.SETPOINT] = wanted[::2]
    columns = {name: np.ascontiguousarray(log[:, k]) for k, name in enumerate(LOG_COLUMNS)}
    beside = {name: np.ascontiguousarray(truth[:, k]) for k, name in enumerate(TRUTH_COLUMNS)}
    return LogColumns(truth=beside, **columns)


def _ticks(setpoint: float | Floats | None, rows: int) -> Floats:
    """Return the set point of every control tick, two per sample."""
    if setpoint is not None and np.shape(setpoint) == (2 * rows,):
        return np.array(setpoint, dtype=float)
    return np.repeat(_column(setpoint, rows, np.nan, "setpoint"), 2)


def _column(given: float | Floats | None, rows: int, absent: float, name: str) -> Floats:
    values = np.asarray(absent if given is None else given, dtype=float)
    if values.shape not in ((), (rows,)):
        raise ValueError(f"simulate: {name} has {values.size} values for {rows} samples")
    return np.broadcast_to(values, (rows,))


def _between(effort: Floats, model: PlantModel) -> Floats:
    """Return PWM steps per tick: the samples, and between two samples their mean."""
    steps = effort * model.controller.pwm_steps.si / at_control.EFFORT_SCALE
    ticks = np.repeat(steps, 2)
    ticks[1:-1:2] = 0.5 * (steps[:-1] + steps[1:])
    return ticks


def _settings(model: PlantModel, part: AxisModel, adc: float) -> Floats:
    """Return the settings vector of the loop kernel."""
    c = model.controller
    grid = grid_ns(model)
    tick = round(c.period.si * 1e9)
    if tick % grid or grid < LATENCY_S * 1e9:
        raise ValueError(f"simulate: the control period must be a multiple of the grid step, {grid} ns")
    s = np.zeros(at_control.SETTINGS)
    s[at_control.KP] = round(c.kp.si * 4096)
    s[at_control.KI] = round(c.ki.si * 4096)
    s[at_control.STEPS] = c.pwm_steps.si
    s[at_control.SPLIT] = round(c.counter_split.si * 100)
    s[at_control.TICK_STEPS] = tick // grid
    s[at_control.LATENCY] = LATENCY_S
    s[at_control.AMPERE] = adc
    s[at_control.DELAYS :] = [delay * 1e-9 for delay in delays_ns(part).values()]
    return s


def _remember(w: Floats, history: Floats) -> None:
    """Take the effects that keep a state of their own through the motion before the start."""
    out = np.zeros(history.shape[1])
    for r in range(int(w[at.ROWS_ALL])):
        row = w[at.EFFECTS + r * at.ROW : at.EFFECTS + (r + 1) * at.ROW]
        _, term = TERMS[int(row[at.ROW_KIND])]
        if term.lasting:
            motors = history if term.of_motors else history[:1]
            for rows in motors:
                values_over(int(row[at.ROW_KIND]), rows, row[at.ROW_MEMORY :], out)


def _start(w: Floats, rate: float) -> None:
    """Set the axis, both motors and the bristle in steady motion at `rate`, rad/s."""
    w[at.RATE] = w[at.RATE_BEFORE] = rate
    w[at.DIRECTION] = np.sign(rate)
    w[at.STRIBECK] = stribeck.py_func(rate, w, at.DECLARED_FRICTION)  # type: ignore[attr-defined]
    w[at.BRISTLE] = np.sign(rate) * w[at.STRIBECK]
    level = w[at.BRISTLE] * w[at.DECLARED_FRICTION + at.F_SIGMA0]
    w[at.FRICTION] = level + rate * w[at.DECLARED_FRICTION + at.F_SIGMA2]
    for r in range(int(w[at.ROWS_ALL])):
        row = w[at.EFFECTS + r * at.ROW : at.EFFECTS + (r + 1) * at.ROW]
        _, term = TERMS[int(row[at.ROW_KIND])]
        for word in term.moving:
            row[at.ROW_MEMORY + term.memory.index(word)] = rate
    half = 0.5 * w[at.GRID]
    w[at.ANGLE] += half * rate
    for m in range(2):
        o = at.MOTORS + m * at.MOTOR_SIZE
        w[o + at.M_RATE] = w[o + at.M_RATE_BEFORE] = rate * w[at.RATIO]
        w[o + at.M_ANGLE] += half * rate * w[at.RATIO]
