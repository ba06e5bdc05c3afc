"""The declared model without effects: which numbers move, how far, and its own waves as fitted."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from calibration.balances.problem import Estimate
from calibration.decide.tolerance import CHANGES
from calibration.finding import Finding, Parameter
from calibration.replay import before as module
from calibration.replay.before import before_numbers, with_declared_lines
from plant.model import load, with_effects
from tests.calibration.logs import effect

CALIBRATED = {
    name: Parameter(1.0, "unit", 0.5, 1.5) for name in ("coulomb", "sigma_0", "resistance", "stiffness")
}


def chosen(named: dict[str, float], some: bool = True) -> Any:
    problem = SimpleNamespace(named=lambda fit: {n: Estimate(x, 0.1) for n, x in named.items()})
    return SimpleNamespace(chosen=["one"] if some else [], problem=problem, before="the fit without")


def numbers(
    monkeypatch: pytest.MonkeyPatch, effects: list[Finding] | None = None, **selections: Any
) -> dict[str, float]:
    def fitted(torque: Any, fit: str, largest: float) -> dict[str, Estimate]:
        assert (fit, largest) == ("the fit without", 0.3)
        return {"coulomb": Estimate(20.0, 1.0), "viscous": Estimate(7.0, 1.0), "sigma_0": Estimate(5.0, 1.0)}

    monkeypatch.setattr(module, "fitted_numbers", fitted)
    law = SimpleNamespace(law=SimpleNamespace(numbers={"sigma_0": 30.0}))
    result = SimpleNamespace(
        selections=selections, torque=selections.pop("torque", SimpleNamespace(friction=law)),
        declared=SimpleNamespace(number=lambda name: 10.0),
    )  # fmt: skip
    found = before_numbers(result, CALIBRATED, effects or [])  # type: ignore[arg-type]
    assert all(p.unit == "unit" and (p.low, p.high) == (0.5, 1.5) for p in found.values())
    return {name: p.value for name, p in found.items()}


ONES = dict.fromkeys(CALIBRATED, 1.0)


def test_numbers_are_those_of_the_fit_without_effects_where_there_are_any(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert numbers(monkeypatch) == ONES
    # the bristles' stiffness keeps its ratio to Coulomb's friction; what was not calibrated stays out
    assert numbers(monkeypatch, T=chosen({})) == ONES | {"coulomb": 20.0, "sigma_0": 600.0}
    assert numbers(monkeypatch, T=chosen({}, False)) == ONES
    assert numbers(monkeypatch, T=chosen({}), torque=None) == ONES
    volts = {"resistance": 2.5, "torque_constant": 0.4, "offset": 3.0}
    assert numbers(monkeypatch, E=chosen(volts)) == ONES | {"resistance": 2.5}
    assert numbers(monkeypatch, E=chosen(volts, False)) == ONES


@pytest.mark.parametrize(
    ("compliance", "stiffness"), [(0.25, 4.0), (0.0, 1.0), (-0.25, 1.0), (float("nan"), 1.0)]
)
def test_a_stiffness_is_one_over_what_yields(
    monkeypatch: pytest.MonkeyPatch, compliance: float, stiffness: float
) -> None:
    assert numbers(monkeypatch, K=chosen({"compliance": compliance})) == ONES | {"stiffness": stiffness}
    assert numbers(monkeypatch, K=chosen({"compliance": compliance}, False)) == ONES


def test_a_number_that_is_an_effect_itself_moves_within_its_tolerance(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    name, changed = next((n, c) for n, c in CHANGES.items() if "coulomb" in c.numbers)
    found = [Finding(name, "T", "velocity"), Finding("gear_mesh", "T", "axis_angle")]
    top, low = 10.0 * changed.factor, 10.0 / changed.factor
    assert numbers(monkeypatch, found, T=chosen({}))["coulomb"] == pytest.approx(min(20.0, top))
    assert numbers(monkeypatch, found)["coulomb"] == pytest.approx(max(1.0, low))


MODEL = with_effects(
    load("low_preload"),
    "ra",
    [
        effect("gear_mesh", "mesh3", amplitude=(12.0, "N m"), phase=(0.7, "rad")),
        effect("gear_mesh", "mesh2", amplitude=(3.0, "N m"), phase=(0.1, "rad")),
    ],
)
LINES = (("gear_mesh", "mesh3", 1), ("gear_mesh", "mesh2", 1))


def waves(
    beta: list[float],
    variance: float = 0.0,
    lines: Any = LINES,
    labels: Any = ("offset", "declared mesh3 1", "declared mesh3 1"),
) -> list[tuple[float, float]]:
    fit = SimpleNamespace(beta=np.array(beta), covariance=variance * np.eye(3))
    t = SimpleNamespace(problem=SimpleNamespace(base_labels=[(x, "N m") for x in labels]))
    result = SimpleNamespace(selections={"T": t}, declared=SimpleNamespace(lines=lines))
    made = with_declared_lines(MODEL, "ra", result, fit)  # type: ignore[arg-type]
    assert made.axes.dec == MODEL.axes.dec and [e.stage for e in made.axes.ra.effects] == ["mesh3", "mesh2"]
    found = [e.parameters for e in made.axes.ra.effects]
    assert found[1] == MODEL.axes.ra.effects[1].parameters
    if found[0] != MODEL.axes.ra.effects[0].parameters:
        assert {p.source for p in found[0].values()} == {"re-calibrated"}
    return [(p["amplitude"].value, p["phase"].value) for p in found]


def test_a_declared_wave_has_the_size_and_the_phase_of_the_fit() -> None:
    """The motors' counter-torque is the wave's the other way; a plant's is a sine."""
    (found, _) = waves([9.0, 3.0, 4.0])
    assert found[0] == pytest.approx(5.0)
    angle = np.linspace(0.0, 6.0, 50)
    made = found[0] * np.sin(angle + found[1])
    assert made == pytest.approx(-3.0 * np.cos(angle) - 4.0 * np.sin(angle))


@pytest.mark.parametrize(
    ("beta", "variance", "more"),
    [
        ([9.0, 3.0, 4.0], 12.6, {}),  # a variance of more than its square: the motion does not show it
        ([9.0, 1e6, 4.0], 0.0, {}),  # beyond the plant's bounds
        ([9.0, 3.0, 4.0], 0.0, {"lines": LINES[1:]}),
        ([9.0, 3.0, 4.0], 0.0, {"labels": ("offset", "declared mesh1 1", "b")}),
        ([9.0, 3.0, 4.0], 0.0, {"lines": ()}),
    ],
)
def test_a_wave_that_nothing_tells_stays_as_declared(beta: list[float], variance: float, more: Any) -> None:
    assert waves(beta, variance, **more)[0] == (12.0, 0.7)


def test_a_wave_just_as_uncertain_as_it_is_large_is_taken() -> None:
    assert waves([9.0, 3.0, 4.0], 12.4)[0][0] == pytest.approx(5.0)


def test_without_a_fit_or_a_balance_of_torque_the_model_stays() -> None:
    declared = SimpleNamespace(lines=LINES)
    for selections, fit in (({}, "a fit"), ({"T": "a balance"}, None)):
        result: Any = SimpleNamespace(selections=selections, declared=declared)
        assert with_declared_lines(MODEL, "ra", result, fit) is MODEL  # type: ignore[arg-type]
