"""When an effort acts: a hold, a delay that pays, and one that is only close."""

from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.finding import Finding, Parameter
from calibration.inputs.declaration import Column, Response
from calibration.look import delay as delays
from tests.calibration.names.made import drive

delay: Any = delays
VALUE_S = 0.012495  # 12.5 ms and a little less: 12 of two digits


def late(value: float = VALUE_S, share: float = 0.3) -> Finding:
    return Finding("channel_delay", "S", "clock", parameters={"delay": Parameter(value, "s")}, share=share)


def found(after: float, names: int = 1, bounds: Any = (), before: float = 1.0) -> Any:
    return Some(held=Some(after=after, before=before), chosen=[None] * names), None, list(bounds)


def timed(
    monkeypatch: pytest.MonkeyPatch, *, was: float, now: float, before: float = 10.0, alone: float = 1.0,
    floor: float = 0.0, names: tuple[int, int] = (1, 1), bounds: tuple[Any, Any] = ((), ()),
    dominant: bool = False,
) -> Any:  # fmt: skip
    """What is taken of a delay, beside which `now` is left, and a search without it, that leaves `was`."""
    problem = Some(once=None, floor=floor, name="plain")
    beside = found(now, names[1], bounds[1], before=alone)
    monkeypatch.setattr(delay, "force_delay", lambda *_: (late(), "close"))
    monkeypatch.setattr(delay, "is_hold", lambda *_: False)
    monkeypatch.setattr(delay, "left_by_the_declared", lambda view, p: 1.0)
    monkeypatch.setattr(delay, "Selection", Some(of=lambda p: Some(held=Some(before=before))))
    monkeypatch.setattr(delay, "dominant", lambda s: dominant and s.held.after == was)
    monkeypatch.setattr(delay, "_settled", lambda *_: (late(), "moved", beside))
    return delay.timed(
        Some(period_s=0.01), lambda v: v, problem, "force", lambda p: found(was, names[0], bounds[0])
    )


NO_MASS = ((), ("inertia: the fit gives -1",))


@pytest.mark.parametrize(
    ("given", "share"),
    [
        ({"was": 5.0, "now": 3.0, "alone": 4.0}, 0.84),
        ({"was": 5.0, "now": 3.0, "alone": 12.0}, 0.0),
        ({"was": 5.0, "now": 3.0, "before": 0.0, "alone": 0.0}, 0.3),  # of nothing there is no share
        ({"was": 5.0, "now": 0.1, "before": 0.5, "alone": 0.1}, 0.96),
        ({"was": 5.0, "now": 3.0, "floor": 1.0, "alone": 9.9}, 1 - 0.99**2),  # far above the floor
        ({"was": 5.0, "now": 1.0, "before": 2.0, "floor": 2.0, "alone": 1.3}, 1 - 0.65**2),  # takes over half
        ({"was": 9.0, "now": 5.0, "before": 7.0, "floor": 1.0}, 1 - 1 / 49),  # leaves just half
        ({"was": 10.0, "now": 5.0, "bounds": NO_MASS}, 0.99),
        ({"was": 10.0, "now": 9.5, "alone": 5.0}, 0.75),  # a tenth, where a twentieth is asked
        ({"was": 1.0, "now": 0.9}, 0.99),
        ({"was": 10.0, "now": 9.9, "names": (2, 1)}, 0.99),  # little, with a name less
        ({"was": 2.0, "now": 1.0, "dominant": True}, 0.99),  # three hundredths of 99
    ],
)
def test_a_delay_that_takes_a_twentieth_or_a_name_is_taken(
    monkeypatch: pytest.MonkeyPatch, given: dict[str, Any], share: float
) -> None:
    told = timed(monkeypatch, **given)
    assert told.problem == "moved" and told.found[0].held.after == given["now"] and told.declared is not None
    assert told.first.share == pytest.approx(share) and told.close == ""


