"""Counters: what wraps is joined, whatever the motion, the length and the rows that are missing."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from calibration.inputs.counters import align_counters, count_wraps, unwrap
from calibration.inputs.rigfile import load_rig
from calibration.inputs.run import Run

LENGTHS = st.sampled_from([256, 4096, 2**17, 2**29])


@st.composite
def motions(draw: st.DrawFn) -> tuple[np.ndarray, int]:
    """A motion in counts (n,) that never moves half a length in a row, and the length."""
    length = draw(LENGTHS)
    steps = draw(st.lists(st.integers(-length // 2 + 1, length // 2 - 1), min_size=1, max_size=60))
    return np.cumsum([draw(st.integers(0, length - 1)), *steps]).astype(float), length


@settings(max_examples=100, deadline=None)
@given(made=motions())
def test_a_motion_comes_back_but_for_whole_lengths(made: tuple[np.ndarray, int]) -> None:
    motion, length = made
    found = unwrap(motion % length, length)
    assert np.diff(found) == pytest.approx(np.diff(motion))
    assert ((found - motion) / length) == pytest.approx(np.round((found - motion) / length))


@settings(max_examples=60, deadline=None)
@given(made=motions(), seed=st.integers(0, 2**32 - 1))
def test_rows_without_a_number_stay_so_and_the_others_do_not_mind(
    made: tuple[np.ndarray, int], seed: int
) -> None:
    motion, length = made
    lost = np.random.default_rng(seed).random(len(motion)) < 0.3
    counts = np.where(lost, np.nan, motion % length)
    found = unwrap(counts, length)
    assert np.array_equal(np.isnan(found), lost)
    assert found[~lost] % length == pytest.approx(counts[~lost])
    assert np.array_equal(unwrap(counts[~lost], length), found[~lost])


@settings(max_examples=60, deadline=None)
@given(made=motions())
def test_wraps_are_counted_where_the_motion_passes_an_end(made: tuple[np.ndarray, int]) -> None:
    motion, length = made
    passed = np.count_nonzero(np.diff(motion // length))
    counts = motion % length
    assert count_wraps(counts, unwrap(counts, length), length) == passed


def test_what_never_wraps_is_left_alone() -> None:
    x = np.array([5.0, 9.0, np.nan, 3.0])
    assert np.array_equal(unwrap(x, 4096), x, equal_nan=True)
    assert count_wraps(x, unwrap(x, 4096), 4096) == 0


RIG = """rig: made up
turn: 1.0
columns:
  time: {column: t, unit: s}
  position: {column: q, unit: turn, wrap: %s}
  effort: {column: u, unit: N m}
response: {channel: effort, unit: N m}
runs: {by: none, origin: %s}
"""


def record(name: str, position: list[float]) -> Run:
    x = np.array(position)
    return Run(name, Path(name), name, {"t": np.arange(len(x)) * 1.0, "position": x}, period_s=1.0)


def written(folder: Path, wrap: str, origin: str) -> Path:
    path = folder / "rig.yaml"
    path.write_text(RIG % (wrap, origin), encoding="utf-8")
    return path


def test_files_of_one_zero_are_moved_next_to_the_first_by_whole_lengths(tmp_path: Path) -> None:
    rig = load_rig(written(tmp_path, "10", "shared"))
    records = [record("a", [1.0, 2.0]), record("b", [11.5, 12.5]), record("c", [-19.0, -18.0])]
    align_counters(records, rig)
    assert [r.columns["position"].tolist() for r in records] == [[1.0, 2.0], [1.5, 2.5], [1.0, 2.0]]


def test_files_with_zeros_of_their_own_stay_where_they_are(tmp_path: Path) -> None:
    rig = load_rig(written(tmp_path, "10", "own"))
    records = [record("a", [1.0, 2.0]), record("b", [11.5, 12.5])]
    align_counters(records, rig)
    assert records[1].columns["position"].tolist() == [11.5, 12.5]
