"""A coupling between two sensors that slips: the difference steps and stays."""

import itertools
from collections.abc import Callable
from functools import partial

import numpy as np
from scipy.special import ndtr

from calibration.balances.motion import acceleration_of, rate_of
from calibration.names.name import RATES, SENSORS, Array, Candidate, Name, Scene, tried
from plant.units import ARCSEC

# rad/s2, limits that are tried: the axis is asked for 2 deg/s2 (paper)
LIMITS = (0.0005, 0.001, 0.002, 0.0035, 0.005, 0.008, 0.012, 0.02)
BEYOND = (0.002, 0.6)  # of the rows, that are beyond a limit which is tried: least and most. ASSUMPTION
CHATTER = 0.1  # of the limit, rms of the acceleration within a row. ASSUMPTION
# likewise of the limit at most: with more the roller slips in steady motion, too, which is its ratio and no
# slip. ASSUMPTION
MOST_CHATTER = 0.5
STEPS = (0.1, 0.2)  # of the limit and of the chatter, for their refinement: steps. ASSUMPTION
MOST_LIMIT = 0.1  # rad/s2: three times what the axis is asked for. ASSUMPTION


def columns(s: Scene) -> list[Candidate]:
    """Of rates, travel that is lost while the axis accelerates too hard: a share of it, or what is beyond the
    limit. Row by row, as means would round it off. Slips of two sensors are found by look/slips.py."""
    if s.pair is None or not s.rates:
        return []
    m, roller = s.pair.motion, s.pair.train.one("roller")
    if roller is None:
        return []
    row_s = s.view.period_s
    rate, acceleration = rate_of(m.x, 1, row_s), acceleration_of(m.x, 1, row_s)
    beyond = np.abs(m.acceleration[m.rows])
    limits = [x for x in LIMITS if BEYOND[0] < np.mean(beyond > x) < BEYOND[1]]
    forms = {"slip": _share, "creep": _excess}

    def shape(lost: Callable[..., Array], p: Array) -> Array:
        """Rate lost (n_analysis, 1), arcsec/s per unit, for p = (limit, rms within a row), rad/s2."""
        limit = float(np.clip(abs(p[0]), 1e-6, MOST_LIMIT))
        chatter = float(np.clip(abs(p[1]), 1e-6, MOST_CHATTER * limit))
        return np.asarray(-m.at(lost(rate, acceleration, limit, chatter))[:, None] / ARCSEC)

    out: list[Candidate] = []
    for limit, (size, lost), part in itertools.product(limits, forms.items(), (CHATTER, MOST_CHATTER)):
        at = {"threshold": (limit, "rad/s2"), "chatter": (part * limit, "rad/s2")}
        steps, lose = (STEPS[0] * limit, STEPS[1] * part * limit), partial(shape, lost)
        out.append(tried("roller_slip", lose, size, at=at, steps=steps, searched=0, sign=1, stage=roller))
    return out


def _share(rate: Array, acceleration: Array, limit: float, chatter: float) -> Array:
    """Of the rate, the share of a row's time beyond the limit."""
    beyond = ndtr((acceleration - limit) / chatter) + ndtr((-acceleration - limit) / chatter)
    return np.asarray(rate * beyond)


def _excess(rate: Array, acceleration: Array, limit: float, chatter: float) -> Array:
    """The acceleration beyond the limit, mean over a row, against the motion."""
    z = (np.abs(acceleration) - limit) / chatter
    beyond = chatter * (np.exp(-np.minimum(z * z, 1e3) / 2) / np.sqrt(2 * np.pi) + z * ndtr(z))
    return np.asarray(np.sign(rate) * beyond)


NAME = Name(
    name="roller_slip",
    channels=(SENSORS, RATES),
    columns=columns,
    experiment="out and back with gentle and hard acceleration",
    nuisances={"chatter": ""},  # a plant's acceleration is known within a row, too
)
