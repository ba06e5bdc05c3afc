"""Effects seen between encoders (channels K and S)."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from calibration.candidates.axis_lines import line, pair
from calibration.candidates.candidate import Candidate
from calibration.candidates.context import Context
from calibration.candidates.friction import stop_operator
from calibration.candidates.orders import order_spectrum, peaks
from calibration.channels.motion import Motion, acceleration_of, rate_of
from calibration.readers.drive import ARCSEC
from calibration.readers.run import Array
from calibration.statistics.whitening import Mask

RESOLVED = 0.3  # periods per row, ASSUMPTION: where hardly a row is slower, the log cannot show the error


def motor_encoder_effects(c: Context, period_s: float, motor: Array) -> list[Candidate]:
    """Candidates of the stacked K problem in arcsec; `c` holds the stacked columns."""
    out = []
    turns = c.angle / c.turn
    span = float(np.ptp(turns))
    x = c.angle
    out.append(
        Candidate(
            "encoder_eccentricity",
            "axis_angle",
            np.column_stack([np.cos(x), np.sin(x), np.cos(2 * x), np.sin(2 * x)]),
            (("amplitude", "arcsec"),),
            kind="line",
            stage="axis",
            harmonic=1,
            order=1.0,
        )
    )
    for stage in (*c.train.shafts, *c.train.meshes):
        for h in (1, 2):
            order = c.train.orders[stage] * h
            if span * order < 0.8:
                continue
            name = "gear_mesh" if stage in c.train.meshes else "gear_eccentricity"
            columns = pair(turns * order, c, period_s, None, order)
            for one in (columns, columns * (motor == 0)[:, None], columns * (motor == 1)[:, None]):
                out.append(
                    line(
                        c,
                        name,
                        stage,
                        h,
                        order,
                        one,
                        "motor_angle" if stage == c.train.motor else "axis_angle",
                    )
                )
    if c.temperature is not None and np.ptp(c.temperature) > 0.3:
        out.append(
            Candidate(
                "encoder_thermal_drift",
                "temperature",
                (c.temperature.mean() - c.temperature)[:, None],
                (("drift", "arcsec/K"),),
            )
        )
    out.append(
        Candidate(
            "encoder_thermal_drift",
            "time",
            ((c.t - c.t.mean()) / (np.ptp(c.t) or 1.0))[:, None],
            (("drift", "arcsec"),),
        )
    )
    return out


# of the limit: with more the roller slips in steady motion, too, which is its ratio and no slip
MOST_CHATTER = 0.5
MOST_LIMIT = 0.1  # rad/s2: three times what the axis is asked for (2 deg/s2, paper)
PLAY_TRAVELS = (0.6, 1.2, 2.5, 5.0, 10.0, 20.0, 40.0, 80.0)  # arcsec, gaps that are tried


def play(c: Context, moved: Array) -> list[Candidate]:
    """A gap in the coupling of the absolute encoder: its reading stands while the axis crosses the gap.

    `moved` (n,) arcsec: where the axis is by its motors, without their wind-up; the stacked K problem has
    each motor's rows after the other's, `c` its stacked columns.
    """
    run = np.asarray(c.run)[: len(moved)]
    reach = float(np.ptp(moved))

    def shape(p: Array) -> Array:
        gap = max(float(p[0]), 0.1)
        one = lag_in_gap(moved, run, gap) / gap
        return np.concatenate([-one, -one])[:, None]

    return [
        Candidate(
            "play",
            "reversal",
            shape(np.array([gap])),
            (("gap", "arcsec"),),
            sign=1,
            stage="axis",
            fixed={"travel": (gap, "arcsec")},
            shape=shape,
            steps=(0.1 * gap,),
        )
        for gap in PLAY_TRAVELS
        if gap < 0.5 * reach
    ]


def lag_in_gap(moved: Array, run: NDArray[np.int64], gap: float) -> Array:
    """Reading less place, same unit as `gap`, of a sensor behind a coupling with a gap; the middle of the gap
    at the start of a run."""
    return -stop_operator(moved, run, 0.5 * gap)


def roller_effects(c: Context, m: Motion) -> list[Candidate]:
    """Candidates of velocity minus rate in arcsec/s; `c.speed` in rad/s."""
    period_s = m.period_s
    w = c.speed * 206264.806
    turns = c.angle / c.turn
    span = float(np.ptp(turns))
    roller = c.train.one("roller")
    out = []
    if roller is not None:
        out += [Candidate("roller_ratio", "velocity", w[:, None], (("scale", "1"),), stage=roller)]
        out += _slips(m, roller)
    for h in (1, 2):
        if roller is None:
            break
        order = c.train.orders[roller] * h
        if span * order > 0.8:
            out.append(
                line(
                    c,
                    "encoder_eccentricity",
                    roller,
                    h,
                    order,
                    pair(turns * order, c, period_s, w, order),
                    "axis_angle",
                )
            )
    x = c.angle
    out.append(
        Candidate(
            "encoder_eccentricity",
            "axis_angle",
            w[:, None] * np.column_stack([np.cos(x), np.sin(x), np.cos(2 * x), np.sin(2 * x)]),
            (("amplitude", "1"),),
            kind="line",
            stage="axis",
            harmonic=1,
            order=1.0,
        )
    )
    return out


def _slips(m: Motion, roller: str) -> list[Candidate]:
    """Travel lost while the axis accelerates harder than a limit: a share of it, or as much as the limit is
    exceeded. Row by row: the analysis' means would round off what is beyond a limit."""
    row_s = m.period_s / m.width
    rate, acceleration = rate_of(m.theta, 1, row_s), acceleration_of(m.theta, 1, row_s)
    size, out = np.abs(m.acceleration[m.pick]), []
    forms = ((_share(rate, acceleration), "creep", "1"), (_excess(rate, acceleration), "slip", "s"))
    for limit in (0.0005, 0.001, 0.002, 0.0035, 0.005, 0.008, 0.012, 0.02):
        if not 0.002 < np.mean(size > limit) < 0.6:
            continue
        for (lost, name, unit), part in itertools.product(forms, (0.1, MOST_CHATTER)):
            shape = _seen(m, lost)
            chatter = part * limit
            out.append(
                Candidate(
                    "roller_slip",
                    "velocity",
                    shape(np.array([limit, chatter])),
                    ((name, unit),),
                    stage=roller,
                    fixed={"limit": (limit, "rad/s2"), "chatter": (chatter, "rad/s2")},
                    sign=1,
                    shape=shape,
                    steps=(0.1 * limit, 0.2 * chatter),
                )
            )
    return out


