"""A response's filter, its sign and how friction turns, before names are looked for; what is said of it."""

from dataclasses import replace
from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.balances.filters import Filter
from calibration.balances.view import STANDSTILLS
from calibration.decide.accept import SHORT
from calibration.decide.residual import Left
from calibration.decide.selection import Refusal, Selection
from calibration.inputs.declaration import Response, Stage
from calibration.look import jumps, looked, said, settled
from calibration.look.looked import Balance, Options
from tests.calibration.look.test_steps_and_events import noise, problem
from tests.calibration.names.made import PERIOD_S, drive

look: Any = settled
told: Any = looked
leaps: Any = jumps
words: Any = said
ROWS = 2000


@pytest.mark.parametrize(
    ("rates", "sigma", "shows", "wide"),
    [(5.0, 2.0, False, True), (5.0, 2.0, True, False), (2.0, 2.0, False, False)],
)
def test_a_response_is_filtered_as_its_rates_are(
    monkeypatch: pytest.MonkeyPatch, rates: float, sigma: float, shows: bool, wide: bool
) -> None:
    view = Some(rates=rates, sigma=sigma, filter="narrow")
    chosen: Any = []
    monkeypatch.setattr(look, "_quick_waves_show", lambda view, p: shows)
    monkeypatch.setattr(look, "choose_rows", chosen.append)
    look.one_filter(view, lambda: "problem")
    assert (view.filter == Filter(5.0)) == wide == bool(chosen)


T = np.arange(0.0, ROWS) * PERIOD_S
X = 2.0 * T  # units per second: top speed 2
WAVE = 0.5  # units per period: four a second, one in 25 rows


def waved(
    monkeypatch: pytest.MonkeyPatch, *, rates: float = 8.0, size: float = 1.0, sure: bool = True,
    period: float | None = WAVE, harmonics: int = 1, response: str = "force", kept: float = 1.0,
) -> Any:  # fmt: skip
    """Whether waves show that a filter of so many rows takes away; and the columns that were compared."""
    asked: Any = []
    y = size * np.sin(2 * np.pi * X / WAVE) + 0.01 * noise(rows=ROWS)
    stages = (Stage("worm", period, None, harmonics, None), Stage("none", None, None, 1, None))
    s = drive(X, y=y, base=np.ones((ROWS, 1)), rig={"stages": stages}, rates=rates, speed=np.full(ROWS, 2.0),
              response=Response(response, "N"), columns={response: y})  # fmt: skip

    def validated(p: Any, known: Any, both: Any, whitener: Any) -> Any:
        asked.append((known.shape[1], both.shape[1]))
        return Some(sure=sure)

    monkeypatch.setattr(look, "cross_validate", validated)
    return look._quick_waves_show(s.view, s.problem), asked


@pytest.mark.parametrize(
    ("given", "shows"),
    [
        ({}, True),
        ({"sure": False}, False),
        ({"period": None}, False),
        ({"rates": 3.0}, False),  # three rows leave three quarters of a wave of 25
        ({"rates": 4.6}, False),  # half at 4.69: exp(-(2 pi 4.69 / 25)^2 / 2)
        ({"rates": 4.8}, True),
        ({"period": 4 * WAVE, "harmonics": 4}, True),
    ],
)
def test_waves_show_that_a_wider_filter_takes_away(
    monkeypatch: pytest.MonkeyPatch, given: dict[str, Any], shows: bool
) -> None:
    found, asked = waved(monkeypatch, **given)
    assert found == shows
    if shows:
        quick = 2 if given.get("harmonics") else 1  # of four harmonics, of 25 and 33 rows
        assert asked == [(2, 2 + 2 * quick)]
    own, asked = waved(monkeypatch, response="acceleration")
    assert own and asked[-1] == (1, 3)  # the waves are in it


