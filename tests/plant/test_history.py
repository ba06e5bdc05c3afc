"""What an axis remembers of the motion before a log: its cable, its windings, and masses that swing along."""

from math import exp

import numpy as np
import pytest

from plant import loop
from plant.effects import REGISTRY, unknown
from plant.effects import signals as sig
from plant.evaluate import signals
from plant.kernels import layout as at
from plant.loop import Excitation, simulate
from plant.model import PlantModel, with_effects
from plant.parts import EffectModel, Function, Number
from plant.rows import KINDS
from plant.units import ARCSEC
from plant.world import build
from tests.plant.bench import bare

WIDTH, TAU_S, RTH = 0.01, 600.0, 1.5
EFFECTS = (
    EffectModel("gravity_imbalance"),  # keeps nothing
    EffectModel("cable_wrap", parameters={"width": Number(WIDTH, "rad", "")}),
    EffectModel(
        "winding_heating",
        parameters={
            "thermal_resistance": Number(RTH, "K/W", ""), "time_constant": Number(TAU_S, "s", "")
        },
    ),
    EffectModel("structural_mode"),
)  # fmt: skip


def model() -> PlantModel:
    return with_effects(bare(), "ra", EFFECTS)


def memories(w: np.ndarray) -> list[np.ndarray]:
    """Memory of each effect, in the order of EFFECTS; rows stand by the hooks."""
    rows = w[at.EFFECTS : at.EFFECTS + at.ROW * int(w[at.ROWS_ALL])].reshape(-1, at.ROW)
    kinds = [int(kind) for kind in rows[:, at.ROW_KIND]]
    place = [kinds.index(KINDS[REGISTRY[each.name].terms[0].formula]) for each in EFFECTS]
    return [rows[k, at.ROW_MEMORY : at.ROW_MEMORY + sig.MEMORY - 1] for k in place]


def test_a_cable_and_windings_have_the_state_of_the_motion_before() -> None:
    """Dahl: 1 - exp(-travel / width). A winding: Rth R i^2 (1 - exp(-t / tau)), each its own."""
    w = build(model(), 1, {"ra": 0.0})[0]
    before = [part.copy() for part in memories(w)]
    seconds, rate = np.arange(0.0, 60.01, 0.5), 1e-4
    amperes = (2.0, 0.5)
    history = np.stack(
        [
            signals(
                len(seconds),
                {sig.TIME: seconds, sig.RATE: np.full(121, rate), sig.CURRENT: np.full(121, i),
                 sig.MOTOR: np.full(121, m)},
            )
            for m, i in enumerate(amperes)
        ]
    )  # fmt: skip
    loop._remember(w, history)
    gravity, cable, windings, mode = memories(w)
    assert cable[0] == pytest.approx(1 - exp(-60.0 * rate / WIDTH))
    ohm = bare().axes.ra.motor.resistance.si
    warm = [RTH * ohm * i**2 * (1 - exp(-60.0 / TAU_S)) for i in amperes]
    assert windings[:2] == pytest.approx(warm)
    assert np.array_equal(gravity, before[0]) and np.array_equal(mode, before[3])


def test_a_mass_that_swings_along_has_the_axis_rate_at_the_start() -> None:
    w = build(model(), 1, {"ra": 0.0})[0]
    loop._start(w, 3e-4)
    gravity, cable, windings, mode = memories(w)
    assert mode == pytest.approx([0.0, 3e-4, 3e-4])  # lead, rate, the axis' rate
    assert not gravity.any() and not cable.any() and not windings.any()


def test_a_log_begins_with_the_state_of_its_history() -> None:
    """A warm winding, 40 K above the air: copper has 0.393 % more per kelvin, and the current is less."""
    rows = 20_001
    history = np.stack(
        [
            signals(
                rows,
                {sig.TIME: np.arange(rows), sig.CURRENT: np.full(rows, 3.0), sig.MOTOR: np.full(rows, m)},
            )
            for m in (0.0, 1.0)
        ]
    )
    heated = with_effects(bare(), "ra", EFFECTS[2:3])
    ohm = bare().axes.ra.motor.resistance.si
    loop_ohm = bare().axes.ra.motor.loop
    cold, warm = (
        simulate(heated, "ra", 0.5, Excitation(effort=600.0, history=given), adc_counts_per_A=400.0)
        for given in (None, history)
    )
    rise = RTH * ohm * 9.0
    expected = loop_ohm / (loop_ohm + ohm * 0.00393 * rise)
    # 50 ms: the current has risen, and the motor in its play has hardly any EMF
    assert warm.adc_a[5] / cold.adc_a[5] == pytest.approx(expected, rel=0.02)


def test_a_start_in_motion_is_half_a_step_ahead() -> None:
    """Places are kept at the grid's step, rates in its middle; motors turn with the axis."""
    w = build(bare(), 1, {"ra": 0.0})[0]
    angle, motors = w[at.ANGLE], [w[at.MOTORS + m * at.MOTOR_SIZE + at.M_ANGLE] for m in (0, 1)]
    rate = 15.041 * ARCSEC
    loop._start(w, rate)
    half = 0.5 * w[at.GRID] * rate
    assert w[at.ANGLE] - angle == pytest.approx(half)
    for m, before in enumerate(motors):
        motor = w[at.MOTORS + m * at.MOTOR_SIZE :]
        assert motor[at.M_RATE] == motor[at.M_RATE_BEFORE] == pytest.approx(rate * w[at.RATIO])
        assert motor[at.M_ANGLE] - before == pytest.approx(half * w[at.RATIO])
    f = bare().axes.ra.friction
    level = f.coulomb.si + (f.stiction.si - f.coulomb.si) * exp(
        -((rate / f.stribeck_rate.si) ** f.stribeck_exponent.si)
    )
    assert w[at.FRICTION] == pytest.approx(level + f.viscous.si * rate)
    assert w[at.BRISTLE] == pytest.approx(level / f.bristle_stiffness.si)


def test_stops_found_in_data_have_the_state_of_the_motion_before() -> None:
    """A stop of 0.2 rad after half a radian up and 0.1 back: 0.2 less 0.1."""
    function = Function("torque", "axis_angle", "stop", 0.0, ((0.2, 30.0),), "a test")
    w = build(with_effects(bare(), "ra", (EffectModel("unknown", function=function),)), 1, {})[0]
    angle = np.array([0.0, 0.25, 0.5, 0.4])
    history = np.stack([signals(4, {sig.TIME: np.arange(4.0), sig.ANGLE: angle})] * 2)
    loop._remember(w, history)
    row = w[at.EFFECTS + at.ROW_MEMORY : at.EFFECTS + at.ROW]
    assert row[:2] == pytest.approx([0.4, 1.0])
    assert unknown.stops(row) == pytest.approx(30.0 * 0.1 / 0.2)
