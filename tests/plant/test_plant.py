"""The axis behind its pins: what the paper's tables and sections say about the machine."""

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plant import model
from plant.gears import RATIO
from plant.grid import TRUTH_COLUMNS
from plant.kernels import layout as at
from plant.plant import Plant
from plant.units import ARCSEC
from tests.plant.bench import SECOND, bare, changed, truth

COLUMN = {name: k for k, name in enumerate(TRUTH_COLUMNS)}


def frictionless(**values: float) -> Plant:
    """Return a plant whose RA axis has (next to) no friction, damping and play."""
    base = changed(
        bare(), friction__coulomb=1e-4, friction__stiction=1e-4, friction__viscous=0.0,
        friction__bristle_damping=0.0,
        friction__bristle_stiffness=1e4, gear__damping=0.0, **values,
    )  # fmt: skip
    return Plant(base, 1)


@pytest.mark.parametrize(("row", "inertia", "published_hz"), [(0, 2200.0, 5.96), (1, 579.0, 10.37)])
def test_P1_lock_rotor_frequency(row: int, inertia: float, published_hz: float) -> None:
    """Table 1: with both rotors locked and both trains in contact the axis swings at the published
    frequency.
    """
    plant = Plant(bare(), 1)
    w = plant.world[row]
    w[at.INERTIA] = inertia  # Table 1's, before the weight removal
    w[at.ROTOR_INERTIA] = 1e9  # locked
    w[at.HALF_PLAY] = w[at.GEAR_DAMPING] = 0.0
    w[at.DECLARED_FRICTION + at.F_COULOMB] = w[at.DECLARED_FRICTION + at.F_STICTION] = 1e-4
    w[at.DECLARED_FRICTION + at.F_SIGMA1] = w[at.DECLARED_FRICTION + at.F_SIGMA2] = 0.0
    for m in range(2):
        w[at.MOTORS + m * at.MOTOR_SIZE + at.M_ANGLE] = 0.0
    w[at.ANGLE] = 20 * ARCSEC
    rows: dict[str, list[np.ndarray]] = {"ra": [], "dec": []}
    plant.record(lambda axis, part: rows[axis].append(part), 5_000_000)
    plant.advance(8 * SECOND)
    plant.flush()
    angle = np.concatenate(list(rows.values())[row])[:, COLUMN["angle"]]
    crossings = np.flatnonzero((angle[:-1] < 0) & (angle[1:] >= 0))
    exact = crossings + angle[crossings] / (angle[crossings] - angle[crossings + 1])
    frequency = (len(exact) - 1) / ((exact[-1] - exact[0]) * 0.005)
    assert frequency == pytest.approx(published_hz, abs=0.01)


def test_spring_keeps_its_energy() -> None:
    """Without damping the swing after 100 s is that of the start: the integrator neither feeds nor drains."""
    plant = frictionless(gear__backlash=0.0)
    w = plant.world[0]
    w[at.ROTOR_INERTIA] = 1e9
    for m in range(2):
        w[at.MOTORS + m * at.MOTOR_SIZE + at.M_ANGLE] = 0.0
    w[at.ANGLE] = 100 * ARCSEC
    rows: list[np.ndarray] = []
    plant.record(lambda axis, part: rows.append(part) if axis == "ra" else None, 5_000_000)
    plant.advance(100 * SECOND)
    plant.flush()
    angle = np.concatenate(rows)[:, COLUMN["angle"]]
    assert np.abs(angle[-400:]).max() == pytest.approx(np.abs(angle[:400]).max(), rel=0.01)


