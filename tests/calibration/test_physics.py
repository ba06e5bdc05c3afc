"""What an effect looks like in the residuals: friction levels, second masses, encoder errors, magnets."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from calibration.balances.candidate import Candidate
from calibration.balances.frame import Frame
from calibration.balances.friction import Path, Sliding, path_of
from calibration.balances.motion import Motion, motion_of
from calibration.balances.problem import Problem
from calibration.balances.recursions import lowpass
from calibration.decide.broadband import BURSTS, kurtosis, unexplained_volts
from calibration.decide.heldout import Model
from calibration.finding import Finding, Parameter
from calibration.inputs.declaration import FrictionLaw
from calibration.inputs.rigfile import telescope
from calibration.inputs.train import train_of
from calibration.look.scene import scene_of_balance
from calibration.look.volts import weakened
from calibration.names import NAMES
from calibration.names.inplant import Facts
from calibration.names.pair import Pair
from calibration.names.scene import MOTOR, RATES
from calibration.names.structural_mode import second_mass
from calibration.statistics.regression import gls
from plant.units import ARCSEC

LINES = 32768  # signal periods per turn of the absolute encoder, hardware.md 1.3
TRAIN = train_of(telescope("ra"))
DT = 0.01
COULOMB = 229.0  # N m
LAW = FrictionLaw(stiction_ratio=2.7, stribeck_speed=4e-4, bristle_travel=4e-5)


def logged(position: np.ndarray) -> Frame:
    """One run with this position, rad."""
    n = len(position)
    zero = np.zeros(n)
    return Frame(
        runs=[],
        period_s=DT,
        t=DT * np.arange(n),
        clock=zero,
        run=zero.astype(int),
        session=zero.astype(int),
        columns={"position": position},
        scale={},
        rig=telescope("ra"),
    )


def moved(position: np.ndarray, width: int = 3) -> Motion:
    """Motion of one run with this position, rad."""
    return motion_of(logged(position), width)


def back_and_forth(n: int = 6000) -> np.ndarray:
    """Out and back over 0.01 rad, slow enough for the Stribeck curve to matter."""
    return np.asarray(0.005 * np.sin(2 * np.pi * np.arange(n) * DT / 30.0))


def sliding(path: Path) -> Sliding:
    step = np.gradient(path.position)
    return Sliding(law=LAW, path=path, side=np.sign(step), speed=step / path.period_s, coulomb=COULOMB)


def test_a_higher_level_answers_as_the_bristle_equation_scaled_does() -> None:
    """g -> (1 + e) g is (1 + e) times the solution with stiffness / (1 + e): equation (4) of the paper."""
    m, h = moved(back_and_forth()), 1e-4
    known = sliding(path_of(m))

    def scaled(factor: float) -> np.ndarray:
        z = known.path.bristle(replace(LAW, bristle_travel=factor * 4e-5))
        return m.at(factor * z) * COULOMB

    numeric = (scaled(1 + h) - scaled(1 - h)) / (2 * h)
    answer = m.at(known.answer(known.steady))
    assert np.max(np.abs(answer - numeric)) < 0.01 * np.max(np.abs(numeric))


def test_after_a_reversal_the_old_level_is_still_held_and_fades_over_the_bristles_travel() -> None:
    out = np.concatenate([np.linspace(0, 0.01, 3000), np.linspace(0.01, 0.0, 3000)])
    m = moved(out)
    answer = m.at(sliding(path_of(m)).answer(np.ones(len(out))))
    turn = np.argmin(np.abs(m.rows - 3000))
    assert answer[turn - 50] == pytest.approx(1.0, abs=0.02)
    assert answer[turn + 1] > 0.3  # still the old side
    assert answer[turn + 200] == pytest.approx(-1.0, abs=0.02)


@pytest.mark.parametrize("width", [1, 3])
def test_an_interpolation_error_keeps_its_size_though_the_lags_see_it_too(width: int) -> None:
    """The counts lag by half their window: that lag's columns are made of the position, error and all."""
    amplitude = 0.02
    t = DT * np.arange(8000)
    rate = 200 * ARCSEC * (1.2 + np.sin(2 * np.pi * t / 17.0))  # 0.01 to 0.11 periods a row
    true = np.cumsum(rate) * DT
    frame = logged(true + amplitude * ARCSEC * np.sin(LINES * true + 0.4))
    m, axis = motion_of(frame, width), moved(true, width)
    row = m.rows

    def base(of: Motion) -> np.ndarray:
        return np.column_stack([of.acceleration[row], np.gradient(of.acceleration, DT)[row]]) / ARCSEC

    lags = {"velocity_delay": -2.5e-3, "window_curvature": 8e-5}  # s, s2
    counted = axis.speed[row] / ARCSEC + base(axis) @ np.array(list(lags.values()))
    run, valid = np.zeros(len(row), dtype=np.int64), m.ok[row]
    y = counted - m.speed[row] / ARCSEC
    problem = Problem(
        channel="S",
        unit="arcsec/s",
        y=y,
        base=base(m),
        base_labels=[],
        t=t[row],
        run=run,
        session=run,
        valid=valid,
        held=~valid,
        period_s=m.cell_s,
        ar_order=0,
    )
    scene = scene_of_balance(Pair(motion=m), problem, y, lags)
    (one,) = NAMES["encoder_subdivision"].columns(scene)
    beta = gls(y, np.hstack([problem.base, one.columns]), valid, 0).beta
    assert np.hypot(*beta[2:4]) == pytest.approx(amplitude, rel=0.03)
    assert np.hypot(*beta[4:6]) < 0.1 * amplitude
    sizes = {"amplitude": Parameter(amplitude, "arcsec")}
    sizes["phase"] = Parameter(float(np.arctan2(-beta[3], beta[2])), "rad")
    found = Finding("encoder_subdivision", "S", "axis_angle", order=float(LINES), parameters=sizes)
    (made,) = NAMES["encoder_subdivision"].to_plant(found, Facts("a test")).effects
    assert made.parameters["phase"].value == pytest.approx(0.4, abs=0.05)


