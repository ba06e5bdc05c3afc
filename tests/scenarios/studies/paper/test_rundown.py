"""Run-downs of an axis against a mass on friction, and which samples are used."""

from dataclasses import replace

import numpy as np
import pytest

from scenarios.studies.paper import rundown
from scenarios.studies.paper.friction_map import FrictionFit
from scenarios.studies.paper.measures import Array, join
from scenarios.studies.paper.rundown import Coasting, coast, fit_run_downs, settled
from scenarios.studies.paper.scales import ARCSEC, COUNT_RATE, Drive
from tests.scenarios.studies.paper.bench import log_of

SHEET = Drive(
    torque_constant=0.4, winding=1.5, switch=0.0, inductance=4e-3, diode_drop=0.8, rotor=300.0, stiffness=5e6,
    voltage=24.0, split=0.1, ripple=0.0,
)  # fmt: skip
FRICTION = FrictionFit(230.0, 230.0, 4e-4, 1.0, 6700.0)  # no Stribeck effect
AXIS = Coasting(inertia=1760.0, damping=5000.0, late_s=0.008)
FAST = np.array([7200.0, 2400.0]) * ARCSEC


def test_the_current_s_distance_to_its_goal_decays_with_the_winding() -> None:
    """Half a duty: (0.5 (24 + 0.8) - 0.8 - emf) / 1.5 ohm; in 0.25 ms it decays by exp(-1.5 0.25 / 4)."""
    duty, emf = np.array([0.5]), np.array([2.0])
    goal = (0.5 * 24.8 - 0.8 - 2.0) / 1.5
    now = goal + (9.0 - goal) * np.exp(-1.5 * 0.25e-3 / 4e-3)
    assert settled(SHEET, np.array([9.0]), duty, emf) == pytest.approx([now])
    assert settled(SHEET, np.array([0.01]), np.array([0.0]), np.array([5.0])) == pytest.approx([0.0])


def test_before_the_command_takes_effect_a_run_is_steady() -> None:
    late = replace(AXIS, late_s=10.0)
    found = coast(SHEET, FRICTION, late, FAST, 10)
    expected = np.broadcast_to([[7200.0], [2400.0]], (2, 10)) / COUNT_RATE
    assert found.shape == (2, 10)
    assert found == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("late_s", [0.0, 0.02])
def test_without_motors_a_rigid_axis_falls_by_its_friction_once_the_command_is_there(late_s: float) -> None:
    """dw/dt = -(Tc + sigma2 w) / J, an exponential; the log has the mean of each second 5 ms. The rotors'
    part is small here, and the motors have no torque."""
    weak = replace(SHEET, torque_constant=1e-6, rotor=1e-3)
    found = coast(weak, FRICTION, replace(AXIS, late_s=late_s, damping=1.0), FAST[:1], 10)[0]
    t = np.arange(10_000) * 1e-5 + 0.5e-5
    w = (FAST[0] + 230.0 / 6700.0) * np.exp(-6700.0 / 1760.0 * t) - 230.0 / 6700.0
    expected = w.reshape(10, 1000)[:, 500:].mean(axis=1) / ARCSEC / COUNT_RATE
    assert found == pytest.approx(expected, rel=0.01)


def test_a_later_command_is_the_same_run_later() -> None:
    """Ten ms later is one row of the log later, once the first row is steady."""
    one = coast(SHEET, FRICTION, replace(AXIS, late_s=0.004), FAST, 8)
    other = coast(SHEET, FRICTION, replace(AXIS, late_s=0.014), FAST, 9)
    assert other[:, 1:] == pytest.approx(one, rel=5e-3, abs=0.5)
    half = coast(SHEET, FRICTION, replace(AXIS, late_s=0.004125), FAST, 8)
    between = coast(SHEET, FRICTION, replace(AXIS, late_s=0.00425), FAST, 8)
    assert half == pytest.approx((one + between) / 2.0, rel=1e-3, abs=0.05)  # a share of a step


def decay(sheet: Drive, friction: FrictionFit, axis: Coasting, speeds: Array, samples: int) -> Array:
    """Counts that fall by inertia and damping, from a command on: quick to compute."""
    assert sheet is SHEET and friction is FRICTION and samples == 10
    t_s = np.maximum(0.0, np.arange(samples) * 0.01 - axis.late_s)[None, :]
    fall = np.exp(-t_s * (1.0 + axis.damping * 0.01 * speeds[:, None]) * 20_000.0 / axis.inertia)
    return np.asarray(speeds[:, None] / ARCSEC / COUNT_RATE * fall)


@pytest.mark.parametrize(("inertia", "damping", "late_s"), [(1500.0, 5000.0, 0.006), (2100.0, 900.0, 0.011)])
def test_run_downs_give_what_they_were_made_of(
    inertia: float, damping: float, late_s: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rundown, "coast", decay)
    truth = Coasting(inertia=inertia, damping=damping, late_s=late_s)
    made = decay(SHEET, FRICTION, truth, FAST, 10)
    logs = [log_of(sign * row * COUNT_RATE, 0.1) for sign, row in zip((1.0, -1.0), made, strict=True)]
    longer = join([logs[1], log_of(-1.0, 1.0)])
    found = fit_run_downs([logs[0], longer], [7200.0, -2400.0], FRICTION, SHEET)
    measured = found.inertia, found.damping, found.late_s
    assert measured == pytest.approx((inertia, damping, late_s), rel=1e-3)


def test_five_samples_above_60_arcsec_s_are_too_few_and_later_ones_count_no_more() -> None:
    """What is fast again after it has been slow is no run-down."""
    slow: Array = np.array([100.0] * 5 + [60.0] + [100.0] * 50)
    with pytest.raises(
        ValueError, match=r"^only 5 samples of the run-downs are usable; at least 6 are needed$"
    ):
        fit_run_downs([log_of(slow, 0.56)], [7200.0], FRICTION, SHEET)
    with pytest.raises(ValueError, match=r"^only 4 samples"):  # the shorter log counts
        fit_run_downs([log_of(100.0, 0.02), log_of(100.0, 0.5)], [7200.0, 7200.0], FRICTION, SHEET)
    with pytest.raises(ValueError, match=r"^only 0 samples"):  # of the other direction
        fit_run_downs([log_of(100.0, 0.5)], [-7200.0], FRICTION, SHEET)