@pytest.mark.parametrize(
    "given",
    [
        {"was": 10.0, "now": 9.9},
        {"was": 1.0, "now": 0.98},
        {"was": 10.0, "now": 9.9, "names": (1, 2)},
        {"was": 10.0, "now": 10.0, "names": (2, 1)},
        {"was": 10.0, "now": 10.1, "names": (2, 1)},
        {"was": 2.0, "now": 1.5, "dominant": True},
        {"was": 5.0, "now": 4.78, "dominant": True},  # 2.15 of 77
    ],
)
def test_a_delay_that_takes_little_is_not(monkeypatch: pytest.MonkeyPatch, given: dict[str, Any]) -> None:
    told = timed(monkeypatch, **given)
    assert told.first is None and told.close == "" and told.found[0].held.after == given["was"]


@pytest.mark.parametrize(
    ("given", "why"),
    [
        ({"was": 5.0, "now": 1.0, "before": 2.0, "floor": 2.0, "alone": 1.5},
         "the declared model is at the floor without it"),
        ({"was": 9.0, "now": 5.1, "before": 7.0, "floor": 1.0}, "it leaves most of what is above the floor"),
        ({"was": 10.0, "now": 9.0, "bounds": NO_MASS},
         "beside it the drive has no inertia: along a sine either is the other"),
    ],
)  # fmt: skip
def test_a_delay_that_is_only_close_says_why(
    monkeypatch: pytest.MonkeyPatch, given: dict[str, Any], why: str
) -> None:
    told = timed(monkeypatch, **given)
    what = "channel_delay of force, 12 ms, was close"
    assert told.close == f"{what} ({why}): quicker turns and a quieter effort"
    assert told.first is None and told.found[0].held.after == given["was"]


@pytest.mark.parametrize(
    ("late_bounds", "bounds", "none"),
    [
        (NO_MASS[1], (), True),
        (NO_MASS[1], ("viscous: x",), False),
        (("viscous: x",), (), False),
        ((), (), False),
    ],
)
def test_a_delay_in_place_of_an_inertia(late_bounds: Any, bounds: Any, none: bool) -> None:
    assert delay._no_inertia(found(1.0, 1, late_bounds), found(1.0, 1, bounds)) == none


@pytest.mark.parametrize(
    ("left", "after", "taken"),
    [
        ({"held": 1.0, "plain": 2.0}, {"held": 9.0, "plain": 1.0}, "held"),
        ({"held": 2.0, "plain": 2.0}, {"held": 0.9, "plain": 1.0}, "held"),
        ({"held": 2.0, "plain": 2.0}, {"held": 1.0, "plain": 1.0}, "plain"),
        ({"held": 2.0, "plain": 2.0, "before": 1.0}, {"held": 1.0, "before": 1.0}, "before"),
        ({"held": 3.0, "plain": 2.0, "behind": 1.0}, {"held": 1.0, "behind": 1.0}, "behind"),
    ],
)
def test_a_hold_of_a_loop_is_no_delay(
    monkeypatch: pytest.MonkeyPatch, left: dict[str, float], after: dict[str, float], taken: str
) -> None:
    """Held for a period of 10 ms, an effort acts half a period before its row or behind it."""
    names = {-0.007: "held", -0.005: "before", 0.005: "behind"}
    monkeypatch.setattr(delay, "force_delay", lambda *_: (late(-0.007), "close"))
    monkeypatch.setattr(
        delay, "is_hold", lambda d, period: (d.parameters["delay"].value, period) == (-0.007, 0.01)
    )
    monkeypatch.setattr(delay, "left_by_the_declared", lambda view, p: left.get(p.name, 9.0))
    told = delay.timed(
        Some(period_s=0.01), lambda v: Some(name=names[v]), Some(once=None, name="plain"), "force",
        lambda p: found(after[p.name]),
    )  # fmt: skip
    assert told.problem.name == taken and told.first is None
    hold = "force: acts 0.007 s after its row: the hold of a sampled loop"
    assert told.note == (hold if taken == "held" else "")
    assert told.close == ("" if taken == "held" else "close")