@pytest.mark.parametrize("hertz", [2.0, 6.0, 11.0])
@pytest.mark.parametrize("zeta", [0.01, 0.05])
def test_a_second_mass_has_the_width_and_height_of_its_equation(hertz: float, zeta: float) -> None:
    n = 40_000
    run = np.zeros(n, dtype=np.int64)
    t = DT * np.arange(n)
    for detune in (0.98, 1.0, 1.02):
        w, w0 = 2 * np.pi * hertz * detune, 2 * np.pi * hertz
        second = second_mass(np.sin(w * t), run, DT, hertz, zeta)
        made = np.sqrt(2) * np.std(second[n // 2 :])
        s = 1j * w
        exact = abs((2 * zeta * w0 * s + w0**2) / (s**2 + 2 * zeta * w0 * s + w0**2))
        assert made == pytest.approx(exact, rel=0.06)


def test_a_second_mass_is_at_rest_when_a_run_begins() -> None:
    run = np.repeat([0, 1], 500)
    push = np.where(run == 0, 1.0, 0.0)
    second = second_mass(push, run, DT, 5.0, 0.005)
    assert np.all(second[run == 1] == 0.0) and np.ptp(second[run == 0]) > 1.0


def test_windings_cool_in_a_pause() -> None:
    clock = np.concatenate([DT * np.arange(3000), 1000.0 + DT * np.arange(100)])
    heat = lowpass(np.ones(3100), clock, 50.0)
    assert heat[2999] == pytest.approx(1 - np.exp(-30.0 / 50.0), rel=0.01)
    assert heat[3000] < 1e-3


def test_a_line_of_known_size_and_new_phase_is_taken_off_a_run_that_was_not_fitted() -> None:
    rng = np.random.default_rng(3)
    n = 4000
    t, run = DT * np.arange(n), np.repeat([0, 1], n // 2)
    x = 2 * np.pi * 3.0 * t
    pair = np.column_stack([np.cos(x), np.sin(x)])
    columns = np.hstack([pair * (run == k)[:, None] for k in (0, 1)])
    y = 2.0 * np.cos(x + np.where(run == 0, 0.4, 2.1)) + 0.1 * rng.standard_normal(n)
    one = np.ones(n, dtype=bool)
    p = Problem(
        channel="S",
        unit="1",
        y=y,
        base=np.zeros((n, 0)),
        base_labels=[],
        t=t,
        run=run,
        session=run,
        valid=one,
        held=run == 1,
        period_s=DT,
    )
    beta = np.array([2 * np.cos(0.4), -2 * np.sin(0.4), 0.0, 0.0])
    left = Model(x=columns, beta=beta, phases=[slice(0, 4)]).residual(p, p.test)
    assert np.std(left) == pytest.approx(0.1, rel=0.1)
    # the size is not fitted there
    half = Model(x=columns, beta=beta / 2, phases=[slice(0, 4)]).residual(p, p.test)
    assert np.std(half) == pytest.approx(1.0 / np.sqrt(2), rel=0.1)


@dataclass
class Volts:
    """An electrical residual with a brush that sticks in part of the turn, and its motor's turns."""

    problem: Problem
    e: np.ndarray
    turns: np.ndarray


def volts(sector: float, size: float) -> Volts:
    rng = np.random.default_rng(5)
    n = 12_000
    turns = 0.003 * np.arange(n)
    e = 0.01 * rng.standard_normal(n) + size * ((turns % 1.0) < sector) * rng.standard_normal(n)
    zero = np.zeros(n, dtype=np.int64)
    held = np.arange(n) > 8000
    one = np.ones(n, dtype=bool)
    p = Problem(
        channel="E",
        unit="V",
        y=e,
        base=np.zeros((n, 0)),
        base_labels=[],
        t=DT * 3 * np.arange(n),
        run=zero,
        session=zero,
        valid=one,
        held=held,
        period_s=3 * DT,
        block_s=3.0,
    )
    return Volts(p, e, turns)


def test_volts_in_a_sector_of_the_turn_are_a_brush_and_noise_is_not() -> None:
    bad, good = volts(0.12, 0.12), volts(0.12, 0.0)
    found = unexplained_volts(bad.e, bad.problem, bad.turns)
    assert found is not None and (found.name, found.domain) == ("unknown", "motor_angle")
    assert unexplained_volts(good.e, good.problem, good.turns) is None
    # as loud, but everywhere in the turn
    assert unexplained_volts(volts(1.0, 0.05).e, volts(1.0, 0.05).problem, good.turns) is None


def test_wind_is_gaussian_and_pulses_are_not() -> None:
    rng = np.random.default_rng(1)
    gusts = np.convolve(rng.standard_normal(20_000), np.exp(-np.arange(100) / 20.0), "valid")
    pulses = np.where((np.arange(20_000) % 1000) < 60, 1.0, 0.0) + 0.02 * rng.standard_normal(20_000)
    assert kurtosis(gusts) < 4.0 < BURSTS < kurtosis(pulses)


def test_what_the_volts_lost_of_a_magnet_is_lost_in_the_torque() -> None:
    clock = np.linspace(0, 100, 11)
    zero = np.zeros((1, 1))
    both = Candidate(
        "magnet_weakening",
        "time",
        zero,
        (("loss", "1"),),
        fixed={"start": (50.0, "s"), "duration": (10.0, "s")},
    )
    left = weakened([(both, np.array([0.02]))], clock)
    assert left["a"][0] == 1.0 and left["b"][-1] == pytest.approx(0.98)
    one = Candidate("magnet_weakening", "velocity", zero, (("loss", "1"),), fixed={"motor": (2.0, MOTOR)})
    left = weakened([(one, np.array([0.05]))], clock)
    assert left["a"].min() == 1.0 and left["b"].max() == pytest.approx(0.95)


def test_heating_is_told_of_the_cold_resistance() -> None:
    p = Parameter(2.0, "K/W", 1.8, 2.2)
    found = Finding("winding_heating", "E", "time", parameters={"thermal_resistance": p})
    f = NAMES["winding_heating"].retold(found, {"resistance": 1.1, "torque_constant": 1.0})
    told = f.parameters["thermal_resistance"]
    assert (told.value, told.low) == (pytest.approx(2.42), pytest.approx(2.178))


def test_what_an_axis_shows_between_its_encoders_is_seen_in_their_rates() -> None:
    seen = {n.name for n in NAMES.values() if RATES in n.channels}
    assert seen == {"encoder_eccentricity", "encoder_subdivision", "roller_ratio", "roller_slip"}
