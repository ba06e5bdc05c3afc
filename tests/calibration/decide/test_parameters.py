"""Parameters and intervals from coefficients that are given, of one effect and of a line's harmonics."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy import stats

from calibration.balances.candidate import Candidate
from calibration.decide.parameters import amplitude_interval, finding_of, findings_of, interval, parameters_of
from calibration.decide.scan import fit_with
from calibration.decide.selection import Selection
from calibration.finding import UNKNOWN, Finding, Parameter
from tests.calibration.decide.made import PERIOD_S, line, problem, term

ROWS, BLOCKS = 2400, 90
T = PERIOD_S * np.arange(ROWS)
RNG = np.random.default_rng(71)
A, B, C, LUCK = RNG.standard_normal((4, ROWS))
REACH = float(stats.t.ppf(0.975, BLOCKS - 2))
MODEL = 0.03  # of a value: the declared model's own error


def of(y: np.ndarray, *some: Candidate) -> Selection:
    s = Selection.of(problem(y + 0.3 * LUCK))
    return s.keep([x for c in some if (x := fit_with(s.problem, s.problem.base, c)) is not None])


def given(beta: Sequence[float], errors: Sequence[float] | float, *some: Candidate) -> Selection:
    """The last effect has these coefficients with errors that do not depend on each other."""
    s = of(np.sum([c.columns.sum(axis=1) for c in some], axis=0), *some)
    at, each = s.at(len(some) - 1), np.broadcast_to(np.asarray(errors), len(beta))
    b, cov = s.after.beta.copy(), s.after.covariance.copy()
    b[at], cov[at, :], cov[:, at] = beta, 0.0, 0.0
    cov[at, at] = np.diag(each**2)
    s.after = replace(s.after, beta=b, covariance=cov)
    s.problem.y = s.columns @ b  # held-out rows have it, too
    return s


def ends(value: float, error: float, model: float | None = None) -> tuple[float, float]:
    reach = REACH * float(np.hypot(error, MODEL * value if model is None else model))
    return value - reach, value + reach


def test_an_interval_of_few_blocks_has_three_degrees_of_freedom() -> None:
    for blocks, freedom in ((1, 3), (5, 3), (6, 4), (30, 28)):
        low, high = interval(2.0, 0.5, blocks, 0.0)
        assert (low, high) == pytest.approx((2 - stats.t.ppf(0.975, freedom) * 0.5, 4 - low))
    assert interval(2.0, 0.3, 30, 0.4) == pytest.approx(interval(2.0, 0.5, 30, 0.0))


def test_every_coefficient_is_a_parameter_and_a_grids_has_no_interval() -> None:
    two = term("friction_asymmetry", np.column_stack([A, B]), fixed={"tau": (7.0, "s")})
    s = given([2.0, -0.5], [0.1, 0.2], term("brake_drag", C[:, None]), two)
    found = parameters_of(s, 1)
    assert list(found) == ["size_0", "size_1", "tau"]
    assert found["tau"] == Parameter(7.0, "s")
    for name, value, error in (("size_0", 2.0, 0.1), ("size_1", -0.5, 0.2)):
        assert (found[name].value, found[name].unit) == (value, "N m")
        assert (found[name].low, found[name].high) == pytest.approx(ends(value, error))
    one_label = replace(two, labels=two.labels[:1])
    assert list(parameters_of(given([2.0, -0.5], 0.1, one_label), 0)) == ["size_0", "tau"]


def waved(h: int, order: float = 0.1, rows: np.ndarray | None = None) -> np.ndarray:
    columns = line("", T, h * order).columns
    return columns if rows is None else np.where(rows[:, None], columns, 0.0)


def wave(*columns: np.ndarray, labels: int = 1, **more: Any) -> Candidate:
    own = {"kind": "line", "order": 2.0, **more}
    named = tuple((("amplitude", "second")[k], "N m") for k in range(labels))
    return replace(term("gear_eccentricity", np.hstack(columns)), labels=named, **own)


def test_harmonics_of_one_section_have_amplitudes_and_phases() -> None:
    """A cos(x) - B sin(x) lead by the phase."""
    s = given([3.0, 4.0, 0.0, -2.0, 1.0, 0.0], 0.1, wave(waved(1), waved(2), waved(3), labels=2))
    found = parameters_of(s, 0)
    phases = ["amplitude", "phase", "second", "second_phase", "second_3", "phase_3"]
    assert list(found) == phases
    values = [5.0, np.arctan2(-4.0, 3.0), 2.0, np.pi / 2, 1.0, 0.0]
    assert [found[name].value for name in phases] == pytest.approx(values)
    assert [found[name].unit for name in phases] == ["N m", "rad"] * 3
    for name, size in (("amplitude", 5.0), ("second", 2.0), ("second_3", 1.0)):
        assert (found[name].low, found[name].high) == pytest.approx(ends(size, 0.1))
    for name, size in (("phase", 5.0), ("second_phase", 2.0)):
        phase = found[name]
        assert (phase.low, phase.high) == pytest.approx(ends(phase.value, 0.1 / size))


def test_a_phase_of_hardly_any_line_may_be_any() -> None:
    for size in (0.0, 1e-3):
        phase = parameters_of(given([size, 0.0], 0.1, wave(waved(1))), 0)["phase"]
        assert phase.half == pytest.approx(REACH * 2.0)  # rad, more than half a turn either way
    small = parameters_of(given([0.5, 0.0], 0.1, wave(waved(1))), 0)["phase"]
    assert small.half == pytest.approx(REACH * 0.2)


def test_errors_of_a_pair_that_differ_are_its_mean_in_the_phase() -> None:
    phase = parameters_of(given([4.0, 0.0], [0.1, 0.7], wave(waved(1))), 0)["phase"]
    assert phase.half == pytest.approx(REACH * 0.5 / 4.0)  # of 0.01 and 0.49 the mean is 0.25


def test_six_harmonics_are_the_most_of_a_line() -> None:
    s = given([1.0, 0.0] * 8, 0.1, wave(*(waved(h) for h in range(1, 9))))
    assert len(parameters_of(s, 0)) == 2 * 6


FIRST = np.arange(ROWS) < ROWS // 2


def sections(*betas: float, errors: float = 0.1, labels: int = 1) -> dict[str, Parameter]:
    """Two harmonics on the first half of the rows, as many as are left on the second."""
    pairs = [waved(1, rows=FIRST), waved(2, rows=FIRST), waved(1, rows=~FIRST), waved(2, rows=~FIRST)]
    s = given(betas, errors, wave(*pairs[: len(betas) // 2], labels=labels))
    s.problem.held = T < -1.0
    return parameters_of(s, 0)


def test_sections_have_one_amplitude_and_no_phase() -> None:
    found = sections(3.0, 4.0, 0.0, 2.0, 0.0, 7.0, 2.0, 0.0)
    assert list(found) == ["amplitude", "amplitude_2"]
    assert found["amplitude"].value == 6.0 and found["amplitude_2"].value == 2.0
    assert found["amplitude_2"].unit == "N m"
    blocks = 2400 // 20
    reach = stats.t.ppf(0.975, blocks - 2)
    halves = [reach * np.hypot(0.1, MODEL * size) for size in (5.0, 7.0)]
    assert found["amplitude"].half == pytest.approx(np.hypot(*halves) / 2)
    assert found["amplitude"].low == pytest.approx(6.0 - np.hypot(*halves) / 2)
    two_names = sections(3.0, 4.0, 0.0, 2.0, 0.0, 7.0, 2.0, 0.0, labels=2)
    assert list(two_names) == ["amplitude", "second"]


def test_a_harmonic_of_one_section_keeps_its_phase() -> None:
    found = sections(3.0, 4.0, 0.0, 2.0, 0.0, 7.0)
    assert list(found) == ["amplitude", "amplitude_2", "phase_2"]
    assert found["amplitude_2"].value == 2.0 and found["phase_2"].value == pytest.approx(-np.pi / 2)


@pytest.mark.parametrize(("size", "mean"), [(1.1, 3.05), (1.0, 5.0), (0.9, 5.0)])
def test_a_section_that_hardly_shows_the_line_does_not_count(size: float, mean: float) -> None:
    """A fifth of the largest is hardly shown."""
    found = sections(5.0, 0.0, 1.0, 0.0, 0.0, size, 1.0, 0.0)
    assert found["amplitude"].value == pytest.approx(mean)
    blocks = 2400 // 20
    alone = stats.t.ppf(0.975, blocks - 2) * np.hypot(0.1, MODEL * 5.0)
    assert mean < 5.0 or found["amplitude"].half == pytest.approx(alone)


def test_an_amplitude_of_sections_is_none_below_zero_and_nothing_where_none_shows_it() -> None:
    loud = sections(5.0, 0.0, 1.0, 0.0, 0.0, 5.0, 1.0, 0.0, errors=9.0)["amplitude"]
    assert loud.low == 0.0 and loud.half > 5.0
    nothing = sections(0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0)["amplitude"]
    assert (nothing.value, nothing.low, nothing.high) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("scale", [1.0, 1e-3, 1e3])
def test_an_amplitudes_error_lies_along_its_own_direction(scale: float) -> None:
    cov = scale**2 * np.diag([0.04, 9.0])
    size, low, high = amplitude_interval(scale * np.array([5.0, 0.0]), cov, BLOCKS)
    assert (size, low, high) == pytest.approx((5.0 * scale, *(scale * x for x in ends(5.0, 0.2))))
    small = amplitude_interval(scale * np.array([0.5, 0.0]), scale**2 * np.eye(2), BLOCKS)
    assert small[1] == 0.0
    # not below what a line of Rice's law, whose amplitude is shown by luck, may be
    upper = np.sqrt(stats.ncx2.ppf(0.95, 2, 0.25))
    assert small[2] == pytest.approx(scale * max(upper, ends(0.5, 1.0)[1]))
    none = amplitude_interval(np.zeros(2), scale**2 * np.eye(2), BLOCKS)
    assert none[:2] == (0.0, 0.0)


def test_of_few_blocks_a_small_line_may_be_as_large_as_rices_law_has_it() -> None:
    """The normal reach of 0.5 in errors of one is 2.5 with many blocks, Rice's 95 % quantile 2.6."""
    many = amplitude_interval(np.array([0.5, 0.0]), np.eye(2), 100000)
    assert many[2] == pytest.approx(max(np.sqrt(stats.ncx2.ppf(0.95, 2, 0.25)), 0.5 + 1.96), abs=1e-3)
    assert np.sqrt(stats.ncx2.ppf(0.95, 2, 0.25)) > 0.5 + 1.96


