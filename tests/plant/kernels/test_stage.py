"""The averaged power stage against the same circuit switch by switch, and what a plant makes of it."""

import itertools

import numpy as np
import pytest

from plant import model
from plant.compiled import Floats
from plant.gears import RATIO
from plant.kernels import layout as at
from plant.kernels.stage import closed_share, peak_current, rail, stage
from plant.model import PlantModel
from plant.plant import Plant
from plant.units import ARCSEC
from tests.plant.bench import SECOND, changed, switching
from tests.plant.stage import Circuit, run

STEPS = 3000
DUTIES = (10, 20, 36, 45, 87, 90, 105, 150, 300, 1000, 3000)  # PWM steps
RATES = (0, 15, -15, 600, -600, 3600, -3600, 10800, -10800)  # arcsec/s of the axis: up to 3 deg/s
SUPPLIES = (21.6, 24.0, 26.4)  # V: ten per cent
GRID_S = 5e-4
MOTORS: dict[str, dict[str, float]] = {
    "fitted": {},
    # hardware.md 2.3: with the diode 0.33 N m/A and 1.4 ohm; 2.4: L/R from 0.8 to 5 ms
    "fast": {"motor__torque_constant": 0.33, "motor__resistance": 1.215, "motor__inductance": 1.12},
    "slow": {"motor__torque_constant": 0.33, "motor__resistance": 1.215, "motor__inductance": 7.0},
}
POINTS = list(itertools.product(DUTIES, RATES, SUPPLIES))


def bridge(motor: str = "fitted") -> PlantModel:
    """The bridge plant with one of the motors and its power stage."""
    return changed(switching("low_preload_bridge"), **MOTORS[motor])


def row(motor: str) -> Floats:
    """RA's row of that plant."""
    found: Floats = Plant(bridge(motor), 1).world[0]
    return found


def circuit(w: Floats, voltage: float) -> Circuit:
    """The circuit of a row."""
    winding = float(w[at.WINDING])
    switch = float(w[at.RESISTANCE]) - winding
    return Circuit(voltage, float(w[at.DIODE_DROP]), winding, switch, float(w[at.INDUCTANCE]), 50e-6)


def near(found: float, true: float) -> bool:
    """Two per cent or 2 mA."""
    return abs(found - true) <= max(0.02 * abs(true), 2e-3)


def settled(w: Floats, duty: float, voltage: float, emf: float) -> tuple[float, float, float]:
    """Valley, mean and supply current of the averaged stage at rest, A."""
    valley, last = 0.0, (0.0, 0.0)
    for _ in range(1000):
        valley, *now = stage(w, valley, duty, voltage, emf, 0.0, GRID_S)
        if now == pytest.approx(last, rel=1e-9, abs=1e-12):
            break
        last = (now[0], now[1])
    return valley, now[0], now[1]


def outside(motor: str, points: list[tuple[int, int, float]]) -> list[object]:
    """Points at which mean, supply current or peak differ by more than is allowed."""
    w, found = row(motor), list[object]()
    for steps, rate, voltage in points:
        emf, duty = float(w[at.TORQUE_CONSTANT]) * RATIO * rate * ARCSEC, steps / STEPS
        valley, mean, drawn = settled(w, duty, voltage, emf)
        w[at.VALLEY], w[at.DUTY], w[at.VOLTAGE] = valley, duty, voltage
        peak = peak_current(w, 0, emf)
        c = circuit(w, voltage)
        periods = round(8.0 * c.inductance / c.winding / c.period)  # what the start is wrong by has gone
        _, *true = run(c, duty, emf, valley, periods)
        if not all(near(a, b) for a, b in zip((mean, drawn, peak), true, strict=True)):
            found.append((steps, rate, voltage, (mean, drawn, peak), true))
    return found


@pytest.mark.parametrize("motor", MOTORS)
def test_P4_the_averaged_stage_is_the_switched_one_at_a_few_points(motor: str) -> None:
    assert not outside(motor, POINTS[7::41])


@pytest.mark.slow
@pytest.mark.parametrize("motor", MOTORS)
def test_P4_the_averaged_stage_is_the_switched_one_over_duty_speed_and_supply(motor: str) -> None:
    assert not outside(motor, POINTS)


@pytest.mark.parametrize(("before", "after"), [(1000, 45), (45, 1000), (300, 0)])
def test_P4_a_step_of_the_duty_runs_through_the_same_currents(before: int, after: int) -> None:
    w = row("fitted")
    emf = float(w[at.TORQUE_CONSTANT]) * RATIO * 600 * ARCSEC
    valley, start, _ = settled(w, before / STEPS, 24.0, emf)
    c, current, averaged, switched = circuit(w, 24.0), valley, [], []
    for _ in range(100):
        valley, mean, _ = stage(w, valley, after / STEPS, 24.0, emf, 0.0, GRID_S)
        averaged.append(mean)
        each = []
        for _ in range(10):
            current, of_period, *_ = run(c, after / STEPS, emf, current, 1)
            each.append(of_period)
        switched.append(np.mean(each))
    assert averaged == pytest.approx(switched, abs=0.02 * max(start, mean))


