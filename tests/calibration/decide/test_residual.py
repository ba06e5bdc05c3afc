"""Where a residual lives: of the place, of time alone, of a turn, with the motion, in its size."""

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from calibration.decide import residual
from calibration.decide.residual import (
    ALONE,
    MOST_LEFT,
    Left,
    Place,
    beyond_names,
    domain_share,
    left_over,
    lives_in,
    part_left,
    quick_lines,
    settle,
)
from calibration.decide.scan import fit_with
from calibration.decide.selection import Selection
from calibration.decide.thresholds import FEWEST_TOLD
from calibration.finding import UNKNOWN, Finding
from tests.calibration.decide.made import PERIOD_S, problem, term

ROWS = 4800
RNG = np.random.default_rng(17)
X, NOISE = RNG.uniform(0.0, 1.0, ROWS), RNG.standard_normal(ROWS)
WAY = RNG.choice([-1.0, 1.0], ROWS)
CLOCK = PERIOD_S * np.arange(ROWS)
WAVE = 2.0 * np.sin(2 * np.pi * X)  # beside noise of one: two thirds of the square


STAGES = [SimpleNamespace(name="worm", period=0.1), SimpleNamespace(name="frame", period=0.0)]


def scene(force: bool = True, x: np.ndarray = X, sigma: float = PERIOD_S, **columns: np.ndarray) -> Any:
    """As much of a scene as the domains need: place, speed, time, and a worm of ten turns."""
    view = SimpleNamespace(
        rows=slice(None),
        x=x,
        clock=CLOCK,
        speed=np.roll(X, 1234),
        direction=WAY,
        rig=SimpleNamespace(stages=STAGES),
        response=SimpleNamespace(is_speed=False, channel="force"),
        columns=columns,
        dynamic=False,
        sigma=sigma,
        step=PERIOD_S,
    )
    at = np.asarray
    return SimpleNamespace(
        view=view, force=force, both=False, span=0.0, temperature=None, model=None, unit="N m", at=at,
        problem=SimpleNamespace(turned=None),
    )  # fmt: skip


