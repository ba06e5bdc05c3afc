"""Two names for one trace, on columns that are made up: a line and the clock, friction and offset, weight
and spring."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from calibration.balances.candidate import Candidate
from calibration.decide.scan import fit_with
from calibration.decide.selection import Selection
from calibration.decide.twins import (
    one_line,
    told_by_the_clock,
    told_by_the_speed,
    told_by_the_way,
    weight_first,
)
from calibration.finding import UNKNOWN
from calibration.names import NAMES, gravity_imbalance
from calibration.names.lines import CLOCKED
from calibration.names.scene import Scene
from tests.calibration.decide.made import PERIOD_S, line, problem, term
from tests.calibration.names.made import drive

ROWS = 4000
T = PERIOD_S * np.arange(ROWS)
SPEED, TURN = -0.5, 4.0  # position units per s, and per turn
HERTZ = 0.83
ORDER = HERTZ / 0.5 * TURN  # cycles per turn that pass as often
SPAN_S = float(T[-1])
RNG = np.random.default_rng(61)
LUCK, WAY = RNG.standard_normal((2, ROWS))


def chosen(y: np.ndarray, *candidates: Candidate, noise: float = 0.05, held: int | None = None) -> Selection:
    p = problem(y + noise * LUCK, held=held)
    return Selection.of(p, [x for c in candidates if (x := fit_with(p, p.base, c)) is not None])


def scene(**more: Any) -> Scene:
    parts = {
        "view": SimpleNamespace(t=np.append(T, 1e3), rows=np.arange(ROWS)),
        "problem": SimpleNamespace(session=np.zeros(ROWS, dtype=np.int64)),
        "one_speed": (SPEED, 0.0),
        "turn": TURN,
        "span": abs(SPEED) * SPAN_S,
        "at": lambda x: x,
        "clocks": {"start": T},
        "pair": None,
    }
    return cast(Scene, cast(Any, SimpleNamespace(**{**parts, **more})))


def place(order: float = ORDER, wobble: float = 0.0, **more: Any) -> Candidate:
    """A line over the place, which the motion leaves by `wobble` turns."""
    turns = abs(SPEED) * T / TURN + wobble * np.sin(2 * np.pi * T / 60.0)
    own = {"twins": ("torque_ripple", CLOCKED), "order": ORDER, **more}
    return replace(line("bearing_pass", turns, order), **own)


def twins_told(
    *some: Candidate, held: int | None = None, of: Scene | None = None, beside: float | np.ndarray = 0.0
) -> list[tuple[str, ...]]:
    y = np.sum([c.columns[:, ::2].sum(axis=1) for c in some], axis=0)
    s = chosen(y + beside, *some, held=held)
    return [c.twins for c in told_by_the_clock(s, of or scene()).candidates]


def test_a_line_that_wobbles_with_the_place_has_no_twin_on_the_clock() -> None:
    assert twins_told(place(wobble=0.08)) == [("torque_ripple",)]
    others = place(wobble=0.08, twins=("torque_ripple",)), replace(place(wobble=0.08), order=None)
    assert [twins_told(c) for c in others] == [[c.twins] for c in others]
    assert twins_told(place(wobble=0.08), held=99) == [("torque_ripple", CLOCKED)]  # nothing is held out
    first, second = place(wobble=0.08), line("motor_cogging", T, 0.31)
    assert twins_told(replace(second, twins=(CLOCKED,), order=None), first)[1] == ("torque_ripple",)


@pytest.mark.parametrize("cells", [-0.94, -0.37, -0.04, 0.25, 0.94])
def test_the_clocks_frequency_is_found_within_the_cell(cells: float) -> None:
    """At one speed the line is as well on the clock: the twin stays where its frequency was found."""
    assert twins_told(place(ORDER * (1 + cells / SPAN_S / HERTZ))) == [("torque_ripple", CLOCKED)]


@pytest.mark.parametrize("cells", [-1.7, 1.7])
def test_a_frequency_beyond_the_cell_is_not_looked_for(cells: float) -> None:
    assert twins_told(place(ORDER * (1 + cells / SPAN_S / HERTZ))) == [("torque_ripple",)]


def test_a_refined_order_is_where_the_clock_looks() -> None:
    """The cell is one over the time; the order that was offered lies three of them off."""
    refined = place(order=ORDER * (1 + 3 / SPAN_S / HERTZ), fixed={"order": (ORDER, "1")})
    assert twins_told(replace(refined, columns=place().columns)) == [("torque_ripple", CLOCKED)]


@pytest.mark.parametrize(
    ("stage", "harmonic", "stays"), [("screw", None, True), ("screw", 2, False), (None, None, False)]
)
def test_only_a_whole_stage_has_all_its_harmonics_on_the_clock(
    stage: str | None, harmonic: int | None, stays: bool
) -> None:
    columns = np.hstack([place(h * ORDER).columns for h in (1, 2, 3)])
    whole = place(columns=columns, stage=stage, harmonic=harmonic)
    assert (CLOCKED in twins_told(whole)[0]) is stays


@pytest.mark.parametrize("harmonics", [1, 3])
def test_a_harmonic_that_the_candidate_lacks_is_not_on_the_clock(harmonics: int) -> None:
    """It is in the log, on the clock, and would speak for that."""
    columns = np.hstack([place(h * ORDER, 0.08).columns for h in range(1, harmonics + 1)])
    of = place(columns=columns, stage="screw", harmonic=None if harmonics > 1 else 1)
    beside = 3.0 * np.cos(2 * np.pi * (harmonics + 1) * HERTZ * T)
    assert twins_told(of, beside=beside) == [("torque_ripple",)]


def test_every_file_has_a_phase_of_its_own_on_the_clock() -> None:
    """The second file begins a quarter of a cycle later, as a line over the place does not mind."""
    files = (np.arange(ROWS) % 1000 > 499).astype(np.int64)
    c = replace(place(), columns=place().columns)
    late = np.where(files[:, None] > 0, c.columns[:, ::-1], c.columns)
    of_files = scene(problem=SimpleNamespace(session=files))
    assert CLOCKED in twins_told(replace(c, columns=late), of=of_files)[0]
    assert CLOCKED not in twins_told(replace(c, columns=late))[0]


def brake(way: np.ndarray, name: str = "brake_drag", **fixed: tuple[float, str]) -> Candidate:
    """Friction that comes at 50 s and turns over with the `way` of the motion."""
    at = fixed or {"duration": (0.0, "s"), "start": (50.0, "s")}
    return term(name, np.where(T >= 50.0, way, 0.0)[:, None], fixed=at, twins=("friction_warmup",))


def way_told(c: Candidate, held: int | None = None, **more: Any) -> tuple[str, ...]:
    (found,) = told_by_the_way(chosen(2.0 * c.columns[:, 0], c, held=held), scene(**more)).candidates
    assert found.columns is c.columns
    return found.twins


ONE_WAY, BOTH_WAYS = np.ones(ROWS), np.sign(WAY)


@pytest.mark.parametrize("name", ["brake_drag", "preload_change"])
def test_friction_that_changes_has_a_twin_where_nothing_turns_it_over(name: str) -> None:
    assert way_told(brake(BOTH_WAYS, name)) == ("friction_warmup",)
    assert way_told(brake(ONE_WAY, name)) == ("friction_warmup", UNKNOWN)


def test_an_offset_is_no_twin_of_what_has_no_onset_or_another_name_or_two_motors() -> None:
    assert way_told(brake(ONE_WAY, "cable_wrap")) == ("friction_warmup",)
    assert way_told(brake(ONE_WAY, duration=(0.0, "s"))) == ("friction_warmup",)
    assert way_told(brake(ONE_WAY), pair=SimpleNamespace()) == ("friction_warmup",)
    assert way_told(brake(ONE_WAY), held=99) == ("friction_warmup",)
    in_file = brake(ONE_WAY, start_in_run=(50.0, "s"))
    assert way_told(in_file, clocks={"start": 0 * T, "start_in_run": T}) == ("friction_warmup", UNKNOWN)


def test_the_offset_that_is_tried_begins_at_the_onset() -> None:
    """An offset that came at another time would explain less than friction one way only."""
    assert way_told(brake(ONE_WAY), clocks={"start": T - 30.0}) == ("friction_warmup",)


ANGLE = 0.2 * np.sin(2 * np.pi * T / 17.0)  # turns: less than one
SINE = np.column_stack([np.cos(2 * np.pi * ANGLE), np.sin(2 * np.pi * ANGLE)])
LOOP = np.sign(np.cos(2 * np.pi * T / 17.0))


def weighed(
    y: np.ndarray, monkeypatch: pytest.MonkeyPatch, of: tuple[str, ...] = ("gravity_imbalance",), **more: Any
) -> Selection:
    """A spring with its loop beside a wave, after a weight was tried in its place."""
    weight = term("gravity_imbalance", SINE, twins=("cable_wrap",), **more)
    monkeypatch.setattr(gravity_imbalance, "columns", lambda scene: [weight])
    spring = term("presliding", np.column_stack([ANGLE, LOOP]), twins=of)
    return weight_first(
        chosen(y + line("", T, 0.3).columns[:, 0], line("gear_mesh", T, 0.3), spring), scene()
    )


@pytest.mark.parametrize("loop", [0.0, 0.5])
def test_a_spring_over_less_than_a_turn_is_a_weight_first(
    loop: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    s = weighed(SINE[:, 1] + loop * LOOP, monkeypatch)
    assert [c.name for c in s.candidates] == ["gear_mesh", "gravity_imbalance"]
    assert s.candidates[1].twins == ("presliding", "cable_wrap")
    found = s.chosen[1].held
    wave, weight, luck = np.var(SINE[:, 1]), loop**2, 0.05**2
    assert found.share == pytest.approx(wave / (wave + weight + luck), abs=0.05) and found.sure


def test_a_spring_that_held_out_rows_have_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    s = weighed(8.0 * ANGLE + 0.5 * LOOP, monkeypatch)
    assert [c.name for c in s.candidates] == ["gear_mesh", "presliding"]


def test_no_weight_where_it_is_no_twin_or_pulls_the_wrong_way(monkeypatch: pytest.MonkeyPatch) -> None:
    y = SINE[:, 1] + 0.5 * LOOP
    assert weighed(y, monkeypatch, of=("play",)).candidates[1].name == "presliding"
    assert weighed(y, monkeypatch, sign=-1).candidates[1].name == "presliding"


@pytest.mark.parametrize(("cells", "lines"), [(0.9, 1), (1.1, 2)])
def test_lines_part_by_a_cycle_within_the_travel_at_any_speed(cells: float, lines: int) -> None:
    """Cycles per position unit, of a motion the other way round."""
    hertz = HERTZ + cells / SPAN_S
    more = {"kind": "line", "steps": (0.1 / SPAN_S,), "fixed": {"frequency": (hertz, "Hz")}}

    def shape(p: np.ndarray) -> np.ndarray:
        return line("", T, float(p[0])).columns

    clock = term(CLOCKED, shape(np.array([hertz])), shape=shape, **more)
    s = chosen(np.cos(2 * np.pi * HERTZ * T), place(), clock)
    assert len(one_line(s, scene()).chosen) == lines


def strokes(quick: float, rows: int = 250) -> Scene:
    """Sixteen strokes there and back, each second pair `quick` times as fast; Coulomb friction of 2 N."""
    ways = np.tile([1.0, -1.0, quick, -quick], 4)
    speed = np.repeat(ways, rows)
    held = np.arange(ROWS) >= 3 * ROWS // 4
    # what neither explains is a fifth of it: the speeds have to tell more than that
    y = 2.0 * np.sign(speed) + 0.4 * LUCK
    return drive(PERIOD_S * np.cumsum(speed), y=y, base=np.ones((ROWS, 1)), held=held)


@pytest.mark.parametrize(("quick", "twins"), [(1.05, ("viscous_change",)), (3.0, ())])
def test_friction_at_speeds_that_hardly_differ_is_either(quick: float, twins: tuple[str, ...]) -> None:
    made = strokes(quick)
    p = made.problem
    names = ("coulomb_change", "viscous_change")
    coulomb, viscous = (fit_with(p, p.base, c) for name in names for c in NAMES[name].columns(made))
    assert coulomb is not None and viscous is not None
    one = told_by_the_speed(Selection.of(p, [coulomb]), made)
    assert one.candidates[0].twins == twins
    both = Selection.of(p, [coulomb, viscous])
    assert told_by_the_speed(both, made) is both
