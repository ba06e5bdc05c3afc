"""Slips that are taken beside all else, gaps that stand for jumps at the reversals, and neither."""

from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.finding import UNKNOWN
from calibration.look import slips
from tests.calibration.look.test_steps_and_events import ROWS, noise, problem, view

look: Any = slips


def effect(name: str, domain: str = "time") -> Any:
    return Some(candidate=Some(name=name, domain=domain))


SLOW, OTHER = effect(UNKNOWN), effect(UNKNOWN, "axis_angle")
FILES = np.repeat([0, 1], ROWS // 2)


def selection(p: Any, after: float = 2.0, chosen: Any = (), asked: Any = None) -> Any:
    """What keeps a choice is another one, of the same error."""
    given = Some(problem=p, held=Some(after=after), chosen=list(chosen), columns=np.ones((ROWS, 1)),
                 after=Some(whitener=None), candidates=[x.candidate for x in chosen], name="s")  # fmt: skip

    def keep(kept: Any) -> Any:
        if asked is not None:
            asked.append(list(kept))
        return given

    given.keep = keep
    return given


def slipped(
    monkeypatch: pytest.MonkeyPatch, *, jumps: Any = (100, 300), turns: Any = (), sure: Any = (300,),
    z: float = 2.0, share: float = 0.05, again: float = 1.0, with_gap: float = 2.0,
) -> Any:  # fmt: skip
    """Of two files, in which something jumps: what is taken, and which places were tried."""
    p = problem(noise(), session=FILES)
    whole: Any = Some(name="whole")
    asked: Any = {"kept": []}
    found = (selection(p, chosen=[SLOW, OTHER], asked=asked["kept"]), "scene", ["bounds"])
    gap = selection(p, with_gap)
    gap.name = "gap"

    def placed(s: Any, places: list[int], v: Any) -> Any:
        asked["places"], asked["of"] = places, s.name
        return dict.fromkeys(places, np.ones(ROWS))

    def sure_of(s: Any, everywhere: Any, steps: Any, v: Any) -> Any:
        assert not everywhere.held.any() and p.held.any()
        return {row: x for row, x in steps.items() if row in sure}

    def validated(everywhere: Any, x0: Any, x1: Any, w: Any) -> Any:
        assert x1.shape[1] > x0.shape[1]
        return Some(z=z, share=share)

    monkeypatch.setattr(look, "jumps_of", lambda s, clear: list(jumps) if clear == 5.0 else [])
    monkeypatch.setattr(look, "_turns", lambda v, p: np.array(turns, dtype=int))
    monkeypatch.setattr(look, "_with_gap", lambda s, scene: gap)
    monkeypatch.setattr(look, "_placed", placed)
    monkeypatch.setattr(look, "_sure", sure_of)
    monkeypatch.setattr(look, "cross_validate", validated)
    monkeypatch.setattr(look, "_apart", lambda p, steps: Some(name="apart", steps=len(steps)))
    monkeypatch.setattr(look, "_finding", lambda s, rows, v, share: ("slips", rows, share))
    monkeypatch.setattr(look, "Selection", Some(of=lambda p: "declared"))
    told = look.slipped(whole, found, None, lambda p: (selection(p, again), "scene", []))
    assert asked["kept"][0] == [OTHER]  # steps look like something slow
    return told, asked


def test_slips_are_taken_where_they_explain_what_nothing_else_does(monkeypatch: pytest.MonkeyPatch) -> None:
    told, asked = slipped(monkeypatch)
    assert told.problem.name == "apart" and told.problem.steps == 1 and told.declared == "declared"
    assert told.first == ("slips", [300], 0.05) and asked["places"] == [100, 300]
    assert slipped(monkeypatch, again=2.0)[0].first is not None  # as little as before


@pytest.mark.parametrize(
    "given", [{"sure": ()}, {"jumps": ()}, {"z": 1.99}, {"share": 0.049}, {"again": 2.01}]
)
def test_slips_that_do_not_pay_are_none(monkeypatch: pytest.MonkeyPatch, given: dict[str, Any]) -> None:
    told, _ = slipped(monkeypatch, **given)
    assert (told.problem.name, told.first, told.found[0].name) == ("whole", None, "s")


def test_no_slip_is_looked_for_where_a_file_begins(monkeypatch: pytest.MonkeyPatch) -> None:
    """Within 24 rows of a first one, on either side."""
    at = (24, 25, 725, 726, 774, 775)
    assert slipped(monkeypatch, jumps=at)[1]["places"] == [25, 725, 775]


@pytest.mark.parametrize(
    ("turns", "at_turns"),
    [
        ((100, 800), False),  # at one of two reversals
        ((100,), True),
        ((97, 303, 900), True),  # three rows off
        ((94, 306), True),
        ((106, 294, 900), True),
        ((93, 307), False),
    ],
)
def test_jumps_at_more_than_half_of_the_reversals_are_a_gap_s(
    monkeypatch: pytest.MonkeyPatch, turns: tuple[int, ...], at_turns: bool
) -> None:
    told, asked = slipped(monkeypatch, turns=turns, with_gap=0.5)
    assert asked["of"] == ("gap" if at_turns else "s")
    left = [at for at in (100, 300) if not any(abs(at - turn) <= look.SIDES[0] for turn in turns)]
    assert asked["places"] == (left if at_turns else [100, 300])
    if at_turns:  # and slips must leave less than with the gap
        assert told.first is None and told.found[0].name == "gap"


def gapped(
    monkeypatch: pytest.MonkeyPatch, *left: float | None, before: float = 1.0, names: Any = ("other",)
) -> Any:
    """The best of gaps that leave so much; None is one that cannot be fitted."""
    monkeypatch.setattr(look, "PLAY", Some(name="play", columns=lambda scene: list(left)))
    monkeypatch.setattr(
        look, "fit_with", lambda p, x, gap: None if gap is None else Some(left=gap, held=None)
    )
    monkeypatch.setattr(look, "replace", lambda x, **more: Some(**{**vars(x), **more}))
    signed: Any = []
    monkeypatch.setattr(look, "signed", lambda s: signed.append(s) or s)

    def keep(chosen: Any) -> Any:
        after = chosen[-1].left if hasattr(chosen[-1], "left") else before
        return Some(chosen=list(chosen), held=Some(after=after), keep=keep, candidates=[])

    some = [Some(name=name, candidate=Some(name=name)) for name in names]
    s = Some(problem=None, columns=None, chosen=some, candidates=[x.candidate for x in some], keep=keep,
             held=Some(after=before))  # fmt: skip
    told = look._with_gap(s, None)
    assert bool(signed) == (told is not s)
    return told, s


def test_the_gap_that_leaves_least_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    told, _ = gapped(monkeypatch, 0.9, None, 0.8, 0.95)
    assert [x.name for x in told.chosen[:-1]] == ["other"] and told.chosen[-1].left == 0.8
    assert told.chosen[-1].held.share == pytest.approx(0.36) and told.held.after == 0.8
    half, _ = gapped(monkeypatch, 1.0, before=2.0)
    assert half.chosen[-1].held.share == pytest.approx(0.75)


@pytest.mark.parametrize(
    ("left", "given"),
    [
        ((0.98,), {}),  # four hundredths
        ((), {}),
        ((None,), {}),
        ((0.5,), {"before": 0.0}),
        ((0.5,), {"names": ("play",)}),  # there is one
    ],
)
def test_a_gap_that_takes_little_is_none(
    monkeypatch: pytest.MonkeyPatch, left: Any, given: dict[str, Any]
) -> None:
    told, s = gapped(monkeypatch, *left, **given)
    assert told is s


def test_a_slip_is_looked_for_within_two_fitted_rows_of_its_place() -> None:
    """Every tenth row is fitted; a slip that lies 19 rows off is placed there, one at the end, too."""
    v = view(3.0)
    v.rows = np.arange(0, ROWS, 10)
    v.file = np.zeros(ROWS, dtype=np.int64)
    rows = len(v.rows)
    p = problem(3.0 * look._step(v, 519), held=np.zeros(rows, dtype=bool))
    s = Some(problem=p, columns=p.base)
    assert list(look._placed(s, [50], v)) == [519]
    assert list(look._placed(s, [55], v)) == [529]  # two fitted rows, and a row of the second round
    assert list(look._placed(s, [49], v)) == [511]
    for at, place in ((7, 0), (ROWS - 24, rows - 1)):
        p = problem(3.0 * look._step(v, at), held=np.zeros(rows, dtype=bool))
        (found,) = look._placed(Some(problem=p, columns=p.base), [place], v)
        assert abs(found - at) <= 1
