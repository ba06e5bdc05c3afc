"""The selection: noise gets no name, what was planted gets its own, with its size."""

from dataclasses import replace

import numpy as np
import pytest

from calibration.balances.candidate import Candidate
from calibration.decide.accept import SHORT, least_share
from calibration.decide.parameters import finding_of, parameters_of
from calibration.decide.select import _Search, select
from calibration.decide.selection import Selection
from calibration.decide.thresholds import MARGIN, MOST_EFFECTS
from calibration.decide.verdict import judge
from calibration.names import NAMES
from tests.calibration.decide.made import PERIOD_S, line, problem, term

ROWS = 2400


def candidates(rng: np.random.Generator) -> list[Candidate]:
    """Lines of three stages, a step in time, a drag, and columns that nothing has."""
    turns = np.cumsum(0.02 + 0.01 * np.sin(np.arange(ROWS) / 90.0))
    found = [line(f"gear_{k}", turns, order) for k, order in enumerate((1.0, 3.7, 11.3))]
    found.append(term("change", (np.arange(ROWS) > ROWS / 3)[:, None].astype(float)))
    found.append(term("drag", np.gradient(turns)[:, None] * 50.0))
    return found + [term(f"other_{k}", rng.standard_normal((ROWS, 1))) for k in range(10)]


@pytest.mark.parametrize("seed", range(8))
def test_white_noise_gets_no_name(seed: int) -> None:
    rng = np.random.default_rng(seed)
    s = select(problem(rng.standard_normal(ROWS)), candidates(rng), rng)
    assert not s.chosen
    assert s.held.share == 0.0
    assert s.refused  # and each says why
    assert all(r.why for r in s.refused)


@pytest.mark.parametrize("seed", range(4))
def test_coloured_noise_gets_no_name_either(seed: int) -> None:
    rng = np.random.default_rng(100 + seed)
    e = rng.standard_normal(ROWS)
    for k in range(1, ROWS):
        e[k] += 0.8 * e[k - 1]
    assert not select(problem(e), candidates(rng), rng).chosen


@pytest.mark.parametrize("name", ["gear_0", "gear_1", "gear_2", "change", "drag", "other_4"])
def test_what_was_planted_is_named_and_nothing_else_with_a_size_that_covers(name: str) -> None:
    rng = np.random.default_rng(7)
    have = candidates(rng)
    planted = next(c for c in have if c.name == name)
    beta = np.array([1.2, -0.9])[: planted.width]
    s = select(problem(planted.columns @ beta + rng.standard_normal(ROWS)), have, rng)
    assert [c.candidate.name for c in s.chosen] == [name]
    found = parameters_of(s, 0)
    truth = float(np.hypot(*beta)) if planted.kind == "line" else beta[0]
    size = found["amplitude" if planted.kind == "line" else "size_0"]
    assert size.low is not None and size.high is not None and size.low < truth < size.high
    if planted.kind == "line":  # cos and sin coefficients as one cosine with its phase
        assert found["phase"].value == pytest.approx(np.arctan2(-beta[1], beta[0]), abs=0.2)
    assert s.held.share > 0.1
    assert s.chosen[0].held.share == pytest.approx(s.held.share, abs=0.05)


def test_two_effects_are_both_found_and_fitted_together() -> None:
    rng = np.random.default_rng(8)
    have = candidates(rng)
    y = have[0].columns @ [2.0, 0.0] + have[3].columns @ [1.5] + rng.standard_normal(ROWS)
    s = select(problem(y), have, rng)
    sizes = {c.name: beta for c, beta in s.fitted}
    assert set(sizes) == {"gear_0", "change"}
    assert sizes["gear_0"] == pytest.approx([2.0, 0.0], abs=0.2)
    assert sizes["change"] == pytest.approx([1.5], abs=0.3)
    assert s.after.residual.std() == pytest.approx(1.0, abs=0.1)
    names = [finding_of(s, k).name for k in range(2)]
    assert names[0] == "gear_0"  # the one that takes most away first


def test_no_more_effects_than_asked_for() -> None:
    rng = np.random.default_rng(9)
    have = [term(f"t{k}", rng.standard_normal((ROWS, 1))) for k in range(MOST_EFFECTS + 2)]
    y = np.sum([c.columns[:, 0] for c in have], axis=0) + rng.standard_normal(ROWS)
    assert len(select(problem(y), have, rng).chosen) == MOST_EFFECTS
    assert len(select(problem(y), have, rng, most=2).chosen) == 2