def _seen(m: Motion, lost: Callable[[float, float], Array]) -> Callable[[Array], Array]:
    """Rate lost (n_analysis, 1), arcsec/s per unit, for p = (limit, rms of the acceleration within a row)."""

    def shape(p: Array) -> Array:
        limit = float(np.clip(abs(p[0]), 1e-6, MOST_LIMIT))
        chatter = float(np.clip(abs(p[1]), 1e-6, MOST_CHATTER * limit))
        return np.asarray(-m.at(lost(limit, chatter))[:, None] / ARCSEC)

    return shape


def _share(rate: Array, acceleration: Array) -> Callable[[float, float], Array]:
    """Of the rate, the share of a row's time beyond the limit."""
    from scipy.special import ndtr

    return lambda limit, chatter: (
        rate * (ndtr((acceleration - limit) / chatter) + ndtr((-acceleration - limit) / chatter))
    )


def _excess(rate: Array, acceleration: Array) -> Callable[[float, float], Array]:
    """The acceleration beyond the limit, mean over a row, against the motion."""
    from scipy.special import ndtr

    size = np.abs(acceleration)

    def lost(limit: float, chatter: float) -> Array:
        z = (size - limit) / chatter
        beyond = chatter * (np.exp(-np.minimum(z * z, 1e3) / 2) / np.sqrt(2 * np.pi) + z * ndtr(z))
        return np.asarray(np.sign(rate) * beyond)

    return lost


def subdivision(c: Context, m: Motion, lags: Array, lines: int | None) -> list[Candidate]:
    """Rate error of the absolute encoder's interpolation: its line count (signal periods per turn) and twice
    it; none where nobody declared one.

    It is sampled with the position, row by row, and goes through the same differences; `lags` (2,) are what
    the channel's base makes of the position's acceleration and jerk, in which the error is, too.
    """
    row_s = m.period_s / m.width
    if lines is None or np.mean(np.abs(c.speed) / c.turn * lines * row_s < RESOLVED) < 0.02:
        return []
    parts = []
    for wave in (g(h * lines * m.theta) for h in (1, 2) for g in (np.cos, np.sin)):
        bent = acceleration_of(wave, m.width, row_s)
        late = lags[0] * bent + lags[1] * np.gradient(bent, row_s)
        parts.append((rate_of(wave, m.width, row_s) + late)[m.pick])
    return [
        Candidate(
            "encoder_subdivision",
            "axis_angle",
            np.column_stack(parts),
            (("amplitude", "arcsec"),),
            kind="line",
            order=float(lines),
            harmonic=1,
        )
    ]


def free_kinematic(c: Context, e: Array, rows: Mask, period_s: float, top: float = 3000.0) -> list[Candidate]:
    """Strongest orders of the difference that no stage explains."""
    turns = c.angle / c.turn
    span = float(np.ptp(turns))
    orders, power = order_spectrum(np.where(rows, e, 0.0), turns, rows.astype(float), top)
    out = []
    for order in peaks(orders, power, 2, 1.5 / span if span else 1.0):
        if min(abs(order - v * h) for v in c.train.orders.values() for h in (1, 2)) * span < 0.8:
            continue
        out.append(
            line(
                c,
                "unknown",
                None,
                None,
                float(order),
                pair(turns * order, c, period_s, None, order),
                "axis_angle",
            )
        )
    return out


def wind_up_loss(torque: Array, lagging: Array) -> list[Candidate]:
    """Wind-up of the motor that should hold the counter torque: lost when its torque is."""
    arcsec = 4.84813681e-6
    return [
        Candidate(
            "backlash_loss",
            "reversal",
            (torque * lagging / arcsec)[:, None],
            (("lost_compliance", "rad/(N m)"),),
        )
    ]