def stepped(start: float, duration: float | None = None, free: int = 2) -> Candidate:
    """A step or ramp; all but the first `free` parameters are of a grid."""
    at = {"start": (start, "s"), **({} if duration is None else {"duration": (duration, "s")})}

    def shape(p: np.ndarray) -> np.ndarray:
        length = float(p[1]) if len(p) > 1 else (duration or 0.0)
        return np.asarray(np.clip((T - p[0]) / max(length, 1.0), 0.0, 1.0))[:, None]

    steps = (2.0, 4.0)[: min(len(at), free)]
    columns = shape(np.array([x for x, _ in at.values()]))
    return term("brake_drag", columns, fixed=at, steps=steps, shape=shape)


def test_an_onset_has_the_interval_of_its_slope_and_of_the_grid() -> None:
    """A step of size s over one second errs by noise of the level over its slope at least."""
    s = of(2.0 * stepped(40.0, 8.0).columns[:, 0], stepped(40.0, 8.0))
    found = parameters_of(s, 0)
    assert list(found) == ["size_0", "start", "duration"]
    start, duration = found["start"], found["duration"]
    assert (start.value, start.unit, duration.value) == (40.0, "s", 8.0)
    fit = s.problem.fit(np.hstack([s.columns, *(_slope(s, at) for at in ((1.0, 0.0), (0.0, 1.0)))]))
    for one, error, step in ((start, fit.errors[-2], 2.0), (duration, fit.errors[-1], 4.0)):
        assert one.half == pytest.approx(REACH * np.hypot(error, 0.15 * step), rel=0.02)


