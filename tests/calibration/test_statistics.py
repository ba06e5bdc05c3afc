"""The statistics hold their level on coloured noise, and intervals cover."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from calibration.balances.candidate import Candidate, pairs_by_section, sine_columns
from calibration.balances.context import direction_of, since_reversal, turning_points
from calibration.balances.filters import boxcar
from calibration.balances.noise import rough
from calibration.balances.problem import Problem
from calibration.balances.recursions import stop_operator
from calibration.decide.heldout import cross_validate, folds
from calibration.decide.scan import look
from calibration.decide.thresholds import FOLDS
from calibration.statistics.orders import order_spectrum, peaks
from calibration.statistics.regression import gls
from calibration.statistics.surrogate import basis, orthonormal_blocks, score, taken_away, together
from calibration.statistics.whitening import Whitener, fit_ar


def coloured(rng: np.random.Generator, n: int, a: float) -> np.ndarray:
    out = np.zeros(n)
    w = rng.standard_normal(n)
    for k in range(1, n):
        out[k] = a * out[k - 1] + w[k]
    return out


def test_whitening_takes_the_colour_out_and_respects_gaps() -> None:
    rng = np.random.default_rng(1)
    x = coloured(rng, 20000, 0.7)
    valid = np.ones(len(x), dtype=bool)
    valid[5000:5100] = False
    w = fit_ar(x, valid, 2)
    use = w.usable(valid)
    e = w.apply(x)[use]
    assert abs(np.corrcoef(e[1:], e[:-1])[0, 1]) < abs(np.corrcoef(x[1:], x[:-1])[0, 1]) - 0.3
    assert not use[5000:5102].any() and use[5102]


def test_intervals_cover_on_coloured_noise() -> None:
    inside = 0
    for seed in range(120):
        rng = np.random.default_rng(seed)
        n = 3000
        x = np.column_stack([np.ones(n), np.sin(np.arange(n) / 40)])
        fit = gls(x @ [1.0, 0.5] + coloured(rng, n, 0.8), x, np.ones(n, dtype=bool), 3, block=100)
        error = np.sqrt(fit.covariance[1, 1])
        inside += abs(fit.beta[1] - 0.5) < 2.05 * error
    assert 106 <= inside <= 120  # 95 % of 120 is 114, three standard deviations are 7


@pytest.mark.slow
def test_the_surrogate_threshold_holds_its_level_on_coloured_noise() -> None:
    alarms = 0
    for seed in range(60):
        rng = np.random.default_rng(seed)
        n = 4000
        e = coloured(rng, n, 0.9)
        t = np.arange(n) / 100
        columns = [
            np.column_stack([np.cos(2 * np.pi * f * t), np.sin(2 * np.pi * f * t)])
            for f in np.linspace(0.1, 5, 60)
        ]
        q, widths = orthonormal_blocks(columns, basis(np.ones((n, 1))))
        signs = rng.choice([-1.0, 1.0], size=(200, n // 200))
        s = together([score(e, e, q, widths, 200, signs)], 0.99)
        alarms += s.value.max() > s.threshold
    assert alarms <= 5  # 1 % of 60 is 0.6; naive chi2 thresholds alarm in all of them


@given(st.lists(st.floats(-5, 5), min_size=3, max_size=80), st.floats(0.1, 3.0))
@settings(max_examples=40, deadline=None)
def test_the_stop_element_is_bounded_and_dissipates(path: list[float], radius: float) -> None:
    x = np.array(path)
    force = stop_operator(x, np.zeros(len(x), dtype=np.int64), radius)
    assert np.abs(force).max() <= radius + 1e-12
    loop = np.concatenate([x, x[::-1]])
    f = stop_operator(loop, np.zeros(len(loop), dtype=np.int64), radius)
    stored = 0.5 * f[-1] ** 2 - 0.5 * f[0] ** 2
    assert np.sum(0.5 * (f[1:] + f[:-1]) * np.diff(loop)) - stored >= -1e-9


def test_direction_and_travel_since_reversal() -> None:
    x = np.concatenate([np.linspace(0, 10, 101), np.linspace(10, 4, 61)[1:], np.linspace(4, 8, 41)[1:]])
    run = np.zeros(len(x), dtype=np.int64)
    assert np.flatnonzero(turning_points(x, run, 1.0)).tolist() == [100, 160]
    d = direction_of(x, run, 1.0)
    assert (d[:100] == 1).all() and (d[101:160] == -1).all() and (d[161:] == 1).all()
    assert since_reversal(x, d, run)[159] == pytest.approx(x[159] - 10)


def test_the_order_spectrum_peaks_at_the_order_and_odd_orders_need_their_weight() -> None:
    rng = np.random.default_rng(3)
    turns = np.concatenate([np.linspace(0, 0.3, 9000), np.linspace(0.3, 0, 9000)])
    sign = np.sign(np.gradient(turns))
    e = sign * np.cos(2 * np.pi * 86.13 * turns) + rng.standard_normal(18000)
    odd, even = (order_spectrum(e, turns, w, 300) for w in (sign, np.ones(18000)))
    assert peaks(*odd, 1, 1.0)[0] == pytest.approx(86.13, abs=0.5)
    assert odd[1].max() > 50 * even[1].max()


def test_smoothing_and_second_differences_are_consistent() -> None:
    """Boxcar twice over D rows of an acceleration is the second difference of the position over D rows."""
    t = np.arange(400) * 0.01
    acceleration = np.sin(3 * t)
    theta = np.cumsum(np.cumsum(acceleration)) * 1e-4
    d = 3
    second = (theta[2 * d :] - 2 * theta[d:-d] + theta[: -2 * d]) / (d * 0.01) ** 2
    # the double sum runs one row late, so compare with the acceleration one row later
    assert second == pytest.approx(boxcar(boxcar(acceleration, d), d)[d + 1 : -d + 1], abs=1e-6)


def regression(y: np.ndarray, base: np.ndarray, period_s: float, runs: int = 1) -> Problem:
    n = len(y)
    run = np.repeat(np.arange(runs), n // runs)
    t = np.tile(np.arange(n // runs) * period_s, runs)  # every file's own time
    nothing = np.zeros(n, dtype=bool)
    return Problem(
        channel="T",
        unit="N m",
        y=y,
        base=base,
        base_labels=[("offset", "N m"), ("viscous", "N m s/rad")][: base.shape[1]],
        t=t,
        run=run,
        session=run,
        valid=~nothing,
        held=nothing,
        period_s=period_s,
        ar_order=4,
    )


@pytest.mark.parametrize(("rows", "runs"), [(300, 1), (1000, 2), (6000, 3)])
def test_every_fold_holds_rows_and_short_logs_are_predicted_too(rows: int, runs: int) -> None:
    rng = np.random.default_rng(rows)
    x = rng.standard_normal((rows, 1))
    p = regression(x[:, 0] + 0.3 * rng.standard_normal(rows), np.ones((rows, 1)), 0.01, runs)
    fold = folds(p, p.train)
    assert np.bincount(fold, minlength=FOLDS).min() > 0.1 * rows
    score = cross_validate(p, p.base, np.hstack([p.base, x]), Whitener(np.zeros(0)))
    assert score.share == pytest.approx(1 - 0.09 / 1.09, abs=0.05)  # variance of what was added over all


def test_places_that_no_other_fold_has_been_to_test_nothing() -> None:
    rng = np.random.default_rng(8)
    n = 6000
    x = rng.standard_normal((n, 1))
    lonely = np.zeros((n, 2))  # one stretch of 1.5 s, which lies in one fold
    lonely[300:450, 0], lonely[300:450, 1] = 1.0, np.linspace(0.0, 1.0, 150)
    # next to nothing of either elsewhere: the other folds give them coefficients without meaning
    lonely[450:] = 1e-4 * rng.standard_normal((n - 450, 2))
    p = regression(x[:, 0] + 3.0 * lonely[:, 0] + 0.3 * rng.standard_normal(n), np.ones((n, 1)), 0.01)
    score = cross_validate(p, p.base, np.hstack([p.base, x, lonely]), Whitener(np.zeros(0)))
    assert score.share == pytest.approx(1 - 0.09 / 1.09, abs=0.05)


def test_an_exact_line_gains_through_one_filter_though_its_own_residual_is_whitened_by_another() -> None:
    rng = np.random.default_rng(4)
    t = np.arange(3000) * 0.01
    columns = np.column_stack([np.cos(2 * np.pi * 0.7 * t), np.sin(2 * np.pi * 0.7 * t)])
    p = regression(columns @ [1.0, 0.5] + 0.02 * rng.standard_normal(3000), np.ones((3000, 1)), 0.01)
    line = Candidate("bearing_pass", "axis_angle", columns, (("amplitude", "N m"),), kind="line", order=7.0)
    top = look(p, p.base, p.fit(), [line])[0]
    # n log(rms with / rms without): sqrt(0.625 + 0.0004) over 0.02 in white noise, less through a filter
    assert top.gain > 0.5 * 3000 * np.log(np.sqrt(0.6254) / 0.02)
    assert top.bayes > 0


def test_pairs_on_the_same_rows_are_harmonics_and_pairs_on_rows_of_their_own_are_sections() -> None:
    phase, section = np.arange(600) / 97.0, np.repeat([0, 1, 2], 200)
    assert pairs_by_section(sine_columns(phase, section)) == [[0], [2], [4]]
    one = np.zeros(600, dtype=int)
    assert pairs_by_section(np.hstack([sine_columns(h * phase, one) for h in (1, 2)])) == [[0, 2]]


def test_the_noise_of_a_column_is_found_beside_a_smooth_motion_and_a_burst() -> None:
    rng = np.random.default_rng(8)
    t = np.arange(6000) * 0.01
    x = 50 * np.sin(2 * np.pi * t / 7) + 0.3 * rng.standard_normal(6000)
    x[3000:3010] += 40  # a transient is no noise
    for order in (2, 4):
        assert rough(x, order) == pytest.approx(0.3, rel=0.05)
    assert np.isnan(rough(x[:150], 2))


def test_what_blocks_take_away_is_the_same_from_inner_products_and_from_columns() -> None:
    rng = np.random.default_rng(0)
    base, e = rng.standard_normal((500, 3)), rng.standard_normal(500)
    blocks = [rng.standard_normal((500, k)) for k in (1, 2, 3)]
    blocks.append(np.column_stack([blocks[0], 2 * blocks[0], base[:, 1]]))  # a twin, and one of the base
    q, widths = orthonormal_blocks(blocks, basis(base))
    parts = np.split((q.T @ e) ** 2, np.cumsum(widths)[:-1])
    taken, kept = taken_away(e, basis(base), blocks)
    assert kept == widths == [1, 2, 3, 1]
    assert taken == pytest.approx([p.sum() for p in parts])
