"""Candidate effects and problems: what they add, where phases stand, which coefficients are allowed."""

from typing import Any

import numpy as np
import pytest

from calibration.balances.candidate import Candidate, pairs_by_section, ramp, sine_columns, waves
from calibration.balances.problem import Problem, labels_of

ROWS = 60
T: np.ndarray = np.arange(float(ROWS))


def candidate(**more: Any) -> Candidate:
    given = {"columns": np.column_stack([T, T**2]), "labels": (("a", "N"), ("b", "N")), **more}
    return Candidate("name", "time", given.pop("columns"), given.pop("labels"), **given)


def test_a_candidate_has_a_key_a_width_and_a_cost() -> None:
    c = candidate(stage="worm", harmonic=3, apart=2.5, searched=2)
    assert c.key == ("name", "worm", 3, 2.5) and (c.width, c.cost) == (2, 4)
    assert c.say() == "name on worm, harmonic 3" and candidate().say() == "name"
    assert candidate(stage="worm").say() == "name on worm"
    assert (candidate().cost, candidate().sign, candidate().open, candidate().per_run) == (2, 0, False, False)


def test_only_lines_and_pulses_repeat_at_an_order() -> None:
    assert candidate(order=4.0).repeats is None
    assert candidate(order=4.0, kind="line").repeats == 4.0
    assert candidate(order=4.0, fixed={"width": (0.1, "1")}).repeats == 4.0


def test_parameters_with_a_step_are_refined_and_the_others_are_its_place() -> None:
    fixed = {"tau": (3.0, "s"), "motor": (1.0, "1 A, 2 B")}
    c = candidate(fixed=fixed, steps=(0.1,), shape=lambda p: p[0] * T[:, None])
    assert c.free == ["tau"] and c.point.tolist() == [3.0] and c.place == {"motor": 1.0}
    moved = c.moved(np.array([5.0]))
    assert np.array_equal(moved.columns[:, 0], 5 * T)
    assert moved.fixed == {"tau": (5.0, "s"), "motor": (1.0, "1 A, 2 B")}


@pytest.mark.parametrize(
    ("more", "beta", "allowed"),
    [
        ({}, [-3.0, 4.0], True), ({"sign": 1}, [3.0, 0.0], True), ({"sign": 1}, [3.0, -1.0], False),
        ({"sign": -1}, [-3.0, -1.0], True), ({"sign": -1}, [3.0, -1.0], False),
        ({"most": 4.0}, [3.0, -4.0], True), ({"most": 4.0}, [3.0, -4.1], False),
        ({"most": (5.0, 1.0)}, [4.5, 0.9], True), ({"most": (5.0, 1.0)}, [4.5, 1.1], False),
        ({"positive": (1,)}, [-3.0, 1.0], True), ({"positive": (1,)}, [3.0, 0.0], False),
    ],
)  # fmt: skip
def test_coefficients_have_the_physical_sign_and_size(more: Any, beta: list[float], allowed: bool) -> None:
    assert candidate(**more).allowed(np.array(beta)) == allowed


def test_waves_are_pairs_of_cosine_and_sine() -> None:
    angle = np.array([0.0, 0.3])
    found = waves(angle, (1, 2.5))
    assert found[1] == pytest.approx([np.cos(0.3), np.sin(0.3), np.cos(0.75), np.sin(0.75)])


def test_every_session_has_a_pair_of_its_own() -> None:
    session = np.repeat([3, 7], 30)
    found = sine_columns(T / 8, session)
    assert found.shape == (ROWS, 4) and not found[30:, :2].any() and not found[:30, 2:].any()
    assert found[1, :2] == pytest.approx([np.cos(np.pi / 4), np.sin(np.pi / 4)])
    assert found[33, 2:] == pytest.approx([np.cos(33 * np.pi / 4), np.sin(33 * np.pi / 4)])


def test_pairs_on_the_same_rows_are_harmonics_and_on_others_a_section() -> None:
    columns = np.zeros((ROWS, 8))
    columns[:30, 0:2] = columns[30:, 2:4] = columns[10:20, 4:6] = columns[29:31, 6:8] = 1.0
    assert pairs_by_section(columns) == [[0, 4, 6], [2]]
    assert pairs_by_section(np.zeros((ROWS, 2))) == [[0]] and pairs_by_section(np.zeros((ROWS, 1))) == []
    touching = np.zeros((ROWS, 4))
    touching[:31, :2] = touching[30:, 2:] = 1.0
    assert pairs_by_section(touching) == [[0, 2]]


