"""Where a counter, a leap, a spike or an end of a range begins: every limit, from either side."""

from typing import Any

import numpy as np
import pytest

from calibration.inputs.declaration import Column
from calibration.inputs.repair import (
    _is_counter,
    _leaps,
    _least_step,
    _wraps,
    counter_length,
)
from calibration.inputs.run import Run
from tests.calibration.inputs.made import PERIOD_S, run

K = np.arange(300)
WORD = np.round(7.3 * K) % 256


def saw(rate: float, length: float, rows: int = 300) -> np.ndarray:
    return rate * np.arange(rows) % length


@pytest.mark.parametrize(
    ("x", "length"),
    [
        *((saw(length // 51, length), length) for length in (256.0, 4096.0, 2.0**32, 360.0)),
        *((saw(length / 51.3, length), length) for length in (1.0, 24.0, 2 * np.pi, 400.0, 1000.0, 86400.0)),
        (saw(1296000 / 51.3, 1296000), 1296000.0),
        (WORD, 256.0),
        (WORD - 128, 256.0),  # with a sign
        (WORD - 20, 0.0),  # neither
        (WORD + 1, 0.0),
        (WORD % 128, 0.0),  # no shorter word than eight bits
        (saw(7.0, 300), 0.0),  # what is missing to 360 is more than it moves
        (saw(7.3, 1.1e6), 0.0),
        (saw(71.0, 360), 360.0),
        (saw(72.0, 360), 0.0),  # a jump of four times the usual step is none
        (np.tile(18.0 * np.arange(20), 10), 360.0),
        (np.tile(18.0 * np.arange(1, 20), 10), 0.0),  # nineteen levels are a switch's
        (np.zeros(100), 0.0),
        (np.sin(K / 9.0), 0.0),
    ],
)
def test_a_counter_is_told_by_its_jumps(x: np.ndarray, length: float) -> None:
    assert counter_length(x) == pytest.approx(length)


@pytest.mark.parametrize(
    ("jumps", "still", "span", "length", "told"),
    [
        ([355.0] * 10, 1.0, 300.0, 360.0, True),  # three times what is moved, and two steps
        ([354.0] * 10, 1.0, 300.0, 360.0, False),
        ([-365.0] * 10, 1.0, 300.0, 360.0, True),
        ([355.0] * 9 + [300.0], 1.0, 300.0, 360.0, True),
        ([355.0] * 8 + [300.0] * 2, 1.0, 300.0, 360.0, False),
        ([288.0] * 10, -30.0, 300.0, 360.0, True),  # a fifth of the length at most
        ([287.0] * 10, -30.0, 300.0, 360.0, False),
        ([100.0] * 10, 1.0, 250.0, 256.0, True),  # a word from end to end, but for what is moved
        ([100.0] * 10, 1.0, 249.0, 256.0, False),
        ([100.0] * 10, 1.0, 360.0, 360.0, False),
    ],
)
def test_jumps_are_a_counters_by_their_size_or_its_ends(
    jumps: list[float], still: float, span: float, length: float, told: bool
) -> None:
    step = np.array([*jumps, *[still] * 90])
    assert _is_counter(np.array([0.0, span]), step, np.abs(step) > 99, length) is told


def test_the_least_step_is_none_where_nothing_moves() -> None:
    found = [_least_step(np.array(x)) for x in ([0.0, -2.0, 3.0], [0.0, 0.0], [])]
    assert found == [2.0, 0.0, 0.0]


def record(channel: str, x: np.ndarray, t: np.ndarray | None = None) -> Run:
    return run(np.arange(float(len(x))), t, **{channel: x})


def told(r: Run) -> list[tuple[Any, ...]]:
    return [(x.kind, x.channel, x.rows, x.size, x.note) for x in r.repairs]


@pytest.mark.parametrize("scale", [0.5, -0.5])
def test_a_wrap_is_joined_in_the_counters_own_unit(scale: float) -> None:
    true = 7.3 * np.arange(200)
    r = record("joint", (true % 360) * scale + 3.0)
    r.columns["joint"][7] = np.nan
    _wraps(r, "joint", Column("deg", "q", scale=scale, offset=3.0))
    assert np.delete(r.columns["joint"], 7) == pytest.approx(np.delete(true, 7) * scale + 3.0)
    assert told(r) == [("wrap", "joint", 4, 180.0, "a counter of 360 wraps: joined")]


@pytest.mark.parametrize(("rows", "count"), [(50, 1), (49, 0)])
def test_fewer_rows_than_fifty_tell_no_wrap(rows: int, count: int) -> None:
    r = record("joint", saw(12.0, 360.0, rows))
    _wraps(r, "joint", Column("deg", "q"))
    assert len(r.repairs) == count


def test_a_word_of_one_turn_has_a_sign_unless_it_is_a_motions() -> None:
    words = np.round(100 * np.sin(K / 20.0))
    words[10] = -128.0
    for channel, kind in (("effort", "signed"), ("velocity", "wrap")):
        r = record(channel, 2.0 * (words % 256))
        _wraps(r, channel, Column("", "u", scale=2.0))
        count = int(np.count_nonzero(np.diff(np.where(words == -128, 128, words) < 0)))
        note = "signed numbers of 256 values written unsigned: 255 is -1"
        joined = "a counter of 256 wraps: joined"
        assert told(r) == [(kind, channel, count, 512.0, note if kind == "signed" else joined)]
    r = record("effort", words % 256)
    _wraps(r, "effort", Column("", "u"))
    assert r.columns["effort"] == pytest.approx(np.where(words == -128, 128, words))  # half is not above half


@pytest.mark.parametrize(
    ("rows", "below", "kinds"),
    [(300, 1, []), (300, 2, []), (300, 3, ["wrap"]), (200, 2, ["wrap"]), (101, 1, []), (100, 1, ["wrap"])],
)
def test_there_and_back_in_two_rows_is_a_spike_and_no_wrap(rows: int, below: int, kinds: list[str]) -> None:
    middle = rows // 2 - 0.5 * (below % 2 == 0)
    true = 0.3 * np.abs(np.arange(rows) - middle) - 0.15 * below  # below zero in so many rows
    r = record("joint", true % 360)
    _wraps(r, "joint", Column("deg", "q"))
    assert [x.kind for x in r.repairs] == kinds


TRAVEL = [1.0, 2.0, 3.0, 5.0, 6.0, 7.0]


@pytest.mark.parametrize(
    ("leaps", "rows", "joined"),
    [
        ({120: 100.0}, 300, True),
        ({120: -100.0}, 300, True),
        ({120: 70.0}, 300, False),  # ten times the quickest
        ({120: 70.1}, 300, True),
        ({120: 100.0}, 201, True),
        ({120: 100.0}, 200, False),  # 199 steps
        ({60: 100.0, 120: 90.0, 180: 80.0}, 600, True),
        ({60: 100.0, 120: 90.0, 180: 80.0, 240: 85.0}, 800, False),
        ({60: 100.0, 81: 100.0}, 600, True),
        ({60: 100.0, 80: 100.0}, 600, False),
        ({}, 300, False),
    ],
)
def test_a_leap_is_what_is_beyond_the_motion_beside_it(
    leaps: dict[int, float], rows: int, joined: bool
) -> None:
    travel = np.resize([0.5, 7.0], rows - 1)
    true = np.zeros(rows)
    for k, size in leaps.items():
        travel[k - 3 : k + 4] = [*TRAVEL[:3], size, *TRAVEL[3:]]
    r = run(np.concatenate([[0.0], np.cumsum(travel)]))
    for k in leaps:
        travel[k] = 4.0  # the median of those beside it
    true[1:] = np.cumsum(travel)
    before = r.columns["position"]
    _leaps(r, "position")
    if joined:
        assert r.columns["position"] == pytest.approx(true) and before[-1] != true[-1]
        notes = [f"leaps by {x - 4:.4g} between rows {k + 1} and {k + 2}: joined" for k, x in leaps.items()]
        assert [x[:3] + x[4:] for x in told(r)] == [("leap", "position", 1, n) for n in notes]
        assert [x.size for x in r.repairs] == pytest.approx([x - 4 for x in leaps.values()])
    else:
        assert r.columns["position"] is before and not r.repairs


def test_a_leap_is_twenty_steps_of_the_sensor_and_at_no_gap_or_rest() -> None:
    for size, count in ((20.0, 0), (21.0, 1)):
        r = run(np.concatenate([np.arange(200.0), np.arange(200.0) + 199.0 + size]))
        _leaps(r, "position")
        assert len(r.repairs) == count
    x = np.concatenate([np.arange(200.0), np.arange(200.0) + 300.0])
    t = PERIOD_S * np.arange(400)
    t[250:] += 1.0
    for given in (run(x, t), run(np.where(np.arange(400) < 200, 0.0, 50.0))):
        _leaps(given, "position")
        assert not given.repairs
