"""What names see of a log: clocks, zeros, directions, speeds, one speed of all files, and fits."""

from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.finding import Finding, Parameter
from calibration.inputs.declaration import FrictionLaw, Response
from calibration.names.name import Name, beside_stated, both_ways, candidate, grid, tried, unstated
from calibration.names.scene import Scene, since_first
from tests.calibration.names.made import PERIOD_S, back_and_forth, drive

ROWS = 2000
T: np.ndarray = PERIOD_S * np.arange(ROWS)
X: np.ndarray = back_and_forth(20, 100, 2.0)
TWO = np.repeat([0, 1], ROWS // 2)


def scene(x: np.ndarray = X, **more: Any) -> Scene:
    return drive(x, **more)


def test_time_is_counted_from_the_first_row_of_a_label() -> None:
    t = np.array([5.0, 6.0, 9.0, 2.0, 4.0])
    assert since_first(t, np.array([0, 0, 0, 1, 1])).tolist() == [0.0, 1.0, 4.0, 0.0, 2.0]
    assert t.tolist() == [5.0, 6.0, 9.0, 2.0, 4.0]


def test_kinds_of_balance_are_told_by_channel_and_response() -> None:
    assert (scene().channel, scene().force, scene().rates) == ("force", True, False)
    assert scene(response=Response("position2", "m")).channel == "sensors"
    assert scene(response=Response("velocity", "m/s")).channel == "speed"
    rates = scene(response=Response("position2", "m"))
    rates.problem.channel = "S"
    assert rates.channel == "rates" and rates.rates
    rates.pair = Some(motion=Some(width=1))  # type: ignore[assignment]
    assert rates.channel == "full_rates" and rates.rates
    rates.pair = Some(motion=Some(width=3))  # type: ignore[assignment]
    assert rates.channel == "rates"
    volts = scene()
    volts.problem.channel = "E"
    assert volts.channel == "volts" and volts.turn == 1.0 and scene(turn=7.0).turn == 7.0


def test_columns_of_two_motors_have_a_motor_each() -> None:
    ((rows, place),) = scene().motors
    assert rows.tolist() == [1.0] * ROWS and place == {}
    s = scene()
    s.pair = Some(motor=np.repeat([0.0, 1.0], ROWS // 2))  # type: ignore[assignment]
    (a, first), (b, second) = s.motors
    assert np.array_equal(a, 1.0 - TWO) and np.array_equal(b, TWO * 1.0)
    assert (first["motor"], second["motor"]) == ((1.0, "1 A, 2 B"), (2.0, "1 A, 2 B"))


def test_rates_of_an_error_of_place_hold_the_roller_s_lags() -> None:
    """A parabola 3 x^2 in the rows: its rate 6 t, its bend 6 and no jerk."""
    s = scene(response=Response("position2", "m"), declared={"velocity_delay": 0.5, "window_curvature": 2.0})
    s.problem.channel = "S"
    s.pair = Some(motion=Some(width=3, rows=np.arange(1, ROWS, 3)))  # type: ignore[assignment]
    found = s.at(3 * T**2)
    assert found[20:-20] == pytest.approx((6 * T + 0.5 * 6)[1::3][20:-20], rel=1e-6)


def test_friction_is_the_declared_one_or_of_size_one() -> None:
    law = FrictionLaw(1.5, 0.3)
    s = scene(declared={"coulomb": 2.0, "viscous": 3.0}, rig={"friction_law": law})
    assert (s.sliding.coulomb, s.sliding.viscous, s.sliding.law) == (2.0, 3.0, law)
    assert scene(declared={"coulomb": -2.0}).sliding.coulomb == 1.0
    only = scene(declared={"viscous": 3.0}).sliding
    assert (only.coulomb, only.viscous) == (0.0, 3.0) and scene().sliding.viscous == 0.0
    assert s.answer(np.ones(ROWS)) == pytest.approx(s.view.direction)


def test_clocks_are_all_files_and_each_file_s() -> None:
    one, two = scene(), scene(files=TWO)
    assert set(one.clocks) == {"start"} and set(two.clocks) == {"start", "start_in_run"}
    two.view.clock = T + 500.0
    assert two.clocks["start"] == pytest.approx(T)
    assert two.clocks["start_in_run"] == pytest.approx(T % 10.0)
    two.view.in_order = True
    assert set(two.clocks) == {"start_in_run"}


def test_files_share_a_zero_or_may_have_their_own() -> None:
    (rows, own), *more = scene(files=TWO).zeros
    assert rows[0].all() and not own and len(more) == 1
    each, apart = more[0]
    assert apart and [int(x.sum()) for x in each] == [1000, 1000] and each[1][-1]
    assert len(scene().zeros) == 1 and len(scene(files=TWO, rig={"runs": {"origin": "shared"}}).zeros) == 1


@pytest.mark.parametrize(("back", "both"), [(0.049, False), (0.051, True)])
def test_a_drive_goes_both_ways_from_a_twentieth_on(back: float, both: bool) -> None:
    way = np.where(np.arange(ROWS) < back * ROWS, -1.0, 1.0)
    for sign in (1.0, -1.0):
        s = scene(direction=sign * way)
        assert s.both == both and (both_ways(s) == "") == both
    assert not scene(direction=0.5 * np.sign(way - 0.1)).both
    assert not scene(ok=np.zeros(ROWS, dtype=bool)).both
    why = "motion in both directions over the same place"
    assert both_ways(scene(direction=np.ones(ROWS))) == why


def test_a_temperature_counts_where_it_changes() -> None:
    assert scene().temperature is None
    assert scene(columns={"temperature": 20 + 0.5 * T / T[-1]}).temperature is None
    assert scene(columns={"temperature": 20 + 0.51 * T / T[-1]}).temperature is not None


def test_a_speed_varies_by_more_than_a_tenth() -> None:
    for part, told in ((0.09, False), (0.11, True)):
        speed = np.where(np.arange(ROWS) % 2, 1 + part, 1 - part) * np.where(TWO, 1, -1)
        assert scene(speed=speed).speeds == told


def test_travels_are_those_of_sound_rows() -> None:
    ok = X < 1.5
    assert scene(ok=ok).span == pytest.approx(1.48) and scene().span == pytest.approx(2.0)
    none = np.zeros(ROWS, dtype=bool)
    assert scene(ok=none).span == 0.0
    assert scene().stroke == pytest.approx(np.quantile(np.abs(scene().view.since), 0.95))
    assert scene(np.zeros(ROWS)).stroke == 1.0
    assert scene(declared={"gravity_cos": 1.0}).weighed and not scene(declared={"cos": 1.0}).weighed


def test_one_speed_is_every_file_s_its_own_way() -> None:
    x = np.where(TWO, 50 - 3 * (T - 10), 7 + 3 * T)
    speed = np.where(TWO, -3.0, 3.0)
    s = scene(x + 0.1 * np.where(np.arange(ROWS) % 2, 1, -1), files=TWO, speed=speed)
    found, off = s.one_speed
    assert found == pytest.approx(3.0, rel=1e-3) and off == pytest.approx(0.1, rel=0.01)
    s = scene(x, files=TWO, speed=speed)
    s.pair = Some()  # type: ignore[assignment]
    assert s.one_speed == (0.0, np.inf)
    s = scene(x)
    s.problem.valid = np.zeros(ROWS, dtype=bool)
    assert s.one_speed == (0.0, np.inf)


def test_a_fit_is_of_the_base_and_more_columns() -> None:
    base = np.column_stack([np.ones(ROWS), np.zeros(ROWS)])
    held = T > 15
    y = 2.0 + 3.0 * np.sin(T) + 100.0 * held
    s = scene(base=base, y=y, held=held)
    x, made = s.fitted(np.sin(T)[:, None])
    assert x.shape == (ROWS, 2) and made == pytest.approx(2 + 3 * np.sin(T))
    assert np.linalg.norm(x[~held], axis=0) == pytest.approx([1.0, 1.0])
    assert s.fitted(y=np.full(ROWS, 5.0))[1] == pytest.approx(np.full(ROWS, 5.0))
    flat = scene(base=base, y=np.full(ROWS, 4.0))
    assert flat.declared_part == pytest.approx(np.full(ROWS, 4.0))
    columns = s.shaped(lambda p: p[0] * T)(np.array([2.0]))
    assert columns.shape == (ROWS, 1) and columns[:, 0] == pytest.approx(2 * T)


def test_a_candidate_has_the_plant_s_units_and_domain() -> None:
    c = candidate("brake_drag", T, "torque", ("other", "N"), kind="line")
    assert c.labels == (("torque", "N m"), ("other", "N")) and c.columns.shape == (ROWS, 1)
    assert c.domain == "time" and candidate("brake_drag", T, "torque", domain="velocity").domain == "velocity"


def test_a_search_begins_at_its_first_values() -> None:
    def shape(p: np.ndarray) -> np.ndarray:
        return np.full((ROWS, 1), p.sum())

    at = {"tau": (3.0, "s"), "motor": (1.0, "")}
    one = tried("brake_drag", shape, "torque", at=at)
    assert one.steps == pytest.approx((0.3,)) and one.searched == 1 and one.columns[0, 0] == 3.0
    two = tried("brake_drag", shape, "torque", at=at, steps=(0.1, 0.2), searched=0)
    assert (two.columns[0, 0], two.searched, two.steps) == (4.0, 0, (0.1, 0.2))
    several = grid(
        "brake_drag", shape, "torque", along=("tau", (1.0, 2.0), "s"), beside={"motor": (2.0, "")}, step=0.5
    )
    assert [c.fixed for c in several] == [{"tau": (v, "s"), "motor": (2.0, "")} for v in (1.0, 2.0)]
    assert [c.steps for c in several] == [(0.5,), (1.0,)] and several[1].columns[0, 0] == 2.0


def test_friction_that_a_rig_file_states_is_no_change() -> None:
    assert unstated(scene(), "coulomb") and not unstated(scene(rig={"estimate": ("coulomb",)}), "coulomb")
    known = scene(rig={"constants": {"coulomb": 2.0}})
    assert not unstated(known, "coulomb") and len(beside_stated(known, "coulomb", T, "N")) == 1
    assert beside_stated(scene(rig={"estimate": ("coulomb",)}), "coulomb", T, "N") == []
    s = scene()
    s.pair = Some(motor=None)  # type: ignore[assignment]
    assert not unstated(s, "coulomb") and beside_stated(s, "coulomb", T, "N") == []


def test_a_finding_is_told_again_by_the_coefficients_as_they_are_now() -> None:
    name = Name(
        name="brake_drag", experiment="", relative={"share": ("coulomb", 2)},
        nuisances={"knee": "", "split": "why"},
    )  # fmt: skip
    given = {k: Parameter(v, "1") for k, v in (("share", 3.0), ("knee", 1.0), ("split", 1.0))}
    f = name.retold(Finding("brake_drag", "T", "time", parameters=given, note="first"), {"coulomb": 2.0})
    assert f.parameters == {"share": Parameter(12.0, "1")} and f.note == "first; why"
    plain = name.retold(Finding("brake_drag", "T", "time", parameters={"share": Parameter(3.0, "1")}), {})
    assert plain.parameters["share"].value == 3.0 and plain.note == ""
    other = Name(
        name="brake_drag", experiment="", told=lambda f: Finding("unknown", "T", "time", parameters=given)
    )
    assert set(other.retold(f, {}).parameters) == set(given)
