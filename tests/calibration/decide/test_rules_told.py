"""The rules of leaving out, on held-out errors that are told: what each set of effects leaves."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from calibration.decide import drive
from calibration.decide.drive import (
    below_floor,
    cancelled,
    clear,
    displaced,
    dominant,
    harmful,
    remainder,
    worth_little,
)
from calibration.decide.heldout import HeldOut
from calibration.decide.rules import below_surrogates, needless
from calibration.finding import UNKNOWN
from tests.calibration.decide.made import term

NONE = np.zeros((4, 1))
DOMAINS = {"torque_ripple": "axis_angle", "winding_heating": "temperature", "supply_sag": "current"}
DOMAINS |= {"gear_mesh": "axis_angle", "position_friction": "axis_angle"}
KINDS = {"gear_mesh": "line"}


@dataclass
class Told:
    """A selection of which only the mean squares on held-out rows are known, by the effects' initials."""

    names: Sequence[str]
    leaves: dict[str, float]
    before: float = 100.0
    problem: Any = field(default_factory=lambda: SimpleNamespace(floor=0.0))
    bare: Any = field(default_factory=lambda: SimpleNamespace(residual=np.zeros(4)))

    @property
    def candidates(self) -> list[Any]:
        kinds = {n: {"kind": KINDS[n]} for n in self.names if n in KINDS}
        return [replace(term(n, NONE), domain=DOMAINS.get(n, "time"), **kinds.get(n, {})) for n in self.names]

    @property
    def chosen(self) -> list[Any]:
        return [SimpleNamespace(candidate=c) for c in self.candidates]

    @property
    def held(self) -> HeldOut:
        after = self.leaves["".join(sorted(n[0] for n in self.names))]
        share = 1 - after / self.before
        return HeldOut(before=self.before**0.5, after=after**0.5, share=share, z=9.0)

    @property
    def left(self) -> float:
        return self.held.after**2

    @property
    def each_left_out(self) -> list["Told"]:
        return [self.without(k) for k in range(len(self.names))]

    def keep(self, chosen: Sequence[Any]) -> "Told":
        return replace(self, names=[x.candidate.name for x in chosen])

    def without(self, k: int, why: str = "") -> "Told":
        return self.keep([x for j, x in enumerate(self.chosen) if j != k])

    def put(self, k: int, other: Any) -> "Told":
        return self.keep([other if j == k else x for j, x in enumerate(self.chosen)])


def asked(rule: Any, s: Told) -> Any:
    found = rule(s)
    return None if found is None else found[0]


@pytest.mark.parametrize(
    ("names", "left", "gone"),
    [
        # a hundredth of what is left is the worth of most names
        (["load_friction", "play"], {"lp": 10.0, "p": 10.2, "l": 10.09}, 1),
        (["load_friction", "play"], {"lp": 10.0, "p": 10.05, "l": 10.09}, 0),
        (["load_friction", "play"], {"lp": 10.0, "p": 10.2, "l": 10.11}, None),
        # of a bearing 0.04, of Stribeck's friction 0.2
        (["bearing_pass", "stribeck_change"], {"bs": 10.0, "s": 10.39, "b": 12.1}, 0),
        (["bearing_pass", "stribeck_change"], {"bs": 10.0, "s": 10.41, "b": 11.9}, 1),
        (["bearing_pass", "stribeck_change"], {"bs": 10.0, "s": 10.41, "b": 12.1}, None),
    ],
)
def test_what_is_worth_less_than_its_name_needs_goes(
    names: list[str], left: dict[str, float], gone: int
) -> None:
    assert asked(worth_little, Told(names, left)) == gone
    assert asked(worth_little, Told(names, left, problem=SimpleNamespace(floor=4.0))) == gone


@pytest.mark.parametrize(("worth", "gone"), [(0.89, 1), (0.91, None)])
def test_a_name_takes_more_than_a_tenth_of_what_nothing_explains(worth: float, gone: int | None) -> None:
    # of 10 that are left 2 are the floor's: a tenth of 8, and the hundredth of 10 that any name needs
    left = {"lp": 10.0, "p": 12.0, "l": 10.0 + worth}
    s = Told(["load_friction", "play"], left, problem=SimpleNamespace(floor=2.0**0.5))
    assert asked(worth_little, s) == gone


