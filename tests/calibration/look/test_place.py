"""Signals that effects are drawn over, of an axis log too, whose columns no rig file declares."""

from dataclasses import replace

import numpy as np
import pytest

from calibration.look.said import place_of
from calibration.names.name import candidate
from plant.effects import REGISTRY
from tests.calibration.names.test_volts import scene


@pytest.mark.parametrize("name", sorted(REGISTRY))
def test_every_name_has_a_place_in_an_axis_log(name: str) -> None:
    view = scene(2).view
    effort = np.zeros(len(view.t))
    view = replace(view, columns={**view.columns, "effort": effort, "current": effort})
    x, label = place_of(view, candidate(name, np.ones((len(view.rows), 1)), ("size", "1")))
    assert len(x) == len(view.rows) and label


def test_a_line_is_drawn_over_the_phase_of_its_refined_frequency_and_a_mode_over_time() -> None:
    view = scene(2).view
    columns = np.ones((len(view.rows), 1))
    line = candidate("command_disturbance", columns, ("size", "1"), frequency=2.3)
    line = replace(line, fixed={"frequency": (2.5, "Hz")})
    x, label = place_of(view, line)
    assert label == "phase of 2.5 Hz, turns" and x == pytest.approx((2.5 * view.t[view.rows]) % 1.0)
    mode = replace(line, name="structural_mode", fixed={**line.fixed, "damping": (0.02, "1")})
    assert place_of(view, mode)[1] == "time, s"
