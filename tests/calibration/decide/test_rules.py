"""Rules of the answer: intervals, probabilities, withdrawals, domains, verdicts."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from calibration.decide.controls import controls
from calibration.decide.parameters import amplitude_interval, interval
from calibration.decide.residual import domain_share
from calibration.decide.select import select
from calibration.decide.thresholds import MODEL_ERROR, STILL_MISSING, Earned
from calibration.decide.verdict import judge, kind_of, probability
from calibration.decide.withdraw import failed_controls, unnamed, withdraw
from calibration.finding import Finding, Parameter
from calibration.statistics.tails import middle
from tests.calibration.decide.made import problem, term


@settings(max_examples=60, deadline=None)
@given(value=st.floats(-100, 100), error=st.floats(0.0, 10.0), blocks=st.integers(10, 400))
def test_an_interval_is_students_with_the_models_own_error(value: float, error: float, blocks: int) -> None:
    low, high = interval(value, error, blocks)
    reach = stats.t.ppf(0.975, blocks - 2) * np.hypot(error, MODEL_ERROR * value)
    assert (low, high) == (pytest.approx(value - reach), pytest.approx(value + reach))
    plain = interval(value, error, blocks, model=0.0)
    assert plain[1] - plain[0] <= high - low + 1e-12


@settings(max_examples=60, deadline=None)
@given(a=st.floats(-5, 5), b=st.floats(-5, 5), sigma=st.floats(0.01, 3.0), blocks=st.integers(10, 200))
def test_an_amplitude_lies_in_its_interval_which_never_goes_below_zero(
    a: float, b: float, sigma: float, blocks: int
) -> None:
    size, low, high = amplitude_interval(np.array([a, b]), sigma**2 * np.eye(2), blocks)
    assert size == pytest.approx(np.hypot(a, b))
    assert 0.0 <= low <= size <= high


def test_the_interval_of_a_line_that_is_not_there_covers_small_amplitudes() -> None:
    """Of a true amplitude of 0.5 sigma the estimate is Rice's; the upper end must be beyond the truth."""
    rng = np.random.default_rng(1)
    truth = np.array([0.5, 0.0])
    hits = [amplitude_interval(truth + rng.standard_normal(2), np.eye(2), 100)[2] >= 0.5 for _ in range(300)]
    assert np.mean(hits) > 0.95


@settings(max_examples=40, deadline=None)
@given(right=st.integers(0, 200), wrong=st.integers(0, 200))
def test_a_probability_is_never_sure_and_follows_what_was_right(right: int, wrong: int) -> None:
    p = Earned(right, right + wrong).probability
    assert 0.0 < p < 1.0
    assert Earned(right + 1, right + wrong + 1).probability > p
    assert Earned(right, right + wrong + 1).probability < p


def row(after: float, floor: float | None) -> dict[str, dict[str, object]]:
    return {"torque": {"unit": "N m", "before": 9.0, "after": after, "floor": floor}}


@pytest.mark.parametrize(
    ("after", "floor", "equivalent", "place", "kind"),
    [
        (1.0, 1.0, [], 0, "sole"),
        (1.0, 1.0, [], 1, "further"),
        (1.0, 1.0, ["other"], 0, "ambiguous"),
        (1.0, 1.0, ["drag"], 0, "sole"),  # at another place: the name itself is sure
        (STILL_MISSING * 1.01, 1.0, ["other"], 0, "above"),
        (1.0, None, [], 0, None),
    ],
)
def test_the_kind_of_an_answer(
    after: float, floor: float | None, equivalent: list[str], place: int, kind: str | None
) -> None:
    f = Finding("drag", "T", "time", equivalent=equivalent)
    assert kind_of(f, place, row(after, floor)) == kind
    earned = {kind: Earned(3, 4)} if kind else {}
    assert probability(f, place, row(after, floor), earned) == (4 / 6 if kind else None)
    assert probability(f, place, row(after, floor), None) is None


def test_a_name_keeps_its_place_unless_its_own_control_was_accepted() -> None:
    gear = Finding("gear", "T", "axis_angle", stage="shaft1", harmonic=1)
    drag = Finding("drag", "T", "time")
    place = {"name": "gear", "stage": "shaft1", "harmonic": 1}
    accepted = [{"what": "time reversed (gear)", "accepted": True, **place}]
    kept, refused = withdraw([gear, drag], failed_controls(accepted))
    assert kept == [drag]
    assert refused[0][:2] == ("T", "gear on shaft1") and "time reversed" in refused[0][2]
    other = [
        {**accepted[0], "harmonic": 2},
        {**accepted[0], "what": "order 2 in place of 3 (brake)", "name": "brake"},
    ]
    assert withdraw([gear, drag], failed_controls(other)) == ([gear, drag], [])
    none = failed_controls([{**accepted[0], "accepted": False}])
    assert withdraw([gear, drag], none) == ([gear, drag], [])