@pytest.mark.parametrize(
    ("names", "left", "gone"),
    [
        # of 90 that all take, 0.95 is 85.5, and 0.03 is 2.7
        (["brake_drag", "load_friction"], {"bl": 10.0, "b": 12.65, "l": 99.0}, 1),
        (["brake_drag", "load_friction"], {"bl": 10.0, "b": 12.8, "l": 99.0}, None),
        (["load_friction", "brake_drag"], {"bl": 10.0, "b": 12.6, "l": 99.0}, 0),
        # what follows another column stays, if a quarter of what is left without it is its own
        (["brake_drag", "winding_heating"], {"bw": 3.0, "b": 4.2, "w": 99.0}, None),
        (["brake_drag", "supply_sag"], {"bs": 3.0, "b": 4.2, "s": 99.0}, None),
        (["brake_drag", "supply_sag"], {"bs": 3.0, "b": 3.9, "s": 99.0}, 1),
        (["brake_drag", "load_friction"], {"bl": 3.0, "b": 4.2, "l": 99.0}, 1),
        # and so does a line beside a function of the time, which has no part that repeats with every turn
        (["brake_drag", "gear_mesh"], {"bg": 3.0, "b": 4.2, "g": 99.0}, None),
        (["brake_drag", "gear_mesh"], {"bg": 3.0, "b": 3.9, "g": 99.0}, 1),
        (["brake_drag", "position_friction"], {"bp": 3.0, "b": 4.2, "p": 99.0}, 1),
        (["brake_drag", "load_friction"], {"bl": 10.0, "b": 20.0, "l": 20.0}, None),
    ],
)
def test_a_remainder_is_three_hundredths_of_all(names: list[str], left: dict[str, float], gone: int) -> None:
    s = Told(names, left)
    assert asked(remainder, s) == gone
    if gone is not None:
        part = 100 * (left["b"] - s.held.after**2) / s.held.taken
        assert f"worth {part:.1f} % of what is found: a remainder of brake_drag" in remainder(s)[1]  # type: ignore


@pytest.mark.parametrize(("floor", "gone"), [(2.0, None), (2.1, 1)])
def test_a_column_tells_nothing_below_the_floor(floor: float, gone: int | None) -> None:
    left = {"bs": 3.0, "b": 4.2, "s": 99.0}
    s = Told(["brake_drag", "supply_sag"], left, problem=SimpleNamespace(floor=floor))
    assert asked(remainder, s) == gone


def test_a_line_beside_what_is_no_function_of_the_time_is_its_remainder() -> None:
    s = Told(["position_friction", "gear_mesh"], {"gp": 3.0, "p": 4.2, "g": 99.0})
    assert asked(remainder, s) == 1


def test_a_name_that_harms_is_worth_nothing_of_all() -> None:
    s = Told(["brake_drag", "load_friction"], {"bl": 10.0, "b": 9.0, "l": 99.0})
    assert (remainder(s) or (0, ""))[1].startswith("worth 0.0 %")  # type: ignore[arg-type]


@pytest.mark.parametrize(("alone", "name"), [(14.4, "brake_drag"), (14.6, "")])
def test_the_strongest_takes_nineteen_twentieths_alone(alone: float, name: str) -> None:
    assert dominant(Told(["brake_drag", "play"], {"bp": 10.0, "b": alone, "p": 90.0})) == name  # type: ignore
    assert dominant(Told(["brake_drag", "play"], {"bp": 101.0, "b": 100.0, "p": 100.0})) == ""  # type: ignore
    small = Told(["brake_drag", "play"], {"bp": 0.1, "b": 0.101, "p": 0.4}, before=0.5)
    assert dominant(small) == "brake_drag"  # type: ignore[arg-type]
    assert dominant(Told([], {"": 100.0})) == ""  # type: ignore[arg-type]
    # friction that every drive has comes before what begins with the log and leaves a little less
    for friction, first in ((11.0, "coulomb_change"), (40.0, "brake_drag")):
        both = Told(["brake_drag", "coulomb_change"], {"bc": 9.0, "b": 10.0, "c": friction})
        assert dominant(both) == first  # type: ignore[arg-type]
    twice = Told(["brake_drag", "play", "brake_drag"], {"bbp": 10.0, "bb": alone, "p": 90.0})
    assert dominant(twice) == name  # type: ignore[arg-type]


