"""Lines over a place of one drive: which harmonics of a stage are looked for, and what lies beside them."""

import numpy as np
import pytest

from calibration.balances.filters import Filter
from calibration.finding import UNKNOWN
from calibration.inputs.declaration import Response, Stage
from calibration.inputs.train import SHAFT
from calibration.names.lines import (
    as_one,
    has_train,
    line,
    of_stage,
    on_clock,
    over_place,
    seen,
    stage_lines,
)
from calibration.names.scene import Scene
from tests.calibration.names.made import PERIOD_S, back_and_forth, drive

SENSOR = Response("second", "counts")
#: not one speed: a swing over 0 to 6
SWING = 3.0 - 3.0 * np.cos(2 * np.pi * np.arange(4000) / 1700)


def stage(period: float | None, harmonics: int = 2, kind: str | None = "gear_mesh", name: str = "g") -> Stage:
    return Stage(name, period, None, harmonics, kind)


def scene(*stages: Stage, x: np.ndarray = SWING, sensor: bool = False, **more: object) -> Scene:
    rig = {"stages": stages, **more.pop("rig", {})}  # type: ignore[dict-item]
    return drive(x, rig=rig, response=SENSOR if sensor else Response("force", "N"), **more)  # type: ignore[arg-type]


def pair(x: np.ndarray, rate: float) -> np.ndarray:
    return np.column_stack([np.cos(2 * np.pi * rate * x), np.sin(2 * np.pi * rate * x)])


def harmonics(*stages: Stage, **more: object) -> list[int | None]:
    s = scene(*stages, **more)  # type: ignore[arg-type]
    return [c.harmonic for c in of_stage(s, stages[0], line(s, "gear_mesh", 0.0))]


def test_a_blank_line_has_its_order_per_turn_and_the_balances_unit() -> None:
    blank = line(scene(turn=4.0), "gear_mesh", 2.5)
    assert (blank.order, blank.kind, blank.width, blank.labels) == (10.0, "line", 0, (("amplitude", "N"),))
    assert line(scene(), "gear_mesh", 2.5, ("kinematic", "m")).labels == (("kinematic", "m"),)


def test_every_harmonic_is_a_sine_pair_over_the_place() -> None:
    s = scene(stage(2.0, 3), turn=4.0)
    one, two, three, whole = stage_lines(s, "gear_mesh")
    for h, c in enumerate((one, two, three), 1):
        assert c.columns == pytest.approx(pair(SWING, h / 2.0))
        assert (c.stage, c.harmonic, c.per_run, c.order) == ("g", h, False, pytest.approx(h / 2.0 * 4.0))
    assert whole.columns == pytest.approx(np.hstack([pair(SWING, h / 2.0) for h in (1, 2, 3)]))
    assert (whole.harmonic, whole.searched, whole.stage) == (None, 1, "g")
    assert whole.order == pytest.approx(0.5 * 4.0)  # the first one's


@pytest.mark.parametrize(("period", "count", "found"), [
    (6.0 / 1.21, 2, [1, 2]), (6.0 / 1.19, 2, [2]),  # 1.2 turns of few harmonics
    (6.0 / 0.99, 8, [3, 4, 5, 6, 7, 8]),  # two cycles of a force's stage that does not come round
    (6.0 / 1.01, 8, [1, 2, 3, 4, 5, 6, 7, 8]), (6.0 / 1.01, 1, []),
])  # fmt: skip
def test_a_force_needs_turns_of_a_line_within_the_travel(period: float, count: int, found: list[int]) -> None:
    assert harmonics(stage(period, count)) == found


@pytest.mark.parametrize(
    ("turns", "count", "first"), [(0.51, 3, 1), (0.49, 3, 2), (0.61, 2, 2), (0.59, 2, 3)]
)
def test_two_sensors_need_half_a_turn_of_many_harmonics(turns: float, count: int, first: int) -> None:
    found = harmonics(stage(6.0 / turns, count), sensor=True)
    assert found == list(range(first, count + 1))


def test_a_drive_that_is_asked_for_more_turns_has_them_and_no_stage_without_a_period_any() -> None:
    s = scene(stage(2.0, 4))
    asked = of_stage(s, s.view.rig.stages[0], line(s, "gear_mesh", 0.0), turns=7.0)
    assert [c.harmonic for c in asked] == [3, 4]
    assert harmonics(stage(None, 4)) == []


def test_stages_are_told_by_their_kind() -> None:
    s = scene(stage(2.0, 1, SHAFT, "a"), stage(2.0, 1, None, "b"), stage(None, 1, SHAFT, "c"))
    assert [c.stage for c in stage_lines(s, SHAFT)] == ["a"]
    assert [c.stage for c in stage_lines(s, SHAFT, default=True)] == ["a", "b"]
    (of,) = stage_lines(s, "gear_mesh", of=SHAFT)
    assert (of.name, of.stage, of.twins) == ("gear_mesh", "a", (SHAFT,))


