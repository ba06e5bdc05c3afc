"""A guided mount's sections: which count, on what grid, their drift, their air, and what is held out."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.polynomial import legendre

from calibration.balances import guide
from calibration.balances.guide import guide_problem, piece_s, usable
from calibration.errors import CalibrationInputError
from calibration.inputs.run import Run

DAY_WORM_S = 663.0


def section(
    rows: int, frame_s: float = 1.0, name: str = "a.txt", start_s: float | None = None, **columns: Any
) -> Run:
    """One section whose drive error is its row's number unless given."""
    t = 5.0 + frame_s * np.arange(rows)
    own = {"t": t, "ra": np.arange(rows, dtype=float), "segment": np.zeros(rows), **columns}
    return Run(name=name, path=Path(name), session=name, columns=own, start_s=start_s)


def test_sections_of_few_frames_or_a_small_part_of_the_longest_are_left_out() -> None:
    longest, quarter = section(401), section(101)
    short, few, thirty = section(100), section(29, 20.0), section(30, 20.0)
    keep, notes = usable([longest, quarter, short, few, thirty], [])
    assert [r.rows for r in keep] == [401, 30]  # thirty frames of 20 s last longer than the first
    keep, notes = usable([longest, quarter, short], [])
    assert [r.rows for r in keep] == [401, 101]
    assert notes == [
        "1 of 3 sections left out: shorter than 30 frames or than a quarter of the longest (400 s)"
    ]
    assert usable([longest, quarter], [])[1] == []


@pytest.mark.parametrize(("rows", "kept"), [(2, 1), (3, 2)])
def test_a_section_that_is_named_needs_three_frames(rows: int, kept: int) -> None:
    assert len(usable([section(400), section(rows, name="b.txt")], ["b.txt"])[0]) == kept


def test_quick_frames_are_averaged_over_cells_and_slow_ones_put_between_frames() -> None:
    quick = section(10)
    grid: np.ndarray = 5.0 + 3.0 * np.arange(4)
    # cells end halfway: 0 1 | 2 3 4 | 5 6 7 | 8 9
    assert guide._on_grid(quick, grid, 3.0) == pytest.approx([0.5, 3.0, 6.0, 8.5])
    quick.columns = {k: np.delete(x, [2, 3, 4]) for k, x in quick.columns.items()}
    assert np.isnan(guide._on_grid(quick, grid, 3.0)).tolist() == [False, True, False, False]
    slow = section(10, 2.0)
    at = np.array([5.0, 6.0, 22.9, 25.9, 26.0, 27.0])
    found = guide._on_grid(slow, at, 2.0)
    assert found[:3] == pytest.approx([0.0, 0.5, 8.95]) and found[3] == 9.0
    assert np.isnan(guide._on_grid(slow, at + 0.1, 2.0)).tolist() == [False] * 3 + [True] * 3
    gap = section(4, 2.0, t=np.array([5.0, 7.0, 17.0, 19.0]), ra=np.array([0.0, 0.0, 10.0, 10.0]))
    found = guide._on_grid(gap, np.array([9.9, 10.0, 12.0, 14.0, 14.1]), 2.0)
    assert np.isnan(found).tolist() == [False, True, True, True, False]
    assert found[[0, 4]] == pytest.approx([2.9, 7.1])


def test_sections_follow_each_other_twenty_cells_apart_with_segments_of_their_own() -> None:
    moved = np.array([0.0, 0.0, 1.0, 1.0])
    one = section(4, 3.0, segment=moved, dither=np.array([1.0, 2.0, 3.0, 4.0]))
    two = section(3, 3.0, "b.txt", start_s=100.0)
    parts, names = guide._sections([one, two], ["b.txt"], 3.0)
    assert names == ["b.txt"]
    assert parts[0]["t"].tolist() == [0.0, 3.0, 6.0, 9.0] and parts[1]["t"].tolist() == [69.0, 72.0, 75.0]
    assert parts[0]["clock"].tolist() == parts[0]["t"].tolist()  # nobody told when it began
    assert parts[1]["clock"].tolist() == [105.0, 108.0, 111.0]
    assert parts[0]["segment"].tolist() == [0, 0, 1, 1] and parts[1]["segment"].tolist() == [2, 2, 2]
    assert parts[0]["dither"].tolist() == [2.0, 2.0, 3.0, 4.0] and not parts[1]["dither"].any()
    assert [part["run"].tolist() for part in parts] == [[0] * 4, [1] * 3]
    assert not parts[0]["held"].any() and parts[1]["held"].all()


