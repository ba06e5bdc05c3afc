"""Lines of a fixed frequency behind the effort, in made-up rows, beside a motion that repeats itself."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from calibration.finding import Finding, Parameter
from calibration.inputs.declaration import Response, Stage
from calibration.inputs.train import SHAFT
from calibration.names import command_disturbance as named
from calibration.names.inplant import Facts
from calibration.names.scene import Scene
from tests.calibration.names.made import PERIOD_S, drive

ROWS = 3000
T = PERIOD_S * np.arange(ROWS)
SPAN_S = float(T[-1])
NOISE = 0.05 * np.random.default_rng(3).standard_normal(ROWS)
#: two tones, which come again after 10 s
X = np.sin(2 * np.pi * 0.3 * T) + 0.4 * np.cos(2 * np.pi * 0.5 * T)
HERTZ = 4.3373


def scene(hertz: float = HERTZ, x: np.ndarray = X, square: bool = False, **more: Any) -> Scene:
    wave = np.sin(2 * np.pi * hertz * T + 0.4)
    wave = np.sign(wave) if square else wave
    return drive(x, residual=wave + NOISE, y=wave + NOISE, base=np.ones((ROWS, 1)), **more)


def test_a_line_of_a_fixed_frequency_is_a_sine_or_a_square_with_its_overtones() -> None:
    s = scene()
    one, square, *_ = named.columns(s)
    for c, orders in ((one, (1,)), (square, (1, 3, 5, 7, 9))):
        f = c.fixed["frequency"][0]
        assert f == pytest.approx(HERTZ, abs=0.5 / SPAN_S) and c.frequency == f
        angles = [2 * np.pi * k * f * T for k in orders]
        assert c.columns == pytest.approx(np.column_stack([g(a) for a in angles for g in (np.cos, np.sin)]))
        assert c.steps == (pytest.approx(0.1 / SPAN_S),)
        assert (c.kind, c.per_run, c.labels) == ("line", False, (("amplitude", "N"),))
    # a mode at rest looks like a sine, of no square
    assert one.twins == ("structural_mode",) and square.twins == ()
    assert one.shape is not None and square.shape is not None
    assert one.shape(np.array([2.0])) == pytest.approx(
        np.column_stack([np.cos(4 * np.pi * T), np.sin(4 * np.pi * T)])
    )
    assert square.shape(np.array([12.0])).shape == (ROWS, 4)  # 12 and 36 Hz of the 50 that rows hold


def test_what_is_too_quick_for_an_overtone_has_none() -> None:
    for hertz, widths in ((18.37, [2]), (15.37, [2, 4])):  # three times as quick, beyond 50 Hz and not
        here = [c for c in named.columns(scene(hertz)) if abs((c.frequency or 0.0) - hertz) < 0.02]
        assert [c.width for c in here] == widths


def test_a_balance_without_accelerations_knows_no_mode() -> None:
    assert named.columns(scene(dynamic=False))[0].twins == ()


@pytest.mark.parametrize(("count", "widths"), [(2, [4, 20]), (4, [8, 40]), (5, [10])])
def test_every_file_has_its_own_phase_and_many_files_only_sines(count: int, widths: list[int]) -> None:
    files = np.arange(ROWS) * count // ROWS
    found = [c for c in named.columns(scene(files=files)) if abs((c.frequency or 0.0) - HERTZ) < 0.1]
    assert [c.width for c in found] == widths and all(c.per_run for c in found)
    first = files == 0
    assert found[0].columns[first][:, :2].any() and not found[0].columns[~first][:, :2].any()


def test_the_lowest_frequency_has_six_cycles_in_the_log() -> None:
    for hertz, found in ((5.3 / SPAN_S, False), (6.7 / SPAN_S, True)):
        here = [c.frequency for c in named.columns(scene(hertz, 0.001 * X)) if c.frequency]
        assert any(abs(f - hertz) < 0.5 / SPAN_S for f in here) is found
    files = np.repeat([0, 1, 2], 1000)  # 10 s each: three cycles in one are more than six in all
    for hertz, found in ((0.263, False), (0.337, True)):
        here = [c.frequency for c in named.columns(scene(hertz, 0.001 * X, files=files)) if c.frequency]
        assert any(abs(f - hertz) < 0.05 for f in here) is found


def test_nothing_is_looked_for_where_no_row_is_fitted() -> None:
    assert named.columns(scene(held=np.ones(ROWS, dtype=bool))) == []


def test_two_motors_volts_say_more_than_their_torques() -> None:
    s = scene()
    s.pair = cast(Any, SimpleNamespace())
    assert named.columns(s) == []


def steady(*stages: Stage, turn: float | None = None) -> Scene:
    """At -0.5 units per s, 15 units in all."""
    return drive(-0.5 * T, rig={"stages": stages}, turn=turn)


def test_at_one_speed_a_line_may_be_a_place_of_no_stage() -> None:
    assert named.over_the_place(steady(), 1.0) == (SHAFT, "bearing_pass")
    assert named.over_the_place(steady(Stage("g", 1.0, None, 1, SHAFT)), 1.0) == ("bearing_pass",)
    assert named.over_the_place(drive(X), 1.0) == ()
    assert named.over_the_place(drive(np.zeros(ROWS)), 1.0) == ()


@pytest.mark.parametrize(("off", "own"), [(0.9, True), (-0.9, True), (1.1, False), (-1.1, False)])
def test_a_declared_stage_has_the_lines_within_its_cell(off: float, own: bool) -> None:
    """4 per 2 units are 1 Hz at this speed; a cell is one over the travel."""
    s = steady(Stage("none", None, None, 1, SHAFT), Stage("g", 2.0, None, 4, SHAFT))
    hertz = 0.5 * (4 / 2.0 + off / s.span)
    assert (named.over_the_place(s, hertz) is None) is own


@pytest.mark.parametrize(("turns", "own"), [(1.21, True), (1.19, False)])
def test_a_stage_that_hardly_turns_has_no_line(turns: float, own: bool) -> None:
    s = steady()
    g = Stage("g", s.span / turns, None, 1, SHAFT)
    assert (named.over_the_place(steady(g), 0.5 * turns / s.span) is None) is own


def found(unit: str = "N m", **sizes: float) -> Finding:
    parameters = {k: Parameter(v, unit if k == "amplitude" else "") for k, v in sizes.items()}
    return Finding("command_disturbance", "T", "time", frequency=2.0, parameters=parameters)


def test_a_plant_has_the_first_runs_phase_and_the_share_of_full_effort() -> None:
    made = named.to_plant(found("1/400", amplitude=40.0, phase=0.5, frequency=3.0, shape=1.0), Facts("a.log"))
    (effect,) = made.effects
    written = {k: n.value for k, n in effect.parameters.items()}
    assert written["amplitude"] == pytest.approx(0.1) and written["shape"] == 1.0
    assert written["phase"] == pytest.approx(0.5 + np.pi / 2) and written["frequency"] == 3.0
    assert made.remarks == [
        "command_disturbance: every run has a phase of its own, the plant has the first run's"
    ]
    plain = named.to_plant(found(amplitude=0.1, phase=0.0), Facts("a.log")).effects[0]
    assert plain.parameters["amplitude"].value == pytest.approx(0.1)
    assert plain.parameters["frequency"].value == 2.0


def test_a_log_without_an_effort_lacks_it() -> None:
    for channel in ("effort", "current", "force", "voltage"):
        assert named.NAME.lacks(drive(X, response=Response(channel, "N"))) == ""
    assert named.NAME.lacks(drive(X, response=Response("second", "m"))) == "a column of the effort"


@pytest.mark.parametrize(("part", "told"), [(0.04, False), (0.06, True)])
@pytest.mark.parametrize("files", [1, 3])  # the last of three is held out, and says nothing of it
def test_a_line_of_a_twentieth_of_what_the_declared_terms_carry_there_is_their_own_error(
    part: float, told: bool, files: int
) -> None:
    file = np.arange(ROWS) * files // ROWS
    drifting = 0.01 * T  # a motion that never comes again: no multiples of its frequency are left out
    carried = np.sin(2 * np.pi * HERTZ * T + 1.3)
    left = part * np.sin(2 * np.pi * HERTZ * T + 0.4) + 0.001 * NOISE
    held = (file == 2).astype(bool)
    s = drive(drifting, residual=left, y=carried, base=carried[:, None], files=file, held=held)
    here = [c.frequency for c in named.columns(s) if abs((c.frequency or 0.0) - HERTZ) < 0.5 / SPAN_S]
    assert bool(here) is told
