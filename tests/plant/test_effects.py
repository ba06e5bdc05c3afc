"""Every effect of the catalogue: in the registry, in the dispatch, in its channel, and silent when off."""

import dataclasses
import re
from collections.abc import Callable
from inspect import signature
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from plant import model
from plant.effects import REGISTRY
from plant.effects.base import OUTSIDE, STAGES, Term
from plant.effects.signals import MEMORY, MOTOR, SEED, TIME, VECTOR, Hook
from plant.evaluate import values_over
from plant.kernels.layout import ROW, ROW_MEMORY
from plant.parts import EffectModel, Function, Number
from plant.plant import Plant
from plant.rows import KINDS
from plant.units import ARCSEC, UNITS
from tests.plant.bench import SECOND, bare, with_effect

SHARED = Path(__file__).parents[3] / "shared" / "spec" / "effects.md"
# what a run shows of an effect with its default size (or the one given here): "truth" is the motion itself
FIGURES: dict[str, dict[str, float]] = {
    "encoder_eccentricity": {"phase": 1.0},
    "preload_change": {"start": 1.0},
    "roller_slip": {"slip": 0.2, "threshold": 1e-4},
    "winding_heating": {"thermal_resistance": 8.0, "time_constant": 10.0},
    "wind_torque": {"deviation": 50.0},
    "channel_delay": {"column": 2.0, "delay": 0.004},
    "damaged_tooth": {"width": 1.0},
}
SHOWS: dict[str, set[str]] = {
    "encoder_eccentricity": {"absolute"},
    "encoder_subdivision": {"absolute"},
    "play": {"auxiliary"},
    "roller_ratio": {"incremental"},
    "roller_slip": {"incremental"},
    "encoder_thermal_drift": {"absolute"},
    "adc_offset": {"current"},
    "adc_gain": {"current"},
    "channel_delay": {"incremental"},
    "clock_jitter": set(),
    "sample_loss": set(),
    "log_wrap": set(),
}
READINGS = ("truth", "incremental", "absolute", "auxiliary", "tachometer", "current")
FUNCTION = Function("torque", "axis_angle", "cubic", 0.0, ((0.0, 5.0), (0.01, 40.0), (0.05, -20.0)), "a test")


def instance(name: str) -> EffectModel:
    """Return an effect of visible size."""
    if name == "unknown":
        return EffectModel(name, function=FUNCTION)
    effect = REGISTRY[name]
    chosen = {
        word: Number(size, effect.parameter(word).unit, "a test")
        for word, size in FIGURES.get(name, {}).items()
    }
    return EffectModel(name, effect.stages[0] if effect.staged else None, 1, chosen)


def readings(plant: Plant) -> dict[str, np.ndarray]:
    """Return what the sensors and the truth show during a run with acceleration, slow motion and reversal."""
    got: dict[str, list[float]] = {word: [] for word in READINGS}
    program = {0: (0.6, 0.06), 100: (0.9, 0.09), 160: (0.25, 0.12), 220: (0.08, 0.7), 330: (0.0, 0.0)}
    for k in range(400):
        t = k * 10_000_000 + 3_210
        if k in program:
            plant.ra.drive(t, *program[k])
        got["truth"].append(plant.ra.truth(t)[0])
        got["incremental"].append(plant.ra.incremental(t))
        got["absolute"].append(plant.ra.absolute(t))
        got["auxiliary"].append(plant.ra.auxiliary(t))
        got["tachometer"].append(plant.ra.tachometer(t, 0))
        got["current"].append(plant.ra.current(t, 0))
    return {word: np.array(column) for word, column in got.items()}


@pytest.fixture(scope="module")
def declared() -> dict[str, np.ndarray]:
    return readings(Plant(bare(), 1, {"ra": 2**28}))


@pytest.mark.parametrize("name", REGISTRY)
def test_effect_changes_its_own_channel_and_no_other(name: str, declared: dict[str, np.ndarray]) -> None:
    shown = readings(Plant(with_effect(instance(name)), 1, {"ra": 2**28}))
    different = {word for word in READINGS if not np.array_equal(shown[word], declared[word])}
    if "truth" in SHOWS.get(name, {"truth"}):
        assert "truth" in different
    else:
        assert different == SHOWS[name]


@pytest.mark.parametrize("name", REGISTRY)
def test_effect_that_is_off_is_silent(name: str, declared: dict[str, np.ndarray]) -> None:
    off = dataclasses.replace(instance(name), enabled=False)
    shown = readings(Plant(with_effect(off), 1, {"ra": 2**28}))
    assert all(np.array_equal(shown[word], declared[word]) for word in READINGS)


