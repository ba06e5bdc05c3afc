"""Where a spike or an end of a range begins: every limit, from either side."""

from functools import partial

import numpy as np
import pytest

from calibration.inputs import repair as module
from calibration.inputs.declaration import Column
from calibration.inputs.repair import (
    _clear_of_tails,
    _far_off,
    _saturation,
    _spikes,
    repair,
)
from calibration.inputs.run import Run
from tests.calibration.inputs.made import PERIOD_S, rig, run
from tests.calibration.inputs.test_repair_limits import record, told


def wave(rows: int) -> np.ndarray:
    return np.resize([0.0, 1.0, 1.0, 0.0], rows) + 0.01 * np.arange(rows) / rows


@pytest.mark.parametrize(
    ("rows", "at", "found"),
    [
        (50, [1], "rows 2"),
        (49, [1], ""),
        (200, [11, 21, 31], "rows 12, 22, 32"),
        (399, [11, 21, 31, 41], ""),
        (400, [11, 21, 31, 41], "rows 12, 22, 32, 42"),
        (600, [11, 21, 31, 41, 51], "rows 12, 22, 32, 42, 52"),
        (600, [11, 21, 31, 41, 51, 61], "rows 12, 22, 32, 42, 52 …"),
        (300, [11, 12], "rows 12, 13"),
        (300, [], ""),
    ],
)
def test_spikes_are_named_by_their_rows(rows: int, at: list[int], found: str) -> None:
    x = wave(rows)
    x[at] = -40.0
    r = record("effort", x.copy())
    _spikes(r, "effort")
    size = 40.0 + float(np.median(x))
    note = f"{found} are far off their neighbours: left out"
    assert told(r) == ([("spike", "effort", len(at), pytest.approx(size), note)] if found else [])
    assert np.flatnonzero(np.isnan(r.columns["effort"])).tolist() == (at if found else [])


@pytest.mark.parametrize(("behind", "count"), [(99, 1), (100, 0), (101, 0), (102, 1)])
def test_a_row_at_a_gap_of_the_clock_is_no_spike(behind: int, count: int) -> None:
    x, t = wave(300), PERIOD_S * np.arange(300)
    x[100] = 40.0
    t[behind:] += 1.0
    r = record("effort", x, t)
    _spikes(r, "effort")
    assert len(r.repairs) == count


def lone(rows: int, sizes: list[float], rest: float = 1.0) -> np.ndarray:
    off = np.full(rows, rest)
    off[5 + 6 * np.arange(len(sizes))] = sizes
    return off


@pytest.mark.parametrize(
    ("off", "limit"),
    [
        (lone(100, [10.0]), 1.0),
        (lone(100, [2.5]), np.inf),
        (lone(100, [2.6]), 1.0),
        (lone(100, [10.0, 9.0, 8.0]), 1.0),
        (lone(100, [10.0, 9.0, 8.0, 7.0]), np.inf),
        (lone(400, [10.0, 9.0, 8.0, 7.0]), 1.0),
        (lone(400, [10.0, 9.0, 8.0, 7.0, 6.0]), np.inf),
        (lone(100, [10.0], 0.0), 0.0),
        (lone(100, [30.0, 10.0, 3.0], 0.0), 10.0),
        # of a tail whose every value is 1.01 times the next, the largest leaps by exp(9.21 * 10.5 * ln 1.01)
        (lone(300, [2.61 * 1.01**25, *1.01 ** np.arange(25, -1, -1)], 0.5), np.inf),
        (lone(300, [2.63 * 1.01**25, *1.01 ** np.arange(25, -1, -1)], 0.5), 1.01**25),
    ],
)
def test_spikes_leave_a_gap_above_the_rest(off: np.ndarray, limit: float) -> None:
    assert _clear_of_tails(off) == pytest.approx(limit)


def test_neighbours_of_a_spike_are_no_values_of_their_own() -> None:
    off = np.full(100, 1.0)
    off[38:43] = [5.0, 6.0, 10.0, 6.0, 5.0]
    assert _clear_of_tails(off) == 1.0


@pytest.mark.parametrize(("height", "found"), [(18.7, False), (18.9, True), (-16.9, True)])
def test_a_spike_is_twelve_deviations_off_the_line(height: float, found: bool) -> None:
    """Of a column that goes up and down by 1, every row is 1 off the line: a deviation is 1.4826."""
    x = np.resize([0.0, 1.0], 200)
    x[100] = height
    assert np.flatnonzero(_far_off(x, 1)).tolist() == [100] * found


