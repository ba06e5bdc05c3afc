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
