"""The catalogue and its dispatch: names, bounds and sources, and which number a formula gets."""

import dataclasses
import re
from collections.abc import Callable
from inspect import signature
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from plant.effects import REGISTRY
from plant.effects.base import OUTSIDE, STAGES, Term
from plant.effects.signals import MEMORY, MOTOR, SEED, TIME, VECTOR, Hook
from plant.evaluate import values_over
from plant.kernels.layout import ROW, ROW_MEMORY
from plant.rows import KINDS
from plant.units import UNITS

SHARED = Path(__file__).parents[3] / "shared" / "spec" / "effects.md"


def test_names_are_those_of_the_catalogue() -> None:
    if not SHARED.exists():
        pytest.skip("../shared is not there: the catalogue cannot be compared")
    rows = [line for line in SHARED.read_text().split("\n") if line.startswith("| `")]
    listed = {word for row in rows for word in re.findall(r"`(\w+)`", row.split("|")[1])}
    assert listed | {"unknown"} <= set(REGISTRY)


def test_every_effect_carries_its_own_name_bounds_units_and_sources() -> None:
    for name, effect in REGISTRY.items():
        assert effect.name == name
        assert effect.equation
        assert set(effect.stages) <= set(STAGES)
        for parameter in effect.parameters:
            assert parameter.low <= parameter.default <= parameter.high, (name, parameter.name)
            assert parameter.unit in UNITS and parameter.source, (name, parameter.name)


def test_an_effect_outside_the_catalogue_says_what_describes_it() -> None:
    with pytest.raises(TypeError, match="gear_mesh: it has neither a source nor a row"):
        dataclasses.replace(REGISTRY["gear_mesh"], catalogue_row=OUTSIDE)


@pytest.mark.parametrize("name", [n for n in REGISTRY if n not in ("unknown", "wind_torque")])
def test_dispatch_hands_each_formula_what_it_names(name: str) -> None:
    """The compiled chain of dispatch.py against the formula in Python, its arguments given by name."""
    effect, rng = REGISTRY[name], np.random.default_rng(1)
    numbers = {word: rng.uniform(0.3, 0.9) for word in effect.numbers}
    if "motor" in numbers:
        numbers["motor"] = 2.0
    for term in effect.terms:
        if term.formula is None:
            continue
        p = np.zeros(ROW - ROW_MEMORY)
        p[:MEMORY] = *rng.uniform(0.3, 0.9, SEED), 12345.0
        p[MEMORY : MEMORY + len(numbers)] = list(numbers.values())
        rows = rng.uniform(0.3, 0.9, (2, VECTOR))
        rows[:, MOTOR] = 1.0
        rows[1, TIME] = rows[0, TIME] + 0.1
        memory = dict(zip(term.memory, p[1:] if term.of_motors else p, strict=False))
        known = {**numbers, **memory, "seed": 12345.0}
        if term.update is not None:
            dt = rows[1, TIME] - rows[0, TIME]
            after = term.update(rows[1], dt, **named(term.update, known))
            known |= dict(zip(term.memory, np.atleast_1d(after), strict=True))
        x = rows[1].copy()
        expected = term.formula(x, **named(term.formula, known)) or 0.0
        y = np.zeros(2)
        values_over(KINDS[term.formula], rows, p, y)
        assert (y[1], *rows[1]) == pytest.approx((expected, *x), rel=1e-12)
        assert list(p[1:] if term.of_motors else p)[: len(term.memory)] == pytest.approx(
            [known[word] for word in term.memory], rel=1e-12
        )


def named(function: Callable[..., Any], known: dict[str, float]) -> dict[str, float]:
    """Those of the known numbers that a formula names."""
    return {word: known[word] for word in signature(function).parameters if word in known}


@pytest.mark.parametrize("name", REGISTRY)
def test_formulas_name_every_parameter_of_the_declaration(name: str) -> None:
    """Or it says where the effect acts; log effects are no part of the step."""
    effect = REGISTRY[name]
    functions = [f for term in effect.terms for f in (term.formula, term.update) if f is not None]
    used = {word for function in functions for word in signature(function).parameters}
    if functions:
        declared = {parameter.name for parameter in effect.parameters} | {*effect.constants}
        assert declared - used <= {"motor", "encoder"}
        assert {word for term in effect.terms for word in term.memory} - used <= {"axis_rate"}
    else:
        assert [term.hook for term in effect.terms] == [Hook.LOG]