def test_a_size_that_physics_excludes_is_not_taken() -> None:
    rng = np.random.default_rng(10)
    x = rng.standard_normal((ROWS, 1))
    y = -1.0 * x[:, 0] + 0.5 * rng.standard_normal(ROWS)
    assert not select(problem(y), [term("drag", x, sign=1)], rng).chosen
    assert select(problem(y), [term("drag", x, sign=-1)], rng).chosen
    assert not select(problem(y), [term("drag", x, most=0.5)], rng).chosen


def test_what_the_held_out_run_does_not_have_is_refused_when_it_makes_it_worse() -> None:
    rng = np.random.default_rng(11)
    x = rng.standard_normal((ROWS, 1))
    p = problem(rng.standard_normal(ROWS))
    p.y = p.y + np.where(p.held, -1.0, 1.0) * x[:, 0]
    s = select(p, [term("drag", x)], rng)
    assert not s.chosen
    assert any("held-out mean square worse" in r.why for r in s.refused)


def test_a_log_too_short_says_what_is_close_and_how_long_a_log_would_tell() -> None:
    """Six blocks to fit and a drag that takes three fifths of the square."""
    rng = np.random.default_rng(12)
    rows = round(8 / PERIOD_S)
    x = rng.standard_normal((rows, 1))
    p = problem(1.2 * x[:, 0] + rng.standard_normal(rows))
    coloured = select(p, [term("drag", x)], rng)
    assert not coloured.chosen and "20 independent blocks" in coloured.refused[0].why
    p.ar_order = 0
    s = select(
        p, [term("drag", x), *(term(f"other_{k}", rng.standard_normal((rows, 1))) for k in range(400))], rng
    )
    assert not s.chosen
    one = s.refused[0]
    assert one.what == "drag" and one.why.startswith(SHORT) and "times as long" in one.why


def test_a_longer_log_shows_less() -> None:
    shares = [least_share(problem(np.zeros(round(s / PERIOD_S))), 1000) for s in (6, 14, 60, 600)]
    assert shares == sorted(shares, reverse=True) and shares[0] > 0.5 > shares[-1]


def test_a_name_that_fits_as_well_is_said_beside_the_first() -> None:
    rng = np.random.default_rng(13)
    x = rng.standard_normal((ROWS, 1))
    twin = x + 1e-3 * rng.standard_normal((ROWS, 1))
    s = select(problem(x[:, 0] + rng.standard_normal(ROWS)), [term("one", x), term("other", twin)], rng)
    (chosen,) = s.chosen
    names = {chosen.candidate.name, *(c.candidate.name for c in chosen.confounded)}
    assert names == {"one", "other"}
    assert finding_of(s, 0).equivalent == [c.candidate.name for c in chosen.confounded]


def test_places_that_tie_exactly_are_a_class() -> None:
    """Motor A's current reads too much, or motor B's too little by a resistance that is the other one."""
    rng = np.random.default_rng(15)
    current = np.abs(rng.standard_normal(ROWS))
    first = (np.arange(ROWS) % 2 == 0).astype(float)
    each = [current * first, current * (1 - first)]
    places = [
        replace(term("adc_gain", x[:, None]), fixed={"motor": (m, "1 A, 2 B")})
        for x, m in zip(each, (1, 2), strict=True)
    ]
    y = current + 0.3 * each[1] + 0.1 * rng.standard_normal(ROWS)
    for offered in (places, places[::-1]):  # which one rounding prefers does not matter
        s = select(problem(y, base=current[:, None]), offered)
        (chosen,) = s.chosen
        assert chosen.candidate.place == {"motor": 1.0}
        told = finding_of(s, 0)
        assert told.equivalent == ["adc_gain"]
        (other,) = chosen.confounded
        assert other.fit.beta[other.at] == pytest.approx([0.3], abs=0.02)
        assert told.note.startswith("fits exactly as well: size_0") and told.note.endswith("motor 2")
        assert told.parameters["size_0"].value < 0
        assert judge([told]) == ("ambiguous", f"adc_gain: {NAMES['adc_gain'].experiment}")
    places[1] = replace(places[1], columns=places[1].columns + 0.1 * rng.standard_normal((ROWS, 1)))
    (chosen,) = select(problem(y, base=current[:, None]), places).chosen
    assert not chosen.confounded