def test_a_ramp_lasts_a_second_at_least() -> None:
    assert ramp(np.array([0.0, 10.0, 15.0, 30.0, 40.0]), 10.0, 20.0).tolist() == [0.0, 0.0, 0.25, 1.0, 1.0]
    assert ramp(np.array([10.0, 10.25, 11.0]), 10.0, 0.1).tolist() == [0.0, 0.25, 1.0]


def problem(**more: Any) -> Problem:
    base = np.column_stack([np.ones(ROWS), T])
    given: dict[str, Any] = {
        "y": 2 + 3 * T, "base": base, "base_labels": [("offset", "N"), ("slope", "N/s")], "t": T,
        "run": np.zeros(ROWS, dtype=np.int64), "session": np.repeat([0, 1, 2], 20),
        "valid": np.ones(ROWS, dtype=bool), "held": T >= 50, "period_s": 1.0, "ar_order": 0, **more,
    }  # fmt: skip
    return Problem(channel="T", unit="N", **given)


def test_blocks_are_whole_rows_and_four_at_least() -> None:
    assert [problem(block_s=s).block for s in (1.0, 4.0, 6.6)] == [4, 4, 7]
    assert problem(block_s=8.0, period_s=0.5).block == 16 and problem(block_s=7.0).blocks == 7
    assert Problem.__dataclass_fields__["ar_order"].default == 8 and problem().block == 4


def test_fitted_and_judged_rows_are_apart_unless_files_take_turns() -> None:
    valid = T > 5
    p = problem(valid=valid)
    assert p.train.sum() == 44 and p.test.sum() == 10 and not (p.train & p.test).any()
    turned = problem(valid=valid, turned=T < 30)
    assert np.array_equal(turned.train, valid) and turned.test.sum() == 24
    assert np.array_equal(turned.once.train, p.train)
    assert [part.held.sum() for part in turned.turns] == [20, 20, 20]
    assert all(part.turned is None for part in turned.turns)
    assert len(problem(valid=T >= 20).turns) == 2


def test_rows_that_no_fitted_one_is_like_are_not_judged() -> None:
    """A slope that only the last file has."""
    base = np.column_stack([np.ones(ROWS), np.where(T < 40, 0.0, T)])
    p = problem(base=base, held=T >= 30)
    told = p.told()
    assert told.untold == pytest.approx(20 / 30) and np.array_equal(told.valid, T < 40)
    turned = p.in_turn()
    assert turned.turned is not None and np.array_equal(turned.turned, T < 40)
    assert turned.untold == pytest.approx(1 / 3)
    assert problem().told().untold == 0.0 and problem(held=T > 99).told().untold == 0.0
    assert problem(valid=T > 99).in_turn().untold == 1.0


def test_candidates_stand_behind_the_base() -> None:
    p = problem(base_phases=(slice(0, 2),))
    plain, phased = candidate(), candidate(per_run=True, columns=T[:, None], labels=(("a", "N"),))
    assert p.design([plain, phased]).shape == (ROWS, 5)
    assert p.phases([plain, phased]) == [slice(0, 2), slice(4, 5)]
    assert p.phases([phased, plain]) == [slice(0, 2), slice(2, 3)]


def test_terms_are_found_added_and_held() -> None:
    p = problem()
    p.add(("curve", "N/s2", T**2), ("two", "N", np.column_stack([T**3, T**4])))
    assert p.base.shape == (ROWS, 5) and p.place("curve") == 2
    assert p.base_labels[2:] == [("curve", "N/s2"), ("two", "N"), ("two", "N")]
    with pytest.raises(ValueError, match="not in list"):
        p.place("other")
    held = problem().holding({1: 3.0})
    assert held.y == pytest.approx(np.full(ROWS, 2.0)) and held.base_labels == [("offset", "N")]
    assert np.array_equal(held.base, np.ones((ROWS, 1)))
    assert labels_of([("a", "m", np.zeros((ROWS, 2)))]) == [("a", "m")] * 2


def test_a_fit_names_what_the_base_is_made_of() -> None:
    p = problem()
    assert p.plain_fit(p.train)[0] == pytest.approx({"offset": 2.0, "slope": 3.0})
    assert np.abs(p.plain_fit(p.train)[1]).max() < 1e-9
    named = p.named(p.fit())
    assert named["slope"].value == pytest.approx(3.0) and named["slope"].error >= 0.0
    assert p.fit(T[:, None]).beta == pytest.approx([float(T[:50] @ p.y[:50] / (T[:50] @ T[:50]))], rel=1e-2)