def turning(monkeypatch: pytest.MonkeyPatch, best: float, known: Any = None) -> Any:
    """The part of the top speed at which least is left, and what was asked; the view is as it was."""
    view = drive(np.sin(T), y=np.ones(ROWS)).view
    view.standstill, view.direction = 7.0, np.full(ROWS, 0.3)
    now: Any = []
    asked: Any = []
    monkeypatch.setattr(look, "fade", lambda view, part: now.append(part))
    monkeypatch.setattr(look, "response_of", lambda view, delay: (view.x, None))

    def left(view: Any, p: Any) -> float:
        asked.append((p.y[0], p.base.shape[1]))
        return abs(float(now[-1]) - best)

    monkeypatch.setattr(look, "left_by_the_declared", left)
    delays: Any = []

    def made(delay: float) -> Any:
        delays.append(delay)
        return replace(problem(np.ones(ROWS)), base=np.zeros((ROWS, 2)))

    part = look.sharpest(view, made, known)
    assert (view.standstill, view.direction[0]) == (7.0, 0.3) and now == list(STANDSTILLS)
    return part, asked, set(delays)


@pytest.mark.parametrize("best", STANDSTILLS)
def test_friction_turns_where_least_is_left(monkeypatch: pytest.MonkeyPatch, best: float) -> None:
    part, asked, delays = turning(monkeypatch, best)
    assert part == best and set(asked) == {(1.0, 3)} and delays == {0.0}  # beside the response's rate


def test_friction_turns_beside_what_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    s = Some(chosen=[1, 2], effect=lambda k: np.full(ROWS, 0.1 * (k + 1)))
    known = Some(found=(s,), first=Some(parameters={"delay": Some(value=0.02)}))
    _, asked, delays = turning(monkeypatch, 0.01, known)
    assert asked[0][0] == pytest.approx(0.7) and delays == {0.02}
    known.first = None
    assert turning(monkeypatch, 0.01, known)[2] == {0.0}


@pytest.mark.parametrize(
    ("channel", "against", "delay", "turns"),
    [
        ("force", (True, True), None, True),
        ("force", (False, True), None, False),
        ("acceleration", (True, True), None, False),
        ("force", (True, True), 0.02, True),  # late or not
        ("force", (True, False), 0.02, False),
    ],
)
def test_a_force_against_the_motion_is_turned_unless_it_is_late(
    monkeypatch: pytest.MonkeyPatch,
    channel: str,
    against: tuple[bool, bool],
    delay: float | None,
    turns: bool,
) -> None:
    """Against it as it is, and against it put right."""
    view = Some(response=Response(channel, "N", gain=2.0))
    late = None if delay is None else Some(parameters={"delay": Some(value=delay)})
    monkeypatch.setattr(look, "_against", lambda view, p: against[p != "now"])
    monkeypatch.setattr(look, "force_delay", lambda view, p, channel: (late, "") if p == "once" else None)

    class Now(str):
        __slots__ = ()
        once = "once"

    notes = look.turned(view, Now("now"), lambda d: d)
    assert bool(notes) == turns and view.response.gain == (-2.0 if turns else 2.0)
    if turns:
        assert notes[0].startswith("force: points against the motion")


def test_a_direction_is_against_by_a_fifth_of_the_larger_share() -> None:
    """Shares of -1, and of a fifth the other way or less; a weight over a turn has no direction."""
    rng = np.random.default_rng(2)
    one, other = rng.standard_normal((2, ROWS))
    for size, against in ((0.19, True), (0.21, False), (-0.5, True)):
        y = -one / np.std(one) + size * other / np.std(other)
        s = drive(np.sin(T), base=np.column_stack([one, other]), y=y)
        s.problem.base_labels = [("inertia", "N"), ("viscous", "N")]
        assert look._against(s.view, s.problem) == against
    angle = 40.0 * T
    weight = np.cos(2 * np.pi * angle / 360.0)
    s = drive(angle, base=(weight + 0.01 * one)[:, None], y=-5.0 * weight + one, turn=360.0)
    s.problem.base_labels = [("coulomb", "N")]
    assert not look._against(s.view, s.problem)
    s.view.turn = None
    assert look._against(s.view, s.problem)


def balance(
    after: float = 1.0, before: float = 3.0, floor: float | None = 1.0, square: float = 4.0, **more: Any
) -> Any:
    p = Some(unit="N", train=np.ones(300, dtype=bool), period_s=0.01, untold=more.pop("untold", 0.0))
    s: Any = Some(held=Some(before=before, after=after), fitted_square=square, problem=p, refused=[],
                  chosen=[],
                  looked_at=0)  # fmt: skip
    for name in ("chosen", "refused", "looked_at"):
        setattr(s, name, more.pop(name, getattr(s, name)))
    return Balance(key="T", row=more.pop("row", "torque"), selection=s, floor=floor, **more)