def test_a_rigs_line_whose_order_may_be_another_is_unknown() -> None:
    line = Finding("gear", "T", "axis_angle", order=3.0, note="period 120 deg")
    place = {"name": "bearing", "stage": None, "harmonic": None}  # as it was called when the control was made
    wrong = [{"what": "order 3.2 in place of 3 (bearing)", "accepted": True, **place}]
    assert [f.name for f in unnamed([line], [{**wrong[0], "accepted": False}])] == ["gear"]
    (gone,) = unnamed([line], wrong)
    assert (gone.name, gone.stage) == ("unknown", None)
    assert gone.note == "order 3.2 in place of 3 fits as well: the name gear is withdrawn. period 120 deg"


def test_verdicts() -> None:
    drag, unknown = Finding("viscous_change", "T", "velocity"), Finding("unknown", "T", "time")
    both = Finding("viscous_change", "T", "velocity", equivalent=["coulomb_change"])
    assert judge([])[0] == "nothing"
    assert judge([], ["a longer log", "two speeds"]) == ("cannot tell", "a longer log; two speeds")
    assert judge([drag, unknown])[0] == "found"
    assert judge([unknown])[0] == "unknown"
    assert judge([both])[0] == "ambiguous"
    names = ["coulomb_change", "load_friction", "brake_drag"]
    many = Finding("viscous_change", "T", "velocity", equivalent=names)
    told = judge([many])[1] or ""
    assert [name for name in ("viscous_change", *names) if f"{name}: " in told] == [
        "viscous_change", "coulomb_change", "load_friction"
    ], "three experiments, no more"  # fmt: skip


@pytest.mark.parametrize("seed", range(4))
def test_a_domain_is_credited_with_what_it_explains_and_chance_with_nothing(seed: int) -> None:
    rng = np.random.default_rng(seed)
    x = rng.uniform(0, 1, 4000)
    e = np.sin(2 * np.pi * x) + rng.standard_normal(4000)
    train = np.arange(4000) < 2500
    # of sin^2's half beside the noise's one; a little is lost to the means' own noise and width
    assert domain_share(e, x, train, ~train) == pytest.approx(1 / 3, abs=0.06)
    assert domain_share(e, rng.permutation(x), train, ~train) < 0.02
    assert domain_share(e, np.zeros(4000), train, ~train) == 0.0
    few = np.arange(4000) < 50
    assert domain_share(e, x, few, ~few) == 0.0


def test_a_controls_wrong_sign_and_wrong_time_are_refused_for_a_true_effect() -> None:
    rng = np.random.default_rng(3)
    x = rng.standard_normal((2400, 1))
    s = select(problem(x[:, 0] + rng.standard_normal(2400)), [term("drag", x)], rng)
    rows = controls(s, lambda k, c: ())
    assert [r["what"] for r in rows] == ["time reversed (drag)", "sign flipped (drag)"]
    assert not any(r["accepted"] for r in rows)


def test_a_steady_column_reads_the_same_backwards_which_is_said_and_no_test() -> None:
    rng = np.random.default_rng(4)
    x = np.cos(np.linspace(-20, 20, 2400))[:, None]
    s = select(
        problem(2 * x[:, 0] + rng.standard_normal(2400), base=np.zeros((2400, 1))), [term("drag", x)], rng
    )
    assert len(s.chosen) == 1
    assert "reads the same backwards" in controls(s, lambda k, c: ())[0]["note"]


@settings(max_examples=40, deadline=None)
@given(x=st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=30), factor=st.floats(0.01, 100.0))
def test_the_middle_of_several_sizes_and_its_unit(x: list[float], factor: float) -> None:
    found = middle(np.array(x), "s")
    assert found.value == np.median(x)
    assert (found.low is None) == (len(x) == 1)
    other = found.times(factor)
    assert other.value == found.value * factor
    rounded = max(
        1e-12, 4 * float(np.spacing(abs(other.value)))
    )  # a half is a difference of two large numbers
    assert other.half == pytest.approx(found.half * factor, rel=1e-6, abs=rounded)
    assert Parameter(1.0, "s").half == 0.0
