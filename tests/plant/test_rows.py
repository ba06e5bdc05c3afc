"""From effects to rows of numbers: which act, where, in which order, and what their numbers are."""

import hashlib
from dataclasses import replace

import numpy as np
import pytest

from plant.effects import REGISTRY
from plant.effects import unknown as of
from plant.effects.signals import Hook
from plant.kernels import layout as at
from plant.model import with_effects
from plant.parts import EffectModel, Function, Number
from plant.rows import KINDS, number_from, rows_of, values, write
from plant.units import ARCSEC
from plant.world import build, constants
from tests.plant.bench import bare

NONE: dict[str, float] = {}


def number(value: float, unit: str = "1") -> Number:
    return Number(value, unit, "a test")


def function(target: str, **changed: object) -> EffectModel:
    made = Function(target, "reversal", "linear", 0.25, ((-1.0, 2.0), (3.0, 4.0)), "a test", 2)
    return EffectModel("unknown", function=replace(made, **changed))  # type: ignore[arg-type]


def hooks(*effects: EffectModel) -> list[tuple[Hook, int]]:
    given = {"torque_constant": 0.4, "resistance": 2.0, "winding": 1.5, "ratio": 360.0}
    return [(hook, place) for hook, place, _ in rows_of(effects, given, 1, "ra")]


@pytest.mark.parametrize("seed", [0, 1, 77])
def test_a_number_of_53_bit_from_a_seed_and_a_name(seed: int) -> None:
    """SHA-256's first eight bytes, the lowest first, less eleven bits: a float holds it."""
    first = hashlib.sha256(f"{seed}:ra.tach.0".encode()).digest()[:8]
    whole = sum(byte << (8 * k) for k, byte in enumerate(first))
    assert number_from(seed, "ra.tach.0") == whole // 2048 < 2**53
    assert (
        number_from(seed, "ra.tach.1") != number_from(seed, "ra.tach.0") != number_from(seed + 1, "ra.tach.0")
    )


def test_numbers_of_an_effect_are_si_with_defaults_and_the_order_of_its_stage() -> None:
    """The auxiliary encoder turns 10.8 times, a second harmonic twice as often (paper 2.2)."""
    effect = EffectModel("encoder_eccentricity", "aux", 2, {"amplitude": number(5.0, "arcsec")})
    expected = {"order": 21.6, "amplitude": 5 * ARCSEC, "phase": 0.0, "second": 0.0, "second_phase": 0.0}
    assert values(effect) == pytest.approx(expected)
    assert values(EffectModel("wind_torque")) == {"mean": 10.0, "deviation": 10.0, "correlation_time": 2.0}


def test_effects_act_where_they_say() -> None:
    assert hooks(EffectModel("supply_sag"), EffectModel("motor_cogging")) == [
        (Hook.MOTOR_TORQUE, 1),
        (Hook.SUPPLY, 0),
    ], "in the order of the kernel"
    same = [EffectModel("gravity_imbalance"), EffectModel("gear_mesh", "mesh1"), EffectModel("cable_wrap")]
    assert hooks(*same) == [(Hook.AXIS_TORQUE, k) for k in range(3)], "of a hook in the order of the file"
    off = replace(same[0], enabled=False)
    assert hooks(off, *same[1:]) == [(Hook.AXIS_TORQUE, 1), (Hook.AXIS_TORQUE, 2)]


@pytest.mark.parametrize("name", ["sample_loss", "channel_delay", "shaft_compliance"])
def test_what_acts_in_the_log_or_once_has_no_row(name: str) -> None:
    assert hooks(EffectModel(name)) == []


def test_a_wheel_out_of_round_turns_the_train_only_with_a_size() -> None:
    still = EffectModel("gear_eccentricity", "motor")
    turns = replace(still, parameters={"kinematic": number(1e-5, "rad")})
    assert hooks(still) == [(Hook.AXIS_TORQUE, 0)]
    assert hooks(turns) == [(Hook.AXIS_TORQUE, 0), (Hook.TRANSMISSION, 0)]


@pytest.mark.parametrize(
    ("stage", "hook"),
    [("axis", Hook.ABSOLUTE), ("roller", Hook.INCREMENTAL), ("aux", Hook.AUXILIARY)],
)
def test_a_stage_names_its_encoder(stage: str, hook: Hook) -> None:
    assert hooks(EffectModel("encoder_eccentricity", stage)) == [(hook, 0)]


