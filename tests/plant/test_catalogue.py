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