def test_a_spikes_neighbours_agree_and_the_ends_have_none() -> None:
    x = wave(200)
    x[[0, 60, 199]] = 90.0
    assert np.flatnonzero(_far_off(x, 1)).tolist() == [60]
    for beside, found in ((19.0, True), (23.0, False)):  # four times what the neighbours differ by
        y = np.resize([0.0, 0.1], 200)
        y[60:62] = [90.0, beside]
        assert _far_off(y, 1)[60] == found, beside
    for calm, found in ((85.0, False), (20.0, True)):  # and from the rows beyond them
        y = np.resize([0.0, 0.1], 200)
        y[[58, 62]] = calm
        y[60] = 90.0
        assert _far_off(y, 1)[60] == found, calm
    ramp = wave(200) + 30.0 * np.arange(200)
    ramp[60] += 90.0
    assert np.flatnonzero(_far_off(ramp, 1)).tolist() == []  # twice 30 is what its neighbours differ by
    pair = wave(200)
    pair[[60, 61]] = 90.0
    assert np.flatnonzero(_far_off(pair, 2)).tolist() == [60, 61] and not _far_off(pair, 1).any()
    few = np.full(200, np.nan)
    few[:50] = wave(50)
    few[[1, -1]] = 90.0, 0.0
    assert _far_off(few, 1)[1]
    few[49] = np.nan
    assert not _far_off(few, 1).any()


def ended(rows: int, lengths: list[int], end: float = 1.0, levels: int = 0) -> Run:
    """A wave of both ends below 1, held at `end` in pieces of these lengths."""
    x = 0.5 * np.sin(np.arange(rows) / 9.0) if not levels else np.resize(np.arange(levels - 1.0) / 50, rows)
    for k, length in enumerate(lengths):
        x[10 + 30 * k : 10 + 30 * k + length] = end
    return record("effort", x)


@pytest.mark.parametrize(
    ("given", "held"),
    [
        (ended(300, [5, 5, 4]), 14),  # eleven pairs
        (ended(300, [5, 4, 4]), 0),
        (ended(300, [8, 8]), 0),  # a steady load is held once, or twice
        (ended(300, [5, 5, 4], -1.0), 14),
        (ended(200, [5, 5, 4]), 14),
        (ended(199, [5, 5, 4]), 0),
        (ended(6000, [5, 5, 6]), 16),  # thirteen pairs: two in a thousand rows are twelve
        (ended(6000, [5, 5, 5]), 0),
        (ended(300, [5, 5, 4], levels=20), 14),
        (ended(300, [5, 5, 4], levels=19), 0),
        (record("effort", np.ones(300)), 0),
    ],
)
def test_an_end_of_a_range_is_held_again_and_again(given: Run, held: int) -> None:
    x = given.columns["effort"].copy()
    _saturation(given, "effort")
    end = x[10]
    note = f"{held} rows stay at {end:g}: the end of its range, left out"
    assert told(given) == [("saturation", "effort", held, end, note)] * bool(held)
    assert np.array_equal(np.isnan(given.columns["effort"]), (x == end) & bool(held))


@pytest.mark.parametrize(("low", "count"), [(-0.91, 2), (-0.9, 1)])
def test_the_other_end_is_nearly_as_far(low: float, count: int) -> None:
    r = ended(300, [5, 5, 4])
    for k in range(3):
        r.columns["effort"][150 + 30 * k : 155 + 30 * k] = low
    _saturation(r, "effort")
    assert len(r.repairs) == count


def test_every_channel_is_looked_through_for_what_it_can_have(monkeypatch: pytest.MonkeyPatch) -> None:
    called: list[tuple[str, ...]] = []

    def note(name: str, _: Run, *more: object) -> None:
        called.append((name, *(x for x in more if isinstance(x, str))))

    rows = ("repeated_rows", "lost_rows", "rows_without_a_stamp")
    for name in ("_wraps", "_leaps", "_spikes", "_saturation", *rows):
        monkeypatch.setattr(module, name, partial(note, name))
    declared = rig("time", "position", "effort", "current", "force", "velocity", "supply")
    repair(run(np.zeros(3)), declared)
    wrapped = {"effort", "current", "force", "velocity", "position"}
    found = {name: {c for n, *cs in called for c in cs if n == name} for name, *_ in called}
    assert found == {name: set() for name in rows} | {
        "_wraps": wrapped, "_leaps": {"position"}, "_spikes": wrapped,
        "_saturation": {"effort", "current", "force"},
    }  # fmt: skip
    called.clear()
    summed = rig(position=Column("deg", "v", wrap=360.0, integrated=True))
    repair(run(np.zeros(3)), summed)
    assert [name for name, *_ in called] == ["_leaps", "_spikes", "repeated_rows", "lost_rows"]
