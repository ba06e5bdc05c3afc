"""A response put together: what is tried in which order, offsets of the files' own, what is told of it."""

from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.finding import UNKNOWN, Finding, Parameter
from calibration.inputs.declaration import Response
from calibration.look import forces
from calibration.look.looked import Balance

look: Any = forces
Timed: Any = look.Timed
FORCE = Response("force", "N")
LATE = ("force", "applied")


def timed(before: float = 4.0, after: float = 2.0, names: int = 1, name: str = "first") -> Any:
    """A search that chose so many names."""
    held = Some(before=before, after=after, taken=before**2 - after**2)
    s = Some(held=held, left=after**2, chosen=[1] * names, name=name)
    return Timed(Some(name=name), (s, Some(), []))


@pytest.mark.parametrize(
    ("steady", "slow", "instead"),
    [
        (timed(4.0, 2.0), timed(4.0, 2.0), True),  # as little
        (timed(4.0, 2.1), timed(4.0, 2.0), False),  # names in either
        (timed(4.0, 2.1), timed(4.0, 2.0, 0), True),  # 11.6 of 12, with names that the other has not
        (timed(4.0, 2.1, 0), timed(4.0, 2.0, 0), False),
        (timed(4.0, 2.5), timed(4.0, 2.0, 0), False),  # 9.8 of 12
        (timed(4.0, 2.3), timed(4.0, 2.0, 0), False),  # 10.7 of 12, nine tenths are 10.8
        (timed(4.0, 2.28), timed(4.0, 2.0, 0), True),
    ],
)
def test_one_size_for_all_files_stands_in_for_their_offsets(steady: Any, slow: Any, instead: bool) -> None:
    assert look._instead(steady, slow) == instead


OFFSETS = Finding(UNKNOWN, "T", "time", parameters={"rms": Parameter(0.3, "N")})
SLOW = Finding("brake_drag", "T", "time", equivalent=["worm", UNKNOWN], parameters={"x": Parameter(1, "N")})


@pytest.mark.parametrize(
    ("f", "size", "sways", "offsets", "unknown"),
    [
        (SLOW, 0.6, 5.9, OFFSETS, True),  # just twice
        (SLOW, 0.61, 5.9, OFFSETS, False),
        (SLOW, 0.6, 6.0, OFFSETS, False),  # along so many moves it follows none
        (SLOW, 0.6, 5.9, None, False),
        (Finding("brake_drag", "T", "axis_angle"), 0.1, 1.0, OFFSETS, False),
        (Finding("brake_drag", "T", "time", frequency=2.0), 0.1, 1.0, OFFSETS, False),
    ],
)
def test_an_effect_as_large_as_the_files_zeros_differ_has_no_name(
    monkeypatch: pytest.MonkeyPatch, f: Finding, size: float, sways: float, offsets: Any, unknown: bool
) -> None:
    monkeypatch.setattr(look, "slowness", lambda view: sways)
    told = look._of_the_zero(f, size * np.array([1.0, -1.0]), offsets, None)
    if not unknown:
        assert told is f
        return
    assert (told.name, told.equivalent, told.parameters) == (UNKNOWN, ("brake_drag", "worm"), {})
    assert told.note == "hardly larger than what the zero differs by from file to file"


@pytest.mark.parametrize(("declared", "share"), [(8.0, 0.75), (0.0, -15.0)])
def test_constants_of_the_files_are_a_finding(
    monkeypatch: pytest.MonkeyPatch, declared: float, share: float
) -> None:
    """Four are left beside them, of what the model with one constant leaves."""
    view, orders = Some(unit="N", slow_offset=7), []
    whole = Some(held=Some(before=declared))

    def made(delay: float) -> Any:
        orders.append((delay, view.slow_offset))
        return "problem"

    monkeypatch.setattr(look, "Selection", Some(of=lambda p: whole if p == "problem" else None))
    when = look._apart(timed(4.0), view, made, 0.3)
    assert orders == [(0.0, None)] and view.slow_offset == 0 and when.declared is whole
    f = when.offsets
    assert (f.name, f.channel, f.domain, f.note) == (UNKNOWN, "T", "time", look.OWN)
    assert f.parameters == {"rms": Parameter(0.3, "N")} and f.share == pytest.approx(share)


