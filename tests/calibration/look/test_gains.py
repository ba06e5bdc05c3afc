"""Gains of a law that are others, change at a speed or miss a feed-forward."""

from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.balances.problem import Problem
from calibration.finding import UNKNOWN
from calibration.inputs.declaration import Column
from calibration.look import controllerlaw
from tests.calibration.look.test_said_and_settled import scene
from tests.calibration.names.made import PERIOD_S

ROWS = 3000
T: np.ndarray = PERIOD_S * np.arange(ROWS)
RNG = np.random.default_rng(1)


def law(*gains: float, error: float = 1e-3, noise: float = 0.01) -> Any:
    """A command of two gains, fitted to these; what is left is noise."""
    terms = RNG.standard_normal((ROWS, 2))
    label = np.zeros(ROWS, dtype=np.int64)
    p = Problem(
        channel="S", unit="V", y=noise * RNG.standard_normal(ROWS), base=np.ones((ROWS, 1)),
        base_labels=[("law_offset", "V")], t=T, run=label, session=label, valid=label == 0, held=T > 20,
        period_s=PERIOD_S,
    )  # fmt: skip
    sizes = [Some(value=g, error=error) for g in gains]
    labels = [("gain_p", "V/m"), ("gain_d", "V s/m")]
    return Some(problem=p, terms=terms, gains=np.array(gains), sizes=sizes, labels=labels)


DECLARED = {"gain_p": 2.0, "gain_d": 1.0}


def test_gains_that_held_rows_have_are_told() -> None:
    said_, found = controllerlaw._others(law(2.5, 1.1), DECLARED)
    assert said_ == [
        "controller: gain_p is 2.5 V/m (+25.0 % of the declared one)",
        "controller: gain_d is 1.1 V s/m (+10.0 % of the declared one)",
    ]
    assert [f.note for f in found] == said_[:1] and found[0].evidence == 1e4
    assert controllerlaw._others(law(2.0, 1.0), DECLARED) == ([], [])
    small, _ = controllerlaw._others(law(2.5, 1.019), DECLARED)
    assert len(small) == 1  # less than two hundredths
    unsure, _ = controllerlaw._others(law(2.5, 1.1, error=0.021), DECLARED)
    assert len(unsure) == 1  # less than five errors
    assert controllerlaw._others(law(2.003, 1.0, noise=1.0), DECLARED) == ([], [])
    _other, found = controllerlaw._others(law(2.5, 1.0, error=0.05), DECLARED)
    assert found[0].evidence == pytest.approx(100 / 4.6)
    none, _ = controllerlaw._others(law(2.5, 1.1), {"gain_p": 2.0, "gain_d": 0.0})
    assert len(none) == 1


def test_a_law_may_have_other_gains_below_a_speed() -> None:
    terms, speed = RNG.standard_normal((ROWS, 2)), T
    given: Any = Some(
        labels=[("gain_p", "V/m"), ("gain_d", "V s/m")], terms=terms,
        rates={"speed_limit": Some(speed=speed, limits=[3.0, 5.0], unit="m/s")},
    )  # fmt: skip
    first, second = controllerlaw.changed_below(given)
    assert first.labels == (("gain_p_below", "V/m"), ("gain_d_below", "V s/m"))
    assert (first.name, first.domain, first.fixed) == (UNKNOWN, "command", {"speed_limit": (3.0, "m/s")})
    assert np.array_equal(first.columns, np.where(speed[:, None] < 3.0, terms, 0.0))
    assert second.fixed == {"speed_limit": (5.0, "m/s")} and second.columns[450].any()


def test_a_feed_forward_stands_beside_the_gains() -> None:
    c: Any = Some(
        problem=Some(unit="V"),
        labels=[("gain_p", "V/m")],
        follows=np.ones((ROWS, 1)),
        forward=np.zeros((ROWS, 3)),
    )
    v = scene().view
    v.rig.columns["position"] = Column("m")
    found = controllerlaw._forward(v, c)
    assert found.labels == (
        ("gain_p_beside", "V/m"), ("rate_feedforward", "V s/m"), ("acceleration_feedforward", "V s2/m"),
        ("friction_feedforward", "V"),
    )  # fmt: skip
    assert found.domain == "reference" and found.columns.shape == (ROWS, 4)


def test_lines_of_a_command_are_the_changes_of_sines_from_row_to_row() -> None:
    run = np.repeat([0, 1], ROWS // 2)
    p = law(1.0, 1.0).problem
    p.run, p.ar_order = run, 0
    p.t = T + 500.0 * run
    p.y = np.gradient(np.cos(2 * np.pi * 3.0 * p.t)) + 0.001 * RNG.standard_normal(ROWS)
    found = controllerlaw._lines_of_steps(p)
    assert len(found) >= 1 and found[0].per_run and found[0].searched == 0 and found[0].domain == "time"
    f = found[0].fixed["frequency"][0]
    assert f == pytest.approx(3.0, abs=0.05) and found[0].steps[0] == pytest.approx(0.5 / 14.99)
    x, before = 2 * np.pi * f * p.t, 2 * np.pi * f * (p.t - PERIOD_S)
    assert found[0].columns[:, 0] == pytest.approx(np.where(run == 0, np.cos(x) - np.cos(before), 0.0))
    assert found[0].columns[:, 3] == pytest.approx(np.where(run == 1, np.sin(x) - np.sin(before), 0.0))
