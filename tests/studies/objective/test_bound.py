"""The bound in wind: its steps against integrals, its figure against a run of its own and the firmwares'."""

import numpy as np
import pytest
from scipy.linalg import expm

from plant.deadzone import bias_steps
from plant.kernels import layout as at
from plant.model import load, with_effects
from plant.parts import EffectModel, Number
from plant.plant import Plant
from plant.units import ARCSEC, TURN
from plant.wind import wind
from scenarios.language.configure import parameters_of
from scenarios.studies.objective import bound as best
from scenarios.studies.objective.bench import SIDEREAL, hold
from scenarios.studies.objective.bound import ANGLE, RATE

LOW = load("low_preload_bridge")
BIAS = bias_steps(LOW, LOW.axes.ra.motor)


def test_noise_of_a_step_is_its_integral() -> None:
    a, b, noise = best.disturbed(LOW, wind(3.0))
    step, push, added = best.held(a, b, noise, best.TICK_S)
    assert step == pytest.approx(expm(a * best.TICK_S), rel=1e-8, abs=1e-10)
    times = (np.arange(400) + 0.5) * best.TICK_S / 400
    moves = [expm(a * t) for t in times]
    assert added[RATE, RATE] == pytest.approx(
        np.mean([(m @ noise @ m.T)[RATE, RATE] for m in moves]) * best.TICK_S, rel=1e-3
    )
    assert push[RATE, 0] == pytest.approx(np.mean([(m @ b)[RATE, 0] for m in moves]) * best.TICK_S, rel=1e-3)


@pytest.mark.parametrize("speed_m_s", [1.0, 3.0, 10.0])
def test_no_firmware_leaves_less_and_less_noise_leaves_less(speed_m_s: float) -> None:
    blown = wind(speed_m_s)
    least = best.bound(LOW, blown)
    assert 0 < least.exact < least.rms and least.torque < least.available / 5
    model = with_effects(LOW, "ra", (*LOW.axes.ra.effects, blown))
    for firmware in ("fine", "paper"):
        assert least.rms < hold(model, 137.0, 4, "RATE", list(parameters_of(firmware, LOW).items()), 30.0).rms
    same = best.designed(LOW, blown, 0.01148 / 12**0.5, effort_weight=1e-6).rms
    assert same == pytest.approx(least.rms, rel=1e-3)  # torque costs nothing


def test_on_the_plant_the_best_controller_comes_near_its_figure() -> None:
    """1 N m rms, a tenth of a second: the linear controller on the kernels, with friction as it is. The slow
    torque it knows nothing of, friction's, is left to an integrator."""
    given = {"mean": (0.0, "N m"), "deviation": (1.0, "N m"), "correlation_time": (0.1, "s")}
    blown = EffectModel("wind_torque", parameters={k: Number(*v, "a test") for k, v in given.items()})
    count = TURN / ARCSEC / 112_896_000
    made = best.designed(LOW, blown, count / 12**0.5)
    plant = Plant(with_effects(LOW, "ra", (*LOW.axes.ra.effects, blown)), 4, {"ra": 0.38 * 2**29})
    steps, first = LOW.controller.pwm_steps.si, plant.ra.incremental(0)
    x, base, wanted, rates = np.zeros(len(made.a)), 0.0, 0.0, []
    for tick in range(round(80.0 / best.TICK_S)):
        t_ns = tick * 5_000_000
        error = (plant.ra.incremental(t_ns) - first + 0.5) * count - wanted
        rates.append(plant.world[0, at.RATE] / ARCSEC - SIDEREAL)
        wanted += SIDEREAL * best.TICK_S * min(1.0, tick * best.TICK_S / 10.0)
        x = x + made.correction * (error - x[ANGLE])
        base = max(-500.0, min(500.0, base - 0.05 * error))
        lead = max(0.0, min(1500.0, base + 3 * BIAS - float(made.gain[0] @ x)))
        plant.ra.drive(t_ns, lead / steps, max(0.0, 0.1 * base + 3 * BIAS) / steps)
        x = made.a @ x + made.b[:, 0] * (lead - base - 3 * BIAS)
    left = float(np.std(rates[round(40.0 / best.TICK_S) :]))
    print(f"bound {made.rms:.3f}, on the plant {left:.3f} arcsec/s")
    assert 0.9 * made.rms < left < 1.25 * made.rms
