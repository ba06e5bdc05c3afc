"""What noise and counts leave of an axis with two motors; motors that stand or leave their teeth."""

from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.balances.electrical import _conducts, _spin, _windings
from calibration.balances.filters import Filter
from calibration.balances.floors import floors_of_pair
from calibration.balances.kinematic import _off_face, standing
from calibration.balances.torque import Transmission, slid
from plant.units import ARCSEC

ROWS, PERIOD_S = 3000, 0.01
RNG = np.random.default_rng(1)


def white(size: float) -> np.ndarray:
    return size * RNG.standard_normal(ROWS)


NOISE = {"position": 2 * ARCSEC, "velocity": 3e-5, "current_a": 0.05, "current_b": 0.08, "effort": 0.003}
LOG = {name: white(size) + (5.0 if "current" in name else 0.0) for name, size in NOISE.items()}
SCALE = {
    "position_arcsec_per_count": 0.1, "velocity_arcsec_per_count": 0.01, "velocity_window_s": 0.005,
    "adc_A_per_count": 0.001, "counter_torque": 0.1, "supply_V": 24.0, "tach_counts_per_turn": 500.0,
    "gear_ratio": 1000.0, "adc_end_A": 9.0,
}  # fmt: skip
DRIVE = Transmission(per_ampere=140.0, left={}, softness_s2=1e-4, stiffness=1e6)