def _slope(s: Selection, way: tuple[float, float]) -> np.ndarray:
    c, h = s.candidates[0], 0.5 * np.array(way)
    assert c.shape is not None
    return np.asarray((c.shape(c.point + h) - c.shape(c.point - h)) @ s.sizes(0))[:, None]


def test_a_parameter_of_a_grid_beside_a_refined_one_has_no_interval() -> None:
    c = stepped(40.0, 8.0, free=1)
    found = parameters_of(of(2.0 * c.columns[:, 0], c), 0)
    assert found["start"].low is not None and found["duration"] == Parameter(8.0, "s")


@pytest.mark.parametrize(("duration", "told"), [(-3.0, 0.0), (0.0, 0.0), (0.5, 0.5)])
def test_a_length_below_nothing_is_a_step(duration: float, told: float) -> None:
    c = stepped(40.0, duration)
    one = parameters_of(of(2.0 * c.columns[:, 0], c), 0)["duration"]
    assert (one.value, one.unit) == (told, "s")
    assert (one.low is None) is (duration < 0.0)


@pytest.mark.parametrize("ramp", [True, False])
def test_an_onset_that_no_fitted_row_saw_lies_anywhere_in_the_gap(ramp: bool) -> None:
    """The last of four runs is held out; no row was logged from 30 to 60 s."""
    c = stepped(45.0, 0.0 if ramp else None)
    p = problem(2.0 * c.columns[:, 0] + 0.3 * LUCK)
    p.valid = (T < 30.0) | (T > 60.0)
    s = Selection.of(p, [x for x in [fit_with(p, p.base, c)] if x is not None])
    found = parameters_of(s, 0)
    start = found["start"]
    assert start.value == 45.0 and start.unit == "s"
    assert start.low == pytest.approx(29.0, abs=1.3) and start.high == pytest.approx(60.0, abs=1.3)
    assert ("duration" in found) is ramp and (not ramp or found["duration"] == Parameter(0.0, "s"))


