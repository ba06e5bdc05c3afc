"""Faults of a column undone: the late column is shifted, and a correction stays only where errors fall."""

from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.finding import Finding, Parameter
from calibration.inputs.run import Run
from calibration.look.applied import (
    axis_by_motors,
    before_of,
    corrected_runs,
    judged,
    keep_untouched,
    too_little,
    without,
)  # fmt: skip
from plant.units import ARCSEC

RATE_S = 0.01
T = RATE_S * np.arange(300)


def late(column: float, delay: float) -> Finding:
    parameters = {"column": Parameter(column, "1"), "delay": Parameter(delay, "s")}
    return Finding("channel_delay", "K", "clock", parameters=parameters)


def result(**fields: Any) -> Any:
    return Some(**{"findings": [], "refused": [], "selections": {}, "floors": {}, "before": {}} | fields)


def channel(before: float = 1.0, after: float = 1.0, chosen: tuple[str, ...] = ()) -> Any:
    return Some(held=Some(before=before, after=after), chosen=chosen)


NAMES = ("position", "velocity", "current_a", "current_b", "motor_a", "motor_b")


@pytest.mark.parametrize(
    ("number", "names"),
    [(1, ("position",)), (2, ("velocity",)), (3, ("current_a", "current_b")), (4, ("motor_a", "motor_b"))],
)
def test_the_late_column_alone_is_shifted_by_its_delay(number: int, names: tuple[str, ...]) -> None:
    """A sine that is read late by 37 ms is itself again; the ends of the log are not known."""

    def sine(t: np.ndarray) -> np.ndarray:
        return np.asarray(np.sin(2 * np.pi * t))

    given = {name: sine(T - 0.037) for name in NAMES}
    run = Run("one", None, "one", {"t": T, **given})  # type: ignore[arg-type]
    (found,) = corrected_runs(result(frame=Some(runs=[run])), late(number, 0.037))
    for name in NAMES:
        if name not in names:
            assert found.columns[name] is given[name]
            continue
        good = np.isfinite(found.columns[name])
        assert good.sum() == 296 and good[:296].all()  # 3.7 rows behind the last
        assert found.columns[name][good] == pytest.approx(sine(T[good]), abs=1e-4)
    assert run.columns["position"] is given["position"]


def test_a_column_of_a_few_numbers_is_left_alone() -> None:
    few = np.full(300, np.nan)
    few[:3] = 1.0
    run = Run("one", None, "one", {"t": T, "velocity": few})  # type: ignore[arg-type]
    (found,) = corrected_runs(result(frame=Some(runs=[run])), late(2, 0.02))
    assert found.columns["velocity"] is few


@pytest.mark.parametrize(
    ("before", "after", "floors", "helps"),
    [
        ({"T": 1.0}, {"T": 0.98}, {}, True),
        ({"T": 1.0}, {"T": 0.995}, {}, False),
        ({"T": 1.0, "K": 1.0}, {"T": 0.9, "K": 1.04}, {}, True),
        ({"T": 1.0, "K": 1.0}, {"T": 0.9, "K": 1.07}, {}, True),  # together they fall
        ({"T": 1.0, "K": 1.0}, {"T": 0.9, "K": 1.12}, {}, False),
        ({"T": 1.0, "K": 1.0}, {"T": 0.4, "K": 1.2}, {}, False),  # one rises by too much
        ({"T": 1.0, "K": 1.0}, {"T": 0.4, "K": 1.2}, {"K": 1.3}, True),  # within the floor it may
        ({"T": 1.0, "K": 0.0}, {"T": 0.9, "K": 0.0}, {}, True),
        ({}, {"T": 0.1}, {}, False),
    ],
)
def test_an_applied_effect_stays_where_the_errors_fall_and_none_rises(
    before: dict[str, float], after: dict[str, float], floors: dict[str, float], helps: bool
) -> None:
    again = result(selections={key: channel(value) for key, value in after.items()}, floors=floors)
    refusal = judged(before, again, late(1, 0.02))
    assert (refusal is None) is helps
    if refusal is not None and before:
        assert refusal.what == "channel_delay"
        assert f"T {before['T']:.3g} to {after['T']:.3g}" in refusal.why


