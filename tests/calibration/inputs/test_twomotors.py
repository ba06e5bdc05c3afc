"""Tables of an axis with two motors as runs in SI: columns, clock, and scales from the columns' steps."""

from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
import pytest

from calibration.errors import CalibrationInputError
from calibration.inputs.declaration import Rig
from calibration.inputs.rigfile import load_rig
from calibration.inputs.run import Run, Signal
from calibration.inputs.twomotors import runs_of
from plant.units import ARCSEC
from tests.calibration.azimuth import RIG

ROWS, PERIOD_S = 400, 0.01
DEG = pi / 180
UNITS = {
    "time": "s", "position": "deg", "velocity": "deg/s", "reference_rate": "deg/s", "effort": "1",
    "current_a": "A", "current_b": "A", "motor_a": "turn/s", "motor_b": "turn/s",
}  # fmt: skip
QUANTA: dict[str, float | None] = {
    "time": None, "position": 1e-4, "velocity": 2e-3, "reference_rate": None, "effort": 0.001 / 3,
    "current_a": 0.003, "current_b": 0.003, "motor_a": 0.05, "motor_b": 0.05,
}  # fmt: skip


@pytest.fixture
def rig() -> Rig:
    return load_rig(RIG)


def table(name: str = "one", start_s: float | None = None, **columns: np.ndarray) -> Run:
    """A record in the rig's units: a slow sweep, unless a column is given."""
    t = PERIOD_S * np.arange(ROWS)
    wave = np.sin(2 * pi * t / 2.0)
    given = {
        "position": 3.0 * wave, "velocity": 9.0 * wave, "reference_rate": 10.0 * wave, "effort": 0.2 * wave,
        "current_a": 1.0 + wave, "current_b": 1.0 - wave, "motor_a": 5.0 * wave, "motor_b": 4.0 * wave,
    } | columns  # fmt: skip
    signals = {
        n: Signal(n, f"{n}_column", UNITS[n], 0.0, 1.0, QUANTA[n], 0, 0)
        for n in UNITS
        if n in ("time", *given)
    }
    return Run(
        name, Path(f"{name}.csv"), "?", {"t": t, **given}, signals=signals, period_s=PERIOD_S, start_s=start_s
    )


def test_columns_are_si_and_keep_their_time(rig: Rig) -> None:
    (run,) = runs_of([table(start_s=77.0)], rig)
    given = table().columns
    factors = {
        "t": 1.0, "position": DEG, "velocity": DEG, "effort": 1.0, "current_a": 1.0, "current_b": 1.0,
        "motor_a": 2 * pi, "motor_b": 2 * pi,
    }  # fmt: skip
    for name, factor in factors.items():
        assert run.columns[name] == pytest.approx(factor * given[name]), name
    assert run.columns["setpoint"] == pytest.approx(DEG * given["reference_rate"])
    assert set(run.columns) == {*factors, "setpoint"}
    assert (run.name, run.start_s, run.header) == ("one", 77.0, {"axis": rig.name, "loop": "closed"})
    assert runs_of([table()], rig)[0].start_s == 0.0


def test_scales_come_from_the_steps_of_the_columns(rig: Rig) -> None:
    (run,) = runs_of([table()], rig)
    s = run.scales
    assert s["sample_period_s"] == s["tach_window_s"] == PERIOD_S
    assert s["velocity_window_s"] == 0.005  # as the rig declares
    assert s["position_arcsec_per_count"] == pytest.approx(0.36)
    assert s["velocity_arcsec_per_count"] == pytest.approx(7.2 * 0.005)  # a step of the rate over its window
    assert s["adc_A_per_count"] == 0.003
    assert s["tach_counts_per_turn"] == pytest.approx(1 / (0.05 * PERIOD_S))
    assert s["effort_full_scale"] == 3000.0
    assert (s["supply_V"], s["counter_torque"]) == (36.0, 0.2)
    assert s["gear_ratio"] == pytest.approx(360 / 18 * 91 / 15 * 71 / 12)
    assert s["adc_end_A"] == float("inf")