def test_a_finding_has_what_was_refined_and_every_name_that_ties() -> None:
    c = term(
        "command_disturbance",
        A[:, None],
        order=3.0,
        frequency=2.0,
        stage="motor",
        harmonic=2,
        twins=("cable_wrap", "command_disturbance", "cable_wrap"),
    )
    f = finding_of(of(2 * A, c), 0)
    assert (f.name, f.channel, f.domain, f.stage, f.harmonic) == (
        "command_disturbance",
        "T",
        "time",
        "motor",
        2,
    )
    assert (f.order, f.frequency, f.note) == (3.0, 2.0, "") and list(f.equivalent) == ["cable_wrap"]
    moved = replace(c, fixed={"order": (3.1, "1"), "frequency": (2.1, "Hz")})
    f = finding_of(of(2 * A, moved), 0)
    assert (f.order, f.frequency) == (3.1, 2.1)


def test_the_same_name_elsewhere_and_another_one_that_tie_are_told() -> None:
    first, second, third = (term("adc_gain", A[:, None], fixed={"motor": (k, "1")}) for k in (1.0, 2.0, 3.0))
    other = term("cable_wrap", A[:, None])
    s = of(2 * A, first)
    beside = [x for c in (second, third, other) if (x := fit_with(s.problem, s.problem.base, c)) is not None]
    s = s.keep([replace(s.chosen[0], confounded=beside)])
    f = finding_of(s, 0)
    assert list(f.equivalent) == ["adc_gain", "cable_wrap"]
    size = f"{beside[0].fit.beta[1]:.3g}"
    told = [f"fits exactly as well: size_0 {size}, motor {k}" for k in (2, 3)]
    assert f.note == "; ".join(told)


