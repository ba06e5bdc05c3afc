"""What is added behind the effort of two motors, by their volts; the phase of a wave on uneven rows."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from calibration.balances.volts import Counter, Windings
from calibration.names import command_disturbance as named
from calibration.names.scene import Scene
from tests.calibration.names.test_command_disturbance import T

N = 2000
SECONDS = 0.02 * np.arange(N)
RUN = np.repeat([0, 1], N // 2)


def amplifier(square: bool, held: np.ndarray | None = None) -> Scene:
    """0.03 of full effort at 1.7 Hz behind an effort that leads with A, then B, 4 s each; two runs.

    The lagging motor has half the effort, against which a positive disturbance works as well. The supply
    goes for some rows, and others hold nothing of worth.
    """
    t = SECONDS + 100.0
    wave = np.sin(2 * np.pi * 1.7 * t + np.where(RUN == 0, 0.8, 2.9))
    wave = np.sign(wave) if square else wave
    leads_a = SECONDS % 8.0 < 4.0
    supply = np.where(np.arange(N) % 100 < 10, 0.0, 20.0 + SECONDS / 10.0)
    share = np.concatenate([np.where(leads_a, 1.0, 0.5), np.where(leads_a, 0.5, 1.0)])
    volts = share * np.tile(supply * np.where(leads_a, 1.0, -1.0), 2)
    valid = np.tile(np.arange(N) % 70 > 3, 2)
    windings = Windings(
        at=lambda x: x,
        current=np.zeros(2 * N),
        rate=np.zeros(2 * N),
        clock=np.zeros(2 * N),
        supply=np.tile(supply, 2),
        counter=Counter(
            share=share, lagging=np.concatenate([~leads_a, leads_a]).astype(float), dragged=np.zeros(2 * N)
        ),
    )
    luck = 0.02 * np.random.default_rng(8).standard_normal(2 * N)
    problem = SimpleNamespace(
        y=np.zeros(2 * N),
        t=np.tile(t, 2),
        run=np.tile(RUN, 2),
        held=np.zeros(2 * N, dtype=bool) if held is None else np.tile(held, 2),
        valid=valid,
    )
    parts = {
        "windings": windings,
        "problem": problem,
        "residual": np.where(valid, 0.03 * volts * np.tile(wave, 2) + luck, 50.0),
        "view": SimpleNamespace(t=t, run=RUN),
        "at": lambda x: np.tile(x, 2),
    }
    return cast(Scene, cast(Any, SimpleNamespace(**parts)))


@pytest.mark.parametrize("square", [False, True])
def test_what_is_added_to_the_effort_is_a_share_of_the_volts_with_its_own_phase(square: bool) -> None:
    s = amplifier(square)
    found = named.columns(s)
    c = found[int(square)]
    f = c.fixed["frequency"][0]
    assert f == pytest.approx(1.7, abs=0.5 / 20.0)
    assert c.fixed["shape"][0] == float(square) and c.open is square
    assert (c.sign, c.searched, c.labels[0][0]) == (1, 3, "amplitude")
    assert c.steps == (pytest.approx((0.25 if square else 0.05) / SECONDS[N // 2 - 1]),)
    assert c.shape is not None
    rows = s.problem.valid
    column, left = c.shape(np.array([1.7]))[rows, 0], s.residual[rows]
    share = float(column @ left / (column @ column))
    assert share == pytest.approx(0.03, rel=0.02)
    assert np.std(left - share * column) < (0.03 if not square else 0.15)


def test_too_few_rows_of_volts_and_rigs_of_one_motor_say_nothing() -> None:
    told = named.columns(amplifier(False))
    s = amplifier(False)
    seen = (s.windings.supply[:N] > 0) & s.problem.valid[:N] if s.windings is not None else RUN > 0
    for count, any_found in ((999, False), (1000, True)):
        held = np.cumsum(seen) > count
        assert bool(named.columns(amplifier(False, held))) is any_found
    assert told
    s = amplifier(False)
    s.windings = Windings(at=lambda x: x, current=T, rate=T, clock=T)
    assert named.columns(s) == []


@pytest.mark.parametrize("square", [False, True])
@pytest.mark.parametrize("phase", [-2.5, -0.3, 0.9, 2.9])
def test_the_phase_of_a_wave_on_uneven_rows_beside_a_constant(phase: float, square: bool) -> None:
    x = np.sort(np.random.default_rng(4).uniform(0, 60.0, 700))
    x = x[(x < 20.0) | (x % 6.0 < 4.0)]
    wave = np.sin(x + phase)
    y = 5.0 + (np.sign(wave) if square else wave)
    off = np.angle(np.exp(1j * (named._phase(x, y, square) - phase)))
    assert abs(off) < (0.03 if square else 1e-6)
