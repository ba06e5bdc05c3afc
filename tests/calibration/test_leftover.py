"""What is above the floor decides which names may stay; a rig's floor comes from its columns alone."""

from pathlib import Path

import numpy as np
import pytest

from calibration.decide.residual import Left, settle
from calibration.finding import Finding
from calibration.look.applied import too_little
from calibration.look.axis_result import AxisResult
from tests.calibration.test_drives import FORCE, answer, motion


def test_names_that_leave_most_above_the_floor_become_unknown_where_they_lived() -> None:
    named = [Finding("position_friction", "T", "axis_angle", share=0.3)]
    kept = settle(named, Left(4.0, 0.3), "T")
    assert [f.name for f in kept] == ["position_friction"]
    gone = settle(named, Left(8.7, 0.7), "T")
    assert [(f.name, f.domain) for f in gone] == [("unknown", "axis_angle")]
    assert "position_friction would take 30 %" in gone[0].note


def test_what_nobody_named_is_unknown_only_where_it_has_a_domain() -> None:
    assert settle([], Left(4.0, 1.0), "T") == [] and settle([], None, "T") == []
    found = settle([], Left(4.0, 1.0, "time", "over time", 0.5), "T")
    assert [(f.name, f.domain, f.channel) for f in found] == [("unknown", "time", "T")]


@pytest.mark.parametrize(("after", "refused"), [(0.53, True), (0.15, False)])
def test_a_gap_of_the_coupling_must_take_most_of_what_the_encoders_show(after: float, refused: bool) -> None:
    result = AxisResult.__new__(AxisResult)
    held = type("Held", (), {"before": 0.58, "after": after})()
    result.selections = {"K": type("Chosen", (), {"held": held})()}
    result.floors = {"K": 0.13}
    assert (too_little(result, Finding("play", "K", "reversal")) is not None) == refused
    assert too_little(result, Finding("channel_delay", "K", "clock")) is None


@pytest.mark.slow
def test_an_effect_is_no_part_of_the_floor(tmp_path: Path) -> None:
    t, x, u = motion()
    slow = 0.5 * np.sin(2 * np.pi * t / 7.0)
    floors = []
    for k, force in enumerate((u, u + slow)):
        folder = tmp_path / str(k)
        folder.mkdir()
        torque = answer(folder, FORCE, (t, x, force))["error"]["torque"]
        floors.append(torque["floor"])
    assert floors[1] == pytest.approx(floors[0], rel=0.1) and floors[1] < 0.3 * torque["before"]


@pytest.mark.parametrize(("share", "domain"), [(0.9, "time"), (0.1, "axis_angle")])
def test_the_domain_is_that_of_the_larger_part(share: float, domain: str) -> None:
    """A name took a fifth of the square; what is left lives over time with nine tenths, or nowhere much."""
    named = [Finding("bearing_pass", "T", "axis_angle", share=0.5)]
    (found,) = settle(named, Left(13.0, 0.8, "time", "over time alone", share), "T")
    assert (found.name, found.domain) == ("unknown", domain)
