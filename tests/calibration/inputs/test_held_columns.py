"""Columns that hold one number while the drive moves, and currents that pile up at the end of a converter."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from calibration.errors import CalibrationInputError
from calibration.inputs.declaration import Response
from calibration.inputs.rigfile import telescope
from calibration.inputs.run import Run
from calibration.inputs.stuck import _held, _leaps, check_counted, check_stuck, converter_end, piled_at
from tests.calibration.inputs.made import rig, run

NAN = float("nan")


def refused(call: object, *more: object) -> str:
    with pytest.raises(CalibrationInputError) as caught:
        call(*more)  # type: ignore[operator]
    return str(caught.value)


def test_a_column_holds_a_number_where_all_rows_have_it() -> None:
    found = [_held(np.array(x)) for x in ([2.0, NAN, 2.0], [2.0, 3.0], [NAN], [], [-0.0])]
    assert found == [2.0, None, None, None, 0.0]


def quick(rate: float, rows: int = 200, **raw: float) -> Run:
    """From rest to `rate` rad/s and more, evenly."""
    t = 0.01 * np.arange(float(rows))
    r = run(rate * t**2 / (2 * t[-1]), t)
    r.scales = {"gear_ratio": 10.0}
    r.raw = {name: np.full(rows, x) for name, x in raw.items()}
    return r


FACTORS = {"velocity": 0.1, "tach_a": 1.0, "tach_b": 1.0, "aux": 0.1}


@pytest.mark.parametrize(
    ("given", "column"),
    [
        # over 25 rows the rate goes from 6 % to 94 % of the last one; of that 98 in 100 rows count
        (quick(0.36, velocity=7.0), "velocity"),
        (quick(0.33, velocity=7.0), ""),
        (quick(0.36, tach_a=7.0), "tach_a"),  # ten times as quick, ten times as coarse
        (quick(0.33, tach_a=7.0), ""),
        (quick(0.36, tach_b=7.0), "tach_b"),
        (quick(0.32, aux=7.0), "aux"),  # of an angle of 0.32 rad all but two in a hundred
        (quick(0.30, aux=7.0), ""),
        (quick(9.0), ""),
        (quick(9.0, 125, velocity=7.0), "velocity"),
        (quick(9.0, 124, velocity=7.0), ""),  # 99 stretches of 25 rows
        (quick(9.0, 100, aux=7.0), "aux"),
        (quick(9.0, 99, aux=7.0), ""),
    ],
)
def test_a_sensor_misses_more_than_three_counts_or_is_coarse(given: Run, column: str) -> None:
    if column:
        said = "holds 7 in every row while the position moves: it measures nothing, leave it out"
        assert refused(check_counted, given, FACTORS, 12) == f"a.csv:12: column '{column}': {said}"
    else:
        check_counted(given, FACTORS, 12)


def test_stretches_with_a_leap_a_gap_or_without_a_number_do_not_count() -> None:
    still = quick(0.0, 300, velocity=7.0)
    still.columns["position"][150:] += 5.0  # a counter that wraps
    check_counted(still, FACTORS, 12)
    still.columns["position"][10:40] = NAN
    check_counted(still, FACTORS, 12)
    moved = quick(9.0, 300, velocity=7.0)
    moved.columns["position"][7] = NAN
    assert "velocity" in refused(check_counted, moved, FACTORS, 12)
    moved.columns["t"][:] = 0.0
    check_counted(moved, FACTORS, 12)


@pytest.mark.parametrize(("step", "leaps"), [(1.0, True), (0.0102, True), (0.01, False), (-1.0, True)])
def test_a_leap_is_ten_times_the_rows_beside_it(step: float, leaps: bool) -> None:
    """A step of 0.001 in every row, and 1e-4 rad more than ten times that."""
    steps = np.full(60, 0.001)
    steps[30] = step
    found = _leaps(np.concatenate([[0.0], np.cumsum(steps)]))
    assert len(found) == 61 - 25
    assert np.flatnonzero(found).tolist() == (list(range(6, 31)) if leaps else [])
    beside = steps.copy()
    beside[29] = abs(step)  # as quick as the row before
    assert not _leaps(np.concatenate([[0.0], np.cumsum(beside)])).any()


def drive(moved: float, **columns: float) -> list[Run]:
    parts = []
    for k in range(2):
        x = 5.0 + moved * np.sin(np.arange(50.0) + k)
        parts.append(run(x, **{name: np.full(50, value) for name, value in columns.items()}))
    return parts


CHANNELS = ("position", "effort", "velocity", "acceleration", "motor_a", "motor_b", "load")


@pytest.mark.parametrize("channel", ["effort", "velocity", "acceleration", "motor_a", "motor_b"])
def test_a_response_or_a_rate_that_holds_still_explains_nothing(channel: str) -> None:
    said = refused(check_stuck, drive(1.0, **{channel: 3.0}), rig(*CHANNELS))
    why = "holds 3 in every row while the position moves: it measures nothing, leave it out"
    assert said == f"a.csv: column '{channel}': {why}"
    check_stuck(drive(0.0, **{channel: 3.0}), rig(*CHANNELS))
    check_stuck(drive(2e-9, **{channel: 3.0}), rig(*CHANNELS))  # as numbers of about 5 are rounded
    assert refused(check_stuck, drive(3e-9, **{channel: 3.0}), rig(*CHANNELS)) == said


def test_other_columns_may_hold_still() -> None:
    check_stuck(drive(1.0, load=3.0, effort=NAN), rig(*CHANNELS))
    position = replace(rig("position", "effort"), responses=(Response("position", "deg"),))
    check_stuck(drive(1.0, effort=3.0), position)
    motors = replace(position, motors=telescope("ra").motors)
    assert "column 'effort'" in refused(check_stuck, drive(1.0, effort=3.0), motors)
    other = drive(1.0, effort=3.0)
    other[1].columns["effort"] = np.full(50, 4.0)
    check_stuck(other, rig(*CHANNELS))


def piled(at_end: int, next_to: int, below: int = 500, steady: bool = False) -> tuple[np.ndarray, np.ndarray]:
    x = np.concatenate([np.full(at_end, 10.0), np.full(next_to, 9.0), np.linspace(0.0, 8.0, below)])
    effort = np.resize([0.0, 1.0], len(x))
    return x, np.where(x == 10.0, 0.5, effort) if steady else effort


@pytest.mark.parametrize(
    ("at_end", "next_to", "crowded"),
    [(60, 0, True), (59, 0, False), (81, 20, True), (80, 20, False), (500, 100, True), (320, 100, False)],
)
def test_rows_pile_up_at_an_end(at_end: int, next_to: int, crowded: bool) -> None:
    x, effort = piled(at_end, next_to)
    assert piled_at(x, effort, 10.0, 9.0) == ((at_end, next_to) if crowded else None)
    assert piled_at(-x, effort, -10.0, -9.0) == ((at_end, next_to) if crowded else None)


def test_a_steady_effort_makes_a_steady_current() -> None:
    x, effort = piled(100, 0, steady=True)
    assert piled_at(x, effort, 10.0, 9.0) is None and piled_at(x, effort, 11.0, 9.0) is None
    effort[0] = 0.519  # two per cent of the whole range are 0.02
    assert piled_at(x, effort, 10.0, 9.0) is None
    effort[0] = 0.521
    assert piled_at(x, effort, 10.0, 9.0) == (100, 0)


def currents(x: np.ndarray, effort: np.ndarray) -> Run:
    return Run("a", Path("a"), "a", {"current_a": x, "current_b": 0.5 * x, "effort": effort})


def test_a_converters_end_is_the_largest_current_of_all_runs() -> None:
    x, effort = piled(100, 3)
    names = ("current_a", "current_b")
    assert converter_end([currents(x, effort)], names) == 10.0
    assert converter_end([currents(x, effort)] * 2, names) == 10.0
    assert converter_end([currents(x, effort), currents(np.array([12.0, NAN]), np.zeros(2))], names) is None
    bare = Run("b", Path("b"), "b", {"effort": effort})
    assert converter_end([currents(x, effort), bare], names) is None
    assert converter_end([], names) is None
    assert converter_end([currents(np.full(100, 3.0), effort[:100])], ("current_a",)) is None
    gappy = np.concatenate([x, [NAN]])
    assert converter_end([currents(gappy, np.append(effort, 1.0))], names) == 10.0