@pytest.mark.parametrize(
    "duties", [(45, 45), (600, 60), (60, 600), (1800, 180)], ids=["stands", "forward", "back", "fast"]
)
def test_P4_both_motors_of_a_plant_carry_the_currents_of_their_circuits(duties: tuple[int, int]) -> None:
    plant = Plant(bridge(), 1)
    plant.ra.drive(0, *(steps / STEPS for steps in duties))
    plant.advance(10 * SECOND)
    w = plant.world[0]
    for m, steps in enumerate(duties):
        motor = at.MOTORS + m * at.MOTOR_SIZE
        emf = float(w[at.TORQUE_CONSTANT] * w[motor + at.M_RATE]) * (1 - 2 * m)
        _, mean, _, peak = run(circuit(w, 24.0), steps / STEPS, emf, float(w[at.VALLEY + m]), 2000)
        assert near(w[motor + at.M_CURRENT], mean)
        assert near(w[at.OUT + at.OUT_CURRENT_A + m], peak)


def test_P4_a_short_pulse_drives_next_to_nothing_through_a_diode() -> None:
    """By hand at 45 steps: 0.75 us of 24 V, then 0.7 V down: i = V (V + drop) t^2 / (2 drop L T)."""
    _, mean, _ = settled(row("fitted"), 45 / STEPS, 24.0, 0.0)
    on, drop, inductance, period = 0.75e-6, 0.7, 2.72e-3, 50e-6
    assert mean == pytest.approx(24.0 * 24.7 * on**2 / (2 * drop * inductance * period), rel=0.02)


def by_hand() -> Floats:
    """24 V, 2 ohm and 0.5 ohm of the switch, 5 mH, a drop of 0.7 V, 20 kHz: 0.01 A/V in a period."""
    w = np.zeros(at.WIDTH)
    w[at.VOLTAGE], w[at.WINDING], w[at.RESISTANCE], w[at.INDUCTANCE], w[at.PULSE] = 24.0, 2.0, 2.5, 5e-3, 0.01
    w[at.DIODE_DROP] = 0.7
    return w


@pytest.mark.parametrize(("steps", "share"), [(300, 0.1), (12, 0.004), (6, 0.001), (3, 0.00025), (0, 0.0)])
def test_P4_a_pulse_of_less_than_200_ns_is_a_triangle(steps: int, share: float) -> None:
    """12 steps of 3000 are 200 ns; half of them reach half as high, for half as long."""
    assert closed_share(by_hand(), steps / STEPS) == pytest.approx(share)


def test_P4_the_rail_sags_by_what_both_axes_drew() -> None:
    w = by_hand()
    w[at.SUPPLY_RESISTANCE], w[at.SUPPLY_CURRENT], w[at.OTHERS_SAG] = 0.5, 2.0, 0.25
    assert rail(w) == 22.75


@pytest.mark.parametrize(("valley", "duty", "heated"), [(1.0, 0.5, 0.5), (0.0, 0.2, 0.0)])
def test_P4_a_current_that_never_ends_by_hand(valley: float, duty: float, heated: float) -> None:
    """3 V of EMF: with the switch closed it climbs by what 24 V leave over.

    Mean volts of a period less those of the resistance are L di.
    """
    h, volts, ohm = 1e-3, duty * 24.7 - 3.7, 2.0 + heated + duty * 0.5
    goal = volts / ohm - 0.5 * (21.0 - (2.5 + heated) * valley) * duty * 0.01
    end, mean, drawn = stage(by_hand(), valley, duty, 24.0, 3.0, heated, h)
    assert end == pytest.approx(goal + (valley - goal) * np.exp(-ohm * h / 5e-3))
    assert (end - valley) * 5e-3 == pytest.approx(h * (volts - ohm * mean))
    assert drawn == pytest.approx(duty * mean)


@pytest.mark.parametrize(("duty", "emf", "mean", "drawn"), [
    (0.05, 10.0, 0.0035 * (0.05 + 0.007 / (0.01 * 10.707)), 0.0035 * 0.05),  # 14 V for 2.5 us: 7 mA, and down
    (0.5, 11.6, 0.5 * 0.062, 0.5 * 0.062 * 0.5),  # just about the whole period
    (0.5, 23.5, 0.00125 * (0.5 + 0.0025 / 0.242025), 0.00125 * 0.5),  # half a volt drives it
    (0.5, 30.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0),  # nothing drives it
])  # fmt: skip
def test_P4_a_current_that_ends_in_every_period_by_hand(
    duty: float, emf: float, mean: float, drawn: float
) -> None:
    assert stage(by_hand(), 0.0, duty, 24.0, emf, 0.0, 1e-3) == pytest.approx((0.0, mean, drawn))


@pytest.mark.parametrize("duty", [0.0, 0.05])
def test_P4_a_current_that_ends_within_a_step(duty: float) -> None:
    """Valley of 0.5 A against 10 V of EMF: by its own exponential to nothing, then as if it began so."""
    h, ohm = 1e-3, 2.0 + duty * 0.5
    half = 0.5 * (24.0 - 10.0 - 2.5 * 0.5) * duty * 0.01
    goal, tau = (duty * 24.7 - 10.7) / ohm - half, 5e-3 / ohm
    _, after, supply = stage(by_hand(), 0.0, duty, 24.0, 10.0, 0.0, h)
    t = (np.arange(100_000) + 0.5) * h / 100_000
    valleys = goal + (0.5 - goal) * np.exp(-t / tau)
    flows = valleys > 0.0
    mean = np.where(flows, valleys + half, after).mean()
    drawn = np.where(flows, duty * (valleys + half), supply).mean()
    assert 0.1 < flows.mean() < 0.9
    assert stage(by_hand(), 0.5, duty, 24.0, 10.0, 0.0, h) == pytest.approx((0.0, mean, drawn), rel=1e-4)


def test_P4_a_plant_without_a_declared_drop_has_no_stage() -> None:
    assert Plant(model.load("low_preload"), 1).world[0][at.PULSE] == 0.0
    assert row("fitted")[at.PULSE] > 0.0
