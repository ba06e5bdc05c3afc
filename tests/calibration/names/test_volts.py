"""Electrical names have one set of columns, for a rig's one winding and for an axis' two motors."""

import numpy as np
import pytest

from calibration.balances.problem import Problem
from calibration.balances.volts import Counter, Windings
from calibration.finding import UNKNOWN, Finding, Parameter
from calibration.names import NAMES
from calibration.names.inplant import Facts
from calibration.names.scene import Scene
from tests.calibration.axisscene import stacked

ROWS, PERIOD_S, R, K, V = 400, 0.05, 2.0, 0.4, 24.0
T = PERIOD_S * np.arange(ROWS)
EFFORT, SPIN = 0.2 + 0.05 * np.sin(T), 2.0 + np.sin(0.3 * T)


def scene(motors: int, measured: bool = False) -> Scene:
    """A balance without a filter; of two motors the second holds a tenth of the effort and is dragged."""
    share, spin = np.repeat([1.0, 0.1], ROWS), np.concatenate([SPIN, 0 * SPIN])
    rows = slice(0, motors * ROWS)
    duty = np.tile(EFFORT, 2) * share
    current = (duty * V - K * spin) / R
    label = np.zeros(2 * ROWS, dtype=np.int64)
    problem = Problem(
        channel="E", unit="V", y=(duty * V)[rows], base=np.column_stack([current, spin])[rows],
        base_labels=[("resistance", "ohm"), ("torque_constant", "N m/A")], t=np.tile(T, 2)[rows],
        run=label[rows], session=label[rows], valid=np.ones(motors * ROWS, dtype=bool),
        held=np.tile(T, 2)[rows] > 15.0, period_s=PERIOD_S,
    )  # fmt: skip
    found = stacked(problem, np.cumsum(SPIN) * 1e-5, {"resistance": R, "torque_constant": K})
    counter = Counter(share=share, lagging=(share < 1) * 1.0, dragged=(share < 1) * 0.1)
    if motors == 1:
        found.pair = None
    none = np.zeros(0)
    found.windings = Windings(
        at=lambda full: full, current=current[rows], rate=spin[rows], clock=problem.t,
        duty=none if measured else duty[rows], supply=none if measured else np.full(motors * ROWS, V),
        counter=counter if motors == 2 else None, resistance=R, constant=K,
    )  # fmt: skip
    return found


@pytest.mark.parametrize(
    ("name", "of_one", "of_two"),
    [
        ("adc_gain", 0, 2),  # of one it is the declared resistance
        ("adc_offset", 1, 3),
        ("diode_braking", 0, 1),
        ("backlash_loss", 0, 1),
        ("supply_sag", 1, 2),
        ("winding_heating", 2, 2),
    ],
)
def test_a_name_is_offered_where_it_can_be_seen(name: str, of_one: int, of_two: int) -> None:
    for motors, count in ((1, of_one), (2, of_two)):
        found = NAMES[name].columns(scene(motors))
        assert len(found) == count
        assert {c.columns.shape[0] for c in found} <= {motors * ROWS}


def test_behind_a_declared_diode_no_motor_brakes_by_another() -> None:
    found = scene(2)
    assert found.windings is not None and found.windings.counter is not None
    found.windings.counter.dragged[:] = 0.0  # as calibration/balances/electrical.py has it there
    assert NAMES["diode_braking"].columns(found) == []


def test_measured_volts_have_lost_what_a_bridge_and_a_supply_take() -> None:
    for name in ("pwm_deadband", "supply_sag"):
        assert NAMES[name].columns(scene(1, measured=True)) == []
        assert NAMES[name].lacks(scene(1, measured=True)).startswith("a column of the duty")
        assert NAMES[name].lacks(scene(1)) == ""


def test_motors_are_counted_as_the_plant_counts_them() -> None:
    found = NAMES["adc_gain"].columns(scene(2))
    assert [c.fixed["motor"] for c in found] == [(1.0, "1 A, 2 B"), (2.0, "1 A, 2 B")]
    assert not found[0].columns[ROWS:].any() and not found[1].columns[:ROWS].any()


def test_a_supply_gives_way_to_all_that_is_drawn_from_it() -> None:
    alone, both = (NAMES["supply_sag"].columns(scene(n))[0].columns[:, 0] for n in (1, 2))
    duty, current = EFFORT, (EFFORT * V - K * SPIN) / R
    drawn = duty * current + 0.1 * duty * (0.1 * duty * V / R)
    assert alone == pytest.approx(duty * duty * current)
    assert both == pytest.approx(np.concatenate([duty * drawn, 0.1 * duty * drawn]))


def test_a_knee_is_no_parameter_of_a_dead_band() -> None:
    band = {"deadband": Parameter(0.01, "1"), "knee": Parameter(0.012, "1")}
    f = NAMES["pwm_deadband"].retold(Finding("pwm_deadband", "E", "command", parameters=band), {})
    assert list(f.parameters) == ["deadband"] and f.note == ""
    wide = band | {"knee": Parameter(0.2, "1")}
    other = NAMES["pwm_deadband"].retold(Finding("pwm_deadband", "E", "command", parameters=wide), {})
    assert other.name == UNKNOWN and "knee" in other.parameters


def test_what_the_plant_lacks_is_noted_and_stands_in_its_remarks() -> None:
    p = {"resistance": Parameter(0.2, "ohm"), "of_the_sum": Parameter(1.0, "choice")}
    f = NAMES["supply_sag"].retold(Finding("supply_sag", "E", "current", parameters=p), {})
    assert list(f.parameters) == ["resistance"] and "motors' currents" in f.note
    assert NAMES["supply_sag"].to_plant(f, Facts("log")).remarks == [f"supply_sag: {f.note}"]