def motion(width: int = 3, speed: float = 0.0, **columns: np.ndarray) -> Any:
    columns = columns or LOG
    full = {**LOG, **columns}
    frame = Some(
        scale=SCALE, columns=full, get=columns.get, period_s=PERIOD_S, filled=lambda name: (full[name], None)
    )  # fmt: skip
    rows = np.arange(width // 2, ROWS, width)
    return Some(
        frame=frame, width=width, filter=Filter(1.0, width), rows=rows, cell_s=width * PERIOD_S,
        speed=np.full(ROWS, speed), ok=np.ones(ROWS, dtype=bool),
    )  # fmt: skip


HELD = np.arange(ROWS) > 2000


def floors(
    m: Any, inertia: float = 0.0, resistance: float = 0.0, drive: Transmission = DRIVE
) -> dict[str, float]:
    return floors_of_pair(m, drive, HELD, inertia, resistance)


def test_a_torque_s_floor_is_the_currents_through_the_trains_and_the_position_through_the_inertia() -> None:
    """Behind two boxcars of three rows, with weights 1 2 3 2 1 over nine."""
    weights = np.array([0, 1, 2, 3, 2, 1, 0]) / 9
    second = np.array([1, 0, 0, -2, 0, 0, 1]) / 0.03**2
    amperes = 0.05**2 + 0.08**2
    force = 140**2 * np.sum((weights - 1e-4 * second) ** 2) * amperes
    assert floors(motion())["T"] == pytest.approx(np.sqrt(force), rel=0.05)
    heavy = (2e5 * 2 * ARCSEC) ** 2 * 6 / 0.03**4
    assert floors(motion(), 2e5)["T"] == pytest.approx(np.sqrt(force + heavy), rel=0.05)


def test_volts_have_a_current_through_the_resistance_and_half_a_tick_of_effort() -> None:
    averaged = 19 / 81  # squares of the weights
    tick = (24 * 0.003) ** 2 / 2 * (1 + 0.1**2) / 2
    known = np.sqrt(averaged * (2.0**2 * (0.05**2 + 0.08**2) / 2 + tick))
    assert floors(motion(), resistance=2.0)["E"] == pytest.approx(known, rel=0.05)
    one = floors(motion(position=LOG["position"], current_b=LOG["current_b"]), resistance=2.0)
    assert one["E"] == pytest.approx(np.sqrt(averaged) * 2.0 * 0.08, rel=0.05)
    none = floors(motion(position=LOG["position"]))
    assert set(none) == {"K"}


@pytest.mark.parametrize(("speed", "quick"), [(6.0e-4, False), (6.6e-4, True)])
def test_encoders_have_a_count_s_rounding_averaged_where_half_a_count_comes_a_row(
    speed: float, quick: bool
) -> None:
    """Of 500 000 counts a turn half a one in 10 ms: 2 pi 1e-4 rad/s."""
    averaged = 19 / 81
    count = 2 * np.pi / 500_000 / np.sqrt(12)
    wind = 0.08 * 140 / 1e6
    left = (averaged if quick else 1.0) * count**2 + averaged * ((2 * ARCSEC) ** 2 + wind**2)
    assert floors(motion(speed=speed))["K"] == pytest.approx(np.sqrt(left) / ARCSEC, rel=0.04)
    assert floors(motion(speed=-speed))["K"] == floors(motion(speed=speed))["K"]
    assert floors(motion())["S"] == pytest.approx(3e-5 * np.sqrt(averaged) / ARCSEC, rel=0.05)


def test_a_motor_stands_where_no_count_came_for_longer() -> None:
    spin = np.zeros(60)
    spin[[10, 12, 40]] = 1.0, -1.0, 1.0
    run = np.zeros(60, dtype=np.int64)
    assert np.flatnonzero(~standing(spin, run, 5)).tolist() == [0, *range(10, 18), *range(40, 46)]
    run[30:] = 1
    moving = [0, *range(10, 18), *range(30, 36), *range(40, 46)]
    assert np.flatnonzero(~standing(spin, run, 5)).tolist() == moving


def test_rows_off_the_wind_up_line_are_those_of_a_motor_that_left_its_teeth() -> None:
    """A line of 2 arcsec per N m, a level of its own in either segment, and rows 30 arcsec off."""
    torque = RNG.uniform(-5, 5, 400)
    segment = np.repeat([0, 1], 200)
    y = 2.0 * torque + np.where(segment == 0, 100.0, -50.0) + 0.1 * RNG.standard_normal(400)
    y[50:60] += 30.0
    y[300] -= 8.5
    y[301] -= 7.0
    centred, off = _off_face(y, torque, segment, np.ones(400, dtype=bool))
    assert np.flatnonzero(off).tolist() == [*range(50, 60), 300]
    assert centred[~off] == pytest.approx(2 * torque[~off], abs=7.5)
    assert np.median(np.abs(centred - 2 * torque)) < 0.2
    some = np.arange(400) % 2 == 0
    spoiled = np.where(some, y, 1e3 * RNG.standard_normal(400))
    centred, _ = _off_face(spoiled, torque, segment, some)
    assert np.median(np.abs(centred - 2 * torque)[some]) < 0.2


def test_rows_behind_unseen_ones_wait_for_a_path() -> None:
    m: Any = Some(x=np.array([0.0, 1.0, 2.0, 1.5, 1.0, 0.5, 0.0]))
    unseen = np.array([0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    assert slid(m, unseen, 1.4).tolist() == [True, False, False, True, True, True, True]
    assert slid(m, unseen, 1.5).tolist() == [True, False, False, False, True, True, True]


DECLARED: Any = Some(diode_drop=0.0, torque_constant=0.1, resistance=2.0)


def conducts(current: float, volts: float, speed: float, key: str = "a", declared: Any = DECLARED) -> bool:
    """Of a motor that turns a hundred times as quickly as the axis; a count is 0.01 A."""
    scale = {"gear_ratio": 100.0, "adc_A_per_count": 0.01}
    frame: Any = Some(
        scale=scale, filled=lambda _: (np.array([current]), np.array([True])), saturated=lambda i: i >= 5.0
    )
    m: Any = Some(speed=np.array([speed]))
    return bool(_conducts(frame, m, key, np.array([volts]), declared)[0])


def test_a_current_is_measured_where_four_counts_are_expected() -> None:
    """(V - K w) / R: 0.08 V over 2 ohm are four counts of 0.01 A; a count less is cut off."""
    assert conducts(1.0, 0.081, 0.0) and not conducts(1.0, 0.079, 0.0) and not conducts(5.0, 9.0, 0.0)
    assert conducts(1.0, 1.081, 0.1) and not conducts(1.0, 1.079, 0.1)
    assert conducts(1.0, 0.081, -0.1)  # dragged backwards it has no back-EMF
    assert conducts(1.0, 1.081, -0.1, "b") and not conducts(1.0, 1.079, -0.1, "b")
    diode: Any = Some(diode_drop=0.5, torque_constant=0.1, resistance=2.0)
    assert conducts(1.0, -0.9, -0.1, declared=diode) and not conducts(1.0, -0.93, -0.1, declared=diode)
    assert not conducts(1.0, -0.01, -0.1)


def test_a_motor_turns_as_the_axis_does_and_ahead_by_its_wind_up() -> None:
    rows = np.arange(1, 300, 3)
    current = 0.02 * np.arange(300.0)  # 2 A/s
    own = np.full(300, 31.0)
    frame: Any = Some(
        scale={"gear_ratio": 100.0, "tach_counts_per_turn": 500.0}, period_s=PERIOD_S,
        filled=lambda name: (own if name.startswith("motor") else current, np.ones(300, dtype=bool)),
        get=lambda name: own,
    )  # fmt: skip
    m: Any = Some(speed=np.full(300, 0.3), rows=rows, at=lambda full: full[rows])
    spin, engaged = _spin(frame, m, "a", 0.005)
    assert spin == pytest.approx(np.full(100, 0.3 * 100 + 2 * 0.005 * 100)) and engaged.all()
    assert _spin(frame, m, "b", 0.005)[0] == pytest.approx(np.full(100, -30.0 + 1.0))
    # 0.75 of a count per row: 0.942 rad/s
    own[151] = 31.0 + 0.93
    assert _spin(frame, m, "a", 0.005)[1].all()
    own[151] = 31.0 + 0.95
    assert np.flatnonzero(~_spin(frame, m, "a", 0.005)[1]).tolist() == [49, 50, 51]
    frame.get = lambda name: None
    assert _spin(frame, m, "a", 0.005)[1].all()


def test_columns_of_two_windings_stand_one_after_the_other() -> None:
    effort = np.repeat([0.5, -0.4], 30)
    columns = {"current_a": np.full(60, 1.0), "current_b": np.full(60, 2.0), "supply": np.full(60, 23.0)}
    frame: Any = Some(
        scale={"supply_V": 24.0, "counter_torque": 0.1}, get=columns.get,
        filled=lambda name: (columns[name], None), one_clock=np.arange(60.0),
        t=np.arange(60.0), runs=[], run=np.zeros(60, dtype=int),
    )  # fmt: skip
    rows = np.arange(1, 60, 3)
    m: Any = Some(rows=rows, at=lambda full: full[rows])
    spin = np.repeat([3.0, -2.0], 20)
    w = _windings(frame, m, effort, spin, DECLARED)
    assert w.current.tolist() == [1.0] * 60 + [2.0] * 60 and w.supply.tolist() == [23.0] * 120
    assert w.at(w.current).tolist() == [1.0] * 20 + [2.0] * 20
    assert w.rate.tolist() == [3.0] * 20 + [0.0] * 20 and w.clock.tolist() == [*rows, *rows]
    assert w.duty[[0, 59, 60, 119]] == pytest.approx([0.5, 0.04, 0.05, 0.4])
    assert w.counter is not None and w.counter.dragged.tolist() == [0.0] * 20 + [2.0] * 20
    assert w.counter.lagging.tolist() == [0.0] * 10 + [1.0] * 10 + [1.0] * 10 + [0.0] * 10
    diode: Any = Some(diode_drop=0.5)
    assert not _windings(frame, m, effort, spin, diode).counter.dragged.any()  # type: ignore[union-attr]
    del columns["supply"]
    assert _windings(frame, m, effort, spin, DECLARED).supply.tolist() == [24.0] * 120