def test_a_weight_has_the_line_once_a_turn_of_an_angle() -> None:
    s = scene(stage(2.0, 3), turn=2.0)
    assert [c.harmonic for c in stage_lines(s, "gear_mesh")] == [2, 3, None]
    sensor = scene(stage(2.0, 3), turn=2.0, sensor=True)
    assert [c.harmonic for c in stage_lines(sensor, "gear_mesh")] == [1, 2, 3, None]
    files = scene(stage(2.0, 2), turn=2.0, files=np.repeat([0, 1], 2000))
    told = [(c.harmonic, c.per_run) for c in stage_lines(files, "gear_mesh")]
    assert told == [(1, True), (2, False), (2, True), (None, False), (None, True)]


def test_harmonics_of_what_does_not_come_round_have_no_name_together() -> None:
    s = scene(stage(7.0, 4), sensor=True)
    *_, whole = stage_lines(s, "gear_mesh")
    assert (whole.name, whole.twins) == (UNKNOWN, ("gear_mesh",))
    force = stage_lines(scene(stage(7.0, 8)), "gear_mesh")
    assert all(c.harmonic is not None for c in force)


def test_a_file_of_its_own_zero_has_its_own_phase() -> None:
    files = np.repeat([0, 1], 2000)
    s = scene(files=files)
    one, own = over_place(s, line(s, "gear_mesh", 0.5), 0.5)
    assert (one.per_run, own.per_run) == (False, True)
    first = (files == 0)[:, None]
    assert own.columns == pytest.approx(np.hstack([pair(SWING, 0.5) * first, pair(SWING, 0.5) * ~first]))
    shared = scene(files=files, rig={"runs": {"origin": "shared"}})
    assert len(over_place(shared, line(s, "gear_mesh", 0.5), 0.5)) == 1
    weight = np.linspace(1, 2, 4000)
    (c, _) = over_place(s, line(s, "gear_mesh", 0.5), 0.5, weight)
    assert c.columns == pytest.approx(weight[:, None] * pair(SWING, 0.5))


def test_as_one_joins_the_harmonics_of_one_zero_and_no_more_than_are_told() -> None:
    s = scene(stage(0.5, 30))
    mine = of_stage(s, s.view.rig.stages[0], line(s, "gear_mesh", 0.0))
    (whole,) = as_one(mine)
    assert len(mine) == 30 and whole.width == 2 * 24
    assert as_one(mine[:1]) == []


@pytest.mark.parametrize(("slow", "is_seen"), [(0.29, False), (0.31, True)])
@pytest.mark.parametrize(("step", "sigma"), [(1, 0.0), (3, 0.0), (1, 3.0)])
def test_a_line_is_seen_by_rows_that_are_slow_enough(
    slow: float, is_seen: bool, step: int, sigma: float
) -> None:
    """0.45 periods per row of what is fitted, in three of ten rows."""
    rows = np.arange(3000)
    per_row = max(step, sigma)
    speed = np.where(rows % 100 < 100 * slow, -0.44, 0.46) / (0.5 * PERIOD_S * per_row)
    s = scene(x=back_and_forth(6), speed=speed, rows=rows[::step], filter=Filter(sigma))
    assert seen(s, 0.5) is is_seen


def test_a_line_that_the_filter_ends_has_no_columns_there() -> None:
    """Two boxcars of 5 rows pass nothing from a cycle in five rows on."""
    rate = 1.0 / (5 * PERIOD_S * 6.0)  # at a speed of 6 a cycle in five rows
    speed = np.where(np.arange(4000) < 2000, 1.0, 6.5)
    s = scene(speed=speed, filter=Filter(1.0, 5))
    (c,) = over_place(s, line(s, "gear_mesh", rate), rate)
    assert c.columns[:1900].any() and not c.columns[2000:].any()


@pytest.mark.parametrize(("wobble", "told"), [(0.09, 0.2), (0.11, 0.0)])
def test_the_clock_and_the_place_are_one_until_they_slip_by_a_tenth_of_a_cycle(
    wobble: float, told: float
) -> None:
    """At 0.4 per s a line of 0.5 cycles per unit is one of 0.2 Hz; rms off it is the wobble."""
    t = PERIOD_S * np.arange(4000)
    x = 0.4 * t + wobble / 0.5 * np.sqrt(2) * np.sin(2 * np.pi * t / 4.0)
    for sign in (1.0, -1.0):
        assert on_clock(scene(x=sign * x), 0.5) == pytest.approx(told, abs=1e-3)


def test_at_one_speed_a_stages_line_may_be_the_clocks() -> None:
    x = 0.2 * PERIOD_S * np.arange(4000)
    assert stage_lines(scene(stage(2.0, 1), x=x), "gear_mesh")[0].twins == ("command_disturbance",)
    assert stage_lines(scene(stage(2.0, 1)), "gear_mesh")[0].twins == ()


@pytest.mark.parametrize(("kind", "period", "turn", "train"), [
    (SHAFT, 2.0, None, True), (SHAFT, 2.0, 2.0, False), ("motor", 2.0, 2.0, True),
    (SHAFT, 1.9, 2.0, True), (SHAFT, None, 2.0, False), ("motor", None, 2.0, False),
])  # fmt: skip
def test_a_train_turns_quicker_than_the_axis(
    kind: str, period: float | None, turn: float | None, train: bool
) -> None:
    assert has_train(scene(stage(period, 1, kind), turn=turn)) is train