def test_steps_of_the_effort_are_whole_where_digits_make_them_all_but_whole(rig: Rig) -> None:
    def full(step: float) -> float:
        record = table()
        record.signals["effort"] = replace(record.signals["effort"], quantum=step)
        return runs_of([record], rig)[0].scales["effort_full_scale"]

    assert full(0.000333333) == 3000.0
    assert full(1 / 10.5) == pytest.approx(10.5)


def test_a_column_without_steps_has_a_ten_millionth_of_its_range(rig: Rig) -> None:
    record = table()
    for name in ("position", "current_a", "current_b"):
        record.signals[name] = replace(record.signals[name], quantum=None)
    (run,) = runs_of([record], rig)
    assert run.scales["position_arcsec_per_count"] == pytest.approx(
        1e-7 * np.ptp(record.columns["position"]) * 3600
    )
    assert run.scales["adc_A_per_count"] == pytest.approx(2e-7, rel=1e-3)
    still = table(position=np.full(ROWS, 2.0))
    still.signals["position"] = replace(still.signals["position"], quantum=None)
    assert runs_of([still], rig)[0].scales["position_arcsec_per_count"] == pytest.approx(1e-7 / ARCSEC)


def test_without_currents_velocity_and_motors_the_scales_are_those_of_the_telescope(rig: Rig) -> None:
    record = table()
    for name in ("current_a", "current_b", "velocity", "motor_a", "motor_b"):
        del record.signals[name]
    (run,) = runs_of([record], rig)
    assert run.scales["adc_A_per_count"] == 1e-3
    assert run.scales["tach_counts_per_turn"] == 4096.0
    assert run.scales["velocity_arcsec_per_count"] == pytest.approx(0.36 * 0.005)


def test_without_a_reference_the_loop_is_open_and_the_supply_may_be_a_column(rig: Rig) -> None:
    columns = {n: c for n, c in rig.columns.items() if n != "reference_rate"}
    record = table(supply=np.linspace(23.0, 25.0, ROWS))
    (run,) = runs_of([record], replace(rig, columns=columns, supply_V=None))
    assert run.header["loop"] == "open"
    assert run.scales["supply_V"] == pytest.approx(24.0)


@pytest.mark.parametrize(("runs", "sessions"), [({}, ["one", "two"]), ({"origin": "shared"}, 2 * ["rig"])])
def test_files_that_share_an_origin_are_one_session(
    rig: Rig, runs: dict[str, str], sessions: list[str]
) -> None:
    found = runs_of([table("one"), table("two")], replace(rig, runs=runs))
    assert [run.session.replace(rig.name, "rig") for run in found] == sessions


@pytest.mark.parametrize("motor", ["current_a", "current_b"])
def test_a_current_below_nothing_is_refused_but_for_its_noise(rig: Rig, motor: str) -> None:
    least = np.full(ROWS, 0.5)
    least[7] = -0.008  # of steps of 3 mA: less than three
    runs_of([table(**{motor: least})], rig)
    least[7] = -0.0095
    with pytest.raises(CalibrationInputError, match="A motor pulls one way only") as caught:
        runs_of([table(**{motor: least})], rig)
    assert f"{motor}_column" in str(caught.value) and "one.csv" in str(caught.value)


def test_currents_that_stop_at_the_end_of_their_converter_are_left_out(rig: Rig) -> None:
    sine = np.sin(2 * pi * PERIOD_S * np.arange(ROWS))
    columns = {
        name: np.minimum(np.round((1.0 + sign * sine) / 0.003) * 0.003, 1.5)
        for name, sign in (("current_a", 1.0), ("current_b", -1.0))
    }
    records = [table(name, effort=0.2 * sine, **columns) for name in ("one", "two")]
    stopped = sum(int(np.sum(column >= 1.5)) for column in columns.values())
    for run in runs_of(records, rig):
        assert run.scales["adc_end_A"] == pytest.approx(1.5 - 0.0015)
        assert run.notes == [f"{run.name}: {stopped} currents stop at 1.5 A, left out"]
