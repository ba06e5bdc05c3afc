"""What an answer is worth: probabilities, withdrawals, floors, what is lacking."""

from typing import Any

import numpy as np
import pytest

from calibration.balances.problem import Problem
from calibration.decide.heldout import HeldOut
from calibration.decide.thresholds import AXIS_EARNED
from calibration.decide.verdict import effect_as_dict, judge, kind_of, probability
from calibration.decide.withdraw import against_nature, failed_controls, withdraw
from calibration.finding import Finding, Parameter
from calibration.look.lacks import motion_lacks
from calibration.look.looked import Balance
from calibration.names.bearing_pass import between
from calibration.names.command_disturbance import _phase
from calibration.names.play import lag_in_gap
from calibration.statistics.tails import middle


def row(after: float, floor: float | None) -> dict[str, dict[str, Any]]:
    return {"torque": {"unit": "N m", "before": 9.0, "after": after, "floor": floor}}


def finding(name: str = "gear_mesh", **more: Any) -> Finding:
    return Finding(name, "T", "axis_angle", stage="mesh3", harmonic=1, evidence=99.0, **more)


@pytest.mark.parametrize(
    ("after", "floor", "equivalent", "place", "kind"),
    [
        (1.9, 1.0, [], 0, "sole"),
        (1.9, 1.0, [], 1, "further"),
        (1.9, 1.0, ["motor_cogging"], 0, "ambiguous"),
        (2.1, 1.0, [], 0, "above"),
        (2.1, None, [], 0, None),
    ],
)
def test_a_name_is_worth_what_such_answers_earned(
    after: float, floor: float | None, equivalent: list[str], place: int, kind: str | None
) -> None:
    f = finding(equivalent=equivalent)
    error = row(after, floor)
    assert kind_of(f, place, error) == kind
    sure = probability(f, place, error, AXIS_EARNED)
    assert sure is None if kind is None else sure == pytest.approx(AXIS_EARNED[kind].probability)
    assert probability(f, place, error, None) is None, "no sealed logs of such drives: no probability"


def test_what_is_left_above_two_floors_never_has_nine_tenths() -> None:
    assert AXIS_EARNED["above"].probability < 0.9
    data = effect_as_dict(finding(), 0, row(5.0, 1.0), AXIS_EARNED)
    assert data["probability"] == round(AXIS_EARNED["above"].probability, 4)


def test_a_name_whose_control_was_accepted_is_withdrawn_and_not_lost() -> None:
    place = {"name": "gear_mesh", "stage": "mesh3", "harmonic": 1}
    tried = [
        {"what": "time reversed (gear_mesh on mesh3)", "accepted": True, **place},
        {"what": "sign flipped", "accepted": False, "name": "brake_drag", "stage": None, "harmonic": None},
    ]
    kept, refused = withdraw([finding(), Finding("brake_drag", "T", "time")], failed_controls(tried))
    assert [f.name for f in kept] == ["brake_drag"]
    assert refused == [("T", "gear_mesh on mesh3", "withdrawn: accepted as well with time reversed")]
    assert judge([], ["a second speed"]) == ("cannot tell", "a second speed")
    assert judge([])[0] == "nothing"


def test_a_floor_is_not_limited_to_what_is_left() -> None:
    zero, every = np.zeros(10), np.ones(10, dtype=bool)
    run = zero.astype(np.int64)
    p = Problem(
        channel="T", unit="N m", y=zero, base=zero[:, None], base_labels=[], t=zero, run=run, session=run,
        valid=every, held=every, period_s=1.0,
    )  # fmt: skip
    s = type("S", (), {"problem": p, "held": HeldOut(before=2.0, after=0.8)})()
    one, *none = [Balance(key="T", row="torque", selection=s, floor=f) for f in (1.0, None, np.nan)]
    assert one.error["floor"] == 1.0  # above after: the noise of this stretch was less
    assert one.times == pytest.approx(0.8)
    assert all(b.error["floor"] is None and b.times == 0.0 for b in none)
    assert Balance(key="S1", row=None, selection=s, floor=1.0).times == 0.0