def of(y: np.ndarray, files: int = 1, **more: Any) -> Selection:
    p = problem(y)
    return Selection.of(replace(p, session=np.arange(ROWS) * files // ROWS, **more))


@pytest.mark.parametrize(
    ("y", "where", "domain", "share"),
    [
        (WAVE + NOISE, "over axis angle", "axis_angle", 2 / 3),
        (WAY * WAVE + NOISE, "over axis angle, against the motion", "axis_angle", 2 / 3),
        (2 * np.sin(20 * np.pi * X) + NOISE, "over the turn of worm", "axis_angle", 2 / 3),
        (2 * np.sin(2 * np.pi * np.roll(X, 1234)) + NOISE, "over velocity", "velocity", 2 / 3),
        # of a normal law's size 2/pi of the square is the mean's, which is 1 or 3: of var 5 (1 - 2/pi) + 2/pi
        (np.where(X < 0.5, 1.0, 3.0) * NOISE, "over axis angle, in size", "axis_angle", 0.26),
        (NOISE, "in no domain that was tried", None, 0.0),
    ],
)
@pytest.mark.parametrize("files", [1, 3])
def test_what_is_left_lives_where_its_bin_means_take_most(
    y: np.ndarray, where: str, domain: str | None, share: float, files: int
) -> None:
    left = left_over(of(y, files), scene(), 0.5)
    assert left is not None and left.effect
    assert (left.where, left.domain, left.share) == (where, domain, pytest.approx(share, abs=0.05))
    assert left.noise is where.endswith("in size")


@pytest.mark.parametrize(("rows", "noise"), [(1, True), (4, True), (12, False)])
def test_what_is_louder_in_places_is_noise_unless_rows_beyond_the_filter_share_it(
    rows: int, noise: bool
) -> None:
    """A vibration that comes and goes has a wave of its own, longer than the filter's four rows."""
    quick = np.convolve(NOISE, np.ones(rows) / np.sqrt(rows), "same")
    left = left_over(of(np.where(X < 0.5, 1.0, 3.0) * quick), scene(), 0.5)
    assert left is not None and (left.where, left.noise) == ("over axis angle, in size", noise)


def test_what_neighbours_share_and_no_domain_has_lives_over_time_alone() -> None:
    """Four runs of one slow wave, which no run's time tells another's."""
    y = np.sin(2 * np.pi * CLOCK / 40.0) + 0.3 * NOISE
    left = left_over(of(y), scene(), 0.1)
    assert left is not None and (left.where, left.domain) == (ALONE, "time")
    # correlation of neighbours: 0.5 / (0.5 + 0.09), squared
    assert left.share == pytest.approx((0.5 / 0.59) ** 2, abs=0.05)
    little = left_over(of(np.sin(2 * np.pi * CLOCK / 40.0) + 0.2 * WAVE), scene(), 0.1)
    assert little is not None and little.where == ALONE  # of which the place has an eighth
    both = left_over(of(0.5 * y + 5 * WAVE), scene(), 0.1)
    assert both is not None and both.where == "over axis angle"


def test_a_place_that_is_passed_slowly_is_not_time_alone() -> None:
    place = np.abs((CLOCK / 40.0) % 2.0 - 1.0)
    left = left_over(of(np.sin(2 * np.pi * place) + 0.3 * NOISE), scene(x=place), 0.1)
    assert left is not None and left.where == "over axis angle"


@pytest.mark.parametrize(
    ("rows", "sigma", "alone"),
    [(8, PERIOD_S, False), (4, 0.0, True), (3, 0.0, False), (200, PERIOD_S, True)],
)
def test_neighbours_of_one_filter_share_what_it_smears(rows: int, sigma: float, alone: bool) -> None:
    """Of a mean over n rows the correlation k rows on is 1 - k / n; at four sigma a filter has none."""
    left = left_over(of(np.convolve(NOISE, np.ones(rows) / rows, "same")), scene(sigma=sigma), 1e-3)
    assert left is not None and (left.where == ALONE) is alone


@pytest.mark.parametrize("scale", [1.0, 1e-3])
@pytest.mark.parametrize(("files", "share"), [(3, (9 * 2 / 3 + 9 * 2 / 3 - 8) / 19), (2, None)])
def test_of_three_files_each_is_held_against_the_others(
    files: int, share: float | None, scale: float
) -> None:
    """The last one has no wave, whose square is 8 beside 1: of the others' mean half is left, of it eight."""
    file = np.arange(ROWS) * files // ROWS
    held = file == 2 if files == 3 else problem(X).held
    s = of(scale * (np.where(held, 0.0, 2 * WAVE) + NOISE), files, held=held)
    left = left_over(s, scene(), 0.1 * scale)
    assert left is not None and left.domain == (None if share is None else "axis_angle")
    assert left.share == pytest.approx(share or 0.0, abs=0.06)


def test_at_the_very_limit_nothing_is_left_over() -> None:
    s = of(NOISE)
    half = s.held.after / 2
    assert left_over(s, scene(False), half) is None
    s.problem.resolved = (np.ones(ROWS, dtype=bool), half)
    assert left_over(s, scene(), 10.0) is None
    of_held = np.flatnonzero(s.problem.held)
    for rows, told in ((FEWEST_TOLD, True), (FEWEST_TOLD - 1, False)):
        s.problem.resolved = (np.isin(np.arange(ROWS), of_held[:rows]), 0.1)
        assert (left_over(s, scene(), 10.0) is not None) is told


def test_a_louder_file_says_nothing_of_its_one_speed() -> None:
    file = np.arange(ROWS) * 2 // ROWS
    s = of((1.0 + 2.0 * file) * NOISE, 2, held=np.arange(ROWS) % 2 == 0)
    assert lives_in(s, [Place("speed", "velocity", file + 0.1 * X)])[0] is None


@pytest.mark.parametrize(
    ("floor", "of_force", "of_sensors"),
    [(1 / 1.5, False, False), (1 / 1.8, True, False), (1 / 2.2, True, True)],
)
def test_a_force_tells_from_fewer_floors_on_than_sensors_do(
    floor: float, of_force: bool, of_sensors: bool
) -> None:
    s = of(NOISE)
    for force, tells in ((True, of_force), (False, of_sensors)):
        left = left_over(s, scene(force), floor)
        assert (left is not None) == tells
        if left is not None:
            assert left.times == pytest.approx(1 / floor, rel=0.05)
            assert left.part == pytest.approx(1.0, rel=0.01)  # nothing was taken
    assert left_over(s, scene(), None) is None and left_over(s, scene(), 0.0) is None
    assert left_over(of(NOISE, held=np.zeros(ROWS, dtype=bool)), scene(), 0.5) is None


@pytest.mark.parametrize(("noise", "every", "force", "told"), [
    (0.4, 2, True, True), (0.6, 2, True, False), (0.4, 2, False, False), (0.4, 30, True, False),
])  # fmt: skip
def test_of_a_force_rows_that_steps_do_not_spoil_are_looked_at_first(
    noise: float, every: int, force: bool, told: bool
) -> None:
    """The others are three times as loud, which the floor of all rows knows."""
    clean = np.arange(ROWS) % every == 0
    assert (clean & problem(NOISE).held).sum() >= FEWEST_TOLD or every == 30
    s = of(np.where(clean, NOISE + (WAVE if every == 2 else 0), 3 * NOISE), resolved=(clean, noise))
    scale = float(np.sqrt(3.0)) if every == 2 else 1.0
    s = of(s.problem.y / scale, resolved=(clean, noise))
    left = left_over(s, scene(force), 10.0)
    assert (left is not None) == told
    if left is not None:
        assert left.times == pytest.approx(1 / noise, rel=0.05)
        assert left.where == "over axis angle" and left.share == pytest.approx(2 / 3, abs=0.05)


def test_the_part_that_is_left_is_of_the_square_above_the_floor() -> None:
    assert part_left(5.0, 4.0, 3.0) == pytest.approx(7 / 16)
    assert part_left(3.0, 5.0, 3.0) == pytest.approx(16 / 9)  # nothing was above it: of the floor's own


def test_a_shape_over_a_place_is_found_of_the_motor_that_leaves_most() -> None:
    """Of two motors, one after the other; the second leaves a function of the place."""
    half = np.arange(ROWS) >= ROWS // 2
    held = np.arange(ROWS) % 2 == 0  # the first one is louder, but on rows that were fitted
    y = np.where(half, WAVE, 0.0) + np.where(half | held, 1.0, 3.0) * NOISE
    assert [lives_in(of(sign * y, held=held), [Place("", "time", X)], 2)[0] for sign in (1, -1)] == [
        "time"
    ] * 2
    s = of(np.where(half, WAVE, 0.0) + NOISE, held=held)
    places = [Place("place", "axis_angle", X), Place("time", "time", CLOCK)]
    domain, share, words = lives_in(s, places, 2)
    assert (domain, words) == ("axis_angle", "over place") and share == pytest.approx(2 / 3, abs=0.05)
    assert lives_in(s, places)[1] < 0.5
    assert lives_in(of(NOISE), places) == (None, 0.0, "in none of place, time")
    loud = of(np.where(X < 0.5, 1.0, 3.0) * NOISE)
    assert lives_in(loud, places)[::2] == ("axis_angle", "over place, in size")


def test_eight_bins_of_ten_rows_are_the_fewest() -> None:
    x = np.tile(np.arange(8.0), 20)
    train = np.arange(160) < 80
    assert domain_share(x - 3.5, x, train, ~train) == pytest.approx(1.0)
    for few in (np.arange(160) < 79, np.arange(160) < 81):
        assert domain_share(x - 3.5, x, few, ~few) == 0.0
    assert domain_share(x - 3.5, x / 7.0, train, ~train) == pytest.approx(1.0)
    # half of the fitted rows are at the last place; beyond it nothing is known, so nothing is taken
    tied = np.where(np.arange(160) < 40, 7.0, x)
    beyond = np.where((~train) & (x == 7.0), 9.0, tied)
    assert 0.0 < domain_share(x - 3.5, beyond, train, ~train) < 0.9
    # of 250 rows 24 bins, as many as there are at most: a wave of 25 places keeps the last two together
    x = np.tile(np.arange(24.0), 40)
    train = np.arange(960) < 480
    assert domain_share(np.where(x % 2 > 0, 1.0, -1.0), x, train, ~train) == pytest.approx(1.0)


def named(name: str = "brake_drag", share: float = 0.3, domain: str = "axis_angle") -> Finding:
    return Finding(name, "T", domain, share=share)


def test_half_of_what_is_above_the_floor_must_go_with_the_names() -> None:
    left = Left(4.0, MOST_LEFT, "time", "over time", 0.9)
    assert settle([named()], left, "T") == [named()]
    assert settle([named()], None, "T") == [named()]
    shape = Finding(UNKNOWN, "T", "time", share=0.1)
    assert settle([shape], replace(left, part=0.9), "T") == [shape]


def test_names_that_leave_most_are_said_beside_the_function_that_stays() -> None:
    shape = Finding(UNKNOWN, "T", "time", share=0.1)
    second = replace(shape, domain="velocity")
    many = [named(), shape, named("cable_wrap", 0.1), named(), second]
    found = settle(many, Left(4.0, 0.75, "time", "over time", 0.9), "T")
    size = "4.0 floors are left over time"
    note = f"brake_drag, cable_wrap would take 25 % of what is above the floor only: {size}"
    assert found == [replace(shape, note=note), second]


@pytest.mark.parametrize(("share", "domain"), [(0.21, "time"), (0.19, "axis_angle")])
def test_names_that_leave_most_give_their_domain_or_that_of_the_rest(share: float, domain: str) -> None:
    """The largest name takes 0.15 of all. Of three quarters that are left a fifth is as much."""
    some = [named("cable_wrap", 0.1, "velocity"), named(share=0.15)]
    (found,) = settle(some, Left(4.0, 0.75, "time", "over time", share), "K")
    assert (found.name, found.domain, found.channel) == (UNKNOWN, domain, "K")
    assert found.equivalent == ["cable_wrap", "brake_drag"] and found.share == share


def test_as_large_a_part_keeps_the_names_domain() -> None:
    (found,) = settle([named(share=0.75)], Left(4.0, 0.75, "time", "over time", 0.25), "T")
    assert found.domain == "axis_angle"
    (worse,) = settle([named()], Left(4.0, 1.75), "T")
    assert worse.note.startswith("brake_drag would take -75 % of")


def test_nothing_found_and_a_domain_is_an_unknown_with_its_size() -> None:
    (found,) = settle([], Left(4.0, 1.0, "time", "over time", 0.5), "T")
    assert (found.note, found.share) == ("4.0 floors are left over time", 0.5)


def beyond(
    y: np.ndarray, floor: float, force: bool = True, drag: np.ndarray | None = None, **columns: np.ndarray
) -> tuple[Selection, Selection, list[Finding]]:
    s = of(y, floor=floor)
    if drag is not None:
        one = fit_with(s.problem, s.problem.base, term("brake_drag", drag[:, None]))
        assert one is not None
        s = s.keep([one])
    return beyond_names(s, scene(force, **columns))


def test_a_function_of_the_place_that_nobody_named_is_found_as_one() -> None:
    alone, together, (found,) = beyond(WAVE + NOISE, 0.3)
    assert not alone.chosen and [c.name for c in together.candidates] == [UNKNOWN]
    assert (found.name, found.domain) == (UNKNOWN, "axis_angle")
    assert together.held.share == pytest.approx(2 / 3, abs=0.05)


def test_beside_a_name_the_function_is_found_and_the_name_stays() -> None:
    drag = np.random.default_rng(3).standard_normal(ROWS)
    alone, together, (found,) = beyond(2 * drag + WAVE + NOISE, 0.3, drag=drag)
    assert [c.name for c in alone.candidates] == ["brake_drag"]
    assert [c.name for c in together.candidates] == ["brake_drag", UNKNOWN] and found.domain == "axis_angle"


def test_what_is_little_above_the_floor_is_not_called_missing() -> None:
    drag = np.random.default_rng(3).standard_normal(ROWS)
    whole = float(np.std(WAVE + NOISE))
    assert beyond(2 * drag + WAVE + NOISE, whole, drag=drag)[2] == []
    assert beyond(WAVE + NOISE, 1.01 * whole)[2] == []  # the floor holds it all
    assert beyond(WAVE + NOISE, of(WAVE + NOISE).held.after)[2] == []
    # a little above the floor, but most of it goes with the function
    assert [f.domain for f in beyond(WAVE + NOISE, 0.95 * whole)[2]] == ["axis_angle"]
    assert beyond(0.6 * WAVE + NOISE, 0.95 * float(np.std(0.6 * WAVE + NOISE)))[2] == []
    assert [f.domain for f in beyond(WAVE + NOISE, 0.0)[2]] == ["axis_angle"]


def test_of_two_sensors_one_function_of_a_force_more() -> None:
    speed = 2.0 * np.sin(2 * np.pi * np.roll(X, 1234))
    for force, domains in ((True, {"axis_angle"}), (False, {"axis_angle", "velocity"})):
        alone, together, found = beyond(1.5 * WAVE + speed + NOISE, 0.3, force)
        assert {f.domain for f in found} == domains and not alone.chosen
        assert len(together.chosen) == len(domains)


def test_two_functions_are_the_most_of_two_sensors() -> None:
    third = np.roll(X, 777)
    y = sum(2.0 * np.sin(2 * np.pi * x) for x in (X, np.roll(X, 1234), third)) + NOISE
    assert len(beyond(np.asarray(y), 0.3, False, effort=third)[2]) == 2


def test_a_name_that_a_function_of_its_domain_displaces_is_refused() -> None:
    speed = np.roll(X, 1234)
    s = of(3.0 * np.sin(2 * np.pi * speed) + 0.3 * NOISE, floor=0.1)
    one = fit_with(
        s.problem, s.problem.base, replace(term("viscous_change", speed[:, None]), domain="velocity")
    )
    assert one is not None
    s = s.keep([one])
    alone, together, (found,) = beyond_names(s, scene())
    assert found.domain == "velocity" and [c.name for c in together.candidates] == [UNKNOWN]
    assert not alone.chosen and "a smooth function of velocity" in alone.refused[-1].why


def test_a_quick_line_of_the_column_is_an_unknown_of_time(monkeypatch: pytest.MonkeyPatch) -> None:
    line: Callable[[Any, float], Any] = lambda view, top: (12.5, 0.3)  # noqa: E731
    monkeypatch.setattr(residual, "pick_up", line)
    moving, still = SimpleNamespace(dynamic=True, unit="N m"), SimpleNamespace(dynamic=False)
    (found,) = quick_lines(moving, "T")  # type: ignore[arg-type]
    assert (found.name, found.channel, found.domain, found.frequency) == (UNKNOWN, "T", "time", 12.5)
    assert found.parameters["amplitude"].value == 0.3 and found.note.startswith("12.5 Hz")
    assert quick_lines(still, "T") == []  # type: ignore[arg-type]
    monkeypatch.setattr(residual, "pick_up", lambda view, top: None)
    assert quick_lines(moving, "T") == []  # type: ignore[arg-type]


def test_friction_that_nobody_stated_keeps_its_name_beside_much_that_is_left() -> None:
    friction = named("coulomb_change", 0.1, "velocity")
    left = Left(4.0, 0.75, "time", "over time", 0.5)
    kept, rest = settle([friction], left, "T")
    assert kept == friction and (rest.name, rest.domain, rest.equivalent) == (UNKNOWN, "time", ())
    assert settle([friction], replace(left, part=MOST_LEFT), "T") == [friction]
    assert settle([friction], replace(left, domain=None), "T") == [friction]
    kept, rest = settle([friction, named(share=0.9)], left, "T")
    assert kept == friction and (rest.name, rest.equivalent) == (UNKNOWN, ["brake_drag"])
    shape = Finding(UNKNOWN, "T", "velocity", share=0.1)
    assert settle([shape, friction], left, "T") == [friction, shape]