def test_a_balance_has_floors_that_are_left_on_both_kinds_of_rows() -> None:
    b = balance(3.0, floor=2.0, square=36.0)
    assert (b.times, b.fitted_times) == (1.5, 3.0)
    assert b.error == {"unit": "N", "before": 3.0, "after": 3.0, "floor": 2.0}
    assert balance(before=3.0).error["before"] == 3.0 and replace(b, before=9.0).error["before"] == 9.0
    for none in (None, 0.0, np.nan, np.inf, -1.0):
        c = balance(floor=none)
        assert (c.error["floor"], c.times, c.fitted_times) == (None, 0.0, 0.0)
    unheld = balance(before=np.nan)
    assert not unheld.held_out and unheld.times == 0.0 and not replace(b, row=None).held_out and b.held_out
    assert Options().replay and not looked.Spectrum(turns=T, stages={}, label="").periods


@pytest.mark.parametrize(("share", "part"), [(0.0, ""), (0.345, " (34 % of its mean square)")])
def test_what_is_missing_is_said_with_its_share(share: float, part: str) -> None:
    left = Left(3.25, 0.5, "time", "over time", share)
    said_ = "something is still missing in torque: 3.2 floors are left, over time"
    assert balance(missing=left).still == said_ + part and balance().still == ""


@pytest.mark.parametrize(
    ("power", "more", "few"),
    [
        (0.51, {"looked_at": 9}, True),
        (0.5, {"looked_at": 9}, False),
        (0.9, {"looked_at": 0}, False),
        (0.9, {"looked_at": 9, "chosen": ["c"]}, False),
    ],
)
def test_a_short_log_says_what_it_could_have_shown(
    monkeypatch: pytest.MonkeyPatch, power: float, more: dict[str, Any], few: bool
) -> None:
    monkeypatch.setattr(told, "least_share", lambda p, looked_at: power)
    said_ = f"channel T: 3 s to fit show only what is {100 * power:.0f} % of it"
    assert balance(**more).short == ([said_] if few else [])


@pytest.mark.parametrize(
    ("more", "said_"),
    [
        ({"after": 1.5}, ["channel T: play: " + SHORT]),
        ({"after": 1.0}, []),  # at the floor
        ({"after": 1.0, "floor": None}, ["channel T: play: " + SHORT]),
        ({"after": 1.5, "chosen": ["c"]}, []),
        ({"after": 1.0, "untold": 0.5}, []),
        ({"after": 1.0, "untold": 0.515},
         ["channel T: 52 % of the rows held out go where no fitted row did"]),
        ({"after": 1.0, "untold": 0.9, "chosen": ["c"]}, []),
    ],
)  # fmt: skip
def test_names_that_need_a_longer_log_are_said_above_the_floor(
    more: dict[str, Any], said_: list[str]
) -> None:
    refused = [Refusal("play", SHORT), Refusal("worm", "another reason")]
    assert balance(refused=refused, **more).short == said_


@pytest.mark.parametrize(
    ("after", "share", "effect"),
    [(2.0, 0.9, None), (2.1, 0.4, False), (2.1, 0.41, True), (5.0, 0.1, False), (5.1, 0.1, True)],
)
def test_an_effect_is_five_floors_or_most_of_one_domain(
    monkeypatch: pytest.MonkeyPatch, after: float, share: float, effect: bool | None
) -> None:
    asked: Any = []
    monkeypatch.setattr(
        told, "lives_in", lambda s, places, stacked: asked.append(stacked) or ("time", share, "over time")
    )
    found = told.missing_over(balance(after, before=9.0), ["place"])
    assert (found is None) == (effect is None)
    if found is not None:
        assert found.effect == effect and asked == [1]
    assert told.missing_over(balance(4.0), []).share == 0.0


def test_what_fits_five_floors_on_fitted_rows_is_a_need_only() -> None:
    left = Left(9.0, 0.5, "time", "over time", effect=True)
    for square, named in ((25.0, False), (25.1, True)):
        effects, needs = told.unnamed_where_missing([], ["short"], [balance(missing=left, square=square)])
        assert bool(effects) == named and len(needs) == 2


