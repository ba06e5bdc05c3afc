"""The observer of the axis board: no gain beside its own does better by its own weights and noise."""

import numpy as np
import pytest

from plant import observer as of
from plant.linear import ANGLE, RATE, continuous, stepped
from plant.model import load
from plant.observer import DELAY_S, LAST, LOAD, OTHERS, SIZE, TICK_S, count_rad, designed, lumped, sections
from plant.parts import PlantModel
from plant.units import ARCSEC

KEEP = [n for n in range(SIZE) if n != LOAD]  # nobody controls the disturbance
Designed = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


@pytest.fixture(scope="module")
def model() -> PlantModel:
    return load("high_preload_bridge")


@pytest.fixture(scope="module")
def made(model: PlantModel) -> Designed:
    return designed(model, model.axes.ra)


def test_a_count_is_a_turn_over_the_encoders_lines_and_the_rollers_ratio(model: PlantModel) -> None:
    assert count_rad(model.axes.ra) == pytest.approx(2 * np.pi / 112_896_000)  # hardware.md 1.3


def test_rotors_that_turn_alike_are_one(model: PlantModel) -> None:
    """From any state with both rotors alike, and A's motor's torque, the rates are those of both together."""
    a, b, _ = continuous(model, model.axes.ra, 15.041 * ARCSEC)
    whole, effort = lumped(model, model.axes.ra)
    state = np.array([1e-5, 2e-6, 30.0, 3e-5, 4e-6, 5.0, 0.0])
    apart = np.array([*state[:3], *state[3:5], 5.0, *state[3:5], 0.0])
    full = a @ apart
    both = (full[4] + full[7]) / 2
    expected = [*full[:3], (full[3] + full[6]) / 2, both, full[5] + full[8], 0.0]
    assert whole @ state == pytest.approx(expected, rel=1e-9)
    assert effort[:, 0] == pytest.approx([*b[:5, 0], b[5, 0], 0.0])


def test_the_disturbance_pushes_the_axis_and_stays(model: PlantModel) -> None:
    """A torque of a newton metre on the axis, of its inertia."""
    whole, _ = lumped(model, model.axes.ra)
    pushed = np.zeros(LAST)
    pushed[RATE] = 1 / model.axes.ra.inertia.si
    assert whole[:, LAST - 1] == pytest.approx(pushed)


def test_the_last_effort_acts_until_the_delay_is_over(model: PlantModel, made: Designed) -> None:
    """A tick by two steps of the same system: the delay with the last effort, the rest with the new one."""
    plant = lumped(model, model.axes.ra)
    state, last, new = np.array([1e-5, 2e-6, 30.0, 3e-5, 4e-6, 5.0, 0.7]), 20.0, 50.0
    for seconds, effort in ((DELAY_S, last), (TICK_S - DELAY_S, new)):
        step, push = stepped(*plant, seconds)
        state = step @ state + push[:, 0] * effort
    a, b, _, _ = made
    after = a @ np.array([1e-5, 2e-6, 30.0, 3e-5, 4e-6, 5.0, 0.7, last]) + b[:, 0] * new
    assert after == pytest.approx([*state, new], rel=1e-9)


def summed(step: np.ndarray, each: np.ndarray) -> np.ndarray:
    """step^k each step'^k over all k, by doubling. Units of states are too far apart for an equation."""
    for _ in range(40):
        each, step = each + step @ each @ step.T, step @ step
    return each


def others(best: np.ndarray) -> list[np.ndarray]:
    """A per cent up and down, one after the other."""
    return [best + s * 0.01 * best * np.eye(len(best))[k] for k in range(len(best)) for s in (1, -1)]


