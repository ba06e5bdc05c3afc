"""What is said of a balance, whatever drive it is of."""

from dataclasses import replace

import numpy as np
import pytest

from calibration.decide.accept import SHORT
from calibration.decide.residual import Left, Place
from calibration.decide.select import select
from calibration.decide.selection import Refusal, Selection
from calibration.finding import Finding, Parameter
from calibration.look.looked import Balance, Looked, calibrated, missing_over, unnamed_where_missing
from tests.calibration.decide import made

ROWS = 4000
TURNS = np.linspace(0.0, 37.0, ROWS) % 1.0


def selection(y: np.ndarray) -> Selection:
    """Of a constant and a term that the log has nothing of; nothing is offered."""
    base = np.column_stack([np.ones(ROWS), np.zeros(ROWS)])
    return select(made.problem(y, base), [], np.random.default_rng(0))


@pytest.fixture(scope="module")
def quiet() -> Selection:
    return selection(np.random.default_rng(1).standard_normal(ROWS))


@pytest.fixture(scope="module")
def turning() -> Selection:
    """Something once a turn, eight times the noise."""
    noise = np.random.default_rng(1).standard_normal(ROWS)
    return selection(noise + 8.0 * np.sign(TURNS - 0.3))


def balance(s: Selection, floor: float | None = 1.0, **more: object) -> Balance:
    return Balance(key="T", row="torque", selection=s, floor=floor, **more)  # type: ignore[arg-type]


def test_what_is_above_its_floor_lives_where_one_domain_shows_it(
    quiet: Selection, turning: Selection
) -> None:
    places = [Place("the turn of a wheel", "axis_angle", TURNS), Place("time", "time", turning.problem.t)]
    assert missing_over(balance(quiet), places) is None
    assert missing_over(balance(turning, floor=None), places) is None
    found = missing_over(balance(turning), places)
    assert found is not None and found.effect and found.domain == "axis_angle"
    assert found.times > 5.0 and found.where == "over the turn of a wheel"
    nowhere = missing_over(balance(turning), [])
    assert nowhere is not None and nowhere.domain is None and nowhere.where == "not looked for"


def missing(times: float, domain: str | None, effect: bool = True) -> Left:
    return Left(times, 0.5, domain, "somewhere", effect=effect)


def test_a_large_residual_without_a_name_is_unknown_or_a_need(quiet: Selection) -> None:
    somewhere = [replace(balance(quiet), missing=missing(9.0, "time"))]
    effects, needs = unnamed_where_missing([], [], somewhere)
    assert [(f.name, f.domain) for f in effects] == [("unknown", "time")] and len(needs) == 1
    assert unnamed_where_missing([], ["a longer log"], somewhere)[0] == []
    named = [Finding("brake_drag", "T", "time")]
    assert unnamed_where_missing(named, [], somewhere)[0] == named
    nowhere = [replace(balance(quiet), missing=missing(90.0, None))]  # of nothing that a log may hold
    effects, needs = unnamed_where_missing([], [], nowhere)
    assert effects == [] and needs[0].startswith("something is still missing in ")
    loud = [replace(balance(quiet), missing=replace(missing(9.0, "time"), noise=True))]
    effects, needs = unnamed_where_missing([], [], loud)
    assert effects == [] and len(needs) == 1  # neither an effect nor nothing
    small = [replace(balance(quiet), missing=missing(3.0, "time", effect=False))]
    assert unnamed_where_missing([], [], small) == ([], [])


def test_a_number_that_the_log_has_nothing_of_is_not_calibrated(quiet: Selection) -> None:
    assert list(calibrated(quiet)) == ["term_0"] and calibrated(quiet, ("term_0",)) == {}


def test_a_drive_says_what_its_balances_say(quiet: Selection) -> None:
    one = balance(quiet, numbers={"coulomb": Parameter(1.0, "N m")}, remarks=["the offset wanders"])
    two = replace(
        one, key="E", row="electrical", numbers={}, remarks=[], missing=missing(3.0, None, effect=False)
    )
    found = Looked(title="a drive", balances=[one, two], remarks=["a leap"], not_identifiable=["sigma_1"])
    assert list(found.calibrated) == ["coulomb"] and found.unsure == ["sigma_1"]
    assert (
        found.said[:2] == ["a leap", "the offset wanders"] and "still missing in electrical" in found.said[2]
    )


def test_at_its_floor_a_balance_asks_for_no_longer_log(quiet: Selection) -> None:
    close = replace(quiet, refused=[Refusal("play", f"{SHORT}: it lowers the held-out mean square")])
    assert [x for x in balance(close, floor=0.5).short if "play" in x]
    assert not [x for x in balance(close, floor=2.0).short if "play" in x]


@pytest.mark.parametrize("in_turn", [False, True])
def test_rows_that_no_fitted_row_is_like_are_said_where_they_are_most(
    quiet: Selection, in_turn: bool
) -> None:
    """A term that only three quarters of the rows held out have, and one that all rows have."""
    noise, late = quiet.problem.y, np.arange(ROWS) >= ROWS - 3 * ROWS // 16
    for column, most in ((late.astype(float), True), (np.sin(TURNS), False)):
        p = made.problem(noise, np.column_stack([np.ones(ROWS), column]))
        p = replace(p, session=p.run).in_turn() if in_turn else p.told()
        share = (0.75 / 4 if in_turn else 0.75) if most else 0.0
        assert p.untold == pytest.approx(share, abs=1e-3)
        said = balance(select(p, [], np.random.default_rng(0))).short
        assert any("go where no fitted row did" in x for x in said) == (most and not in_turn)
    assert made.problem(noise, held=9).told().untold == 0.0


def test_much_that_is_left_on_fitted_rows_is_no_luck_of_a_short_log(turning: Selection) -> None:
    needs = ["channel T: 3 s to fit show only what is 90 % of it"]
    loud = balance(turning, missing=Left(8.0, 1.0, "time"))
    effects, _ = unnamed_where_missing([], needs, [loud])
    assert [f.name for f in effects] == ["unknown"]
    for other in (balance(turning, floor=3.0, missing=Left(2.7, 1.0, "time")), close_to(turning)):
        assert unnamed_where_missing([], needs, [other])[0] == []


def close_to(turning: Selection) -> Balance:
    """The same, where a name was close."""
    refused = [Refusal("gravity_imbalance", f"{SHORT}: a longer one would decide")]
    return balance(replace(turning, refused=refused), missing=Left(8.0, 1.0, "time"))
