"""One look over candidates: who is fitted in full, what a fit is worth, who comes first."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from calibration.balances.problem import Problem
from calibration.decide import scan
from calibration.decide.scan import (
    Contender,
    _alike,
    _first_of_class,
    _share,
    _worth_fitting,
    few,
    fit_with,
    look,
    ranked,
)
from calibration.finding import UNKNOWN
from calibration.statistics.regression import Fit, under
from calibration.statistics.tails import wald_log10
from calibration.statistics.whitening import Whitener
from tests.calibration.decide.made import PERIOD_S, line, problem, term

ROWS = 1000
T = PERIOD_S * np.arange(ROWS)
RNG = np.random.default_rng(111)
A, B, C, LUCK = RNG.standard_normal((4, ROWS))
Q = np.linalg.qr(np.column_stack([A, B, C]))[0]  # orthonormal
PRICE = float(np.log(ROWS)) / 2


def made(
    columns: np.ndarray,
    gain: float,
    name: str = "drag",
    bayes: float = 100.0,
    effect: float = 1.0,
    **more: Any,
) -> Contender:
    """One whose columns all have the size 1."""
    width = columns.shape[1]
    fit = Fit(np.ones(width), np.eye(width), np.zeros(ROWS), Whitener(np.zeros(0)), 1.0, 0.0, ROWS)
    numbers: dict[str, Any] = {"wald": 50.0, "blocks": 40.0, "bayes": bayes, "gain": gain, "effect": effect}
    return Contender(candidate=term(name, columns, **more), fit=fit, at=slice(0, width), **numbers)


def test_evidence_is_the_wald_tests_and_of_more_such_logs_as_many_times() -> None:
    one = replace(made(Q, 1.0), at=slice(3, 5))
    assert one.evidence == pytest.approx(float(wald_log10(50.0, 2, 40.0)))
    assert one.after(3) == pytest.approx(float(wald_log10(150.0, 2, 120.0)))


def names(found: list[Contender]) -> list[str]:
    return [c.candidate.name for c in found]


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize(("common", "alike"), [(0.92, True), (0.88, False)])
@pytest.mark.parametrize("size", [0.1, 1.0, 30.0])
def test_what_has_nine_tenths_in_common_says_the_same(
    common: float, alike: bool, sign: float, size: float
) -> None:
    one = made(Q[:, :1], 1.0)
    other = made(sign * size * (np.sqrt(common) * Q[:, :1] + np.sqrt(1 - common) * Q[:, 1:2]), 1.0)
    assert _alike(one, other) is alike and _alike(one, one) is True
    nothing = made(np.zeros((ROWS, 1)), 1.0)
    assert _alike(nothing, nothing) and not _alike(one, nothing)


@pytest.mark.parametrize(("gain", "first"), [(116.0, 3), (110.0, 1)])
def test_of_an_effects_forms_the_richer_must_pay_for_its_coefficients(gain: float, first: int) -> None:
    """By its own design effect: half the gain of either."""
    simple, rich = made(Q[:, :1], 100.0, effect=2.0, bayes=80.0), made(Q[:, :1], gain, effect=2.0, searched=2)
    assert (gain / 2 - 3 * PRICE > 50 - PRICE) is (first == 3)
    for both in ([simple, rich], [rich, simple]):
        assert [c.candidate.cost for c in ranked(both)] == [first, 4 - first]


@pytest.mark.parametrize(("gain", "first"), [(497.0, "wrap"), (496.0, "drag")])
def test_another_effect_with_fewer_coefficients_goes_first_by_the_shared_filter(
    gain: float, first: str
) -> None:
    """Whatever its own design effect."""
    rich = made(Q[:, :1], 500.0, searched=1, bayes=300.0)
    simple = made(Q[:, :1], gain, "wrap", bayes=10.0, effect=9.0)
    assert (gain - PRICE > 500.0 - 2 * PRICE) is (first == "wrap")
    assert names(ranked([rich, simple]))[0] == first


def test_an_effect_with_more_coefficients_or_a_line_never_goes_before_what_says_the_same() -> None:
    one = made(Q[:, :1], 500.0, bayes=300.0)
    same = made(Q[:, :1], 510.0, "same", bayes=200.0)
    richer = made(Q[:, :1], 900.0, "richer", bayes=100.0, searched=1)
    wave = made(Q[:, :1], 900.0, "wave", bayes=90.0, kind="line")
    assert names(ranked([one, richer, wave])) == ["drag", "richer", "wave"]
    assert names(ranked([one, same])) == ["same", "drag"]
    assert names(ranked([made(Q[:, :1], 500.0, bayes=300.0, kind="line"), same])) == ["drag", "same"]
    assert names(ranked([same, made(Q[:, 1:2], 900.0, bayes=300.0)])) == ["drag", "same"]


def test_what_has_no_evidence_goes_last_as_it_came() -> None:
    first, second = made(Q[:, :1], 5.0, "first", -np.inf), made(Q[:, :1], 9.0, "second", -np.inf)
    one = made(Q[:, :1], 1.0)
    assert names(ranked([first, second, one])) == ["drag", "first", "second"]


def test_places_that_tie_are_one_class_and_the_first_of_them_leads() -> None:
    """A thousandth of a logarithm is rounding."""
    forms = [
        made(Q[:, :1], gain, fixed={"motor": (motor, "1")})
        for gain, motor in ((5.0, 2.0), (5.0005, 1.0), (4.9995, 3.0), (5.002, 0.0), (5.0, 2.0))
    ]
    best = _first_of_class(forms)
    assert best.candidate.place == {"motor": 1.0}
    assert [c.candidate.place["motor"] for c in best.confounded] == [2.0, 3.0]
    assert _first_of_class(forms[3:]).confounded == []


def of(y: np.ndarray, base: np.ndarray | None = None) -> Problem:
    return problem(y, np.column_stack([np.ones(ROWS), C]) if base is None else base)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("through", [None, Whitener(np.array([0.4]))])
def test_a_fit_is_worth_its_gain_less_the_price_of_its_coefficients(
    scale: float, through: Whitener | None
) -> None:
    p = of(scale * (2.0 * A + B + LUCK))
    c = term("drag", np.column_stack([A, B]), searched=1)
    x = fit_with(p, p.base, c, through)
    assert x is not None
    both = np.hstack([p.base, c.columns])
    fit, own = p.fit(both), through or x.fit.whitener
    assert x.at == slice(2, 4) and x.fit.beta == pytest.approx(fit.beta) and x.candidate is c
    assert x.gain == pytest.approx(under(p.y, both, p.train, own) - under(p.y, p.base, p.train, own))
    wald = fit.beta[2:] @ np.linalg.solve(fit.covariance[2:, 2:], fit.beta[2:])
    assert x.wald == pytest.approx(wald) and x.blocks == fit.rows / p.block
    assert x.effect == pytest.approx(max(2 * x.gain / wald, 1.0))
    assert x.bayes == pytest.approx(x.gain / x.effect - 3 / 2 * np.log(fit.rows))


def test_a_smooth_function_without_a_name_counts_less() -> None:
    p = of(2.0 * A + B + LUCK)
    for columns, part in ((np.column_stack([A, B]), 0.85), (A[:, None], 1.0)):
        named, unnamed = (fit_with(p, p.base, term(name, columns)) for name in ("drag", UNKNOWN))
        assert named is not None and unnamed is not None
        assert unnamed.bayes == pytest.approx(part * named.bayes)


def test_a_design_effect_is_how_much_more_the_gain_is_than_evidence_allows() -> None:
    """Noise that comes in blocks of ten rows tells less than its rows do."""
    p = of(2.0 * A + B + LUCK)
    p.ar_order, slow = 0, np.repeat(RNG.standard_normal(ROWS // 10), 10)
    x = fit_with(p, p.base, term("drag", slow[:, None] + 0.0 * A[:, None]))
    assert x is not None and x.effect >= 1.0
    coloured = replace(p, y=np.repeat(RNG.standard_normal(ROWS // 10), 10) + 0.5 * slow)
    y = fit_with(coloured, p.base, term("drag", slow[:, None]))
    assert y is not None and y.effect > 2.0
    assert y.effect == pytest.approx(2 * y.gain / y.wald)
    assert y.bayes == pytest.approx(y.gain / y.effect - np.log(y.fit.rows) / 2)
    at, error = y.fit.beta[-1], y.fit.errors[-1]
    weak = fit_with(replace(coloured, y=coloured.y - (at - 0.5 * error) * slow), p.base, y.candidate)
    assert weak is not None and weak.wald == pytest.approx(0.25)
    assert weak.effect == pytest.approx(2 * weak.gain / weak.wald) and weak.effect > 2.0


def test_columns_of_nothing_are_worth_less_than_nothing() -> None:
    p = of(A)
    x = fit_with(p, p.base, term("drag", np.zeros((ROWS, 1))))
    assert x is not None
    assert (x.wald, x.effect) == (0.0, 1.0) and x.bayes == pytest.approx(-np.log(x.fit.rows) / 2)


def test_a_size_that_physics_refuses_is_no_fit() -> None:
    p = of(2.0 * A - B + 0.1 * LUCK)
    assert fit_with(p, p.base, term("drag", A[:, None], sign=1)) is not None
    assert fit_with(p, p.base, term("drag", A[:, None], sign=-1)) is None
    two = np.column_stack([A, B])
    assert fit_with(p, p.base, term("drag", two, positive=(0,))) is not None
    assert fit_with(p, p.base, term("drag", two, positive=(1,))) is None
    assert fit_with(p, p.base, term("drag", two, positive=(0,), sign=1)) is None


@pytest.mark.parametrize(("errors", "sure"), [(4.5, True), (3.5, False)])
@pytest.mark.parametrize("scale", [0.01, 1.0])
def test_what_must_be_positive_must_be_so_by_four_errors(errors: float, sure: bool, scale: float) -> None:
    p = of(LUCK)
    fit = p.fit(np.hstack([p.base, A[:, None], B[:, None]]))
    at = 3
    y = p.y + (errors * fit.errors[at] - fit.beta[at]) * B  # the fit is linear in y but for its filter
    q = replace(p, y=scale * y, ar_order=0)
    plain = q.fit(np.hstack([q.base, A[:, None], B[:, None]]))
    q.y = q.y + (errors * plain.errors[at] - plain.beta[at]) * B
    found = fit_with(q, q.base, term("drag", np.column_stack([A, B]), positive=(1,)))
    assert (found is not None) is sure


@pytest.mark.parametrize("white", [False, True])
@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_a_share_is_what_columns_take_of_what_is_left_less_chance(white: bool, scale: float) -> None:
    """Three times one over the rows for each column."""
    p = of(scale * (2.0 * A + 0.5 * B + LUCK))
    null = replace(p.fit(), whitener=Whitener(np.array([0.6])))
    some = [
        term("drag", A[:, None] + C[:, None]),
        term("wrap", np.column_stack([A, B])),
        term("play", B[:, None]),
    ]
    keep = null.whitener.usable(p.train) if white else p.train

    def rows(x: np.ndarray) -> np.ndarray:
        return null.whitener.apply(np.where(p.train if x.ndim == 1 else p.train[:, None], x, 0.0))[keep]

    e, base = (rows(x) if white else x[keep] for x in (null.residual, p.base))
    rest = e - base @ np.linalg.lstsq(base, e, rcond=None)[0]
    expected = []
    for c in some:
        x = np.hstack([base, rows(c.columns) if white else c.columns[keep]])
        left = e - x @ np.linalg.lstsq(x, e, rcond=None)[0]
        expected.append((rest @ rest - left @ left) / (e @ e) - 3.0 * c.width / len(e))
    assert _share(p, null, p.base, some, white) == pytest.approx(expected)


def test_groups_have_some_thirty_columns_and_every_candidate_once() -> None:
    some = [term(str(k), np.zeros((1, 1 + k % 3))) for k in range(60)]
    groups = few(some)
    assert [c.name for group in groups for c in group] == [str(k) for k in range(60)]
    sizes = [sum(c.width for c in group) for group in groups]
    assert len(groups) == 4 and max(sizes) <= 34


def fitted(
    shares: list[float],
    keys: str,
    plain: list[float] | None = None,
    monkeypatch: pytest.MonkeyPatch | None = None,
) -> list[int]:
    """Places of those that are fitted in full, of effects that are called by these letters."""
    assert monkeypatch is not None
    p = problem(A)
    null = p.fit()
    own = Whitener(np.zeros(0 if plain is None else 2))
    monkeypatch.setattr(scan, "_share", lambda *given: np.array(shares if given[-1] else plain))
    some = [term(name, A[:, None]) for name in keys]
    return _worth_fitting(p, replace(null, whitener=own), p.base, some)


def test_the_best_eight_effects_are_fitted_in_two_forms_each(monkeypatch: pytest.MonkeyPatch) -> None:
    down = [1.0 - 0.01 * k for k in range(20)]
    assert fitted(down, "abcdefghijkl" + "z" * 8, monkeypatch=monkeypatch) == list(range(8))
    assert fitted(down[::-1], "z" * 8 + "abcdefghijkl", monkeypatch=monkeypatch) == list(range(19, 11, -1))
    # a third form is not, and a second one not beside eight
    assert fitted(down, "aaabbbccc" + "d" * 11, monkeypatch=monkeypatch) == [0, 1, 3, 4, 6, 7, 9, 10]
    assert fitted(down, "aabbccddeeffgghhiijj", monkeypatch=monkeypatch) == [
        0,
        1,
        2,
        3,
        4,
        5,
        6,
        7,
        8,
        10,
        12,
        14,
    ]
    assert fitted(down[:12], "aabbccdedfgh", monkeypatch=monkeypatch) == [0, 1, 2, 3, 4, 5, 6, 7, 9, 10, 11]
    assert fitted(down[:3], "abb", monkeypatch=monkeypatch) == [0, 1, 2]


def test_the_best_two_of_the_residual_as_it_is_are_fitted_too(monkeypatch: pytest.MonkeyPatch) -> None:
    down = [1.0 - 0.01 * k for k in range(12)]
    plain = [0.0] * 12
    plain[10], plain[3], plain[11] = 0.9, 0.8, 0.7
    assert fitted(down, "abcdefghijkl", plain, monkeypatch) == [*range(8), 10]
    plain[9] = 0.95
    assert fitted(down, "abcdefghijkl", plain, monkeypatch) == [*range(8), 9, 10]


def test_nothing_that_can_be_fitted_is_nothing_to_rank() -> None:
    p = of(2.0 * A + LUCK)
    assert look(p, p.base, p.fit(), [term("drag", A[:, None], sign=-1)]) == []
    assert names(look(p, p.base, p.fit(), [term("drag", A[:, None])])) == ["drag"]


def test_a_look_ranks_effects_and_keeps_the_best_form_of_each() -> None:
    p = of(2.0 * A + B + LUCK)
    near = term("drag", (A + 0.5 * LUCK)[:, None], fixed={"tau": (2.0, "s")})
    some = [term("wrap", B[:, None]), near, term("drag", A[:, None], fixed={"tau": (1.0, "s")})]
    found = look(p, p.base, p.fit(), some)
    assert names(found) == ["drag", "wrap"]
    assert len({len(x.fit.whitener.a) for x in found}) == 1
    best = found[0].fit.whitener
    assert found[0].gain == pytest.approx(
        under(p.y, np.hstack([p.base, found[0].candidate.columns]), p.train, best)
        - under(p.y, p.base, p.train, best)
    )


@pytest.mark.parametrize(("true", "first"), [(3.0, "own"), (3.1, "beside")])
@pytest.mark.parametrize("harmonic", [1, None])
def test_a_line_beside_a_stages_own_goes_first_where_it_gains_clearly_more(
    true: float, first: str, harmonic: int | None
) -> None:
    turns = T / 5.0
    y = line("", turns, true).columns[:, 0] + 0.3 * LUCK
    neighbours = tuple(line("beside", turns, order) for order in (2.9, 3.1))
    own = line("own", turns, 3.0, stage="motor", harmonic=harmonic, neighbours=neighbours)
    p = problem(y)
    assert names(look(p, p.base, p.fit(), [own]))[0] == first


def found_beside(gain: float, bayes: float, monkeypatch: pytest.MonkeyPatch, **more: Any) -> list[str]:
    """Beside a first one that gains 100 and has a `bayes` of 50."""
    first = made(Q[:, :1], 100.0, "own", bayes=50.0, **{"kind": "line", "harmonic": 1, **more})
    tried = [made(Q[:, 1:2], gain, "beside", bayes=bayes), made(Q[:, 1:2], gain + 1, "best", bayes=bayes)]
    monkeypatch.setattr(scan, "_fits_beside", lambda *given: [(x.candidate, x.fit) for x in tried])
    monkeypatch.setattr(
        scan, "_scored", lambda p, base, c, *given: next(x for x in tried if x.candidate is c)
    )
    p = problem(A)
    return names(scan._neighbours(p, p.base, p.fit(), first, 0.0, Whitener(np.zeros(0))))


def test_beside_a_harmonic_a_line_must_gain_a_twentieth_more_the_best_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert found_beside(106.0, 0.0, monkeypatch) == ["best", "beside"]
    assert found_beside(102.0, 99.0, monkeypatch) == []
    assert found_beside(106.0, 0.0, monkeypatch, kind="linear", harmonic=None) == ["best", "beside"]


def test_beside_a_whole_stage_a_line_must_be_worth_more(monkeypatch: pytest.MonkeyPatch) -> None:
    assert found_beside(106.0, 49.0, monkeypatch, harmonic=None) == []
    assert found_beside(90.0, 51.0, monkeypatch, harmonic=None) == ["best", "beside"]
    assert found_beside(90.0, 50.0, monkeypatch, harmonic=None) == []