@pytest.mark.parametrize("name", REGISTRY)
def test_effect_on_one_axis_leaves_the_other_alone(name: str) -> None:
    plain, other = Plant(bare(), 1), Plant(with_effect(instance(name)), 1)
    for plant in (plain, other):
        plant.ra.drive(0, 0.6, 0.06)
        plant.dec.drive(0, 0.3, 0.03)
        plant.advance(SECOND // 2)
    assert np.array_equal(plain.world[1], other.world[1])


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


def test_too_many_effects_and_too_late_delays_are_refused() -> None:
    crowd = model.with_effects(bare(), "ra", [instance("gravity_imbalance")] * 33)
    with pytest.raises(ValueError, match="33 effects, at most 32"):
        Plant(crowd, 1)


def test_delayed_channel_shows_what_the_plain_one_showed_before() -> None:
    delay = 7_000_000
    late_effect = instance("channel_delay")
    late_effect = dataclasses.replace(
        late_effect, parameters={"column": Number(1, "1", "t"), "delay": Number(7, "ms", "t")}
    )
    plain, late = Plant(bare(), 1), Plant(with_effect(late_effect), 1)
    seen: dict[int, int] = {}
    for plant in (plain, late):
        plant.ra.drive(0, 0.6, 0.06)
    for t in range(SECOND, 2 * SECOND, 500_000):
        seen[t] = plain.ra.absolute(t)
    for t in range(SECOND + delay, 2 * SECOND, 1_000_000):
        assert late.ra.absolute(t) == seen[t - delay]


def test_log_effects_are_handed_to_the_log_writer() -> None:
    plant = Plant(
        model.with_effects(bare(), "ra", [instance("sample_loss"), instance("gravity_imbalance")]), 1
    )
    assert plant.log_effects("ra") == [("sample_loss", {"packet_loss": 0.02, "repeats": 0.0})]
    assert plant.log_effects("dec") == []


def test_structural_mode_swings_at_its_frequency_whatever_the_drive() -> None:
    """The second mass on the locked axis: f0 within a percent, decaying with zeta."""
    from plant.effects.structural_mode import formula
    from plant.effects.structural_mode import update as swing

    lead, rate, before = 1e-5, 0.0, 0.0
    x = np.zeros(VECTOR)
    leads = []
    for _ in range(4000):
        lead, rate, before = swing(x, 5e-4, lead, rate, before, frequency=9.0, damping=0.01)
        leads.append(lead)
        assert np.sign(formula(x, lead, rate, 9.0, 0.01, 200.0)) in (-1.0, 0.0, 1.0)
    up = np.flatnonzero((np.array(leads[:-1]) < 0) & (np.array(leads[1:]) >= 0))
    assert (len(up) - 1) / ((up[-1] - up[0]) * 5e-4) == pytest.approx(9.0, rel=0.01)
    decay = np.exp(-2 * np.pi * 9.0 * 0.01 * 1.0)
    assert max(leads[2000:2200]) / max(leads[:200]) == pytest.approx(decay, rel=0.1)


def test_gravity_imbalance_wants_more_current_up_than_down() -> None:
    """Even in direction: the torque adds on the way up and helps on the way down."""
    effect = EffectModel("gravity_imbalance", parameters={"amplitude": Number(80, "N m", "t")})
    speeds = []
    for duties in ((0.5, 0.05), (0.05, 0.5)):
        pair = []
        for m in (bare(), with_effect(effect)):
            plant = Plant(m, 1)
            plant.ra.drive(0, *duties)
            plant.advance(5 * SECOND)
            pair.append(plant.ra.truth(5 * SECOND)[1])
        speeds.append(pair[1] - pair[0])
    assert speeds[0] > 100 * ARCSEC  # helped forward
    assert speeds[1] > 100 * ARCSEC  # and, in the other direction, held back


def test_a_counter_does_not_jump_where_it_wakes_up_away_from_zero() -> None:
    """A scale of 500 ppm makes 2 arcsec of a degree, never of the angle that the axis starts at."""
    ratio = EffectModel("roller_ratio", parameters={"error": Number(500, "ppm", "t")})
    plain, other = (Plant(m, 1, {"ra": 2.0**27}) for m in (bare(), with_effect(ratio)))
    turned = []
    for plant in (plain, other):
        assert plant.ra.incremental(0) == 0
        plant.advance(SECOND // 100)
        assert plant.ra.incremental(SECOND // 100) == 0
        plant.ra.drive(SECOND // 100, 0.6, 0.06)
        plant.advance(5 * SECOND)
        turned.append(plant.ra.incremental(5 * SECOND))
    assert turned[1] / turned[0] == pytest.approx(1 + 500e-6, abs=2 / turned[0])


def test_diode_braking_slows_the_slew() -> None:
    plain, braked = (Plant(m, 1) for m in (bare(), with_effect(instance("diode_braking"))))
    rates = []
    for plant in (plain, braked):
        plant.ra.drive(0, 0.6, 0.06)
        plant.advance(10 * SECOND)
        rates.append(plant.ra.truth(10 * SECOND)[1])
    assert rates[1] < 0.8 * rates[0]


@pytest.mark.parametrize(
    ("target", "reading"),
    [
        ("torque", "truth"), ("motor_torque", "truth"), ("voltage", "truth"), ("command", "truth"),
        ("incremental", "incremental"), ("absolute", "absolute"), ("auxiliary", "auxiliary"),
        ("current", "current"),
    ],
)  # fmt: skip
def test_unknown_acts_where_its_function_says(
    target: str, reading: str, declared: dict[str, np.ndarray]
) -> None:
    size = {"torque": 50.0, "motor_torque": 0.1, "voltage": -3.0, "command": -0.05, "current": 0.3}.get(
        target, 1e-4
    )
    function = Function(target, "velocity", "linear", 0.0, ((-0.02, -size), (0.02, size)), "a test")
    shown = readings(Plant(with_effect(EffectModel("unknown", function=function)), 1, {"ra": 2**28}))
    different = {word for word in READINGS if not np.array_equal(shown[word], declared[word])}
    assert reading in different
    if reading != "truth":
        assert different == {reading}


def test_unknown_written_to_a_file_reads_back() -> None:
    base = with_effect(instance("unknown"))
    assert model.loads(model.dumps(base)) == base
    text = model.dumps(base).replace("domain: axis_angle", "domain: axis_angel")
    with pytest.raises(model.ModelError, match="did you mean 'axis_angle'"):
        model.loads(text)
