"""A spring without a loop over an angle, and a weight there: each is told from the other."""

from pathlib import Path

import numpy as np
import pytest

from tests.calibration.test_drives import FORCE, answer, motion

ARM = FORCE.replace("unit: m}", "unit: rad}").replace("unit: N}", "unit: N m}")
WIDER = 3.0  # times the motion's 0.3 and 0.1: some two radians from end to end
STIFFNESS, WEIGHT = 2.0, 5.0  # N m/rad, N m


@pytest.mark.parametrize("spring", [True, False])
def test_what_pulls_back_over_two_radians_is_told_from_a_weight(tmp_path: Path, spring: bool) -> None:
    t, x, u = motion()
    x, u = WIDER * x, WIDER * u
    u += STIFFNESS * x if spring else WEIGHT * np.sin(x)
    (first, *more) = answer(tmp_path, ARM, (t, x, u))["effects"]
    assert not more
    if spring:
        assert first["name"] == "cable_wrap"
        assert first["parameters"]["stiffness"]["value"] == pytest.approx(STIFFNESS, rel=0.05)
    else:
        assert first["name"] == "gravity_imbalance"
        assert first["parameters"]["amplitude"]["value"] == pytest.approx(WEIGHT, rel=0.05)


def test_over_two_degrees_a_force_with_the_place_is_unknown_over_it(tmp_path: Path) -> None:
    """Neither a weight nor a cable can be told there: both are a straight line."""
    t, x, u = motion()
    small = 0.04  # of the motion's 0.3 and 0.1, rad: some two degrees
    x, u = small * x, small * u + 30.0 * small * x
    top = answer(tmp_path, ARM, (t, x, u))["effects"][0]
    assert (top["name"], top["domain"]) == ("unknown", "axis_angle")
    assert top["parameters"]["stiffness"]["value"] == pytest.approx(30.0, rel=0.05)
