"""Friction along a motion, and the terms of a controller."""

from typing import Any

import numpy as np
import pytest

from calibration.balances import law
from calibration.balances.friction import Path, Sliding, sliding_of
from calibration.inputs.declaration import Column, Controller, FrictionLaw, Response
from tests.calibration.names.made import PERIOD_S, back_and_forth, drive

ROWS = 4000
X: np.ndarray = back_and_forth(40, 100)
T: np.ndarray = PERIOD_S * np.arange(ROWS)
TWO = np.repeat([0, 1], ROWS // 2)


LAW = FrictionLaw(stiction_ratio=1.8, stribeck_speed=0.5, stribeck_exponent=1.5)
BRISTLES = FrictionLaw(1.8, 0.5, 1.5, bristle_travel=0.01)
SPEED: np.ndarray = np.linspace(-2, 2, 200)


def sliding(given: FrictionLaw) -> Sliding:
    x = np.cumsum(SPEED) * PERIOD_S
    path = Path(position=x, fresh=np.arange(200) == 0, period_s=PERIOD_S)
    return Sliding(law=given, path=path, side=np.sign(SPEED), speed=SPEED, coulomb=3.0, viscous=0.5)


def test_friction_along_a_motion_is_the_law_s() -> None:
    f, dip = sliding(LAW), np.exp(-((np.abs(SPEED) / 0.5) ** 1.5))
    assert f.shape == pytest.approx(np.sign(SPEED) * (1 + 0.8 * dip))
    assert f.steady == pytest.approx(3 * (1 + 0.8 * dip)) and f.drag == pytest.approx(0.5 * SPEED)
    assert f.size == pytest.approx(f.steady + 0.5 * np.abs(SPEED))
    assert f.stiction == pytest.approx(3 * 1.8 * dip)
    plain = sliding(FrictionLaw())
    assert plain.stiction == pytest.approx(np.full(200, 3.0)) and plain.shape == pytest.approx(np.sign(SPEED))
    change = np.cos(SPEED)
    assert f.answer(change) == pytest.approx(np.sign(SPEED) * change)
    assert sliding(BRISTLES).shape == pytest.approx(sliding(BRISTLES).path.bristle(BRISTLES))


def test_bristles_answer_to_a_change_of_their_level() -> None:
    """As the difference of two frictions whose levels differ little."""
    f = sliding(BRISTLES)
    change = 0.3 * np.cos(SPEED)
    more, less = (
        f.path.bristle(BRISTLES, f.path.level(BRISTLES) * (1 + h * change / f.steady)) for h in (0.01, -0.01)
    )
    assert f.answer(change) == pytest.approx(3.0 * (more - less) / 0.02, rel=1e-2, abs=2e-3)
    assert not f.answer(0 * change).any()


def test_a_drive_s_friction_is_its_rig_s_law_or_coulomb_s() -> None:
    v = drive(X).view
    plain = sliding_of(v)
    assert np.array_equal(plain.shape, v.direction) and (plain.coulomb, plain.viscous) == (1.0, 0.0)
    assert plain.path.fresh.tolist() == [True] + [False] * (ROWS - 1)
    two = drive(X, files=TWO, rig={"friction_law": LAW}).view
    assert np.flatnonzero(sliding_of(two).path.fresh).tolist() == [0, ROWS // 2]
    assert sliding_of(two, 2.0, 3.0).law is LAW and sliding_of(two, 2.0, 3.0).coulomb == 2.0


PID = Controller(
    "pid", {"p": 3.0, "i": 2.0, "d": 0.5, "rate_feedforward": 0.1, "acceleration_feedforward": 0.2}
)
CASCADE = Controller("cascade", {"position": 4.0, "velocity": 2.0})


def commanded(**more: Any) -> Any:
    reference = np.sin(T)
    columns = {"reference": reference, "effort": np.cos(T)}
    v = drive(
        0.9 * np.sin(T - 0.1), columns=columns, response=Response("effort", "A"), dynamic=True, **more
    ).view
    v.rig.columns["effort"] = Column("A")
    return v


def test_a_law_s_terms_have_their_declared_sizes() -> None:
    assert law.declared_terms(PID) == {f"gain_{k}": x for k, x in PID.gains.items()}
    assert law.declared_terms(CASCADE) == {"gain_of_error": 8.0, "gain_of_rate": 2.0}
    assert CASCADE.gains == {"position": 4.0, "velocity": 2.0}


def test_columns_of_a_law_are_the_error_its_integral_and_rates() -> None:
    v = commanded()
    error = v.columns["reference"] - v.x
    labels, x = law._terms(v, PID, error)
    assert labels == [
        ("gain_p", "A/m"), ("gain_i", "A/(m s)"), ("gain_d", "A s/m"), ("gain_rate_feedforward", "A s/m"),
        ("gain_acceleration_feedforward", "A s2/m"),
    ]  # fmt: skip
    rate = np.gradient(v.columns["reference"], PERIOD_S)
    expected = [
        error,
        np.cumsum(error) * PERIOD_S,
        np.gradient(error, PERIOD_S),
        rate,
        np.gradient(rate, PERIOD_S),
    ]
    assert x == pytest.approx(np.column_stack(expected))
    labels, x = law._terms(v, CASCADE, error)
    assert labels == [("gain_of_error", "A/m"), ("gain_of_rate", "A s/m")]
    assert x == pytest.approx(np.column_stack([error, -np.gradient(v.x, PERIOD_S)]))


def test_lags_begin_settled_and_stay_within_a_segment() -> None:
    v = commanded(segment=TWO)
    step = np.where(TWO == 0, 2.0, 5.0)
    assert law._lagged(v, step, 10.0) == pytest.approx(step)
    rise = np.where(np.arange(ROWS) < 50, 0.0, 1.0)
    k = np.arange(ROWS) - 49
    expected = np.where(k > 0, 1 - np.exp(-k / 10.0), 0.0)
    assert law._lagged(v, rise, 10.0)[:2000] == pytest.approx(expected[:2000])
    known = law._known(v, v.columns["reference"])
    assert known.shape == (ROWS, 1 + 2 * (3 + 6))


def test_offsets_of_a_law_are_per_file_and_of_an_integral_per_piece_with_a_ramp() -> None:
    s = drive(X, files=TWO)
    plain, names = law._per_file(s.view, s.problem, False, "A")
    assert np.array_equal(plain, np.column_stack([TWO == 0, TWO == 1])) and names == [("law_offset", "A")] * 2
    s.view.segment = np.repeat([0, 1, 2, 3], 1000)
    ramps, names = law._per_file(s.view, s.problem, True, "A")
    assert ramps.shape == (ROWS, 8) and names[4:] == [("law_ramp", "A")] * 4
    assert ramps[500, 4] == pytest.approx(s.view.t[500] / s.view.t.max()) and ramps[1500, 4] == 0.0


@pytest.mark.parametrize(
    ("given", "count"),
    [(PID, 1), (Controller("pid", {"p": 1.0}), 1), (CASCADE, 2), (Controller("pid", {"d": 1.0}), 1)],
)
def test_lags_of_a_law_are_of_its_rate_and_of_all(given: Controller, count: int) -> None:
    v = commanded()
    output = np.cos(T)
    found = law._late(v, given, output)
    assert len(found) == count
    error = v.columns["reference"] - v.x
    if given.law == "cascade":
        assert found[0] == pytest.approx(v.second(v.x))
    elif "d" in given.gains:
        assert found[0] == pytest.approx(-v.second(error))
    if "d" not in given.gains:
        assert found[-1] == pytest.approx(-np.gradient(output, PERIOD_S))