def told(beta: Sequence[float], errors: Sequence[float] | float = 0.01, **more: Any) -> list[Finding]:
    own = {"stage": "screw", **more}
    columns = [waved(h) for h in range(1, len(beta) // 2 + 1)]
    return findings_of(given(beta, errors, wave(*columns, **own)), 0)


def test_a_whole_stage_is_told_harmonic_by_harmonic_strongest_first() -> None:
    found = told([3.0, 4.0, 0.0, -9.0, 1.0, 0.0])
    assert [(f.harmonic, f.order) for f in found] == [(2, 4.0), (1, 2.0), (3, 6.0)]
    assert [f.parameters["amplitude"].value for f in found] == pytest.approx([9.0, 5.0, 1.0])
    assert [f.parameters["phase"].value for f in found] == pytest.approx([np.pi / 2, np.arctan2(-4, 3), 0.0])
    assert all(list(f.parameters) == ["amplitude", "phase"] for f in found)
    first = found[1].parameters["phase"]
    assert first.half == pytest.approx(REACH * 0.01 / 5.0)  # the model errs in size, not in phase
    assert [f.order for f in told([1.0, 0.0, 1.0, 0.0], order=None)] == [None, None]


def test_one_harmonic_a_line_of_no_stage_and_a_nameless_one_are_one_finding() -> None:
    pair = [3.0, 0.0, 2.0, 0.0]
    assert len(told(pair)) == 2
    assert [f.harmonic for f in told(pair, harmonic=3)] == [3]
    assert len(told(pair, stage=None)) == len(told(pair[:2])) == 1
    assert (
        len(
            findings_of(
                given(pair, 0.1, term("gear_mesh", np.hstack([waved(1), waved(2)]), stage="screw")), 0
            )
        )
        == 1
    )
    (nameless,) = told(pair, name=UNKNOWN)
    assert nameless.order is None and "amplitude_2" in nameless.parameters
    (simple,) = told(pair[:2], name=UNKNOWN)
    assert simple.order == 2.0


def test_of_many_harmonics_only_clear_ones_are_told_and_of_few_those_that_show() -> None:
    """Three errors of an amplitude that is told among many; among few its interval must not hold zero."""
    errors = [0.1] * 14
    many = [9.0, 0.0, 0.25, 0.0, 0.35, 0.0, 0.3001, 0.0, 9.0, 0.0, 9.0, 0.0, 9.0, 0.0]
    assert sorted(f.harmonic or 0 for f in told(many, errors)) == [1, 3, 4, 5, 6, 7]
    few = many[:12]
    assert sorted(f.harmonic or 0 for f in told(few, errors[:12])) == [1, 2, 3, 4, 5, 6]
    assert [f.harmonic for f in told([9.0, 0.0, 0.15, 0.0], 0.1)] == [1]


@pytest.mark.parametrize(("size", "shown"), [(0.033, True), (0.027, False)])
def test_a_thousandth_of_the_strongest_ones_square_is_a_trifle(size: float, shown: bool) -> None:
    """The upper end of its interval counts, here a sixteenth beyond it."""
    found = told([0.0, 1.0, size, 0.0], 1e-6)
    assert len(found) == (2 if shown else 1)


def test_where_no_harmonic_shows_the_strongest_is_told() -> None:
    assert [f.harmonic for f in told([0.1, 0.0, 0.2, 0.0], 1.0)] == [2]
    (whole,) = told([0.1, 0.0] * 7, 1.0)
    assert whole.harmonic is None


def test_of_several_runs_a_harmonic_is_told_as_the_run_that_shows_it_best() -> None:
    pairs = [waved(1, rows=FIRST), waved(2, rows=FIRST), waved(1, rows=~FIRST), waved(2, rows=~FIRST)]
    c = wave(*pairs, stage="screw", per_run=True)
    found = findings_of(given([3.0, 0.0, 1.0, 0.0, 0.0, 5.0, 0.0, 0.5], 0.01, c), 0)
    assert [f.parameters["amplitude"].value for f in found] == pytest.approx([5.0, 1.0])
    assert [f.parameters["phase"].value for f in found] == pytest.approx([-np.pi / 2, 0.0])


@pytest.mark.parametrize(("part", "shown"), [(1.0, True), (0.55, True), (0.45, False), (-1.0, False)])
def test_a_harmonic_is_told_where_held_out_rows_are_better_off_with_it(part: float, shown: bool) -> None:
    """With half of its size there they are as well off without it."""
    own = given([3.0, 0.0, 1.0, 0.0], 0.01, wave(waved(1), waved(2), stage="screw"))
    p = own.problem
    p.y = np.where(p.held, p.y + (part - 1.0) * waved(2)[:, 0], p.y)
    assert [f.harmonic for f in findings_of(own, 0)] == ([1, 2] if shown else [1])
    p.held = T < -1.0
    assert [f.harmonic for f in findings_of(own, 0)] == [1, 2]  # none is held out


def test_a_candidates_note_is_told() -> None:
    assert finding_of(of(2 * A, term("brake_drag", A[:, None], note="as said")), 0).note == "as said"
