"""Effects in a step: the signals they see, the place where their values go, which motor has which."""

from math import cos, exp

import numpy as np
import pytest

from plant.compiled import Floats
from plant.effects import REGISTRY
from plant.effects import signals as sig
from plant.effects.signals import HOOK_COUNT, MOTOR_HOOKS, Hook
from plant.kernels import layout as at
from plant.kernels.dispatch import KINDS, TERMS, value
from plant.kernels.hooks import evaluate
from plant.kernels.step import axis_step
from plant.parts import EffectModel, Number
from plant.plant import Plant
from plant.rows import write
from tests.plant.bench import bare, with_effect

T, H = 20.0, 5e-4


def effect(name: str, **numbers: float) -> EffectModel:
    """An effect with these numbers, each in its own unit."""
    unit = REGISTRY[name].parameter
    given = {word: Number(value, unit(word).unit, "a test") for word, value in numbers.items()}
    return EffectModel(name, parameters=given)


@pytest.fixture
def row() -> Floats:
    """An axis whose every signal is another number."""
    w = np.zeros(at.WIDTH)
    w[at.GRID], w[at.ANGLE], w[at.RATE], w[at.REVERSED_AT], w[at.ACCELERATION] = H, 2.0, 0.25, 1.5, 0.125
    w[at.TEMPERATURE], w[at.WARMING], w[at.SUPPLY_CURRENT] = 10.0, 0.25, 6.0
    w[at.MOTORS : at.MOTORS + 2 * at.MOTOR_SIZE] = (5.0, 13.0, 0.0, 2.0, 40.0, -1.0, 7.5, 0.0, 1.0, -15.0)
    w[at.MEAN_DUTY], w[at.MEAN_DUTY + 1] = 0.5, 0.25
    w[at.DECLARED_FRICTION : at.DECLARED_FRICTION + at.FRICTION_SIZE] = range(101, 101 + at.FRICTION_SIZE)
    return w


def test_every_signal_is_that_of_the_step_and_of_its_motor(row: Floats) -> None:
    """B comes last, so that the vector is left with its signals."""
    row[at.SUMS : at.SUMS + HOOK_COUNT + MOTOR_HOOKS] = 9.0
    evaluate(row, T, H)
    x = row[at.SIGNALS : at.SIGNALS_END]
    expected = {
        sig.TIME: T, sig.ANGLE: 2.0, sig.RATE: 0.25, sig.REVERSAL: 0.5, sig.TEMPERATURE: 15.0,
        sig.SUPPLY_CURRENT: 6.0, sig.ACCELERATION: 0.125, sig.TORQUE: 25.0, sig.MOTOR: 1.0,
        sig.MOTOR_ANGLE: 7.5, sig.MOTOR_RATE: -1.0, sig.CURRENT: 1.0, sig.COMMAND: 0.25, sig.LAGGING: 1.0,
    }  # fmt: skip
    assert {place: x[place] for place in expected} == expected
    assert x[sig.SIGMA0 : sig.STRIBECK_EXPONENT + 2].tolist() == list(range(101, 109))
    assert not row[at.SUMS : at.SUMS + HOOK_COUNT + MOTOR_HOOKS].any(), "no effect, no sum"


PAIRS = [((0.5, 0.25), (0, 1)), ((0.25, 0.5), (1, 0)), ((0.5, 0.5), (0, 0))]


@pytest.mark.parametrize(("duties", "lost"), PAIRS)
def test_the_motor_with_the_lower_duty_lags(
    row: Floats, duties: tuple[float, float], lost: tuple[int, int]
) -> None:
    """Lost backlash compensation takes a share of the lagging motor's duty."""
    row[at.MEAN_DUTY : at.MEAN_DUTY + 2] = duties
    write(row, (effect("backlash_loss", loss=0.5),), {}, 1, "ra")
    evaluate(row, T, H)
    sums = row[at.SUMS + Hook.COMMAND], row[at.SUMS_OF_B + Hook.COMMAND]
    assert sums == pytest.approx([-0.5 * duty * each for duty, each in zip(duties, lost, strict=True)])


