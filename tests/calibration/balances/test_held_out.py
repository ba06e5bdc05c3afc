"""Which rows of a log are held out of a balance."""

from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.balances import balance
from calibration.balances.balance import problem_of
from calibration.balances.filters import Filter
from calibration.inputs.declaration import Response
from tests.calibration.names.made import PERIOD_S, drive

ROWS = 400


def view(files: np.ndarray | None = None, rows: int = ROWS, **more: Any) -> Any:
    x = np.sin(2 * np.pi * np.arange(rows) / 100)
    return drive(x, files=files, rig={"hold_out": 0.25}, **more).view


def records(*names: str) -> Any:
    return [Some(among=lambda given, name=name: name in given) for name in names]


EVERY = np.ones(ROWS, dtype=bool)


def held(v: Any, files: Any, names: list[str], shown: list[np.ndarray] | None = None) -> list[int]:
    found = balance._held(v, files, names, np.ones(len(v.x), dtype=bool), shown or [])
    return np.flatnonzero(found).tolist()


def test_named_files_are_held_out() -> None:
    v = view(np.repeat([0, 1], 200))
    assert held(v, records("a", "b"), ["b"]) == list(range(200, 400))
    assert held(v, records("a", "b"), ["a", "b"]) == list(range(400))


def test_of_three_files_the_one_that_the_others_cover() -> None:
    v = view(np.repeat([0, 1, 2, 3], 100))
    v.columns["position"] = v.x * np.repeat([1.0, 2.0, 0.5, 1.5], 100)
    assert held(v, records("a", "b", "c", "d"), []) == list(range(200, 300))
    v.columns["position"] = np.tile(v.x[:100], 4)
    assert held(v, records("a", "b", "c", "d"), []) == list(range(200, 300))  # the middle one in time
    v.clock = np.repeat([4.0, 3.0, 1.0, 2.0], 100)
    assert held(v, records("a", "b", "c", "d"), []) == list(range(100, 200))
    v.speed = v.speed * np.repeat([1.0, 9.0, 1.0, 1.0], 100)
    assert held(v, records("a", "b", "c", "d"), [])[0] in (0, 300)


def test_of_one_or_two_files_the_end_of_every_run() -> None:
    assert held(view(), records("a"), []) == list(range(300, 400))
    two = view(np.repeat([0, 1], 200))
    assert held(two, records("a", "b"), []) == [*range(150, 200), *range(350, 400)]


def test_where_the_end_goes_far_beyond_the_rest_the_middle_or_the_beginning_is_held_out() -> None:
    """From the half less an eighth on: 0.375 to 0.625 of the rows."""
    shown = np.zeros(ROWS)
    shown[:300] = np.tile([0.0, 1.0], 150)
    shown[300:] = 1.45
    assert held(view(), records("a"), [], [shown]) == list(range(300, 400))
    shown[300:] = 1.6
    assert held(view(), records("a"), [], [shown]) == list(range(150, 250))


def test_a_rest_has_no_rows_to_hold() -> None:
    v = view()
    valid = (np.arange(ROWS) >= 40) & (np.arange(ROWS) < 240)
    assert np.flatnonzero(balance._part(v, valid, 0.75)).tolist() == list(range(190, 400))
    assert np.flatnonzero(balance._part(v, valid, 0.375)).tolist() == list(range(115, 165))
    assert np.flatnonzero(balance._part(v, valid, 0.0)).tolist() == list(range(90))
    assert not balance._part(v, ~EVERY, 0.75).any()
    v.run = np.repeat([0, 1], 200)
    some = np.flatnonzero(balance._part(v, valid, 0.75)).tolist()
    assert some == [*range(160, 200), *range(230, 400)]


def test_beyond_is_told_in_parts_of_the_others_range() -> None:
    z = np.concatenate([np.linspace(0, 1, 300), np.linspace(0.5, 1.5, 100)])
    mine = np.arange(ROWS) >= 300
    low, high = np.quantile(z[:300], [0.01, 0.99])
    _a, b = np.quantile(z[300:], [0.02, 0.98])
    expected = (b - high) / (high - low)
    assert balance._excess([z], mine, ~mine) == pytest.approx(expected)
    assert balance._excess([z, -z], mine, ~mine) == pytest.approx(2 * expected)
    assert balance._excess([z - 1000], mine, ~mine) == pytest.approx((b - high) / 9.99, rel=0.02)
    assert balance._excess([z], mine, ~EVERY) == balance._excess([z], ~EVERY, mine) == float("inf")
    assert balance._excess([0 * z], mine, ~mine) == 0.0


@pytest.mark.parametrize(("sigma", "reach"), [(0.0, -1), (0.3, 0), (1.0, 1), (1.2, 2), (4.0, 6)])
def test_rows_that_the_filter_mixes_are_not_judged(sigma: float, reach: int) -> None:
    """Three deviations, half of them on either side of the border."""
    v = view(filter=Filter(sigma))
    mask = np.arange(ROWS) >= 100
    unused = np.flatnonzero(~balance._apart(mask, v))
    assert unused.tolist() == list(range(99 - reach, 100 + reach))
    v.rows = np.arange(0, ROWS, 2)
    if sigma == 4.0:
        unused = np.flatnonzero(~balance._apart(mask[::2], v))
        assert unused.tolist() == list(range(49 - 3, 50 + 3))


def loaded(names: tuple[str, ...]) -> tuple[Any, np.ndarray]:
    files = np.repeat(np.arange(len(names)), 300)
    rows = len(files)
    x = np.sin(2 * np.pi * np.arange(rows) / 97)
    given = {"estimate": ("viscous", "offset"), "hold_out": 0.25}
    v = drive(x, files=files, response=Response("force", "N"), rig=given).view
    v.columns["force"] = 3 * v.rate(x) + 1.0
    return v, files


@pytest.mark.parametrize("names", [("a",), ("a", "b"), ("a", "b", "c")])
def test_three_files_are_held_out_in_turn_unless_one_is_named(names: tuple[str, ...]) -> None:
    v, files = loaded(names)
    p = problem_of(v, records(*names), [])
    assert (p.turned is not None) == (len(names) == 3)
    named = problem_of(v, records(*names, "z"), ["z" if len(names) == 1 else "b"])
    assert named.turned is None
    assert np.array_equal(p.session, files) and np.array_equal(p.run, v.run)


def test_a_second_sensor_starts_anywhere_in_every_file() -> None:
    files = np.repeat([0, 1], 300)
    x = np.sin(2 * np.pi * np.arange(600) / 97)
    given = drive(x, files=files, response=Response("position2", "m"), rig={"hold_out": 0.25})
    given.view.columns["position2"] = 2 * x + files
    p = problem_of(given.view, records("a", "b"), [])
    assert p.channel == "K" and p.fresh is not None
    assert np.array_equal(p.fresh, np.column_stack([files == 0, files == 1]).astype(float))
    assert p.period_s == PERIOD_S and [n for n, _ in p.base_labels] == ["offset_1", "offset_2", "scale"]
