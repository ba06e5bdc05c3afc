"""A gapped coupling of the axis encoder: which flank drives it, the path meanwhile, the rows fitted."""

import numpy as np
import pytest

from calibration.balances.frame import Frame
from calibration.balances.motion import motion_of
from calibration.balances.torque import slid
from calibration.inputs.rigfile import telescope
from calibration.look.applied import carried_on, driven_side
from plant.units import ARCSEC

DT, GAP, NOISE = 0.01, 8.0, 0.0015  # s, arcsec, arcsec
ONE_RUN = np.zeros(6000, dtype=np.int64)


def axis() -> np.ndarray:
    """Out and back over 500 arcsec at some 100 arcsec/s, then a stand, arcsec."""
    t = DT * np.arange(6000)
    return np.asarray(250.0 * np.sin(2 * np.pi * np.minimum(t, 50.0) / 17.0))


def seen_by(place: np.ndarray) -> np.ndarray:
    """What an encoder behind the gap reads: it moves only while a flank drives it."""
    out, at = np.empty(len(place)), place[0]
    for k, x in enumerate(place):
        at = min(max(at, x - GAP / 2), x + GAP / 2)
        out[k] = at
    return out + NOISE * np.random.default_rng(3).standard_normal(len(place))


def test_a_reading_that_moves_says_on_which_flank_it_lies() -> None:
    place = axis()
    reading = seen_by(place)
    side = driven_side(reading, ONE_RUN, NOISE)
    known = np.isfinite(side)
    assert 0.6 < known.mean() < 0.9  # not the crossings, not the stand
    assert np.abs((reading + side * GAP / 2 - place)[known]).max() < 0.03


@pytest.mark.parametrize(("parted", "close"), [(0.0, 0.05), (90.0, 2 * GAP)])
def test_the_motors_carry_the_axis_through_the_gap_unless_they_left_their_teeth(
    parted: float, close: float
) -> None:
    place = axis()
    reading = seen_by(place)
    axis_seen = reading + driven_side(reading, ONE_RUN, NOISE) * GAP / 2
    first = int(np.flatnonzero(np.isnan(axis_seen) & (np.arange(6000) > 500))[0])
    motors = place + 40.0 + np.where(np.arange(6000) > first + 10, parted, 0.0)
    found = carried_on(axis_seen * ARCSEC, motors * ARCSEC, ONE_RUN) / ARCSEC
    assert np.isfinite(found).all()
    inner = slice(500, 4900)
    assert np.abs((found - place)[inner]).max() < close


def test_rows_are_fitted_again_once_the_bristles_hold_nothing_of_the_unseen_path() -> None:
    position, unseen = 1e-6 * np.arange(1000.0), np.zeros(1000)
    unseen[200:300] = 1.0
    columns = {"position": position, "unseen": unseen}
    zero = np.zeros(1000, dtype=np.int64)
    frame = Frame(
        runs=[], period_s=DT, t=DT * np.arange(1000), clock=np.zeros(1000), run=zero, session=zero,
        columns=columns, scale={}, rig=telescope("ra"),
    )  # fmt: skip
    m = motion_of(frame, 3)
    assert not m.ok[197:303].any() and m.ok[320:900].all() and m.fresh.sum() == 1
    settled = slid(m, unseen, 5e-5)
    assert settled[:199].all() and not settled[200:348].any() and settled[352:].all()