@pytest.mark.parametrize(("motor", "sums"), [(0, (0.5, 0.5)), (1, (0.5, 0.0)), (2, (0.0, 0.5))])
def test_an_effect_of_a_motor_is_at_that_one_and_those_of_a_hook_add_up(
    row: Floats, motor: int, sums: tuple[float, float]
) -> None:
    """Two offsets of 0.2 and 0.3 A; of the axis, whatever the motor: gravity, once."""
    effects = (
        effect("adc_offset", offset=0.2, motor=motor),
        effect("gravity_imbalance", amplitude=30.0, phase=0.5),
        effect("adc_offset", offset=0.3, motor=motor),
    )
    write(row, effects, {}, 1, "ra")
    evaluate(row, T, H)
    assert (row[at.SUMS + Hook.CURRENT], row[at.SUMS_OF_B + Hook.CURRENT]) == pytest.approx(sums)
    assert row[at.SUMS + Hook.AXIS_TORQUE] == pytest.approx(30.0 * cos(2.0 - 0.5))
    others = {Hook(k) for k in range(HOOK_COUNT)} - {Hook.CURRENT, Hook.AXIS_TORQUE}
    assert not any(row[at.SUMS + each] for each in others)


def test_a_memory_is_brought_to_the_step_before_its_value_is_taken(row: Floats) -> None:
    """A motor's winding warms with the loss of its own current: R i^2 Rth (1 - exp(-h / tau))."""
    numbers = {"thermal_resistance": 8.0, "time_constant": 10.0}
    write(row, (effect("winding_heating", **numbers),), {"winding": 2.0}, 1, "ra")
    evaluate(row, T, H)
    copper = 0.00393  # 1/K
    for sums, current in ((at.SUMS, 2.0), (at.SUMS_OF_B, 1.0)):
        warm = 2.0 * current**2 * 8.0 * (1.0 - exp(-H / 10.0))
        assert row[sums + Hook.RESISTANCE] == pytest.approx(2.0 * copper * warm, rel=0.02)


def test_a_friction_effect_changes_the_friction_of_this_step_alone(row: Floats) -> None:
    write(row, (effect("coulomb_change", factor=1.5),), {}, 1, "ra")
    for _ in range(2):
        evaluate(row, T, H)
        assert row[at.FRICTION_NOW + at.F_COULOMB] == pytest.approx(1.5 * 104.0)
    assert row[at.DECLARED_FRICTION + at.F_COULOMB] == 104.0


def test_a_kind_that_is_none_has_no_value() -> None:
    assert value(len(TERMS), np.zeros(sig.VECTOR), np.zeros(at.ROW)) == 0.0
    assert sorted(KINDS.values()) == list(range(len(TERMS)))


def test_effects_of_the_axis_act_in_the_step() -> None:
    """Each against the same step without it: torque, friction of the step, supply."""
    plain = Plant(bare(), 1).world[0]
    plain[at.MEAN_DUTY] = plain[at.DUTY] = 0.5
    plain[at.RATE] = plain[at.RATE_BEFORE] = 1e-3
    pushed, braked, sagging = (
        Plant(with_effect(each), 1).world[0]
        for each in (
            effect("gravity_imbalance", amplitude=30.0, phase=0.5),
            effect("viscous_change", factor=2.0),
            effect("supply_sag", resistance=0.1),
        )
    )
    for w in (pushed, braked, sagging):
        w[: at.OUT] = plain[: at.OUT]
        w[at.SUPPLY_CURRENT] = 3.0
        axis_step(w, 0.0, H)
    axis_step(plain, 0.0, H)
    gained = (pushed[at.ACCELERATION] - plain[at.ACCELERATION]) * plain[at.INERTIA]
    assert gained == pytest.approx(30.0 * cos(0.5), rel=1e-6)
    assert braked[at.FRICTION] - plain[at.FRICTION] == pytest.approx(6700.0 * 1e-3, rel=1e-6)
    current = at.MOTORS + at.M_CURRENT
    less = (plain[current] - sagging[current]) * plain[at.RESISTANCE] / (1.0 - plain[at.CURRENT_DECAY])
    assert less == pytest.approx(0.5 * 0.1 * 3.0, rel=1e-6)


def test_P7_an_incremental_counter_wakes_up_wherever_its_error_is() -> None:
    """Its zero takes the error at the first step, 0.1 % of 0.5 rad, once."""
    wrong = Plant(with_effect(effect("roller_ratio", error=1000.0)), 1).world[0]
    wrong[at.ANGLE] = 0.5
    zero = wrong[at.INCREMENTAL_ZERO]
    for _ in range(2):
        axis_step(wrong, T, H)
        assert wrong[at.SIGNALS + sig.TIME] == pytest.approx(T + H / 2.0, rel=1e-12)  # the step's middle
        assert wrong[at.AWAKE] == 1.0
        assert wrong[at.INCREMENTAL_ZERO] - zero == pytest.approx(0.5e-3, rel=1e-3)