@pytest.mark.parametrize(
    ("choice", "hook"), [(0.0, Hook.INCREMENTAL), (1.0, Hook.ABSOLUTE), (2.0, Hook.AUXILIARY)]
)
def test_a_parameter_names_its_encoder(choice: float, hook: Hook) -> None:
    assert hooks(EffectModel("play", parameters={"encoder": number(choice)})) == [(hook, 0)]


def test_an_unknown_acts_where_its_function_says() -> None:
    assert hooks(function("voltage"), function("motor_torque")) == [(Hook.MOTOR_TORQUE, 1), (Hook.SUPPLY, 0)]
    assert hooks(function("transmission")) == [(Hook.TRANSMISSION, 0)]


def test_a_function_lies_in_its_row_by_its_places() -> None:
    ((_, _, row),) = rows_of((function("torque"),), NONE, 5, "dec")
    assert row[:2] == [Hook.AXIS_TORQUE, KINDS[of.formula]]
    assert row[2:6] == [0.0, 0.0, 0.0, number_from(5, "dec.unknown.0")]
    numbers = row[6:]
    assert len(numbers) == 5 + 2 * 32
    assert numbers[: of.FIRST] == [8.0, 1.0, 0.25, 2.0, 2.0]  # reversal is signal 8; linear, period, two, B
    assert numbers[5:8] == [-1.0, 3.0, 0.0] and numbers[37:40] == [2.0, 4.0, 0.0]
    ((_, _, row),) = rows_of((function("torque", interpolation="stop"),), NONE, 5, "dec")
    assert row[7] == 5.0


def test_a_row_has_hook_kind_memory_seed_and_numbers_in_order() -> None:
    mesh = EffectModel(
        "gear_mesh", "mesh3", 3, {"amplitude": number(4.0, "N m"), "phase": number(0.5, "rad")}
    )
    ((hook, _, row),) = rows_of((mesh,), NONE, 9, "ra")
    kind = KINDS[REGISTRY["gear_mesh"].terms[0].formula]
    assert row == [hook, kind, 0.0, 0.0, 0.0, number_from(9, "ra.gear_mesh.0"), 750.0, 4.0, 0.5]


def test_equal_effects_have_seeds_of_their_own() -> None:
    rows = rows_of((EffectModel("wind_torque"),) * 3, NONE, 9, "ra")
    assert [row[5] for _, _, row in rows] == [number_from(9, f"ra.wind_torque.{k}") for k in range(3)]


def test_rows_are_written_one_behind_the_other_over_what_was_there() -> None:
    world = np.full(at.WIDTH, 7.0)
    effects = (EffectModel("supply_sag"), EffectModel("motor_cogging"), EffectModel("adc_gain"))
    write(world, effects, NONE, 1, "ra")
    rows = [row for _, _, row in rows_of(effects, NONE, 1, "ra")]
    assert (world[at.ROWS_MOTOR], world[at.ROWS_ALL]) == (2, 3)  # the supply's is not of motors
    for place, row in enumerate(rows):
        start = at.EFFECTS + place * at.ROW
        assert world[start : start + at.ROW].tolist() == [*row, *[0.0] * (at.ROW - len(row))]
    assert world[at.EFFECTS + 3 * at.ROW] == 7.0 and world[at.EFFECTS - 1] == 7.0


def test_32_may_act_at_once() -> None:
    crowd = (EffectModel("gravity_imbalance"),) * 32
    assert len(rows_of(crowd, NONE, 1, "ra")) == 32
    with pytest.raises(ValueError, match=r"axes\.dec\.effects: 33 effects, at most 32 can act at once"):
        rows_of((*crowd, crowd[0]), NONE, 1, "dec")
    assert len(rows_of((*crowd, EffectModel("sample_loss")), NONE, 1, "ra")) == 32


def test_a_winding_knows_the_constants_of_its_axis() -> None:
    model = with_effects(bare(), "ra", (EffectModel("winding_heating"),))
    row = build(model, 1, {})[0, at.EFFECTS :]
    assert row[2 + 4 : 2 + 7].tolist() == [1.5, 600.0, 2.2]  # 2.2 ohm: low_preload.yaml
    found = constants(model.axes.ra)
    assert (found["torque_constant"], found["winding"]) == (0.39, 2.2)
    assert found["resistance"] == pytest.approx(2.2 + 0.085 + 0.1)
    assert found["ratio"] == pytest.approx(360.489, abs=1e-3)
