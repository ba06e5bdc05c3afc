"""Words of a logger that wrote numbers of both signs as unsigned ones, and counters of several files."""

import numpy as np
import pytest

from calibration.inputs.counters import _length, align_counters, count_wraps, read_signed, word_length
from calibration.inputs.declaration import Column, Rig
from calibration.inputs.run import Repair, Run
from tests.calibration.inputs.made import rig, run

FULL = 2.0**16
LOW, HIGH = np.arange(50.0), FULL - 1 - np.arange(50.0)  # 0 to 49, and -1 to -50


def words(low: list[float] | np.ndarray = LOW, high: list[float] | np.ndarray = HIGH) -> np.ndarray:
    return np.concatenate([low, high])


@pytest.mark.parametrize(
    ("x", "length"),
    [
        (words(), FULL),
        (words(LOW, HIGH - FULL + 2**24), 2.0**24),
        (words(LOW, HIGH - FULL + 2**32), 2.0**32),
        (words([*LOW, np.nan], HIGH), FULL),
        (words(LOW, HIGH + 1), 0.0),  # 65536 is no word of 16 bits
        (words(LOW[:25], HIGH[:25]), FULL),
        (words(LOW[:25], HIGH[:24]), 0.0),  # 49 rows
        (words(LOW + 1e-8, HIGH), FULL),
        (words(LOW + 0.01, HIGH), 0.0),
        (words(LOW - 1, HIGH), 0.0),  # below zero already
        (words(LOW, np.resize(HIGH[:3], 50)), FULL),
        (words(LOW, np.resize(HIGH[:2], 50)), 0.0),  # two values mark failed readings
        (words([*LOW, 3 / 8 * FULL - 1], [*HIGH, 5 / 8 * FULL]), FULL),
        (words([*LOW, 3 / 8 * FULL], HIGH), 0.0),  # the middle quarter is not empty
        (words(LOW, [*HIGH, 5 / 8 * FULL - 1]), 0.0),
        (words([], HIGH), FULL),
        (words(LOW, []), 0.0),
        (words(LOW + 5000, HIGH), FULL),
        (words(LOW + 6000, HIGH), 0.0),  # more than a tenth of the empty middle
        (words([], HIGH - 3500), FULL),  # 3501 of 61986 counts
        (words([], HIGH - 7000), 0.0),
    ],
)
def test_numbers_of_both_signs_fill_the_two_ends_of_a_word(x: np.ndarray, length: float) -> None:
    assert word_length(x) == length


def signed(where: Column, *columns: np.ndarray) -> tuple[list[Run], Rig]:
    runs = [run(np.zeros(len(x)), joint=x) for x in columns]
    declared = rig(joint=where)
    read_signed(runs, declared)
    return runs, declared


def test_every_run_has_the_sign_that_all_runs_tell() -> None:
    where = Column("A", "i", scale=-0.5, offset=3.0)
    runs, _ = signed(where, words() * -0.5 + 3.0, np.full(20, 32769.0) * -0.5 + 3.0, LOW * -0.5 + 3.0)
    true = [words(LOW, HIGH - FULL), np.full(20, 32769 - FULL), LOW]
    assert [len(r.repairs) for r in runs[:1] + runs[2:]] == [0, 0]  # the middle of the word is not empty
    runs, _ = signed(where, words() * -0.5 + 3.0, HIGH[:20] * -0.5 + 3.0, LOW * -0.5 + 3.0)
    true[1] = HIGH[:20] - FULL
    for r, x in zip(runs, true, strict=True):
        assert r.columns["joint"] == pytest.approx(x * -0.5 + 3.0)
    note = "signed numbers of 65536 values written unsigned: 65535 is -1"
    assert [r.repairs for r in runs] == [
        [Repair("signed", "joint", 50, 32768.0, note)], [Repair("signed", "joint", 20, 32768.0, note)], []
    ]  # fmt: skip
    s = runs[0].signals["joint"]
    assert (s.column, s.unit, s.low, s.high, s.wraps) == ("i", "A", 3 - 24.5, 3 + 25.0, 0)
    assert "joint" not in runs[2].signals
    named, _ = signed(Column("A"), words())
    assert named[0].signals["joint"].column == "joint"


def test_half_of_a_word_is_no_number_below_zero() -> None:
    (r,), _ = signed(Column("A", "i"), words())
    assert r.repairs[0].rows == 50


@pytest.mark.parametrize(
    "where",
    [
        Column("A", "i", wrap=FULL),
        Column("A", "i", sign_bit=15),
        Column("A", "i", steps=((0.0, 1.0),)),
        Column("A", "i", integrated=True),
        Column("A", "i", files={"*": 1.0}),
    ],
)
def test_a_column_that_is_declared_so_or_is_made_has_no_other_sign(where: Column) -> None:
    (r,), _ = signed(where, words())
    assert r.columns["joint"].tolist() == words().tolist() and not r.repairs


@pytest.mark.parametrize("channel", ["position", "velocity", "reference", "supply", "temperature", "normal"])
def test_a_motion_or_a_slow_column_has_no_other_sign(channel: str) -> None:
    r = run(words() if channel == "position" else np.zeros(100))
    r.columns[channel] = words()
    read_signed([r], rig("time", channel))
    assert r.columns[channel].tolist() == words().tolist() and not r.repairs


def files(*middles: float, origin: str = "shared", **more: Column) -> list[list[float]]:
    declared = rig(position=Column("deg", "q", wrap=10.0, scale=-2.0), **more)
    declared.runs["origin"] = origin
    runs = [run(np.array([m - 1, m, m + 1, np.nan])) for m in middles]
    for r in runs:
        r.columns["position2"] = r.columns["position"].copy()
    align_counters(runs, declared)
    return [[float(np.nanmedian(r.columns[c])) for r in runs] for c in ("position", "position2")]


def test_files_are_moved_by_whole_lengths_of_their_counter() -> None:
    assert files(3.0, 25.0) == [[3.0, 5.0], [3.0, 25.0]]  # of 20 deg: 10 in the file, times 2
    assert files(3.0, 45.0, -31.0)[0] == [3.0, 5.0, 9.0]
    assert files(3.0, 25.0, origin="own")[0] == [3.0, 25.0]
    second = Column("deg", "p", wrap=7.0)
    assert files(3.0, 25.0, position2=second)[1] == [3.0, 4.0]
    assert files(3.0)[0] == [3.0]


def test_a_length_is_declared_or_the_one_that_was_found() -> None:
    found = [run(np.zeros(3)) for _ in range(3)]
    for r, size in zip(found, (360.0, 400.0, 720.0), strict=True):
        r.repairs += [Repair("wrap", "position", 1, size, ""), Repair("wrap", "joint", 1, 1.0, "")]
        r.repairs += [Repair("leap", "position", 1, 5.0, "")] * 5
    assert _length(found, rig("position", "velocity"), "position") == 400.0
    assert _length(found, rig("position", "velocity"), "velocity") == 0.0
    assert _length(found, rig(position=Column("deg", "q", wrap=8.0, scale=-0.25)), "position") == 2.0


def test_wraps_are_turns_between_two_rows() -> None:
    counts = np.array([8.0, np.nan, 1.0, 9.0, 2.0])
    assert count_wraps(counts, np.array([8.0, np.nan, 11.0, 9.0, 12.0]), 10.0) == 3