def test_an_argument_that_is_no_parameter_is_one_clear_error() -> None:
    def formula(x: np.ndarray, amplitud: float) -> float:
        return amplitud * x[0]

    def turned(x: np.ndarray, phase: float, amplitude: float) -> float:
        return amplitude * x[0] + phase

    for wrong in (formula, turned):
        with pytest.raises(
            TypeError, match=r"gravity_imbalance: .*in this order, of \(x, seed, amplitude, phase\)"
        ):
            dataclasses.replace(REGISTRY["gravity_imbalance"], terms=(Term(Hook.AXIS_TORQUE, wrong),))


SOURCE = Path(__file__).parents[2] / "docs" / "sources" / "effects.md"
ODD = {
    "stribeck_change", "presliding", "viscous_change", "coulomb_change", "friction_asymmetry",
    "position_friction", "load_friction", "friction_warmup", "preload_change", "diode_braking", "brake_drag",
}  # fmt: skip
"""All that changes friction, and a motor that brakes: they change their sign with the motion."""
WAVES = {
    "position_friction", "gravity_imbalance", "gear_eccentricity", "gear_mesh", "motor_cogging",
    "torque_ripple", "bearing_pass",
}  # fmt: skip
OF_MOTORS = {
    "motor_cogging", "torque_ripple", "backlash_loss", "adc_offset", "adc_gain", "pwm_deadband",
    "winding_heating", "magnet_weakening", "command_disturbance",
}  # fmt: skip


def test_effects_stand_in_the_order_of_the_catalogue() -> None:
    rows = [line for line in SOURCE.read_text(encoding="utf-8").splitlines() if line.startswith("| `")]
    listed = [word for row in rows for word in re.findall(r"`(\w+)`", row.split("|")[1])]
    assert len(listed) == 40
    placed = {effect.catalogue_row: name for name, effect in REGISTRY.items()}
    assert placed == dict(enumerate([*listed, "unknown"], 1))
    assert OUTSIDE == 1000


def test_effects_are_odd_waves_or_of_motors() -> None:
    assert {name for name, effect in REGISTRY.items() if effect.odd} == ODD
    assert {name for name, effect in REGISTRY.items() if effect.wave} == WAVES
    of_motors = {name for name, effect in REGISTRY.items() if any(term.of_motors for term in effect.terms)}
    assert of_motors == OF_MOTORS


def test_what_begins_a_log_with_the_motion_before() -> None:
    lasting = {name for name, effect in REGISTRY.items() if any(term.lasting for term in effect.terms)}
    assert lasting == {"cable_wrap", "winding_heating", "unknown"}


@pytest.mark.parametrize(
    ("name", "parameter", "numbers"),
    [
        ("brake_drag", "start", (-1_000_000, 1_000_000, 0)),
        ("brake_drag", "duration", (0, 1_000_000_000, 1_000_000)),
        ("preload_change", "start", (-100_000, 100_000, 0)),
        ("preload_change", "duration", (0.01, 100_000, 1)),
        ("encoder_subdivision", "lines", (100, 30_000_000, 32_768)),
    ],
)
def test_wide_bounds_are_exact(name: str, parameter: str, numbers: tuple[float, ...]) -> None:
    """The page that lists them rounds to six digits."""
    found = REGISTRY[name].parameter(parameter)
    assert (found.low, found.high, found.default) == numbers


def test_a_parameter_that_is_none_is_an_error() -> None:
    with pytest.raises(KeyError, match="colour"):
        REGISTRY["brake_drag"].parameter("colour")


def test_signals_have_their_places() -> None:
    """By the pages of the kernel: 14 signals, two free places, seven numbers of friction."""
    from plant.effects import signals as sig

    names = ("TIME", "ANGLE", "RATE", "MOTOR_ANGLE", "MOTOR_RATE", "CURRENT", "COMMAND", "TORQUE", "REVERSAL",
             "TEMPERATURE", "SUPPLY_CURRENT", "ACCELERATION", "MOTOR", "LAGGING", "ENCODER")  # fmt: skip
    assert [getattr(sig, name) for name in names] == list(range(15))
    assert (sig.SIGNALS, sig.SIGMA0, sig.SIGMA1, sig.SIGMA2, sig.COULOMB) == (16, 16, 17, 18, 19)
    assert (sig.STICTION, sig.STRIBECK_RATE, sig.STRIBECK_EXPONENT, sig.VECTOR) == (20, 21, 22, 24)
    assert (sig.MEMORY, sig.SEED, sig.MOTOR_HOOKS, sig.HOOK_COUNT) == (4, 3, 5, 12)
    assert [hook.value for hook in sig.Hook] == list(range(14))