@pytest.mark.parametrize(
    ("first", "turns", "again", "taken"),
    [
        (timed(), 0.2, timed(after=1.9, name="again"), True),
        (timed(), 0.2, timed(after=2.0, name="again"), False),
        (timed(), 0.2, timed(after=1.9, names=0, name="again"), False),
        (timed(), 0.1, timed(after=1.9, name="again"), False),  # it turns as before
        (timed(names=0), 0.2, timed(after=1.9, name="again"), False),
    ],
)
def test_friction_that_turns_otherwise_beside_names_is_looked_at_again(
    monkeypatch: pytest.MonkeyPatch, first: Any, turns: float, again: Any, taken: bool
) -> None:
    view = Some(standstill=0.1, direction="shown")

    def fade(view: Any, part: float) -> None:
        view.standstill, view.direction = part, "faded"

    monkeypatch.setattr(look, "fade", fade)
    monkeypatch.setattr(look, "sharpest", lambda view, made, known: turns if known is first else None)
    got = look._sharper(first, view, None, lambda: again)
    assert got is (again if taken else first)
    assert (view.standstill, view.direction) == ((turns, "faded") if taken else (0.1, "shown"))


def found(
    monkeypatch: pytest.MonkeyPatch, response: Response, *, dynamic: bool = True, columns: Any = ("force",),
    order: int | None = None, instead: bool = False, floor: float | None = 0.5,
) -> Any:  # fmt: skip
    """What is found, the remarks, the view, and the searches in turn."""
    view = Some(response=response, dynamic=dynamic, columns=dict.fromkeys(columns), slow_offset=None)
    asked: Any = []
    names = iter("abc")

    def made(delay: float) -> Any:
        assert delay == 0.0
        return Some()

    def searched(kind: str) -> Any:
        def run(*given: Any) -> Any:
            asked.append((kind, view.slow_offset, *(x for x in given if x in LATE)))
            return timed(name=next(names))

        return run

    def crossed(first: Any, view: Any, search: Any) -> Any:
        p = Some()
        assert search(p) == first and (p.floor, p.resolved) == (floor or 0.0, "rows")
        return first

    monkeypatch.setattr(look, "find", lambda view, p: "found")
    monkeypatch.setattr(look, "floor_of", lambda view, p: (floor, "from repeats"))
    monkeypatch.setattr(look, "resolved_rows", lambda view, p: "rows")
    monkeypatch.setattr(look, "crossed_first", crossed)
    monkeypatch.setattr(look, "slipped", searched("slipped"))
    monkeypatch.setattr(look, "timed", searched("timed"))
    monkeypatch.setattr(look, "Timed", searched("plain"))
    monkeypatch.setattr(look, "scene_of", lambda view, p: Some(wander=None))
    monkeypatch.setattr(look, "offset_order", lambda view, p, wander: (order, 0.123))
    monkeypatch.setattr(look, "_instead", lambda steady, when: instead)
    monkeypatch.setattr(look, "_sharper", lambda when, *_: asked.append("sharper") or when)
    monkeypatch.setattr(look, "_apart", lambda when, view, made, size: asked.append(("apart", size)) or when)
    when, remarks = look._found(view, made)
    return when.problem.name, remarks, view.slow_offset, asked


@pytest.mark.parametrize("floor", [0.5, None])
def test_two_sensors_may_slip(monkeypatch: pytest.MonkeyPatch, floor: float | None) -> None:
    response = Response("position2", "m", ratio=2.0)
    got = found(monkeypatch, response, dynamic=False, floor=floor, order=3)
    assert got == ("a", [], None, [("slipped", None)])


@pytest.mark.parametrize(
    ("response", "given", "kind"),
    [
        (FORCE, {}, ("timed", None, "force")),
        (Response("acceleration", "m/s2"), {"columns": ("applied",)}, ("timed", None, "applied")),
        (FORCE, {"columns": ("effort",)}, ("plain", None)),
    ],
)
def test_a_force_that_moves_a_drive_may_be_late(
    monkeypatch: pytest.MonkeyPatch, response: Response, given: dict[str, Any], kind: Any
) -> None:
    assert found(monkeypatch, response, **given) == ("a", [], None, [kind, "sharper"])
    assert found(monkeypatch, FORCE, dynamic=False) == ("a", [], None, [("plain", None)])