def test_P2_motors_turn_360_489_times_as_fast_as_the_axis() -> None:
    plant = Plant(bare(), 1)
    rows = truth(plant, 20.0, (0.5, 0.05))
    turned = rows[-1] - rows[len(rows) // 2]
    assert turned[COLUMN["motor_angle_a"]] / turned[COLUMN["angle"]] == pytest.approx(360.489, rel=1e-4)
    counts = [plant.ra.tachometer(20 * SECOND, m) for m in (0, 1)]
    assert counts[0] == pytest.approx(rows[-1][COLUMN["angle"]] * RATIO / (2 * pi) * 4096, rel=1e-3)
    assert counts[1] == pytest.approx(counts[0], rel=1e-3)


def test_P3_backlash_is_21_deg_at_each_motor() -> None:
    """On a locked axis, motor A rests against one flank and motor B against the other, 21 deg apart."""
    plant = Plant(bare(), 1)
    w = plant.world[0]
    w[at.INERTIA] = 1e12
    for m in range(2):
        w[at.MOTORS + m * at.MOTOR_SIZE + at.M_ANGLE] = 0.0
    rows = truth(plant, 30.0, (0.02, 0.02))
    apart = np.degrees(rows[-1][COLUMN["motor_angle_a"]] - rows[-1][COLUMN["motor_angle_b"]])
    wind_up = np.degrees(
        (rows[-1][COLUMN["gear_torque_a"]] - rows[-1][COLUMN["gear_torque_b"]]) / w[at.GEAR_STIFFNESS] * RATIO
    )
    assert apart - wind_up == pytest.approx(21.0, abs=0.05)


def test_P3_counter_torque_keeps_teeth_in_contact_at_reversal() -> None:
    """With the counter torque the lagging train never lets go; without it, there is a gap."""
    for split, lost in ((0.25, False), (0.0, True)):
        plant = Plant(bare(), 1)
        rows = truth(plant, 10.0, (0.4, 0.4 * split))
        assert (np.abs(rows[300:, COLUMN["gear_torque_b"]]) < 1e-6).any() == lost


@given(st.floats(0, 1), st.floats(0, 1), st.floats(-0.03, 0.03))
@settings(max_examples=25, deadline=None)
def test_P4_motors_pull_in_one_direction_only(duty_a: float, duty_b: float, rate: float) -> None:
    """Low-side switches: whatever duty and speed, no current is negative, so A pulls + and B pulls - or not
    at all.
    """
    plant = Plant(bare(), 1)
    w = plant.world[0]
    w[at.RATE] = w[at.RATE_BEFORE] = rate
    for m in range(2):
        o = at.MOTORS + m * at.MOTOR_SIZE
        w[o + at.M_RATE] = w[o + at.M_RATE_BEFORE] = rate * RATIO
    rows = truth(plant, 0.3, (duty_a, duty_b))
    assert rows[:, COLUMN["current_a"]].min() >= 0.0
    assert rows[:, COLUMN["current_b"]].min() >= 0.0


@pytest.mark.parametrize(("duties", "sign"), [((0.5, 0.05), 1), ((0.05, 0.5), -1)])
def test_P4_A_pulls_plus_and_B_pulls_minus(duties: tuple[float, float], sign: int) -> None:
    plant = Plant(bare(), 1)
    assert np.sign(truth(plant, 3.0, duties)[-1][COLUMN["rate"]]) == sign


def test_P4_stalled_current_follows_ohms_law_with_switch_and_sense_resistor() -> None:
    plant = Plant(bare(), 1)
    truth(plant, 1.0, (0.1, 0.0))
    m = bare().axes.ra.motor
    expected = 0.1 * 24.0 / (m.resistance.si + 0.085 + 0.1)
    ripple = 24.0 / (2 * m.inductance.si * 20e3) * 0.1 * 0.9
    assert plant.ra.current(SECOND, 0) == pytest.approx(expected + ripple, rel=1e-3)


def test_P7_incremental_count_is_0_01148_arcsec() -> None:
    plant = Plant(bare(), 1)
    truth(plant, 5.0, (0.5, 0.05))
    for t in range(5 * SECOND, 5 * SECOND + 100_000_000, 7_777_777):
        angle, _ = plant.ra.truth(t)
        assert plant.ra.incremental(t) == pytest.approx(angle / ARCSEC / 0.0114796, rel=1e-5)


def test_P7_counts_are_floored_so_the_error_is_within_one_count() -> None:
    plant = Plant(bare(), 3)
    truth(plant, 5.0, (0.5, 0.05))
    quantum = 2 * pi / (4.608e6 * 24.5)
    errors = [
        plant.ra.truth(t)[0] / quantum - plant.ra.incremental(t)
        for t in (5 * SECOND + k * 1_000_003 + k * k * 977 for k in range(200))
    ]
    assert max(errors) - min(errors) < 1.0
    assert max(errors) - min(errors) > 0.9


def test_P8_P10_absolute_is_29_bit_and_auxiliary_17_bit_geared_10_8() -> None:
    start = 2**29 - 50  # just below the wrap
    plant = Plant(bare(), 1, {"ra": start, "dec": 1000.5})
    assert plant.ra.absolute(0) == start
    assert plant.dec.absolute(0) == 1000
    assert plant.ra.auxiliary(0) == int(start / 2**29 * 10.8 * 2**17) % 2**17
    truth(plant, 5.0, (0.5, 0.05))
    angle, _ = plant.ra.truth(5 * SECOND)
    assert plant.ra.absolute(5 * SECOND) == int(angle / (2 * pi) * 2**29) % 2**29
    assert plant.ra.absolute(5 * SECOND) < start


def test_nobody_notices_who_looks_and_how_often() -> None:
    quiet, busy = (Plant(model.load(), 5) for _ in range(2))
    for plant in (quiet, busy):
        plant.ra.drive(1_234_567, 0.5, 0.05)
    for t in range(0, 2 * SECOND, 3_333_333):
        busy.ra.incremental(t)
        busy.dec.absolute(t)
        busy.advance(t // 2)  # the past: no effect
    quiet.advance(2 * SECOND)
    busy.advance(2 * SECOND)
    assert np.array_equal(quiet.world, busy.world)


def test_same_seed_same_plant_other_seed_other_encoder_phase() -> None:
    worlds = [Plant(model.load(), seed).world for seed in (1, 1, 2)]
    assert np.array_equal(worlds[0], worlds[1])
    assert not np.array_equal(worlds[0], worlds[2])


def test_a_duty_set_within_a_step_counts_for_the_rest_of_it() -> None:
    """Half a step of full duty moves as much current as a whole step of half duty."""
    half, whole = (Plant(bare(), 1) for _ in range(2))
    step = half.grid_ns
    half.ra.drive(10 * step + step // 2, 0.2, 0.0)
    half.ra.drive(11 * step, 0.0, 0.0)
    whole.ra.drive(10 * step, 0.1, 0.0)
    whole.ra.drive(11 * step, 0.0, 0.0)
    for plant in (half, whole):
        plant.advance(11 * step)
    assert half.world[0, at.MOTORS + at.M_CURRENT] == whole.world[0, at.MOTORS + at.M_CURRENT] > 0.0


def test_truth_arrives_in_chunks_without_holes() -> None:
    plant = Plant(bare(), 1)
    rows: list[np.ndarray] = []
    plant.record(lambda axis, part: rows.append(part) if axis == "dec" else None)
    for t in range(0, 12 * SECOND + 1, 1_700_000):
        plant.advance(t)
    plant.advance(12 * SECOND)
    plant.record(None)
    t_column = np.concatenate(rows)[:, 0]
    assert np.allclose(t_column, np.arange(1, 1201) * 0.01)


def test_errors_of_use_are_one_line() -> None:
    plant = Plant(bare(), 1)
    with pytest.raises(ValueError, match=r"0\.\.1"):
        plant.ra.drive(0, 1.2, 0.0)
    with pytest.raises(ValueError, match="multiple of the grid"):
        plant.record(lambda axis, part: None, 300_000)
    with pytest.raises(ValueError, match="'rightascension' is not known"):
        Plant(bare(), 1, {"rightascension": 1.0})
