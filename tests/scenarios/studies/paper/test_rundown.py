"""Run-downs: equilibrium before the command, what a late command adds, three numbers that are found again."""

from dataclasses import replace

import numpy as np
import pytest

from plant.model import load, with_value
from scenarios.studies.options import LOW
from scenarios.studies.paper import rundown
from scenarios.studies.paper.friction_map import FrictionFit
from scenarios.studies.paper.measures import Array
from scenarios.studies.paper.rundown import Coasting, coast, fit_run_downs, settled
from scenarios.studies.paper.scales import ARCSEC, COUNT_RATE, Drive, drive
from tests.scenarios.studies.paper.test_scales import SHEET
from tests.studies.paper.synthetic import log_of

DIODES = drive(with_value(load(LOW), "axes.ra.motor.diode_drop", 0.7))
FRICTION = FrictionFit(229.0, 621.0, 4e-4, 1.0, 6700.0)
AXIS = Coasting(inertia=1760.0, damping=9000.0, late_s=0.004)


def speeds(*arcsec_s: float) -> np.ndarray:
    return np.array(arcsec_s) * ARCSEC


def test_a_current_tends_to_its_own_by_the_time_constant() -> None:
    """1 ohm and 1 mH: in a quarter of a millisecond a share of 1 - exp(-1/4) is gone."""
    now = settled(SHEET, np.array([4.0, 1.0]), np.array([0.5, 0.0]), np.array([2.0, 30.0]))
    left = np.exp(-0.25)
    assert now == pytest.approx([10.0 - 6.0 * left, 0.0])  # none flows back


def test_until_the_command_takes_effect_an_axis_keeps_its_speed() -> None:
    """Duties give what friction takes, for as long as they are held."""
    late = replace(AXIS, late_s=0.025)
    for sheet in (SHEET, DIODES):
        counts = coast(sheet, FRICTION, late, speeds(7200.0, 600.0), 3)
        assert counts.shape == (2, 3)
        assert counts[:, :2] == pytest.approx(
            np.outer(np.array([7200.0, 600.0]) / COUNT_RATE, [1, 1]), rel=1e-3
        )
        assert (counts[:, 2] < counts[:, 1]).all()


def test_a_command_between_two_steps_counts_for_its_share() -> None:
    found = [
        coast(DIODES, FRICTION, replace(AXIS, late_s=late), speeds(7200.0), 6)[0]
        for late in (0.005, 0.005125, 0.00525)
    ]
    assert found[1] == pytest.approx((found[0] + found[2]) / 2, rel=1e-3)
    assert (found[2][2:5] > found[0][2:5]).all()


def test_a_heavy_axis_loses_its_speed_by_the_torques_of_friction_and_diodes() -> None:
    """Momentum is what is lost: friction alone slows a drive without motors, in proportion to 1 / inertia."""
    weak = replace(SHEET, torque_constant=1e-6, rotor=1.0, stiffness=2e7)
    heavy = replace(AXIS, inertia=1e6, late_s=0.0, damping=300.0)
    counts = coast(weak, FRICTION, heavy, speeds(7200.0), 10)[0]
    took = float(FRICTION.torque(speeds(7200.0))[0]) / 1e6
    t = np.arange(10) * 0.01 + 0.0075  # the middle of the last 5 ms of each row
    wanted = 7200.0 - took * t / ARCSEC
    assert counts * COUNT_RATE == pytest.approx(wanted, rel=1e-5)


def test_an_axis_that_has_stopped_is_not_driven_back_by_friction() -> None:
    counts = coast(DIODES, FRICTION, replace(AXIS, inertia=400.0), speeds(600.0), 12)[0]
    assert abs(counts[-1]) * COUNT_RATE < 60.0


def decaying(_: Drive, __: FrictionFit, axis: Coasting, begin: Array, samples: int) -> Array:
    """Three numbers that can be told apart: a rate of decay, the swing upon it, and when it begins."""
    t = np.maximum(0.0, np.arange(samples) * 0.01 + 0.0075 - axis.late_s)
    shape = np.exp(-40.0 * t * 1000.0 / axis.inertia) * (1.0 + 0.1 * np.sin(t * axis.damping / 100.0))
    return np.outer(begin / ARCSEC / COUNT_RATE, shape)


def test_the_numbers_of_all_run_downs_together_are_found_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rundown, "coast", decaying)
    ways = (7200.0, -7200.0, 2400.0)
    truth = Coasting(inertia=1500.0, damping=9000.0, late_s=0.007)
    made = decaying(DIODES, FRICTION, truth, np.abs(speeds(*ways)), 12)
    logs = [log_of(np.sign(way) * counts * COUNT_RATE) for way, counts in zip(ways, made, strict=True)]
    found = fit_run_downs(logs, ways, FRICTION, DIODES)
    assert found.inertia == pytest.approx(1500.0, rel=1e-3)
    assert found.damping == pytest.approx(9000.0, rel=1e-2)
    assert found.late_s == pytest.approx(0.007, abs=1e-4)
    logs[0].counts[10:] = 5000.0  # 0.1 s count, and what is after them does not
    assert fit_run_downs(logs, ways, FRICTION, DIODES) == found
    logs[0].counts[8] = 20.0  # 46 arcsec/s: this one and the next are left out
    assert fit_run_downs(logs, ways, FRICTION, DIODES).inertia == pytest.approx(1500.0, rel=1e-3)


def test_fewer_than_six_fast_samples_are_refused() -> None:
    """Once below 60 arcsec/s, a sample counts for nothing, however fast the next."""
    slow = np.array([200.0, 100.0, 61.0, 59.0, 200.0, 200.0])
    five = [log_of(slow), log_of(-np.array([90.0, 80.0, 60.0, 70.0, 70.0, 70.0]))]
    with pytest.raises(ValueError, match=r"^only 5 samples .* are usable; at least 6 are needed$"):
        fit_run_downs(five, (600.0, -600.0), FRICTION, DIODES)