def test_an_offset_that_wanders_is_tried_at_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    late = ("timed", 3, "force"), ("timed", None, "force")
    steady = found(monkeypatch, FORCE, order=3, instead=True)
    assert steady == ("b", [], None, [*late, "sharper"])
    slow = found(monkeypatch, FORCE, order=3)
    said = (
        "force: its offset wanders by 0.12 N rms within a file. 3 slow functions of time are fitted anew in "
        "every file, as the offset is"
    )
    assert slow == ("a", [said], 3, [*late, "sharper"])
    apart = found(monkeypatch, FORCE, order=0)
    assert apart[:3] == ("a", [], 0) and apart[3][2:] == ["sharper", ("apart", 0.123)]
    one = found(monkeypatch, FORCE, order=1)
    assert len(one[1]) == 1 and one[3][-1] == "sharper"


@pytest.mark.parametrize("is_force", [True, False])
@pytest.mark.parametrize("event", [None, Finding(UNKNOWN, "T", "time", note="a push")])
@pytest.mark.parametrize("missing", [None, "m"])
@pytest.mark.parametrize("dynamic", [True, False])
def test_a_response_is_looked_at_again_without_an_event(
    monkeypatch: pytest.MonkeyPatch, is_force: bool, event: Any, missing: Any, dynamic: bool
) -> None:
    view = Some(response=Some(is_force=is_force, channel="force"), dynamic=dynamic, slow_offset=2)
    asked: Any = []
    other = Finding("worm", "T", "time")
    named = Balance(key="T", row="torque", selection=timed().found[0], findings=[other], missing=missing,
                    remarks=["told"], notes=["note"])  # fmt: skip
    monkeypatch.setattr(look, "problem_of", lambda *_: Some())
    monkeypatch.setattr(look, "few_values", lambda *_: ("", "the motion"))
    monkeypatch.setattr(look, "turned", lambda *_: ["turned"])
    monkeypatch.setattr(look, "law_of_its_loop", lambda *_: "")
    monkeypatch.setattr(look, "one_filter", lambda *_: asked.append("filter"))
    monkeypatch.setattr(look, "fade", lambda view, part: asked.append(part))
    monkeypatch.setattr(look, "sharpest", lambda *_: "sharp")
    monkeypatch.setattr(look, "floor_of", lambda *_: (1.0, ""))
    monkeypatch.setattr(
        look, "_found", lambda view, made: asked.append(view.slow_offset) or (timed(), ["found"])
    )
    monkeypatch.setattr(look, "leave_out_event", lambda view, made, s: event if s.name == "first" else None)
    monkeypatch.setattr(look, "_told", lambda view, when, notes: named)
    monkeypatch.setattr(look, "follows", lambda view, p, left: [f"law {left}"])
    monkeypatch.setattr(look, "doubts", lambda view, told: ["doubt"])
    told = look.look_at_forces(view, [], Some(hold_out=[]))
    once = ["filter", "sharp"] if dynamic else []
    again = [*(["sharp"] if dynamic else []), None] if event and is_force else []
    assert asked == [*once, 2, *again]
    assert list(told.findings) == [other, *([event] if event and is_force else [])]
    law = ["law 2.0"] if missing else []
    assert told.remarks == ["the motion", "found", "told", *law, "doubt"]


def selection(after: float = 2.0) -> Any:
    p = Some(train=np.array([True, True, False]), channel="T", by_name=lambda beta: {"mass": 1.0})
    return Some(held=Some(after=after, before=9.0), problem=p, worth=[0.25], effect=lambda k: np.arange(3.0),
                after=Some(beta=None))  # fmt: skip


