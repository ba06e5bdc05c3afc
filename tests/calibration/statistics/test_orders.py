"""Lines that stand out of a spectrum."""

import numpy as np
import pytest

from calibration.statistics.orders import Wanted, standing_out

ROWS, SPAN = 6000, 30.0
CELL = 1 / SPAN


def rows(*lines: tuple[float, float], seed: int = 3) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """White noise of rms 1 over a length, with sines of (frequency, amplitude); two files, whose phases are
    opposite."""
    z = np.linspace(0.0, SPAN, ROWS)
    label = (np.arange(ROWS) >= ROWS // 2).astype(np.int64)
    sign = 1.0 - 2.0 * label
    noise = np.random.default_rng(seed).standard_normal(ROWS)
    return noise + sign * sum(a * np.cos(2 * np.pi * f * z) for f, a in lines), z, label


def test_a_line_stands_out_whatever_its_phase_in_every_file() -> None:
    (found,) = standing_out(*rows((7.31, 0.4)), Wanted(span=SPAN, least=1.0, most=5))
    assert found == pytest.approx(7.31, abs=CELL)


def test_nothing_stands_out_of_white_noise() -> None:
    for seed in range(5):
        assert standing_out(*rows(seed=seed), Wanted(span=SPAN, least=1.0, most=5)) == []


def test_lines_come_by_size_and_no_more_than_are_wanted() -> None:
    e, z, label = rows((7.3, 0.4), (12.0, 0.8), (21.5, 0.6))
    for most in (1, 2, 3):
        found = standing_out(e, z, label, Wanted(span=SPAN, least=1.0, most=most))
        assert found == pytest.approx([12.0, 21.5, 7.3][:most], abs=CELL)


def test_what_is_avoided_or_too_slow_is_left_out() -> None:
    e, z, label = rows((7.3, 0.4), (12.0, 0.8))
    avoid = np.array([3.0, 12.0 + 0.5 * CELL, 40.0])
    (found,) = standing_out(e, z, label, Wanted(span=SPAN, least=1.0, most=5, avoid=avoid))
    assert found == pytest.approx(7.3, abs=CELL)
    near = avoid + 2 * CELL
    assert len(standing_out(e, z, label, Wanted(span=SPAN, least=1.0, most=5, avoid=near))) == 2
    assert standing_out(e, z, label, Wanted(span=SPAN, least=13.0, most=5)) == []


def test_rows_too_far_apart_for_any_line_show_none() -> None:
    e, z, label = rows((7.31, 0.4))
    few = slice(None, None, 400)
    assert standing_out(e[few], z[few], label[few], Wanted(span=SPAN, least=1.0, most=5)) == []


def sines(*lines: tuple[float, float], count: int = ROWS, size: float = 1.0) -> tuple[np.ndarray, ...]:
    """Noise of rms `size` in one file of `count` rows over the span, with sines of (frequency, amplitude)."""
    z = 5.0 + np.linspace(0.0, SPAN, count)
    e = size * np.random.default_rng(8).standard_normal(count)
    return e + sum(a * np.cos(2 * np.pi * f * z) for f, a in lines), z, np.zeros(count, dtype=np.int64)


def test_what_is_quicker_than_the_rows_can_show_is_not_offered() -> None:
    """Rows are 0.005 apart: a little below the Nyquist limit, 100, a line is its own alias."""
    (found,) = standing_out(*sines((84.0, 0.5), (97.0, 0.9)), Wanted(span=SPAN, least=1.0, most=5))
    assert found == pytest.approx(84.0, abs=CELL)


def test_rows_where_the_drive_rests_do_not_count_for_how_far_rows_are_apart() -> None:
    e, z, label = sines((7.3, 0.5))
    rests = z[::3].repeat(3)  # two of three rows add no place
    (found,) = standing_out(e, rests, label, Wanted(span=SPAN, least=1.0, most=1))
    assert found == pytest.approx(7.3, abs=CELL)


def test_no_more_than_four_thousand_cycles_are_searched() -> None:
    e, z, label = sines((3900 / SPAN, 0.4), (4100 / SPAN, 0.8), count=12000)
    (found,) = standing_out(e, z, label, Wanted(span=SPAN, least=1.0, most=1))
    assert found == pytest.approx(3900 / SPAN, abs=CELL)


def test_an_octave_at_least_is_searched() -> None:
    """0.45 of a cycle per row of 0.005 is the top: 90."""
    e, z, label = sines((60.0, 0.5))
    assert standing_out(e, z, label, Wanted(span=SPAN, least=46.0, most=5)) == []
    (found,) = standing_out(e, z, label, Wanted(span=SPAN, least=44.0, most=5))
    assert found == pytest.approx(60.0, abs=CELL)


def test_lines_a_cycle_and_a_half_of_the_span_apart_are_two() -> None:
    """A quarter of a period apart where the span has its middle, so that neither helps the other."""
    e, z, label = sines((7.0, 0.4))
    middle = 5.0 + SPAN / 2
    e += 0.4 * np.sin(2 * np.pi * ((7.0 + 1.5 * CELL) * (z - middle) + 7.0 * middle))
    found = standing_out(e, z, label, Wanted(span=SPAN, least=1.0, most=2))
    assert sorted(found) == pytest.approx([7.0, 7.0 + 1.5 * CELL], abs=0.5 * CELL)


def test_five_lines_are_five() -> None:
    lines = (3.0, 11.0, 25.0, 48.0, 71.0)
    found = standing_out(*sines(*((f, 0.5) for f in lines)), Wanted(span=SPAN, least=1.0, most=5))
    assert sorted(found) == pytest.approx(lines, abs=0.5 * CELL)


def test_a_line_is_as_clear_in_any_unit() -> None:
    e, z, label = sines((7.3, 0.4))
    for unit in (1e-9, 1e9):
        (found,) = standing_out(unit * e, z, label, Wanted(span=SPAN, least=1.0, most=1))
        assert found == pytest.approx(7.3, abs=CELL)


def test_a_drive_that_rests_shows_no_line() -> None:
    e, z, label = sines((7.3, 0.4))
    assert standing_out(e, np.full_like(z, 4.0), label, Wanted(span=SPAN, least=1.0, most=5)) == []


def test_a_frequency_to_avoid_hides_no_more_than_its_own_cell() -> None:
    line = 12.0
    for away, hidden in ((0.5, True), (-0.5, True), (1.0, False), (-1.0, False)):
        want = Wanted(span=SPAN, least=1.0, most=5, avoid=np.array([2.0, line + away * CELL, 60.0]))
        near = [f for f in standing_out(*sines((line, 0.3)), want) if abs(f - line) < CELL]
        assert near == ([] if hidden else pytest.approx([line], abs=0.5 * CELL)), away


def times_offered(share: float, rows: int) -> int:
    """Of 40 tries, how often a sine with this share of the mean square of so many rows is offered."""
    z, times = np.linspace(0.0, SPAN, rows), 0
    line = np.cos(2 * np.pi * 2.1 * z)
    for seed in range(40):
        e = np.random.default_rng(seed).standard_normal(rows)
        e -= line * (e @ line) / (line @ line)  # the noise has no part in the line
        e = e / np.sqrt(np.mean(e**2)) + np.sqrt(2 * share / (1 - share)) * line
        found = standing_out(e, z, np.zeros(rows, dtype=np.int64), Wanted(span=SPAN, least=0.5, most=3))
        times += any(abs(f - 2.1) < CELL for f in found)
    return times


def test_a_line_of_a_twentieth_of_the_mean_square_needs_to_stand_out_less() -> None:
    """Its power is share * rows / 2 times that around it: 8.4 to 9.8 here. A small line needs 12."""
    assert times_offered(0.065, 300) >= 30
    assert times_offered(0.042, 400) <= 10
    assert times_offered(0.0065, 3000) <= 10


@pytest.mark.parametrize("first", [{"large_first": True}, {"large_first": False}, {}])
def test_a_large_line_with_flanks_may_come_before_a_small_clear_one(first: dict[str, bool]) -> None:
    """Noise around 5, twenty times that elsewhere, is the large line's; the small one's is clear."""
    e, z, label = sines((50.0, 0.5), size=0.1)
    rng = np.random.default_rng(4)
    for f in np.arange(4.0, 6.0, CELL):
        e += rng.normal(0, 0.3) * np.cos(2 * np.pi * f * z) + rng.normal(0, 0.3) * np.sin(2 * np.pi * f * z)
    e += 2.5 * np.cos(2 * np.pi * 5.0 * z)
    (found,) = standing_out(e, z, label, Wanted(span=SPAN, least=1.0, most=1, **first))
    assert found == pytest.approx(5.0 if first.get("large_first") else 50.0, abs=CELL)