def test_a_refused_fault_is_no_finding_but_said() -> None:
    fault = late(1, 0.02)
    found = result(findings=[fault, Finding("play", "K", "reversal")])
    refusal = judged({"T": 1.0}, result(selections={"T": channel(2.0)}), fault)
    assert refusal is not None
    assert without(found, fault, refusal) is found
    assert [f.name for f in found.findings] == ["play"]
    assert found.refused == [("K", "channel_delay", refusal.why)]


@pytest.mark.parametrize(("after", "left"), [(0.40, 54), (0.20, None)])
def test_a_gap_that_leaves_most_is_said_in_per_cent(after: float, left: int | None) -> None:
    """Of squares above the floor: (0.4^2 - 0.1^2) / (0.53^2 - 0.1^2) is 54 per cent."""
    refusal = too_little(
        result(selections={"K": channel(0.5354, after)}, floors={"K": 0.1}), Finding("play", "K", "reversal")
    )
    assert (refusal and refusal.why) == (
        None if left is None else f"leaves {left} % of what is above the floor between the encoders"
    )
    for empty in ({"selections": {"K": channel(1.0)}}, {"floors": {"K": 0.1}},
                  {"selections": {"K": channel(1.0, np.inf)}, "floors": {"K": 0.1}}):  # fmt: skip
        assert too_little(result(**empty), Finding("play", "K", "reversal")) is None


@pytest.mark.parametrize(
    ("was", "now", "stays"),
    [
        (channel(1.0), channel(1.2), True),
        (channel(1.0), channel(1.1), True),
        (channel(1.0), channel(1.05), False),
        (channel(1.0, chosen=("wave",)), channel(1.2), False),
        (channel(1.0), channel(1.2, chosen=("wave",)), False),
    ],
)
def test_a_channel_that_the_correction_does_not_help_stays(was: Any, now: Any, stays: bool) -> None:
    """On the rows that both have, the logs as they were leave 1.1."""
    first, again = result(selections={"T": was}), result(selections={"T": now}, before={"T": 1.1})
    keep_untouched(first, again)
    assert again.selections["T"] is (was if stays else now)
    assert again.before["T"] == (1.0 if stays else 1.1)


def test_both_motors_less_the_wind_up_are_the_axis() -> None:
    """Turned at the axis, 100 motor turns a turn; A's torque winds it forwards, B's backwards."""
    rows, ratio, per_ampere, compliance = 50, 100.0, 40.0, 2 * ARCSEC
    run = np.zeros(rows, dtype=np.int64)
    axis = 1e-4 * np.arange(rows)
    torque = {"a": 30.0 + np.arange(rows), "b": 10.0 + 0.5 * np.arange(rows)}
    columns = {}
    for key, sign in (("a", 1.0), ("b", -1.0)):
        motor = axis + compliance * sign * torque[key]
        columns[f"motor_{key}"] = np.diff(motor, prepend=0.0) * ratio / RATE_S
        columns[f"current_{key}"] = torque[key] / per_ampere
    named = {"compliance": Some(value=compliance)}
    fit = Some(problem=Some(named=lambda _: named), after=None)
    frame = Some(columns=columns, run=run, scale={"gear_ratio": ratio}, period_s=RATE_S)
    given = result(frame=frame, kinematic=Some(per_ampere=per_ampere), selections={"K": fit})
    assert axis_by_motors(given) == pytest.approx(axis, abs=1e-12)
    assert axis_by_motors(result(frame=frame, kinematic=None, selections={"K": fit})) is None
    assert axis_by_motors(result(frame=frame, kinematic=given.kinematic)) is None


def test_errors_before_are_those_of_the_rows_that_are_left() -> None:
    fault, residual = Finding("play", "K", "reversal"), np.array([3.0, -4.0, 100.0, 5.0])
    test = np.array([True, False, True, False, True, True])
    kept = np.array([True, True, True, True, False, True])
    s = Some(problem=Some(test=test), held=Some(before=1.0), bare=Some(residual=lambda *_: residual))
    first, again = result(selections={"T": s}), result(selections={"T": Some(problem=Some(test=kept))})
    assert before_of(first, again, fault) == {"T": pytest.approx(np.sqrt((9 + 16 + 25) / 3))}
    assert before_of(first, result(), fault) == {}
    other = result(selections={"T": Some(problem=Some(test=kept[:3]))})
    assert before_of(first, other, fault) == {}
    s.held.before = np.inf
    assert before_of(first, again, fault) == {}
