"""A coupling's gap in the position, row by row: the driven side, what carries the axis over, the shift."""

from pathlib import Path
from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.finding import Finding, Parameter
from calibration.inputs.run import Run
from calibration.look import applied
from calibration.look.applied import _earlier, before_of, carried_on, driven_side, judged
from plant.units import ARCSEC
from tests.calibration.look.test_applied import channel, late, result

LEFT = 8.0 * ARCSEC  # further than this a motor has left its tooth


def driven(reading: Any, noise: float = 1.0, run: Any = None) -> list[float]:
    x = np.asarray(reading, dtype=float)
    side = driven_side(x, np.zeros(len(x), dtype=np.int64) if run is None else run, noise)
    return [float(each) for each in side]


def numbers(*each: tuple[float, int]) -> list[float]:
    """Values, each so many times; None is not a number."""
    return [x for value, times in each for x in [value] * times]


ROWS = np.arange(40.0)


@pytest.mark.parametrize(
    ("reading", "noise", "side"),
    [
        (3.0 * ROWS, 1.0, 1.0),  # nine in three rows, of eight noises
        (-3.0 * ROWS, 1.0, -1.0),
        (np.cumsum(np.resize([2.0, 3.0, 3.0], 40)), 1.0, np.nan),  # just eight
        (2.5 * ROWS, 1.0, np.nan),  # four rows would move ten
        (3.0 * ROWS, 1.2, np.nan),
        (3.0 * ROWS, 4.0, np.nan),
        (1000.0 + 0.001 * ROWS, 1e-3, np.nan),
    ],
)
def test_a_side_is_known_where_the_reading_moves_by_eight_noises_in_three_rows(
    reading: Any, noise: float, side: float
) -> None:
    """On either side of the row: three rows at both ends have one side alone."""
    expected = numbers((np.nan, 3), (side, 34), (np.nan, 3))
    assert driven(reading, noise) == pytest.approx(expected, nan_ok=True)


def test_no_side_is_known_about_a_reversal_a_stand_and_between_runs() -> None:
    there_and_back = 100.0 * np.minimum(ROWS, 40 - ROWS)  # turns at row 20
    assert driven(there_and_back) == pytest.approx(
        numbers((np.nan, 3), (1.0, 14), (np.nan, 6), (-1.0, 14), (np.nan, 3)), nan_ok=True
    )
    stood = np.concatenate([100.0 * ROWS[:15], np.full(10, 1400.0), 1400.0 + 100.0 * ROWS[:15]])
    found = driven(stood)
    assert found[3:12] == [1.0] * 9 and found[28:37] == [1.0] * 9 and np.isnan(found[14:26]).all()
    two = driven(100.0 * ROWS, run=np.repeat([0, 1], 20))
    one = numbers((np.nan, 3), (1.0, 14), (np.nan, 3))
    assert two == pytest.approx(one + one, nan_ok=True)


def test_the_axis_goes_on_along_the_motors_or_straight_where_one_left_its_tooth() -> None:
    nan, zeros = np.nan, np.zeros(5, dtype=np.int64)
    bent = np.array([0.0, 0.0, 50.0, 0.0, 0.0]) * ARCSEC
    along = carried_on(np.array([0.0, nan, nan, nan, LEFT]), bent, zeros)
    assert along == pytest.approx(bent + LEFT * np.arange(5) / 4)  # just at the limit
    straight = carried_on(np.array([0.0, nan, nan, nan, 1.01 * LEFT]), bent, zeros)
    assert straight == pytest.approx(1.01 * LEFT * np.arange(5) / 4)
    place = 3.0 + 0.1 * np.arange(12.0)
    seen = place + 2e-5  # within the limit; the first rows and the last are not seen
    seen[[0, 1, 5, 6, 11]] = nan
    assert carried_on(seen, place, np.zeros(12, dtype=np.int64)) == pytest.approx(place + 2e-5, abs=1e-12)
    run = np.repeat([0, 1], 6)
    seen[6:] = nan
    assert carried_on(seen, place, run) == pytest.approx(np.where(run == 0, place + 2e-5, place), abs=1e-12)
    alone = carried_on(np.array([0.0, nan, 1.0, nan, 1.0, nan, 9.0]), np.zeros(7), run[:7] * 0)
    assert alone == pytest.approx([0.0, 0.5, 1.0, 1.0, 1.0, 5.0, 9.0])