@pytest.mark.parametrize(
    ("best", "interval", "other"),
    [
        (0.019, (0.001, 0.019), False),  # within the error, 9 ms
        (0.0191, (0.002, 0.018), True),
        (-0.015, (0.009, 0.011), True),
        (0.0105, (0.0099, 0.0101), False),  # within a step of the search, 1 ms
        (0.015, (None, None), True),
    ],
)
def test_a_delay_beside_the_declared_terms_is_another_beyond_both_errors(
    monkeypatch: pytest.MonkeyPatch, best: float, interval: Any, other: bool
) -> None:
    monkeypatch.setattr(delay, "_left", lambda d: (d - best) ** 2)
    first = Finding("channel_delay", "S", "clock", parameters={"delay": Parameter(0.01, "s", *interval)})
    declared = Some(held=Some(before=10.0))
    _, moved, _ = delay._settled(first, declared, lambda d: d, lambda d: found(2.0 if d == 0.01 else 1.0))
    assert moved == pytest.approx(best if other else 0.01, abs=1e-5)


def test_as_much_is_left_by_a_tie() -> None:
    """The delay beside a friction curve stays where the other leaves just as much."""

    def made(d: float) -> Any:
        return Some(at=d, train=slice(None), plain_fit=lambda rows: ({}, np.array([1.0, 1 + abs(d + 0.02)])))

    first = Finding("channel_delay", "S", "clock", parameters={"delay": Parameter(0.01, "s", 0.009, 0.011)})
    _, moved, _ = delay._settled(first, Some(held=Some(before=10.0)), made, lambda p: found(2.0))
    assert moved.at == 0.01


def test_what_is_left_is_a_mean_square_of_fitted_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    train = np.array([True, True, False])
    p = Some(
        train=train, y=np.array([5.0, 7.0, 9.0]), plain_fit=lambda rows: ({}, np.array([2.0, -4.0, 99.0]))
    )
    assert delay._left(p) == 10.0
    monkeypatch.setattr(delay, "scene_of", lambda view, p: Some(fitted=lambda x: (None, x)))
    monkeypatch.setattr(delay, "plain", lambda scene: np.array([3.0, 11.0, 0.0]))
    assert delay.left_by_the_declared(None, p) == 10.0


@pytest.mark.parametrize("own", [True, False])
def test_a_force_that_is_applied_is_looked_at_as_the_response(
    monkeypatch: pytest.MonkeyPatch, own: bool
) -> None:
    """Turned round: minus its column is what is explained, minus the response stands in its place."""
    rows = np.arange(6.0)
    s = drive(rows, response=Response("force" if own else "acceleration", "N"), y=rows + 1.0,
              base=np.column_stack([np.ones(6), 5.0 * rows]))  # fmt: skip
    s.problem.base_labels = [("offset", "N"), ("force", "1")]
    s.view.rig.columns["force"] = Column("N")
    monkeypatch.setattr(delay, "scene_of", lambda view, p: (view, p))
    view, p = delay._scene_of_the_force(s.view, s.problem, "force")
    if own:
        assert view is s.view and p is s.problem
        return
    assert (view.response.channel, view.response.unit) == ("force", "N")
    assert p.y == pytest.approx(-5.0 * rows) and p.base[:, 1] == pytest.approx(-(rows + 1.0))
    assert p.base[:, 0].all() and s.problem.base[:, 1] == pytest.approx(5.0 * rows)


def test_a_force_s_delay_is_looked_for_beside_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(delay, "_scene_of_the_force", lambda view, p, channel: ("scene", channel))
    monkeypatch.setattr(delay, "lines_over_place", lambda scene: f"lines of {scene[1]}")
    monkeypatch.setattr(delay, "effort_delay", lambda scene, lines: (scene, lines))
    assert delay.force_delay(None, None, "force") == (("scene", "force"), "lines of force")


def test_delays_are_tried_to_twice_the_first_one(monkeypatch: pytest.MonkeyPatch) -> None:
    tried: Any = []
    monkeypatch.setattr(delay, "_left", lambda d: tried.append(d) or d * d)
    first = Finding("channel_delay", "S", "clock", parameters={"delay": Parameter(-0.01, "s")})
    delay._settled(first, Some(held=Some(before=10.0)), lambda d: d, lambda d: found(1.0))
    assert len(tried) > 41 and (tried[0], tried[40]) == (pytest.approx(-0.02), pytest.approx(0.02))
    assert max(abs(d) for d in tried[41:]) < 0.0011  # and a step about the best of them
