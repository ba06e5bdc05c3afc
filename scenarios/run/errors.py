"""How far a telescope was off while a step lasted: pointing and rate, sample by sample."""

import itertools
import math
from collections.abc import Iterable

import numpy as np

from bus.units import ARCSEC_PER_RAD
from host.client import TICK_NS
from host.rates import rate_arcsec_s
from host.sky.catalogue import Star
from scenarios.language.programme import Record
from scenarios.run.outcome import Array, Outcome

MEAN_S = 1.0
PHASE_S = 1.0
"""Boards were switched on within the same second (scenarios/lab/network.py)."""
LOOK_S = 0.25
"""Before a star of a pointing run was noted it had been on target for a second."""
PIECE_S = 1800.0
"""Long windows are looked at in pieces of at most this length."""
_ROWS_PER_MEAN = round(MEAN_S / 0.01)


class NoData(ValueError):
    """A window in which nothing was recorded."""


def looks(record: Record, low_s: float, high_s: float) -> list[tuple[Star, float, float]]:
    """Which star the telescope was on between which times: of a pointing run, while it looked at each."""
    if record.star is not None:
        return [(record.star, low_s, high_s)]
    if not record.visits:
        raise NoData(f"step {record.step.name!r} has no target")
    tick_s = TICK_NS * 1e-9  # in which it looks, and begins to leave
    return [(each.star, each.t_s - LOOK_S, each.t_s - tick_s) for each in record.visits]


def pointing_errors(
    outcome: Outcome, star: Star, low_s: float, high_s: float, source: str
) -> tuple[Array, Array, Array]:
    """Time and the error of hour angle and declination in ″, star less telescope."""
    t, ra, dec = _joined(_pointing_piece(outcome, star, *each, source) for each in _pieces(low_s, high_s))
    return t, ra, dec


def _pointing_piece(
    outcome: Outcome, star: Star, low_s: float, high_s: float, source: str
) -> tuple[Array, Array, Array]:
    if source == "encoder":
        rows = outcome.host(low_s, high_s)
        good = ~np.isnan(rows["ra_error_arcsec"])
        return rows["t_s"][good], rows["ra_error_arcsec"][good], rows["dec_error_arcsec"][good]
    t, hour_angle, declination = outcome.pointed(low_s, high_s)
    if not len(t):
        return t, t, t
    star_ha, star_dec = outcome.star_places(star, t)
    off = np.remainder(star_ha - hour_angle + np.pi, 2 * np.pi) - np.pi
    return t, off * ARCSEC_PER_RAD, (star_dec - declination) * ARCSEC_PER_RAD


def rate_errors(
    outcome: Outcome, record: Record, axis: str, source: str, low_s: float, high_s: float
) -> tuple[Array, Array]:
    """Time and rate error in ″/s: `truth`, `counts_5ms` or `mean_1s`."""
    t, error = _joined(_rate_piece(outcome, record, axis, source, *each) for each in _pieces(low_s, high_s))
    return t, error


def _joined(pieces: Iterable[tuple[Array, ...]]) -> list[Array]:
    columns = [np.concatenate(column) for column in zip(*pieces, strict=True)]
    if not len(columns[0]):
        raise NoData("nothing was recorded in the window")
    return columns


def _pieces(low_s: float, high_s: float) -> list[tuple[float, float]]:
    """A window in pieces that a night's memory has room for."""
    count = max(1, math.ceil((high_s - low_s) / PIECE_S))
    edges = np.linspace(low_s, high_s, count + 1)
    return [
        (float(a), float(b) if b == edges[-1] else float(np.nextafter(b, a)))
        for a, b in itertools.pairwise(edges)
    ]


def _rate_piece(
    outcome: Outcome, record: Record, axis: str, source: str, low_s: float, high_s: float
) -> tuple[Array, Array]:
    if source == "truth":
        t, _, rate = outcome.truth(axis, low_s, high_s)
        measured = rate * ARCSEC_PER_RAD
    else:
        # Stamps are the board's own time, up to a second ahead: what they call low_s may have been before it.
        rows = outcome.axis_log(axis, low_s + PHASE_S, high_s)
        t, measured = rows["t"], rate_arcsec_s(1.0) * rows["velocity"]
        if source == "mean_1s":
            count = len(t) // _ROWS_PER_MEAN * _ROWS_PER_MEAN
            t = t[:count].reshape(-1, _ROWS_PER_MEAN).mean(axis=1)
            measured = measured[:count].reshape(-1, _ROWS_PER_MEAN).mean(axis=1)
    if not len(t):
        return t, t
    return t, measured - _wanted_rate(outcome, record, axis, t)


def _wanted_rate(outcome: Outcome, record: Record, axis: str, t: Array) -> Array:
    if record.step.action == "set_rate":
        if record.step.arguments["axis"] != axis:
            raise NoData(f"step {record.step.name!r} moves the other axis")
        return np.full_like(t, record.step.arguments["rate"])
    if record.star is None:
        raise NoData(f"step {record.step.name!r} has neither a target nor a rate")
    index = 0 if axis == "ra" else 1
    ahead, behind = (outcome.star_places(record.star, t + half)[index] for half in (0.5, -0.5))
    return (ahead - behind) * ARCSEC_PER_RAD