@pytest.mark.parametrize(
    ("floor", "wind", "sum_of"), [(3.0, 4.0, 5.0), (3.0, 0.0, 3.0), (None, 4.0, None), (0.0, 4.0, 0.0)]
)
@pytest.mark.parametrize("declared", [True, False])
def test_a_response_is_told_with_its_floor_and_needs(
    monkeypatch: pytest.MonkeyPatch, floor: Any, wind: float, sum_of: Any, declared: bool
) -> None:
    """A wind-up's part of the floor is beside it, in the square."""
    s, asked = selection(), {}
    f, offsets = Finding("worm", "T", "time", stage="x"), Finding(UNKNOWN, "T", "time", note="offsets")
    view = Some(
        response=Response("force", "N"), angle_unit="turns", direction=np.array([0.4, -0.6, 0.0]),
        columns={"force": 1}, x=np.arange(3.0), rows=np.array([0, 2]),
        rig=Some(stages=[Some(name="worm", period=4.0), Some(name="none", period=None)]),
    )  # fmt: skip

    def same(s: Any, *_: Any) -> Any:
        return s

    def of_the_zero(f: Finding, effect: Any, of: Any, view: Any) -> Finding:
        asked["share"], asked["effect"], asked["of"] = f.share, effect.tolist(), of
        return f

    for name, made in (
        ("where_known", same), ("told_by_the_clock", same), ("told_by_the_way", same),
        ("told_by_the_speed", same), ("weight_first", same),
        ("floor_of", lambda view, p: (floor, "repeats")), ("wound_up", lambda view, s: wind),
        ("filtered", lambda view: ("the filter takes half", asked.get("most", True))),
        ("beyond_names", lambda s, scene: (s, s, [])), 
        ("by_one_column", lambda s, t, *_: (s, t, ["more"])),
        ("findings_of", lambda s, k: [f]), ("_of_the_zero", of_the_zero), ("as_told", same),
        ("of_calibrated", same), ("left_over", lambda s, scene, floor: floor), ("of_one_domain", same),
        ("settle", same),
        ("quick_lines", lambda view, channel: ["quick"]), ("controls", lambda *_: ["control"]),
        ("order_beside", same), ("close", lambda s: ["was close"]), ("calibrated", lambda s: {"mass": 1}),
        ("unnamed", lambda found, tried: found), ("moves_with", lambda s, bounds: ["moves"]),
        ("lacking_names", lambda scene, channel: ["lacks"]),
    ):  # fmt: skip
        monkeypatch.setattr(look, name, made)
    when = Timed(
        Some(),
        (s, Some(channel="force"), ["bound"]),
        offsets=offsets,
        first=None,
        declared=Some(held=Some(before=7.0)) if declared else None,
        note="held",
        close="late?",
    )
    b = look._told(view, when, ["first"])
    assert b.floor == b.missing == sum_of
    source = "repeats, and the effort's through the wind-up" if floor and wind else "repeats"
    assert b.notes == ["first", "held", f"floor of force: {source}", "the filter takes half", "lacks"]
    assert (b.key, b.row, b.before) == ("T", "torque", 7.0 if declared else None)
    assert b.needs == ["late?", *([] if floor else ["was close"])] and b.remarks == ["the filter takes half"]
    assert b.not_identifiable == ["moves", "bound"] and b.controls == ["control"]
    assert [x if isinstance(x, str) else x.name for x in b.findings] == [UNKNOWN, "worm", "more", "quick"]
    assert asked == {"share": 0.25, "effect": [0.0, 1.0], "of": offsets}
    assert b.spectrum.stages == {"worm": 0.25} and b.spectrum.label == "cycles per turn"
    assert b.spectrum.turns.tolist() == [0.0, 2.0] and b.direction.tolist() == [0.4, 0.0]
    view.direction, view.angle_unit, view.columns = np.array([0.5, -0.5, 0.0]), "mas", {}
    still = look._told(view, when, [])
    assert "the position does not move" in still.notes and still.spectrum.label == "cycles per mas"
    assert still.remarks == []
    view.columns, asked["most"] = {"force": 1}, False
    assert look._told(view, when, []).remarks == []
    s.held.after = 3.0
    assert look._told(view, when, []).needs == ["late?", *([] if floor else ["was close"])]
    s.held.after = 5.1
    assert look._told(view, when, []).needs == ["late?", "was close"]


@pytest.mark.parametrize(
    ("few", "law", "need"), [("few values", "a law", "few values"), ("", "a law", "a law")]
)
def test_an_effort_that_tests_nothing_is_a_need(
    monkeypatch: pytest.MonkeyPatch, few: str, law: str, need: str
) -> None:
    p = Some(channel="T")
    monkeypatch.setattr(look, "problem_of", lambda *_: p)
    monkeypatch.setattr(look, "few_values", lambda *_: (few, ""))
    monkeypatch.setattr(look, "floor_of", lambda view, p: (0.7, "repeats"))
    monkeypatch.setattr(look, "law_of_its_loop", lambda view, p, floor: law if floor == 0.7 else "")
    monkeypatch.setattr(look, "Selection", Some(of=lambda p: "bare"))
    b = look.look_at_forces(Some(dynamic=False), [], Some(hold_out=[]))
    assert (b.key, b.row, b.selection, b.needs) == ("T", "torque", "bare", [need])
