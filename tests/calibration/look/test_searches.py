"""Searches over stubbed selections: lines round by round, shapes alone, gaps that are crossed, few values."""

from dataclasses import replace
from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.balances.candidate import Candidate
from calibration.finding import Finding
from calibration.inputs.declaration import Stage
from calibration.look import fewvalues, gap, scene, search, torque
from tests.calibration.look.test_steps_and_events import problem
from tests.calibration.names.made import drive

look: Any = search
gaps: Any = gap
few: Any = fewvalues
channel: Any = torque
pairs: Any = scene


def held(after: float, before: float = 2.0) -> Any:
    return Some(after=after, before=before, taken=before**2 - after**2)


def chosen(after: float, *costs: int, before: float = 2.0, floor: float = 0.5, name: str = "s") -> Any:
    some = [Some(cost=c, frequency=None, name="name", columns=np.ones((4, 1))) for c in costs]
    return Some(held=held(after, before), chosen=some, candidates=some, problem=Some(floor=floor), name=name,
                looked_at=7)  # fmt: skip


@pytest.mark.parametrize(
    ("one", "other", "clear", "more"),
    [
        (chosen(1.0, 1), chosen(1.4, 1), False, True),  # 0.9 of 3 is more than 2.04
        (chosen(1.0, 1), chosen(1.15, 1), False, True),  # than 2.68
        (chosen(1.0, 1), chosen(1.13, 1), False, False),  # 2.72
        (chosen(1.0, 1), chosen(1.13, 2), False, True),  # more with fewer coefficients
        (chosen(1.0, 2), chosen(1.0, 1, 2), False, False),  # as much
        (chosen(1.0, 3), chosen(1.13, 1, 2), False, False),  # with as many
        (chosen(0.1, 1, before=9.0), chosen(0.21, 1, before=9.0, floor=0.2), False, True),  # twice
        (chosen(0.1, 1, before=9.0), chosen(0.2, 1, before=9.0, floor=0.1), False, False),
        (chosen(1.0), chosen(1.9, 1), False, False),  # nothing was chosen
        (chosen(0.2, 1), chosen(0.5, 1), False, False),  # below the floor
        (chosen(0.2, 1), chosen(0.5, 1), True, True),
    ],
)  # fmt: skip
def test_a_shape_alone_replaces_names_that_take_less(
    monkeypatch: pytest.MonkeyPatch, one: Any, other: Any, clear: bool, more: bool
) -> None:
    monkeypatch.setattr(look.drive, "clear", lambda s: clear)
    assert look._takes_more(one, other) == more