@pytest.mark.parametrize(
    ("span", "degree"), [(100.0, 2), (2.4 * 663, 2), (2.6 * 663, 3), (7 * 663, 7), (60 * 663, 43)]
)
def test_a_drift_has_half_a_wave_for_every_turn_of_the_slowest_worm(span: float, degree: int) -> None:
    """What takes twice as long as a turn is drift: degree d has d / 2 waves."""
    t = np.concatenate([np.linspace(-span, 0.0, 50), np.linspace(20.0, 20.0 + span, 300)])
    here = np.arange(350) >= 50
    found = guide._drift(t, here, DAY_WORM_S)
    assert found.shape == (350, degree) and not found[:50].any()
    x = np.linspace(-1.0, 1.0, 300)
    assert found[50:] == pytest.approx(legendre.legvander(x, degree)[:, 1:], abs=1e-9)


def test_nuisances_are_an_offset_per_segment_and_a_drift_per_section_of_the_rows() -> None:
    columns = {
        "segment": np.array([0, 0, 1, 1, 2, 2, 3]),
        "run": np.array([0, 0, 0, 0, 1, 1, 2]),
        "t": np.arange(7.0),
    }
    rows = np.array([True] * 6 + [False])
    found, offsets, drifts = guide._nuisances(columns, rows, DAY_WORM_S)
    assert (offsets, drifts) == (3, 4) and found.shape == (7, 7) and not found[6].any()
    assert found[:, :3].sum(axis=0).tolist() == [2.0, 2.0, 2.0]
    assert found[:4, 3] == pytest.approx([-1.0, -1 / 3, 1 / 3, 1.0]) and not found[4:, 3].any()
    nothing, offsets, drifts = guide._nuisances(columns, np.zeros(7, dtype=bool), DAY_WORM_S)
    assert nothing.shape == (7, 0) and offsets == drifts == 0


@pytest.mark.parametrize(
    ("turns", "pieces"),
    [((2.0,), 3), ((4.0,), 4), ((9.0,), 9), ((4.0, 1.0), 4 + 2), ((1.0, 0.2), 3 + 2), ((3.4, 2.6), 3 + 3)],
)
def test_a_piece_lasts_a_turn_or_a_third_of_the_longest_section(
    turns: tuple[float, ...], pieces: int
) -> None:
    """Another section has two at least; more than six pieces are held out in six groups."""
    t = np.concatenate([1000.0 * k + np.linspace(0, turn * 100.0, 361) for k, turn in enumerate(turns)])
    run = np.repeat(np.arange(len(turns)), 361)
    found = guide._pieces(t, run, 100.0)
    steps = np.flatnonzero(np.diff(found)) + 1
    assert len(steps) + 1 == pieces
    assert found.max() == min(pieces, 6) - 1 and found[0] == 0
    edges = [0, *steps.tolist(), len(t)]
    assert np.array([found[k] for k in edges[:-1]]).tolist() == [k % 6 for k in range(pieces)]
    assert max(np.diff(edges)[: 1 + len(np.flatnonzero(steps < 361))]) <= 361


def test_pieces_of_a_section_are_as_long_as_each_other() -> None:
    found = guide._pieces(np.arange(400.0), np.zeros(400, dtype=np.int64), 100.0)
    assert np.bincount(found).tolist() == [100, 100, 100, 100]


def by_hand(y: np.ndarray, segment: np.ndarray, side: int) -> float:
    """Each cell beside numpy's own parabola through its window, over the root of what that takes along."""
    left = []
    for k in range(side, len(y) - side):
        rows = np.arange(k - side, k + side + 1)
        use = rows[np.isfinite(y[rows]) & (segment[rows] == segment[k])]
        if k in use and (use < k).sum() > side // 2 and (use > k).sum() > side // 2:
            x = np.vander((use - k) / side, 3)
            hat = x @ np.linalg.pinv(x)
            here = list(use).index(k)
            left.append((y[k] - hat[here] @ y[use]) / np.sqrt(1 - hat[here, here]))
    five = 5 * 1.4826 * np.median(np.abs(left))
    return float(np.sqrt(np.mean(np.clip(left, -five, five) ** 2)))


