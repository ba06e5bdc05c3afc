"""High preload: the model has the pole that makes it hard, and the observer holds what the PI cannot."""

import numpy as np
import pytest

from plant.model import load
from plant.units import ARCSEC
from tests.studies.objective import observer


def test_the_loop_is_stable_where_the_axis_alone_is_not() -> None:
    model = load("high_preload_motor_units")
    a, _, _ = observer.continuous(model, 15.041 * ARCSEC)
    assert max(np.linalg.eigvals(a).real) == pytest.approx(18.0, abs=0.5)  # 1/s; the docs quote it
    made = observer.design(model)
    keep = [n for n in range(observer.SIZE) if n != observer.LOAD]
    closed = made.a[np.ix_(keep, keep)] - np.outer(made.b[keep], made.gain[keep])
    assert max(abs(np.linalg.eigvals(closed))) < 1.0
    seen = made.a @ (np.eye(observer.SIZE) - np.outer(made.correction, np.eye(observer.SIZE)[0]))
    assert max(abs(np.linalg.eigvals(seen))) < 1.0


def test_it_holds_the_objective() -> None:
    model = load("high_preload_motor_units")
    errors = observer.hold(model, observer.design(model), 0.0031, 15.0, 193.0, seed=2)
    assert np.abs(errors).max() < 1.0
