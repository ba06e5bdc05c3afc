"""Numbers of a drive that are beyond their tolerance, on fits that are made up."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from scipy import stats

from calibration.balances.friction import Sliding
from calibration.balances.problem import Estimate, Problem
from calibration.balances.torque import Torque
from calibration.decide.selection import Selection
from calibration.decide.thresholds import FEWEST_BLOCKS, FEWEST_VALIDATED
from calibration.decide.tolerance import (
    beyond,
    calibrated_numbers,
    changes,
    fitted_numbers,
    held_numbers,
    nearest,
    seen_speeds,
    telling,
    train_stiffness,
    unsettled_reading,
)
from calibration.finding import Finding, Parameter
from calibration.inputs.declaration import FrictionLaw
from calibration.inputs.declaredplant import Declared
from tests.calibration.decide.made import problem

DRIVE = Declared(
    coulomb=4.0,
    stiction=6.0,
    stribeck_rate=2.0,
    viscous=3.0,
    bristle_stiffness=40.0,
    stribeck_exponent=1.0,
    stiffness=100.0,
    torque_constant=1.0,
    resistance=1.0,
)
LAW = FrictionLaw(stiction_ratio=1.5, stribeck_speed=2.0, bristle_travel=0.1)
TERMS = ["log_sigma_0", "viscous", "offset", "coulomb", "log_stiction", "inertia", "log_stribeck_speed"]
NUMBERS = ["inertia", "viscous", "coulomb", "stiction", "stribeck_speed", "sigma_0"]
MOVED = {"moved", "sliding", "spread", "dip"}


@pytest.mark.parametrize(
    ("value", "error", "factor", "gone"),
    [
        (2.0, 0.01, 1.29, True),
        (0.5, 0.01, 1.29, True),
        (1.28, 1e-3, 1.29, False),
        (1 / 1.28, 1e-3, 1.29, False),
        (1 / 1.3, 1e-3, 1.29, True),
        (2.0, 1e-3, 2.0, False),  # at its tolerance it is within it
        (2.0, 0.199, 1.29, True),
        (2.0, 0.2, 1.29, False),  # five standard errors are no more than that
        (0.0, 0.01, 1.29, False),
        (-2.0, 0.01, 1.29, False),
        (2.0, 0.0, 1.29, False),
    ],
)
def test_a_number_is_beyond_where_it_surely_leaves_its_factor_either_way(
    value: float, error: float, factor: float, gone: bool
) -> None:
    for unit in (1.0, 2.0, 16.0):
        assert bool(beyond(Estimate(unit * value, unit * error), unit, factor)) is gone


def speeds(**counts: int) -> np.ndarray:
    """Rows at a speed each, either way in turn; the Stribeck speed of DRIVE is 2 rad/s, its exponent one."""
    one = np.concatenate(
        [np.full(n, float(w.removeprefix("w").replace("_", "."))) for w, n in counts.items()]
    )
    return one * np.where(np.arange(len(one)) % 2, 1.0, -1.0)


@pytest.mark.parametrize(
    ("rows", "seen"),
    [
        ({"w1": 0}, set()),
        ({"w1": 100}, {"moved"}),
        ({"w12_5": 100}, {"moved"}),  # just where the dip is over
        ({"w12_6": 100}, {"moved", "sliding"}),
        ({"w4": 98, "w20": 2}, {"moved"}),
        ({"w4": 97, "w20": 3}, {"moved", "sliding"}),
        ({"w20": 50, "w58": 50}, {"moved", "sliding"}),
        ({"w20": 50, "w60": 50}, {"moved", "sliding"}),
        ({"w20": 50, "w62": 50}, {"moved", "sliding", "spread"}),
        ({"w4": 50, "w20": 25, "w62": 25}, {"moved", "sliding", "spread"}),
        ({"w20": 96, "w62": 4}, {"moved", "sliding"}),
        ({"w20": 996, "w1": 4}, {"moved", "sliding"}),
        ({"w20": 995, "w1": 5}, {"moved", "sliding", "dip"}),
        ({"w20": 90, "w1_28": 10}, {"moved", "sliding"}),  # just its ends
        ({"w20": 90, "w0_005": 10}, {"moved", "sliding"}),
        ({"w20": 90, "w1_27": 10}, {"moved", "sliding", "dip"}),
        ({"w20": 90, "w0_0051": 10}, {"moved", "sliding", "dip"}),
        ({"w20": 90, "w1_5": 10}, {"moved", "sliding"}),
        ({"w20": 90, "w0_001": 10}, {"moved", "sliding"}),
    ],
)
def test_speeds_tell_of_friction_beyond_the_dip_and_on_it(rows: dict[str, int], seen: set[str]) -> None:
    assert seen_speeds(speeds(**rows), DRIVE) == seen


def torque(beta: dict[str, float], errors: dict[str, float], rows: int = 1200) -> tuple[Torque, Any]:
    x = np.random.default_rng(51).standard_normal((rows, len(TERMS)))
    p = problem(x[:, 2], x)
    p.base_labels = [(name, "") for name in TERMS]
    variances = np.diag([errors.get(name, 0.0) ** 2 for name in TERMS])
    fit = replace(p.fit(), beta=np.array([beta.get(name, 0.0) for name in TERMS]), covariance=variances)
    made = SimpleNamespace(problem=p, friction=SimpleNamespace(law=LAW))
    return cast(Torque, cast(Any, made)), fit


def test_fitted_numbers_are_the_terms_and_the_corrected_law() -> None:
    """Stiction and the bristles' stiffness are of Coulomb's torque, the Stribeck speed is not."""
    beta = {"inertia": 7.0, "viscous": 3.0, "coulomb": 0.5, "log_stiction": 0.2, "log_sigma_0": -0.3}
    errors = {"coulomb": 0.1, "log_stiction": 0.15, "log_stribeck_speed": 0.07, "inertia": 0.3}
    found = fitted_numbers(*torque(beta, errors))
    assert list(found) == NUMBERS
    assert found["inertia"] == Estimate(7.0, pytest.approx(0.3))  # type: ignore[arg-type]
    assert found["viscous"].value == 3.0 and found["coulomb"].value == 0.5
    assert found["stiction"].value == pytest.approx(1.5 * np.exp(0.2) * 0.5)
    assert found["stiction"].error == pytest.approx(found["stiction"].value * 0.25)
    assert found["stribeck_speed"].value == pytest.approx(2.0)
    assert found["stribeck_speed"].error == pytest.approx(2.0 * 0.07)
    assert found["sigma_0"].value == pytest.approx(10.0 * np.exp(-0.3) * 0.5)
    assert found["sigma_0"].error == pytest.approx(found["sigma_0"].value * 0.2)


@pytest.mark.parametrize("way", [-1.0, 1.0])
def test_a_correction_that_runs_away_is_bounded(way: float) -> None:
    made = torque({"coulomb": 1.0, "log_stribeck_speed": 9.0 * way}, {})
    assert fitted_numbers(*made)["stribeck_speed"].value == pytest.approx(2.0 * np.exp(3.0 * way))
    assert fitted_numbers(*made, 0.1)["stribeck_speed"].value == pytest.approx(2.0 * np.exp(0.1 * way))


def test_without_coulombs_friction_no_number_of_it_is_known() -> None:
    found = fitted_numbers(*torque({}, {"coulomb": 1.0}))
    assert found["stiction"].value == 0.0 and np.isfinite(found["stiction"].error)


def test_calibrated_numbers_have_students_interval_of_noise_model_and_scale() -> None:
    """A rigid model errs by 0.6 % of the inertia, by 0.15 % of the other numbers."""
    beta = {"inertia": 7.0, "viscous": 3.0, "coulomb": 0.5}
    made, fit = torque(beta, {"inertia": 0.01, "viscous": 0.01})
    blocks = np.where(np.array(TERMS) == "viscous", 7.0, 20.0)  # that carry it
    numbers, spans = calibrated_numbers(made, fit, made.problem.base, 0.002, blocks)
    assert list(numbers) == list(spans) == NUMBERS and numbers == fitted_numbers(made, fit)
    for name, value, model, freedom in (("inertia", 7.0, 0.006, 18), ("viscous", 3.0, 0.0015, 5)):
        reach = stats.t.ppf(0.975, freedom)
        error = np.hypot(0.01, np.hypot(model, 0.002) * value)
        span = spans[name]
        assert (span.low, span.high) == pytest.approx((value - reach * error, value + reach * error))
    units = ["kg m2", "N m s/rad", "N m", "N m", "rad/s", "N m/rad"]
    assert [span.unit for span in spans.values()] == units


@pytest.mark.parametrize(("common", "apart"), [(0.985, True), (0.997, False)])
def test_numbers_that_the_motion_does_not_hold_apart_are_not_told(common: float, apart: bool) -> None:
    """A variance grows by 1 / (1 - R^2): to a hundred times at an R^2 of 0.99."""
    made, fit = torque({"coulomb": 1.0}, {})
    used = np.linalg.qr(made.problem.base)[0]
    at = TERMS.index("log_stiction")
    used[:, at] = np.sqrt(common) * used[:, TERMS.index("viscous")] + np.sqrt(1 - common) * used[:, at]
    used[:, TERMS.index("offset")] = used[:, TERMS.index("inertia")]  # of no number
    numbers, spans = calibrated_numbers(made, fit, used, 0.0, np.full(len(TERMS), 9.0))
    assert list(numbers) == list(spans)
    assert list(numbers) == [n for n in NUMBERS if apart or n not in ("viscous", "stiction")]


def changed(seen: set[str] = MOVED, drive: Declared = DRIVE, **sizes: Any) -> list[Finding]:
    numbers = {n: Estimate(*x) for n, x in sizes.items()}
    spans = {
        n: Parameter(x.value, "SI", x.value - 2 * x.error, x.value + 2 * x.error) for n, x in numbers.items()
    }
    return changes(numbers, spans, drive, seen)


def test_a_number_beyond_its_tolerance_is_told_as_a_quotient_with_the_declared_one() -> None:
    (found,) = changed(coulomb=(6.0, 0.1), viscous=(3.0, 0.01))
    assert (found.name, found.channel, found.domain) == ("coulomb_change", "T", "velocity")
    assert found.parameters == {"factor": Parameter(1.5, "1", 1.45, 1.55)}
    assert found.evidence == pytest.approx(20.0**2 / 2 / np.log(10))  # a normal law's, of twenty errors
    (less,) = changed(coulomb=(2.0, 0.1))
    assert less.parameters["factor"].value == 0.5 and less.evidence == found.evidence
    (sure,) = changed(coulomb=(6.0, 1e-6))
    assert sure.evidence == 1e4


def test_a_stiffness_is_told_by_itself_against_the_nearest_reading() -> None:
    (found,) = changed(stiffness=(150.0, 1.0))
    assert (found.name, found.channel) == ("shaft_compliance", "K")
    assert found.parameters == {"stiffness": Parameter(150.0, "SI", 148.0, 152.0)}
    assert found.evidence == pytest.approx(50.0**2 / 2 / np.log(10))
    both = replace(DRIVE, readings=(1.0, 0.5))
    assert changed(drive=both, stiffness=(55.0, 1.0)) == []
    assert changed(drive=both, stiffness=(75.0, 1.0))[0].evidence == pytest.approx(25**2 / 2 / np.log(10))


@pytest.mark.parametrize(("missing", "name"), [("sliding", "coulomb"), ("spread", "viscous")])
def test_a_friction_is_told_only_where_the_speeds_show_it(missing: str, name: str) -> None:
    size: Any = {name: (9.0, 0.1)}
    assert len(changed(**size)) == 1 and changed(MOVED - {missing}, **size) == []


def test_the_dip_needs_both_its_numbers_precisely_and_one_of_them_changed() -> None:
    assert [f.name for f in changed(stiction=(9.0, 0.1), stribeck_speed=(2.0, 0.1))] == ["stribeck_change"]
    (found,) = changed(stiction=(6.0, 0.1), stribeck_speed=(4.0, 0.1))
    assert {k: p.value for k, p in found.parameters.items()} == {
        "stiction_factor": 1.0,
        "velocity_factor": 2.0,
    }
    assert found.evidence == 0.0  # stiction's, which is as declared
    assert changed(stiction=(9.0, 0.1)) == []
    assert changed(stiction=(6.0, 0.1), stribeck_speed=(2.0, 0.1)) == []
    assert changed(MOVED - {"dip"}, stiction=(9.0, 0.1), stribeck_speed=(2.0, 0.1)) == []
    # a tenth of the stiction, three twentieths of the speed
    assert changed(stiction=(16.0, 1.6), stribeck_speed=(2.0, 0.1)) == []
    assert changed(stiction=(16.0, 1.5), stribeck_speed=(2.0, 0.1))
    assert changed(stiction=(16.0, 1.5), stribeck_speed=(2.0, 0.31)) == []


def test_of_several_readings_the_nearest_is_the_declared_one_by_its_logarithm() -> None:
    many = replace(DRIVE, readings=(1.0, 0.25))
    assert nearest(many, "stiffness", 51.0) == 100.0
    assert nearest(many, "stiffness", 49.0) == 25.0
    assert nearest(many, "stiffness", 0.5) == nearest(many, "stiffness", -1.0) == 25.0
    assert nearest(many, "coulomb", 51.0) == 4.0
    small = replace(DRIVE, stiffness=1e-3, readings=(1.0, 0.1))
    assert nearest(small, "stiffness", 1.5e-4) == pytest.approx(1e-4)


def held(*names: str, **beta: float) -> dict[str, float]:
    made, fit = torque(beta, {})
    sliding = cast(Sliding, cast(Any, SimpleNamespace(law=LAW, coulomb=2.0)))
    fixed = held_numbers(names, made.problem, fit.beta, DRIVE, sliding)
    return {TERMS[k]: value for k, value in fixed.items()}


def test_numbers_of_the_names_are_held_at_the_nearest_end_of_their_tolerance() -> None:
    assert held("coulomb_change", coulomb=9.0) == {"coulomb": pytest.approx(4.0 * 1.29)}
    assert held("coulomb_change", coulomb=1.0) == {"coulomb": pytest.approx(4.0 / 1.29)}
    assert held("coulomb_change", coulomb=4.5) == {"coulomb": 4.5}
    both = held("coulomb_change", "viscous_change", "brake_drag", viscous=3.1, coulomb=4.1)
    assert both == {"coulomb": 4.1, "viscous": 3.1}
    assert held("shaft_compliance", "brake_drag") == {}  # no number of the torque


def test_a_correction_is_held_where_the_law_times_it_is_within_tolerance() -> None:
    """The law begins with a stiction of three, of 1.5 times 2 N m, and at the declared Stribeck speed."""
    found = held("stribeck_change")
    assert found["log_stiction"] == pytest.approx(np.log(6.0 / 1.29 / 3.0))
    assert found["log_stribeck_speed"] == 0.0 and len(found) == 2
    # bristles: 10 per Coulomb's torque begin with 20, where 40 / 2.2 to 40 * 2.2 is as declared
    assert held("presliding") == {"log_sigma_0": 0.0}


ROWS = 2400
RNG = np.random.default_rng(52)
FRICTION, MORE, LUCK = RNG.standard_normal((3, ROWS))
for part in (problem(LUCK).held, ~problem(LUCK).held):  # of the noise nothing is friction
    LUCK[part] -= FRICTION[part] * (LUCK[part] @ FRICTION[part]) / (FRICTION[part] @ FRICTION[part])
DRAG = Finding("coulomb_change", "T", "velocity")


def told(fitted: float, held_out: float, rows: int = 600, scale: float = 1.0, effect: bool = False) -> bool:
    """Coulomb's friction of 4 is found as 8; without noise holding it at 5.16 leaves 2.84 of it.

    fitted, held_out: the mean square that this adds to a noise of one.
    """
    out = problem(LUCK).held
    x = FRICTION * np.sqrt(np.where(out, held_out, fitted)) / (8.0 - 4.0 * 1.29)
    y = scale * (8.0 * x + LUCK + (5.0 * MORE if effect else 0.0))
    p = problem(y, scale * x[:, None])
    p.valid = ~out | (np.cumsum(out) <= rows)
    p.base_labels = [("coulomb", "N m")]
    sliding = cast(Sliding, cast(Any, SimpleNamespace(law=LAW, coulomb=2.0)))
    columns = np.column_stack([p.base, MORE]) if effect else p.base
    assert p.test.sum() == rows
    return telling([DRAG], p, columns, DRIVE, sliding) == [DRAG]


def test_a_change_is_told_where_a_number_within_tolerance_fits_clearly_worse() -> None:
    assert told(1.0, 1.0) and told(0.1, 0.1) and not told(0.02, 0.02)
    assert told(0.1, 0.1, scale=1e3) and not told(0.02, 0.02, scale=1e3)
    assert told(0.1, 0.1, effect=True) and not told(0.02, 0.02, effect=True)
    assert not told(0.02, 1.0)


def turned(size: float, rows: int) -> bool:
    """Of held-out rows whose friction is as declared, the number that was fitted is the worse one."""
    out = problem(LUCK).held
    y = np.where(out, size, 8.0) * FRICTION + LUCK
    p = problem(y, FRICTION[:, None])
    p.valid = ~out | (np.cumsum(out) <= rows)
    p.base_labels = [("coulomb", "N m")]
    sliding = cast(Sliding, cast(Any, SimpleNamespace(law=LAW, coulomb=2.0)))
    return telling([DRAG], p, p.base, DRIVE, sliding) == [DRAG]


@pytest.mark.parametrize(("size", "as_well"), [(4.0, False), (6.55, False), (6.58, True), (8.0, True)])
def test_held_out_rows_must_not_have_the_declared_number_rather(size: float, as_well: bool) -> None:
    """Halfway, at 6.58, both leave as much."""
    assert turned(size, 600) is as_well


def test_few_held_out_rows_refuse_nothing() -> None:
    assert turned(4.0, FEWEST_VALIDATED - 1) and not turned(4.0, FEWEST_VALIDATED)


def wound_up(compliance: float, blocks: int = 90, error: float = 1e-3) -> tuple[dict[str, Any], ...]:
    p: Problem = problem(LUCK, np.column_stack([MORE, FRICTION]), held=99)
    p.base_labels = [("offset", ""), ("compliance", "rad/(N m)")]
    p.valid = np.arange(ROWS) < blocks * p.block
    s = Selection.of(p)
    s.after = replace(s.after, beta=np.array([9.0, compliance]), covariance=np.diag([9.0, error**2]))
    return train_stiffness(s, 0.002)


def test_a_trains_stiffness_is_one_over_its_compliance() -> None:
    numbers, spans = wound_up(0.02)
    one = numbers["stiffness"]
    assert list(numbers) == list(spans) == ["stiffness"]
    assert one.value == pytest.approx(50.0) and one.error / one.value == pytest.approx(1e-3 / 0.02)
    reach = stats.t.ppf(0.975, 88) * np.hypot(2.5, 50 * np.hypot(0.0015, 0.002))
    assert (spans["stiffness"].low, spans["stiffness"].high) == pytest.approx((50 - reach, 50 + reach))
    assert spans["stiffness"].unit == "N m/rad"


@pytest.mark.parametrize(("compliance", "blocks", "known"), [
    (0.02, FEWEST_BLOCKS, True), (0.02, FEWEST_BLOCKS - 1, False), (-0.02, 90, False), (0.0, 90, False),
])  # fmt: skip
def test_no_wind_up_or_a_short_log_tells_no_stiffness(compliance: float, blocks: int, known: bool) -> None:
    assert wound_up(compliance, blocks) != ({}, {}) or not known
    assert wound_up(compliance, blocks) == ({}, {}) or known


@pytest.mark.parametrize(
    ("value", "readings", "unsettled"),
    [
        (50.0, (1.0, 0.5), True),
        (40.0, (1.0, 0.5), True),
        (38.0, (1.0, 0.5), False),
        (50.0, (0.5, 1.0), False),
        (95.0, (1.0, 0.5), False),
        (50.0, (1.0, 0.6, 0.5), True),
        (90.0, (1.0, 0.9), False),
    ],
)
def test_a_stiffness_of_another_reading_than_the_first_is_unsettled(
    value: float, readings: tuple[float, ...], unsettled: bool
) -> None:
    said = unsettled_reading(Parameter(value, "N m/rad"), replace(DRIVE, readings=readings))
    assert bool(said) is unsettled
    if unsettled:
        assert f"{value:.3g} N m/rad is {value / 100:.2f} of Table 1's" in said
    assert unsettled_reading(None, DRIVE) == ""