@pytest.mark.parametrize("weight", [of.POSITION, 1e9])
def test_no_feedback_costs_less(model: PlantModel, weight: float) -> None:
    """sum of weight angle^2 + effort^2 from any start: as a trace."""
    a, b, gain, _ = designed(model, model.axes.ra, weight)
    a, b, gain = a[np.ix_(KEEP, KEEP)], b[KEEP], gain[KEEP]
    start = np.diag([1e-10, 1e-8, 1.0, 1e-10, 1e-8, 1.0, 1.0])

    def cost(feedback: np.ndarray) -> float:
        closed = a - b @ feedback[None]
        assert max(abs(np.linalg.eigvals(closed))) < 1.0
        each = np.outer(feedback, feedback)
        each[ANGLE, ANGLE] += weight
        return float(np.trace(summed(closed.T, each) @ start))

    assert all(cost(other) >= cost(gain) * (1 - 1e-9) for other in others(gain))
    assert cost(1.01 * gain) > cost(gain) and cost(0.99 * gain) > cost(gain)


@pytest.mark.parametrize("disturbance", [of.DISTURBANCE, 1000.0])
def test_no_correction_errs_less(model: PlantModel, disturbance: float) -> None:
    """Variance of the angle's error before a reading: noise as declared, readings even in a count."""
    a, _, _, correction = designed(model, model.axes.ra, disturbance=disturbance)
    noise = 1e-16 * np.eye(SIZE)
    noise[LOAD, LOAD], noise[RATE, RATE], noise[LOAD - 1, LOAD - 1] = disturbance, *OTHERS
    reading = count_rad(model.axes.ra) ** 2 / 12
    seen = np.eye(SIZE)[ANGLE]

    def spread(taken: np.ndarray) -> float:
        closed = a @ (np.eye(SIZE) - np.outer(taken, seen))
        assert max(abs(np.linalg.eigvals(closed))) < 1.0
        moved = a @ taken
        return float(summed(closed, noise + reading * np.outer(moved, moved))[ANGLE, ANGLE])

    best = spread(correction)
    assert all(spread(other) >= best * (1 - 1e-6) for other in others(correction))
    assert spread(1.01 * correction) > best and spread(0.99 * correction) > best


def test_under_a_steady_disturbance_the_axis_rests_on_its_place(made: Designed) -> None:
    a, b, gain, _ = made
    closed = a - b @ gain[None]
    rest = np.linalg.solve(np.eye(SIZE - 1) - closed[np.ix_(KEEP, KEEP)], closed[KEEP, LOAD])
    assert abs(rest[ANGLE]) < 1e-6 * abs(np.delete(rest, ANGLE)).max() and abs(rest[ANGLE]) < 1e-4 * ARCSEC
    assert rest[-1] != 0.0


def test_sections_answer_as_the_observer_does(model: PlantModel, made: Designed) -> None:
    """Efforts and angles at random; a section is (n1 z + n0) / (z^2 - trace z + determinant)."""
    a, b, gain, correction = made
    parts, through = sections(model, model.axes.ra)
    count = count_rad(model.axes.ra)
    state, halves = np.zeros(SIZE), np.zeros((len(parts), 2))
    assert len(parts) == SIZE // 2
    for effort, angle in np.random.default_rng(3).normal(0, (20, 1), (300, 2)):
        state = state + correction * (angle * count - state[ANGLE])
        assert -gain @ state == pytest.approx(halves[:, 0].sum() + through * angle, rel=1e-6, abs=1e-6)
        state = a @ state + b[:, 0] * effort
        for half, (trace, determinant, g1, g0, h1, h0) in zip(halves, parts, strict=True):
            first = half[0]
            half[0] = trace * first + half[1] + g1 * effort + h1 * angle
            half[1] = -determinant * first + g0 * effort + h0 * angle


def test_weights_and_noise_are_those_of_the_study() -> None:
    """`test_weights.py` of the studies picks two of them by decades; a thousandth of the others is alike."""
    assert (of.POSITION, of.DISTURBANCE, OTHERS) == (1e11, 10.0, (1e-12, 0.01))
    assert (TICK_S, DELAY_S) == (0.005, 9e-5)