@pytest.mark.parametrize(("after", "gone"), [(100.0, None), (101.0, 1)])
def test_what_makes_the_held_out_error_grow_goes_the_worst_first(after: float, gone: int | None) -> None:
    s = Told(["brake_drag", "play"], {"bp": after, "b": 90.0, "p": 95.0})
    assert asked(harmful, s) == gone


@pytest.mark.parametrize(
    ("name", "domain", "left", "gone"),
    [
        # smooth alone 10, both 8: the name is worth 2 of 92, and leaves four times of what the other does
        ("brake_drag", "time", {"b": 41.0, "s": 10.0, "bs": 8.0}, True),
        ("brake_drag", "velocity", {"b": 41.0, "s": 10.0, "bs": 8.0}, False),
        ("brake_drag", "time", {"b": 39.0, "s": 10.0, "bs": 8.0}, False),
        ("brake_drag", "time", {"b": 41.0, "s": 10.0, "bs": 7.2}, False),
        ("torque_ripple", "axis_angle", {"t": 41.0, "s": 10.0, "st": 8.0}, False),
        ("position_friction", "axis_angle", {"p": 41.0, "s": 10.0, "ps": 8.0}, True),
    ],
)
def test_a_smooth_function_displaces_a_name_of_its_domain(
    name: str, domain: str, left: dict[str, float], gone: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(DOMAINS, "position_friction", "axis_angle")
    smooth: Any = SimpleNamespace(candidate=replace(term("smooth", NONE), domain=domain))
    found = displaced(smooth)(Told([name], left))  # type: ignore[arg-type]
    assert (found is not None) == gone
    assert found is None or f"a smooth function of {domain} leaves" in found[1]


@pytest.mark.parametrize(("left", "gone"), [({"b": 5.0, "p": 6.0}, 1), ({"b": 6.0, "p": 5.0}, 0)])
def test_of_two_that_cancel_the_one_whose_absence_leaves_less_goes(
    left: dict[str, float], gone: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(drive, "cancelling", lambda s: (0, 1))
    s = Told(["brake_drag", "play"], {"bp": 4.0, **left})
    assert cancelled(s) == (gone, f"cancels against {s.names[1 - gone]}")  # type: ignore[arg-type]
    monkeypatch.setattr(drive, "cancelling", lambda s: None)
    assert cancelled(s) is None  # type: ignore[arg-type]


@pytest.mark.parametrize(("share", "z", "found"), [(0.6, 4.0, True), (0.4, 4.0, False), (0.6, 2.0, False)])
def test_most_must_go_and_not_by_luck_below_the_floor(share: float, z: float, found: bool) -> None:
    s: Any = SimpleNamespace(held=HeldOut(before=1.0, after=0.5, share=share, z=z))
    assert clear(s) is found
    train = np.ones(4, dtype=bool)
    s.before = SimpleNamespace(residual=np.full(4, 1.9))
    for floor, kept in ((0.9, True), (1.0, found)):  # fitted rows are 1.9, held-out ones 1
        s.problem = SimpleNamespace(train=train, floor=floor, resolved=None)
        gone = (0, "the declared model is at the floor without it")
        assert below_floor(s) == (None if kept else gone)
    s.before.residual = np.full(4, 2.1)
    assert below_floor(s) is None


@pytest.mark.parametrize(("evidence", "goes"), [(6.9, True), (7.1, False)])
def test_an_effect_with_less_evidence_than_surrogates_goes(evidence: float, goes: bool) -> None:
    s: Any = SimpleNamespace(
        chosen=[SimpleNamespace(evidence=evidence)], scores=SimpleNamespace(threshold=7.0)
    )
    assert below_surrogates(s) == ((0, "below the surrogate threshold (6.9 < 7.0)") if goes else None)


def test_of_one_name_alone_nothing_is_compared_with_others() -> None:
    assert needless(0.05)(Told([UNKNOWN], {})) is None  # type: ignore[arg-type]
