"""Every effect of the catalogue in a run: in its channel, and silent when off."""

import dataclasses

import numpy as np
import pytest

from plant import model
from plant.effects import REGISTRY
from plant.effects.signals import VECTOR
from plant.parts import EffectModel, Function, Number
from plant.plant import Plant
from plant.units import ARCSEC
from tests.plant.bench import SECOND, bare, with_effect

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