def test_a_gap_is_half_its_size_on_either_driven_side(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of two runs, the second of which lacks a row; not driven, the axis goes on along the motors."""
    run = np.repeat([0, 1], [5, 4])
    reading = np.array([10.0, 11.0, 12.0, 13.0, 14.0, 50.0, 51.0, np.nan, 53.0])
    side = np.array([1.0, 1.0, np.nan, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0])
    asked: list[Any] = []

    def given(x: Any, of: Any, noise: float) -> Any:
        asked.append((x.tolist(), of.tolist(), noise))
        return side

    monkeypatch.setattr(applied, "driven_side", given)
    monkeypatch.setattr(applied, "column_noise", lambda _: {"position": 0.5})
    monkeypatch.setattr(applied, "axis_by_motors", lambda _: np.zeros(9))
    clock = np.where(np.isfinite(reading), np.arange(9.0), np.nan)
    rows = [reading[:5], reading[[5, 6, 8]]]
    runs = [
        Run(f"{k}", Path("one"), "", {"t": np.linspace(0, 1, len(x)), "position": x})
        for k, x in enumerate(rows)
    ]
    frame = Some(columns={"position": reading}, run=run, clock=clock, runs=runs)
    fault = Finding("play", "K", "reversal", parameters={"gap": Parameter(4.0 / ARCSEC, "arcsec")})
    one, two = applied.corrected_runs(result(frame=frame), fault)
    assert asked == [([10, 11, 12, 13, 14, 50, 51, 52, 53], run.tolist(), 0.5)]
    assert one.columns["position"] == pytest.approx([12, 13, 12, 11, 12])  # straight from 13 to 11
    assert one.columns["unseen"].tolist() == [0, 0, 1, 0, 0]
    assert two.columns["position"] == pytest.approx([48, 49, 51]) and not two.columns["unseen"].any()
    assert runs[0].columns["position"] is rows[0]


def test_a_column_that_is_shifted_by_nothing_keeps_both_ends_and_its_gaps() -> None:
    t = np.arange(8.0)
    x = np.array([np.nan, 1.0, 2.0, np.nan, 4.0, 5.0, 6.0, np.nan])
    assert _earlier(t, x, 0.0) == pytest.approx(x, nan_ok=True)
    four = np.array([np.nan, 1.0, 2.0, 3.0, 4.0])  # as many as a cubic needs
    assert _earlier(t[:5], four, 0.5) == pytest.approx([np.nan, 1.5, 2.5, 3.5, np.nan], nan_ok=True)
    early = _earlier(t[:5], four, -0.5)
    assert early == pytest.approx([np.nan, np.nan, 1.5, 2.5, 3.5], nan_ok=True)


@pytest.mark.parametrize(
    ("before", "after", "floors", "helps"),
    [
        ({"T": 1.0}, {"T": 0.99}, {}, False),  # a hundredth is no fall
        ({"T": 0.1, "K": 0.1}, {"T": 0.09, "K": 0.112}, {}, False),  # together they rise
        ({"T": 2.0, "K": 1.0}, {"T": 0.9, "K": 1.12}, {}, True),
        ({"T": 2.0, "K": 2.0}, {"T": 1.0, "K": 2.4}, {}, False),  # by a fifth one may not
        ({"T": 1.0, "K": 1.0}, {"T": 0.4, "K": 1.15}, {}, True),
    ],
)
def test_limits_of_a_fall_and_a_rise(
    before: dict[str, float], after: dict[str, float], floors: dict[str, float], helps: bool
) -> None:
    again = result(selections={key: channel(value) for key, value in after.items()}, floors=floors)
    assert (judged(before, again, late(1, 0.02)) is None) == helps


@pytest.mark.parametrize(
    ("key", "told", "held"),
    [
        ("K", 0.004, 0.0),  # encoders of a sound log are not late
        ("T", -0.004, 0.0),
        ("S", 0.004, -0.0025),  # half the window of a rate
        ("E", 0.02, 0.0105),
        ("E", 0.005, 0.005),  # within a sound log's
    ],
)
def test_the_declared_model_before_a_shift_has_a_sound_log_s_delay(
    monkeypatch: pytest.MonkeyPatch, key: str, told: float, held: float
) -> None:
    rows, residual = np.ones(3, dtype=bool), np.array([3.0, 4.0, 5.0])
    monkeypatch.setattr(applied, "declared_residual", lambda fixed: fixed[1] * residual)
    p = Some(test=rows, place=lambda _: 1, holding=lambda fixed: {1: fixed[1] - held + 2.0})
    s = Some(problem=p, held=Some(before=1.0), before=Some(beta=np.array([0.0, told])),
             bare=Some(residual=lambda *_: residual))  # fmt: skip
    first, again = result(selections={key: s}), result(selections={key: Some(problem=Some(test=rows))})
    rms = np.sqrt(50 / 3)
    assert before_of(first, again, late(1, 0.02)) == {key: pytest.approx(2.0 * rms)}
    assert before_of(first, again, Finding("play", "K", "reversal")) == {key: pytest.approx(rms)}