def test_the_best_shape_of_all_domains_is_the_one_that_leaves_least(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: Any = []
    left = {"a": 0.5, "b": 0.2, "c": 0.1}

    def select(p: Any, some: Any, rng: Any, most: int, margin: float, before: int) -> Any:
        asked.append(([c.domain for c in some], most, margin, before))
        s = chosen(left[some[0].domain], *([] if some[0].domain == "c" else [1]))
        s.domain = some[0].domain
        return s

    monkeypatch.setattr(look, "select", select)
    some = [Some(domain=d) for d in "bacb"]
    assert look._best_alone(None, some, None, 7).domain == "b"  # of the other nothing was chosen
    assert asked == [(["a"], 1, 0.02, 7), (["b", "b"], 1, 0.02, 7), (["c"], 1, 0.02, 7)]


@pytest.mark.parametrize(
    ("found", "takes_line", "looks"),
    [
        ([None], True, [["mode", "worm", "line"]]),
        ([2.0], True, [["worm", "line"]]),
        ([2.0], False, [["worm", "line"], ["mode", "worm", "line"]]),
    ],
)
def test_a_mode_is_offered_where_no_line_of_a_frequency_is_taken(
    monkeypatch: pytest.MonkeyPatch, found: list[float | None], takes_line: bool, looks: list[list[str]]
) -> None:
    asked: Any = []

    def select(p: Any, some: Any, rng: Any, most: int, margin: float) -> Any:
        assert (most, margin) == (14, 0.02)
        asked.append([c.name for c in some])
        return Some(candidates=[c for c in some if c.name == "line"] if takes_line else [])

    monkeypatch.setattr(look, "select", select)
    named = [Some(name="mode", frequency=3.0), Some(name="worm", frequency=None)]
    look._select(None, named, [Some(name="line", frequency=f) for f in found], None)
    assert asked == looks


LINES = (["l1"], ["l1", "l2"], ["l1", "l2", "l3"])


def rounds(
    monkeypatch: pytest.MonkeyPatch,
    takes: list[list[str]],
    shapes: Any = (),
    more: bool = False,
    lines: Any = LINES,
) -> Any:
    """Searches of lines that show one after the other, where so much is taken each time; what was asked."""
    asked: dict[str, Any] = {"select": [], "beside": []}
    s = Some(view=Some(resolved=1.0), problem=None, channel="force", wander=np.zeros((4, 0)), residual=None)
    fresh = iter(lines)

    def refined(p: Any, some: Any, rng: Any, before: int) -> Any:
        return Some(candidates=[Some(name="refined")], before=before)

    def fitted(*columns: Any) -> Any:
        asked["beside"].append(len(columns) - 1)
        return None, np.zeros(4)

    def select(p: Any, named: Any, found: Any, rng: Any) -> Any:
        asked["select"].append([c.name for c in [*named, *found]])
        names = takes[min(len(asked["select"]), len(takes)) - 1]
        one = chosen(1.0)
        one.candidates = [Some(name=n, columns=np.ones((4, 1))) for n in names]
        return one

    def name(label: str, searched: bool, columns: Any) -> Any:
        return Some(name=label, searched=searched, channels=("force",), columns=columns)

    def offered(scene: Any) -> Any:
        return [Some(name=n, columns=None) for n in next(fresh)]

    s.fitted = fitted
    other = Some(name="other", searched=False, channels=("volts",), columns=None)
    monkeypatch.setattr(look, "scene_of", lambda view, p: s)
    monkeypatch.setattr(look, "NAMES", {
        "l1": name("l1", True, offered), "worm": name("worm", False, lambda s: [Some(name="worm")]),
        "x": other,
    })  # fmt: skip
    monkeypatch.setattr(look, "alone", lambda scene: list(shapes))
    monkeypatch.setattr(look, "_known", lambda c, found, scene: c.name in [f.name for f in found])
    monkeypatch.setattr(look, "_select", select)
    monkeypatch.setattr(
        look,
        "_best_alone",
        refined,
    )
    monkeypatch.setattr(look, "_takes_more", lambda one, s: more and one.before == 7)
    monkeypatch.setattr(look, "one_line", lambda s, scene: s)
    monkeypatch.setattr(look, "signed", lambda s: s)
    monkeypatch.setattr(look, "leave_out", lambda s, *rules: s)
    _, scene = look._search(s.view, Some(y=np.ones(4)))
    assert scene is s
    return asked


def test_lines_are_looked_for_again_beside_those_that_were_found(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = rounds(monkeypatch, [["l1"], ["l1", "l1"], ["l1"]])
    assert asked["select"] == [["worm", "l1"], ["worm", "l1", "l2"], ["worm", "l1", "l2", "l3"]]
    assert asked["beside"] == [0, 1, 2]  # columns beside the wander
    none = rounds(monkeypatch, [[]])
    assert len(none["select"]) == 2  # a second round, once names are out of the way
    assert len(rounds(monkeypatch, [["l1"], []])["select"]) == 2


def test_a_search_ends_where_no_line_is_new(monkeypatch: pytest.MonkeyPatch) -> None:
    assert len(rounds(monkeypatch, [["l1"]], lines=(["l1"], ["l1"], ["l2"]))["select"]) == 1


@pytest.mark.parametrize("more", [True, False])
def test_shapes_alone_are_offered_in_the_first_round(monkeypatch: pytest.MonkeyPatch, more: bool) -> None:
    asked = rounds(monkeypatch, [["l1"]], [Some(name="bend")], more, (["l1"], ["l2"], ["l2"]))["select"]
    again = [["worm", "refined", "bend", "l1"], ["worm", "refined", "bend", "l1", "l2"]]
    assert asked == [["worm", "l1"], *(again if more else [["worm", "l1", "l2"]])]


def test_a_scene_of_a_pair_has_its_channel_s_response_and_filled_columns() -> None:
    """Two motors stacked have their rows twice; gaps of the columns are bridged."""
    n = 6
    m: Any = drive(np.arange(float(n)), columns={"own": np.arange(6.0)}).view
    gap = np.array([0.0, 1.0, np.nan, 3.0, 4.0, 5.0])
    columns: dict[str, Any] = {"current_a": gap, "effort": gap * 2}
    m.frame = Some(columns=columns, get=columns.get, run=np.zeros(n, dtype=np.int64))
    for key, name in (("T", "current"), ("E", "voltage"), ("K", "motor")):
        p = Some(channel=key, unit="N")
        told = pairs.scene_of_balance(Some(motion=m, motor=None), p, np.zeros(n), {"a": 1.0})
        assert (told.view.response.channel, told.view.response.unit) == (name, "N")
        assert told.view.columns["current_a"].tolist() == [0, 1, 2, 3, 4, 5]
        assert told.view.columns["effort"][2] == 4.0 and "own" in told.view.columns
        assert told.wander.shape == (n, 0) and told.view.rows.tolist() == list(range(n))
    two = pairs.scene_of_balance(Some(motion=m, motor=1), Some(channel="K", unit="N"), np.zeros(n), {})
    assert two.view.rows.tolist() == [*range(n), *range(n)]


def test_torques_of_a_pair_are_signed_and_the_lagging_one_follows_the_effort() -> None:
    """Of 2 N m an ampere, B's halved; a stiffness of 4 N m a radian, ten turns of a motor make one."""
    n = 4
    a, b = np.array([1.0, 2.0, 3.0, 4.0]), np.array([8.0, 6.0, 4.0, 2.0])
    m: Any = drive(np.arange(4.0)).view
    columns: dict[str, Any] = {"current_a": a, "current_b": b, "effort": np.array([1.0, -1.0, 0.0, 1.0])}
    frame = Some(
        columns=columns, get=columns.get, run=np.zeros(n, dtype=np.int64), scale={"gear_ratio": 10.0}
    )
    m.frame = frame
    given = Some(per_ampere=2.0, left={"a": np.ones(n), "b": np.full(n, 0.5)}, stiffness=4.0, softness_s2=0.3)
    friction = Some(coulomb=5.0, viscous=6.0)
    p = Some(channel="T", unit="N m", y=np.full(n, 9.0))
    told = pairs.scene_of_pair(
        Some(frame=frame, motion=m), Some(drive=given, friction=friction, problem=p), np.full(n, 2.0)
    )
    pair: Any = told.pair
    assert pair.torque[0].tolist() == [2, 4, 6, 8] and pair.torque[1].tolist() == [-8, -6, -4, -2]
    assert pair.lagging.tolist() == [-8, 4, 6, -2] and pair.load.tolist() == [7] * 4
    turns = [(k + t / 4) * 10 / (2 * np.pi) for k, t in enumerate((2, 4, 6, 8))]
    assert pair.turns[0] == pytest.approx(turns) and pair.softness_s2 == 0.3
    assert told.declared == {"coulomb": 5.0, "viscous": 6.0} and pair.sliding is friction


def test_rows_before_a_gap_is_crossed_are_unknown() -> None:
    """A position goes a unit a row in one of two files, and stands still in the other."""
    x = 5.0 + np.concatenate([np.arange(30.0), np.zeros(10)])
    scene = drive(x, files=np.repeat([0, 1], [30, 10]), held=np.arange(40) % 4 == 0)
    p = scene.problem
    left = gaps.known(p, scene.view, 5.0)
    assert np.flatnonzero(left.valid).tolist() == list(range(5, 30))
    assert gaps.known(p, scene.view, 10.0).train.sum() == 15  # just half
    assert gaps.known(p, scene.view, 11.0) is p
    assert gaps.known(p, scene.view, 0.0) is p
    p.held[:] = np.arange(40) >= 30
    assert gaps.known(p, scene.view, 3.0) is p  # none that are held out


GAP = Some(travel=3.0)


def gapped(after: float, *travels: float) -> Any:
    return Some(held=held(after), candidates=[Some(travel=x) for x in travels])


@pytest.mark.parametrize(
    ("first", "again", "force", "likely", "taken"),
    [
        (gapped(2.0), gapped(0.9, 3.0), False, 3.0, True),
        (gapped(2.0), gapped(1.0, 3.0), False, 3.0, False),  # as much, on the same rows
        (gapped(2.0), gapped(0.9), False, 3.0, False),  # no gap
        (gapped(2.0, 1.0), gapped(0.9, 3.0), False, 3.0, False),
        (gapped(2.0), gapped(0.9, 3.0), True, 3.0, False),
        (gapped(2.0), gapped(0.9, 3.0), False, 0.0, False),
        (gapped(2.0), gapped(0.9, 3.0), False, 9.0, False),  # all rows stay
    ],
)
def test_a_gap_is_looked_for_beyond_the_rows_before_it(
    monkeypatch: pytest.MonkeyPatch, first: Any, again: Any, force: bool, likely: float, taken: bool
) -> None:
    whole, beyond = "whole", "beyond"
    first.problem, first.on = whole, lambda p: gapped(1.0) if p == beyond else first
    monkeypatch.setattr(gaps, "travel_of", lambda c: c.travel)
    monkeypatch.setattr(gaps, "_likeliest", lambda p, scene: likely)
    monkeypatch.setattr(gaps, "known", lambda p, view, size: beyond if 0 < size < 9 else p)
    found: Any = (first, Some(force=force), [])
    other: Any = (again, None, [])
    got = gaps.crossed_first(found, None, lambda p: other if p == beyond else None)
    assert got is (other if taken else found)


def test_a_selection_is_judged_beyond_its_widest_gap(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gaps, "travel_of", lambda c: c.travel)
    monkeypatch.setattr(gaps, "known", lambda p, view, size: f"beyond {size}" if size < 9 else p)
    s = gapped(1.0, 2.0, 5.0)
    s.problem, s.on = "whole", lambda p: p
    assert gaps.where_known(s, None) == "beyond 5.0"
    s.candidates.append(Some(travel=9.0))
    assert gaps.where_known(s, None) is s
    none = gapped(1.0)
    assert gaps.where_known(none, None) is none
    s.candidates = [Some(travel=None)]
    assert gaps.where_known(s, None) is s


def test_the_likeliest_gap_leaves_least_beyond_the_widest(monkeypatch: pytest.MonkeyPatch) -> None:
    """Squares: one row of 3 is more than two of 2."""
    left = {1.0: [3.0, 0.0, 9.0], 2.0: [-2.0, -2.0, 9.0], 4.0: [4.0, 0.0, 0.0]}
    beyond = Some(train=np.array([True, True, False]), design=lambda some: some[0],
                  fit=lambda c: Some(residual=np.array(left[c.travel])))  # fmt: skip
    monkeypatch.setattr(gaps, "travel_of", lambda c: c.travel)
    monkeypatch.setattr(gaps, "known", lambda p, view, size: beyond if size == 4.0 else None)
    monkeypatch.setattr(gaps, "columns", lambda scene: [Some(travel=x) for x in (1.0, None, 2.0, 4.0)])
    assert gaps._likeliest(None, Some(view=None)) == 2.0
    monkeypatch.setattr(gaps, "columns", lambda scene: [])
    assert gaps._likeliest(None, Some(view=None)) == 0.0


def test_what_an_applied_force_takes_is_a_share_of_the_square() -> None:
    """Of 4 a row beside another term: one that is all of it, half, or none."""
    n = 40
    way, other = np.resize([1.0, -1.0], n), np.resize([1.0, 1.0, -1.0, -1.0], n)
    labels = [("offset", ""), ("applied", ""), ("slope", "")]
    base = np.column_stack([np.ones(n), way, np.zeros(n)])
    valid = np.arange(n) < 36
    for y, share in ((2 * way, 1.0), (2 * way + 2 * other, 0.5), (2 * other, 0.0), (0 * way, 0.0)):
        p = problem(y + 7.0, base=base, base_labels=labels, held=~valid)
        assert few._takes(p) == pytest.approx(share, abs=1e-9)
    last = problem(2 * way, base=base[:, [2, 0, 1]], base_labels=[labels[k] for k in (2, 0, 1)], held=~valid)
    assert few._takes(last) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("f", "beside"),
    [
        (Finding("unknown", "T", "time"), True),
        (Finding("unknown", "T", "velocity"), False),
        (Finding("brake_drag", "T", "time"), False),
        (Finding("brake_drag", "T", "time", evidence=120.0), False),
        (Finding("brake_drag", "T", "time", evidence=120.1), True),
    ],
)
def test_what_stands_beside_a_wind(f: Finding, beside: bool) -> None:
    assert channel.beside_wind(f) == beside


@pytest.mark.parametrize(
    ("name", "order", "of", "gear"),
    [
        ("torque_ripple", 12.0, 12.0, True), ("torque_ripple", 12.0, 12.0 * (1 + 2e-6), False),
        ("torque_ripple", None, 12.0, False), ("brake_drag", 12.0, 12.0, False),
    ],
)  # fmt: skip
def test_a_motor_s_line_of_a_gear_s_order_is_the_gear_s(
    name: str, order: float | None, of: float, gear: bool
) -> None:
    c = Candidate(name, "motor_angle", np.ones((3, 1)), (), order=order)
    shown = Finding("gear_eccentricity", "K", "axis_angle", order=of)
    assert channel._of_a_gear(c, [shown]) == gear
    assert not channel._of_a_gear(c, [Finding("gear_eccentricity", "T", "axis_angle", order=of)])
    assert not channel._of_a_gear(c, [Finding("brake_drag", "K", "axis_angle", order=of)])


@pytest.mark.parametrize("bounds", [[], ["inertia: -1"]])
def test_a_term_that_is_out_of_bounds_is_searched_without(
    monkeypatch: pytest.MonkeyPatch, bounds: list[str]
) -> None:
    searched: Any = []
    monkeypatch.setattr(look, "_search", lambda view, p: (searched.append(p) or len(searched), "scene"))
    monkeypatch.setattr(look, "_bound", lambda s: bounds if s == 1 else ["never"])
    assert look.find(None, "p") == (2 if bounds else 1, "scene", bounds)


@pytest.mark.parametrize(
    ("value", "name", "said"),
    [
        (-2.1, "viscous", ""), (-2.0, "viscous", ", within its error"), (0.0, "viscous", None),
        (-2.1, "offset", None),
    ],
)  # fmt: skip
def test_a_negative_term_is_within_its_error_below_two(value: float, name: str, said: str | None) -> None:
    p = Some(base=np.ones((3, 2)), base_labels=[("offset", ""), (name, "")])
    s: Any = Some(problem=p, after=Some(beta=np.array([1.0, value]), errors=np.array([9.0, 1.0])))
    told = look._bound(s)
    if said is None:
        assert told == [] and p.base.all()
    else:
        assert told == [f"{name}: the fit gives {value:.4g}{said}; a negative one feeds energy: kept at zero"]
        assert p.base[:, 0].all() and not p.base[:, 1].any()
    p.base = np.column_stack([np.ones(3), np.zeros(3)])
    assert look._bound(s) == []


def test_a_scene_has_declared_numbers_and_what_its_flexible_fit_leaves(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What a rig knows stands beside what was fitted; lines are looked for beneath the wander."""
    s = drive(np.arange(8.0), base=np.ones((8, 1)), y=np.resize([1.0, 3.0], 8))
    s.view.rig = replace(s.view.rig, constants={"inertia": 4.0})
    monkeypatch.setattr(look, "flexible", lambda scene: np.resize([1.0, -1.0], 8)[:, None])
    scene = look.scene_of(s.view, s.problem)
    assert scene.declared == {"term_0": pytest.approx(2.0), "inertia": 4.0}
    assert scene.residual == pytest.approx(np.resize([-1.0, 1.0], 8)) and scene.wander.shape == (8, 1)
    lines = [Some(columns=np.full((8, 2), 5.0)), Some(columns=np.full((8, 4), 6.0))]
    monkeypatch.setattr(look, "free_lines", lambda scene: lines)
    assert look.lines_over_place(scene).shape == (8, 6)
    assert scene.residual == pytest.approx(np.zeros(8), abs=1e-9)
    monkeypatch.setattr(look, "free_lines", lambda scene: [])
    assert look.lines_over_place(scene).shape == (8, 0)


@pytest.mark.parametrize(
    ("values", "taken", "motion", "why"),
    [
        (4, 0.0, True, ""),  # more values than three terms
        (3, 0.26, True, "explained"),
        (3, 0.25, True, "tests no balance"),
        (3, 0.9, False, "tests no balance"),  # nothing is accelerated
    ],
)
def test_an_effort_of_few_values_tests_no_balance(
    monkeypatch: pytest.MonkeyPatch, values: int, taken: float, motion: bool, why: str
) -> None:
    """Its motion is explained by it, where that takes more than a quarter of the square."""
    estimate = ("inertia",) if motion else ("coulomb",)
    before = Some(channel="effort"), Some(estimate=estimate, constants={}), {"effort": 1}
    view = Some(response=before[0], rig=before[1], columns=before[2])

    def turn_round(view: Any) -> None:
        view.response = view.rig = view.columns = "turned"

    def made(delay_s: float) -> Any:
        assert delay_s == 0.0
        return Some(base=np.ones((9, 3)), y=None)

    monkeypatch.setattr(few, "numbers", lambda records, channel: np.arange(9.0) % values)
    monkeypatch.setattr(few, "_turn_round", turn_round)
    monkeypatch.setattr(few, "_takes", lambda p: taken)
    texts = few.few_values(view, [], made)
    assert [bool(t) for t in texts] == [why == "tests no balance", why == "explained"]
    assert why in "".join(texts) and (
        values > 3 or "effort holds 3 values, the model has 3 terms" in "".join(texts)
    )
    assert (view.response == "turned") == (why == "explained")
    if why != "explained":
        assert (view.response, view.rig, view.columns) == before


def test_between_two_encoders_there_is_the_roller_s_and_not_its_gear() -> None:
    m: Any = drive(np.arange(6.0)).view
    roller, worm = (Stage(name, 1.0, None, 1, "gear_eccentricity") for name in ("roller", "worm"))
    m.rig = replace(m.rig, stages=(roller, worm))
    m.frame = Some(columns={}, get=lambda name: None, run=np.zeros(6, dtype=np.int64))
    pair = Some(motion=m, motor=None, train=Some(one=lambda name: name))
    for channel_, stages in (("S", (replace(roller, kind="encoder_eccentricity"),)), ("K", (roller, worm))):
        told = pairs.scene_of_balance(pair, Some(channel=channel_, unit="arcsec"), np.zeros(6), {})
        assert told.view.rig.stages == stages
    assert m.rig.stages == (roller, worm)