def test_intervals_are_computed_or_absent() -> None:
    assert middle(np.array([3.0]), "s") == Parameter(3.0, "s")
    found = middle(np.array([1.0, 1.2, 0.9, 1.1, 1.0]), "s")
    assert found.low is not None and found.high is not None and found.low < 1.0 < found.high
    assert found.times(2.0).high == pytest.approx(2 * found.high)


def test_one_speed_and_one_direction_are_said() -> None:
    steady = np.full(1000, 1e-3)
    assert motion_lacks(steady) == ["a second speed", "the other direction"]
    assert motion_lacks(np.concatenate([steady, -steady / 9])) == []
    assert motion_lacks(np.zeros(10)) == ["a motion"]


def test_a_gap_lags_by_half_its_width_once_it_is_crossed() -> None:
    there = np.concatenate([np.linspace(0, 10, 101), np.linspace(10, 0, 101)[1:]])
    e = lag_in_gap(there, np.zeros(201, dtype=np.int64), 3.0)
    assert e[50] == pytest.approx(-1.5) and e[200] == pytest.approx(1.5)
    assert e[100 + 15] == pytest.approx(0.0, abs=1e-9)  # half of the 3 are crossed after 1.5 of 0.1 a row
    assert np.diff(there + e)[102:128] == pytest.approx(0.0, abs=1e-9)  # the reading stands meanwhile


@pytest.mark.parametrize("square", [False, True])
def test_a_phase_is_found_on_rows_that_are_half_missing(square: bool) -> None:
    x = np.linspace(0, 60 * np.pi, 6000)
    kept = np.sin(x + 0.4) > -0.3  # the rows of one half turn are gone
    wave = np.sin(x + 2.0)
    y = (np.sign(wave) if square else wave)[kept] + 0.7
    found = _phase(x[kept], y, square)
    assert np.angle(np.exp(1j * (found - 2.0))) == pytest.approx(0.0, abs=0.05 if square else 1e-6)


def test_a_fit_with_a_negative_inertia_names_nothing() -> None:
    zero, every = np.zeros(10), np.ones(10, dtype=bool)
    run = zero.astype(np.int64)
    labels = [("inertia", "kg m2"), ("coulomb", "N m")]
    p = Problem(
        channel="T",
        unit="N m",
        y=zero,
        base=np.zeros((10, 2)),
        base_labels=labels,
        t=zero,
        run=run,
        session=run,
        valid=every,
        held=every,
        period_s=1.0,
    )
    for inertia, kept in ((-5.0, 0), (-0.5, 1), (5.0, 1)):  # half a standard error below zero is no sign
        fit = type("F", (), {"beta": np.array([inertia, 3.0]), "errors": np.ones(2)})()
        s = type("S", (), {"problem": p, "after": fit})()
        found, refused = withdraw([finding()], against_nature({"T": s}))
        assert (len(found), len(refused)) == (kept, 1 - kept)
    assert not refused
    _, ((*_, why),) = withdraw([finding()], against_nature({"T": _with(s, -5.0)}))
    assert "inertia would be -5" in why


def _with(s: Any, inertia: float) -> Any:
    s.after.beta = np.array([inertia, 3.0])
    return s


def test_a_free_order_is_moved_within_its_cell_and_never_onto_a_stage() -> None:
    known = np.array([14.7, 24.5, 250.0])
    assert between(20.7, known, 1.0) == (20.2, 21.2)
    low, high = between(249.2, known, 1.0)
    assert (low, high) == (248.7, pytest.approx(250.0 - 0.35))
    low, high = between(24.9, known, 1.0)
    assert (low, high) == (pytest.approx(24.85), pytest.approx(25.4))
