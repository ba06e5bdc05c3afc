"""What an answer is worth: probabilities, withdrawals, floors, what is lacking."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from calibration.answers import error_row
from calibration.candidates.amplifier import _phase
from calibration.candidates.axis_lines import _between
from calibration.candidates.candidate import Candidate
from calibration.candidates.kinematic import lag_in_gap
from calibration.channels.problem import Problem
from calibration.decide.heldout import HeldOut
from calibration.decide.missing import above_floor
from calibration.decide.passive import sound
from calibration.decide.probability import kind_of, probability
from calibration.decide.select import select
from calibration.decide.thresholds import AXIS_EARNED
from calibration.decide.verdict import Verdict, as_dict, judge
from calibration.decide.withdraw import withdraw
from calibration.finding import Finding, Parameter, middle
from calibration.twomotors.lacks import motion_lacks


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
    data = as_dict(Verdict("found", [finding()], error=row(5.0, 1.0), earned=AXIS_EARNED))
    assert data["effects"][0]["probability"] == round(AXIS_EARNED["above"].probability, 4)
    assert above_floor(row(5.0, 1.0)) == {"torque": 5.0} and above_floor(row(5.0, None)) == {}


def test_a_name_whose_control_was_accepted_is_withdrawn_and_not_lost() -> None:
    place = {"name": "gear_mesh", "stage": "mesh3", "harmonic": 1}
    tried = [
        {"what": "time reversed (gear_mesh on mesh3)", "accepted": True, **place},
        {"what": "sign flipped", "accepted": False, "name": "brake_drag", "stage": None, "harmonic": None},
    ]
    kept, refused = withdraw([finding(), Finding("brake_drag", "T", "time")], tried)
    assert [f.name for f in kept] == ["brake_drag"]
    assert refused == [("T", "gear_mesh on mesh3", "withdrawn: accepted as well with time reversed")]
    assert judge([], ["a second speed"]) == ("cannot tell", "a second speed")
    assert judge([])[0] == "nothing"


def test_a_floor_is_not_limited_to_what_is_left() -> None:
    n = 10
    p = Problem(
        "T", "N m", *[np.zeros(n), np.zeros((n, 1))], [], *[np.zeros(n)] * 3, *[np.ones(n, bool)] * 2, 1
    )
    s = type("S", (), {"problem": p, "held": HeldOut(2.0, 0.8, 0.0, 0.0)})()
    assert error_row(s, 1.0)["floor"] == 1.0  # above after: the noise of this stretch was less
    assert error_row(s, None)["floor"] is None and error_row(s, float("nan"))["floor"] is None


def test_intervals_are_computed_or_absent() -> None:
    assert middle(np.array([3.0]), "s") == Parameter(3.0, "s")
    found = middle(np.array([1.0, 1.2, 0.9, 1.1, 1.0]), "s")
    assert found.low is not None and found.high is not None and found.low < 1.0 < found.high
    assert found.times(2.0).high == pytest.approx(2 * found.high)


def test_a_log_that_is_too_short_names_the_candidate_that_was_close() -> None:
    rng = np.random.default_rng(2)
    t = np.arange(1500) * 0.01  # 15 s: 5 blocks of 3 s
    line = np.column_stack([np.cos(2 * np.pi * t), np.sin(2 * np.pi * t)])
    nothing = np.zeros(1500, dtype=bool)
    run = nothing.astype(np.int64)
    y, base = line @ [1.0, 0.0] + 0.1 * rng.standard_normal(1500), np.ones((1500, 1))
    labels = [("offset", "N m")]
    p = Problem("T", "N m", y, base, labels, t, run, run, ~nothing, nothing, 0.01, block_s=3.0)
    c = Candidate("bearing_pass", "axis_angle", line, (("amplitude", "N m"),), kind="line")
    s = select(p, [c], rng)
    assert not s.chosen
    assert [r.what for r in s.refused] == ["every candidate", "bearing_pass"]
    assert "60 s" in s.refused[0].why and "closest" in s.refused[1].why


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
    p = Problem("T", "N m", zero, np.zeros((10, 2)), labels, zero, run, run, every, every, 1.0)
    for inertia, kept in ((-5.0, 0), (-0.5, 1), (5.0, 1)):  # half a standard error below zero is no sign
        fit = type("F", (), {"beta": np.array([inertia, 3.0]), "covariance": np.eye(2)})()
        s = type("S", (), {"problem": p, "after": fit})()
        found, refused = sound([finding()], {"T": s})
        assert (len(found), len(refused)) == (kept, 1 - kept)
    assert not refused and "inertia would be -5" in sound([finding()], {"T": _with(s, -5.0)})[1][0][2]


def _with(s: Any, inertia: float) -> Any:
    s.after.beta = np.array([inertia, 3.0])
    return s


def test_a_free_order_is_moved_within_its_cell_and_never_onto_a_stage() -> None:
    known = np.array([14.7, 24.5, 250.0])
    assert _between(20.7, known, 1.0) == (20.2, 21.2)
    low, high = _between(249.2, known, 1.0)
    assert (low, high) == (248.7, pytest.approx(250.0 - 0.35))
    low, high = _between(24.9, known, 1.0)
    assert (low, high) == (pytest.approx(24.85), pytest.approx(25.4))