def test_numbers_have_the_model_s_own_error() -> None:
    p = problem(5.0 + 0.1 * noise(rows=300))
    s = Selection.of(p)
    low, high = (told.calibrated(s, model=m)["offset"] for m in (0.0, 0.1))
    assert high.half > low.half and high.half == pytest.approx(2.0 * 0.5, rel=0.5)


SECOND = np.arange(1500)


def leapt(*each: tuple[int, float], size: float = 1.0, seed: int = 1) -> Any:
    y = noise(size, seed)
    for at, step in each:
        y = y + step * (at <= SECOND)
    return y


def test_jumps_that_are_not_clear_beside_the_others_are_left_out() -> None:
    s = Selection.of(problem(leapt((700, 8.0))))
    kept, (f,) = leaps._beside(s, [300, 700], str)
    assert len(kept.chosen) == 1 and f.note.endswith(" at 700") and "300" not in f.note
    sound = Selection.of(problem(noise()))
    for places in ([300], []):
        same, found = leaps._beside(sound, places, str)
        assert same is sound and found == []


def test_as_many_as_twelve_jumps_are_events() -> None:
    places = [60 + 110 * k for k in range(13)]
    for count, told_ in ((12, True), (13, False)):
        y = leapt(*[(at, 30.0 * (-1) ** k) for k, at in enumerate(places[:count])], size=0.5)
        assert bool(leaps.jumps_of(Selection.of(problem(y)), 5.0)) == told_


def test_no_second_jump_is_looked_for_within_twelve_rows() -> None:
    assert leaps.BETWEEN == 12
    near = Selection.of(problem(leapt((700, 20.0), (709, 20.0))))
    assert len(leaps.jumps_of(near, 5.0)) == 1
    begin = Selection.of(problem(leapt((8, 20.0))))
    assert leaps.jumps_of(begin, 5.0) == [8]


@pytest.mark.parametrize(
    ("near", "far", "clear"), [(1.0, 2.0, 4.0), (0.0, 2.0, 0.0), (1.0, 0.9, 0.0), (1.0, 1.0, 4.0)]
)
def test_a_jump_is_sharp_and_lasts(near: float, far: float, clear: float) -> None:
    """Of 2 in units whose usual deviation is half: few rows show more than half of it, and many at least."""
    n = 101
    usual = np.resize([0.5, -0.5], n) / 1.4826

    def steps(size: float, beside: float = 0.0) -> Any:
        out = beside * usual
        out[50] = size
        return out

    given = {6: steps(near, 1e-6), 12: steps(-2.0, 1.0), 48: steps(-far)}
    given[6][50] *= -1
    found, at = leaps._clearest(given, 12)
    assert found == pytest.approx(clear, rel=1e-3) and (at == 50 or clear == 0.0)
    assert leaps._clearest({6: np.full(9, np.nan), 12: np.full(9, np.nan), 48: np.full(9, np.nan)}, 12) == (
        0.0,
        0,
    )


def test_the_efforts_own_noise_winds_a_shaft_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(words, "passed", lambda view, x: x)
    name, channel = words.COMPLIANCE.name, words.WINDS[-1]
    view = Some(columns={channel: 0.25})
    c, other = Some(name=name), Some(name="worm")
    fitted = [(other, np.array([9.0])), (c, np.array([-2.0, 7.0]))]
    assert words.wound_up(view, Some(fitted=fitted)) == 0.5
    assert words.wound_up(view, Some(fitted=fitted[:1])) == 0.0
    monkeypatch.setattr(words, "passed", lambda view, x: None)
    assert words.wound_up(view, Some(fitted=fitted)) == 0.0


def test_names_that_lack_something_are_not_looked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    names = {
        "a": Some(name="a", channels=("force",), lacks=lambda s: "a speed"),
        "b": Some(name="b", channels=("force",), lacks=lambda s: ""),
        "c": Some(name="c", channels=("volts",), lacks=lambda s: "volts"),
    }
    monkeypatch.setattr(words, "NAMES", names)
    assert words.lacking_names(None, "force") == ["not looked for: a: a speed"]


def test_a_second_sensor_of_half_the_travel_is_not_turned() -> None:
    view = Some(response=Response("position2", "m", ratio=0.5))
    assert look.turned(view, None, None) == [] and view.response.ratio == 0.5