@pytest.mark.parametrize("side", [3, 4, 9])
def test_air_is_what_a_parabola_through_the_neighbours_does_not_follow(side: int) -> None:
    rng = np.random.default_rng(3)
    y = rng.normal(0, 0.4, 300) + 1e-3 * np.arange(300) ** 2
    segment = np.repeat([0, 1], 150)
    y[150:] += 50.0
    y[rng.choice(300, 90, replace=False)] = np.nan
    y[200] += 40.0
    assert guide._air(y, segment, side) == pytest.approx(by_hand(y, segment, side), rel=1e-9)


def test_too_few_cells_have_no_air() -> None:
    segment = np.zeros(7, dtype=np.int64)
    y = np.array([0.0, 1.0, 0.0, -1.0, 0.0, 2.0, 0.0])
    assert guide._air(y[:6], segment[:6], 3) == 0.0 and guide._air(y, segment, 3) > 0.0
    assert guide._air(np.full(30, np.nan), np.zeros(30, dtype=np.int64), 3) == 0.0


def test_logs_of_two_units_are_not_put_together() -> None:
    one, two = section(40), section(40, name="b.txt")
    two.header["unit"] = "px"
    assert guide._unit([one]) == "arcsec" and guide._unit([two]) == "px"
    with pytest.raises(CalibrationInputError, match="with and without a pixel scale cannot be put together"):
        guide._unit([one, two])


@pytest.mark.parametrize(
    ("frame_s", "quickest_s", "period_s"),
    [(1.0, 663.0, 3.0), (1.5, 663.0, 3.0), (1.6, 663.0, 1.6), (1.0, 40.0, 2.0), (0.9, 30.0, 0.9)],
)
def test_frames_are_averaged_over_three_seconds_or_a_twentieth_of_the_quickest_turn(
    frame_s: float, quickest_s: float, period_s: float
) -> None:
    p, _ = guide_problem([section(400, frame_s)], [], quickest_s=quickest_s)
    assert p.period_s == pytest.approx(period_s)


def test_without_a_name_pieces_are_held_out_in_turn_beside_all_nuisances() -> None:
    rng = np.random.default_rng(1)
    t = np.arange(2000.0)
    dither = np.where(t > 1000, 4.0, 0.0)
    ra = rng.normal(0, 1, 2000)
    ra[600:700] = np.nan
    keep = np.isfinite(ra)
    run = section(2000, ra=ra, dither=dither, start_s=0.0)
    run.columns = {k: x[keep] for k, x in run.columns.items()}
    p, names = guide_problem([run], [])
    assert names == [] and (p.channel, p.unit, p.ar_order, p.slow) == ("K", "arcsec", 3, True)
    assert p.base_labels == [("offset", "arcsec")] + 3 * [("drift", "arcsec")] + [("guide_gain_error", "1")]
    assert p.base[:, -1].mean() == pytest.approx(0.0, abs=1e-9)
    assert np.ptp(p.base[:, -1]) == 4.0 and p.base[0, -1] < 0
    assert p.turned is not None and np.array_equal(p.turned, p.valid) and p.fresh is None
    assert np.array_equal(p.held, p.session == 0) and set(p.session) == {0, 1, 2}
    assert p.block_s == pytest.approx(663 / 16.6) and p.domains == {}
    assert not p.valid[205:230].any() and not p.y[205:230].any() and p.valid.sum() > 620
    assert piece_s(p) == pytest.approx(2000 / 3, rel=0.02)
    y = np.where(p.valid, p.y, np.nan)
    assert p.floor == pytest.approx(by_hand(y, p.run, 13)) == pytest.approx(1 / np.sqrt(3), rel=0.15)


def test_named_sections_have_nuisances_of_their_own_and_the_clock_is_a_domain() -> None:
    runs = [section(300, start_s=0.0), section(200, 1.0, "b.txt", start_s=1000.0)]
    p, names = guide_problem(runs, ["b.txt"], slowest_s=100.0, quickest_s=20.0)
    assert names == ["b.txt"] and p.period_s == 1.0 and p.block_s == 12.0
    assert p.turned is None and not p.slow and np.array_equal(p.session, p.run)
    assert p.base_labels == [("offset", "arcsec")] + 3 * [("drift", "arcsec")]
    assert p.fresh is not None and p.fresh.shape[1] == 1 + 2 and not p.fresh[:300].any()
    assert not p.base[300:].any() and p.held.sum() == 200 and not p.held[:300].any()
    assert p.domains["clock"][[0, 300]].tolist() == [5.0, 1005.0]
    runs[1].start_s = None
    assert guide_problem(runs, ["b.txt"])[0].domains == {}