def test_a_time_constant_is_refined_between_the_points_of_its_grid() -> None:
    rng = np.random.default_rng(14)
    t = PERIOD_S * np.arange(ROWS)

    def shape(p: np.ndarray) -> np.ndarray:
        return np.exp(-t / max(float(p[0]), 1e-3))[:, None]

    start = np.array([20.0])
    c = term("warm_up", shape(start), fixed={"time_constant": (20.0, "s")}, shape=shape, steps=(3.0,))
    s = select(
        problem(4.0 * shape(np.array([26.0]))[:, 0] + 0.3 * rng.standard_normal(ROWS), held=1), [c], rng
    )
    assert len(s.chosen) == 1
    found = parameters_of(s, 0)["time_constant"]
    assert found.value == pytest.approx(26.0, abs=3.0)
    assert found.low is not None and found.high is not None and found.low < 26.0 < found.high


@pytest.mark.parametrize("seed", range(3))
def test_one_name_that_imitates_two_is_found_out_by_searching_around_it(seed: int) -> None:
    """Beside the imitation, either of the two takes half a per cent of the error; together they take 12 %."""
    rng = np.random.default_rng(20 + seed)
    sag, deadband, luck = rng.standard_normal((3, ROWS, 1))
    have = [term("sag", sag), term("deadband", deadband), term("loss", sag + deadband + 0.32 * luck)]
    y = 1.2 * (sag + deadband)[:, 0] + rng.standard_normal(ROWS)
    assert [c.name for c in select(problem(y), have, rng).candidates] == ["loss"]
    s = select(problem(y), have, rng, around=True)
    assert {c.name for c in s.candidates} == {"sag", "deadband"}
    assert [r.why for r in s.refused if r.what == "loss"][-1].endswith("explain it better")


def test_what_is_true_alone_stands_against_what_is_around_it() -> None:
    rng = np.random.default_rng(30)
    sag, deadband, luck = rng.standard_normal((3, ROWS, 1))
    loss = sag + deadband + 0.32 * luck
    have = [term("sag", sag), term("deadband", deadband), term("loss", loss)]
    s = select(problem(1.2 * loss[:, 0] + rng.standard_normal(ROWS)), have, rng, around=True)
    assert [c.name for c in s.candidates] == ["loss"]


@pytest.mark.parametrize(("friction", "names"), [(1.0, ["coulomb_change"]), (0.0, [])])
def test_friction_that_nobody_stated_comes_before_what_stands_in_for_it(
    friction: float, names: list[str]
) -> None:
    """A brake from the third second on fits as well where luck was against the friction in the first two; and
    what grows with the speed holds most of a friction."""
    rng = np.random.default_rng(11)
    speed = np.sin(np.arange(ROWS) / 41.0)
    way, late = np.sign(speed), np.arange(ROWS) > 2.0 / PERIOD_S
    luck = rng.standard_normal(ROWS)
    have = [
        term("brake_drag", (way * late)[:, None]),
        term("load_friction", (way * np.abs(speed))[:, None]),
        term("coulomb_change", way[:, None]),
    ]
    y = friction * way + 0.3 * luck - 0.7 * friction * way * ~late
    s = select(problem(y), have, rng)
    assert [c.candidate.name for c in s.chosen][:1] == names
    rest = select(problem(y), have[:2], rng)
    assert bool(rest.chosen) == bool(names) and rest.candidates[:1] == have[: len(names)]


def test_friction_that_nobody_stated_turns_no_other_one_negative() -> None:
    """A wave of the force is in the speed, too: all but one speed tells no friction that grows with it."""
    rng = np.random.default_rng(12)
    way = np.repeat([1.0, -1.0], ROWS // 2)
    wave, other = np.sin(np.arange(ROWS) / 17.0), np.sin(np.arange(ROWS) / 23.0)
    speed = way * (1.0 + 0.05 * (0.8 * wave + 0.6 * other))
    p = problem(way * (1.0 + 0.5 * wave) + 0.1 * rng.standard_normal(ROWS), way[:, None])
    p = replace(p, base_labels=[("coulomb", "N m")])
    have = [term("viscous_change", speed[:, None])]
    sound = replace(p, y=0.4 * speed + 0.6 * way + 0.002 * rng.standard_normal(ROWS))
    for drive, names in ((p, []), (sound, ["viscous_change"])):
        search = _Search(Selection.of(drive), have, MARGIN, 0)
        search.expect()
        assert [c.name for c in search.picks.candidates] == names
