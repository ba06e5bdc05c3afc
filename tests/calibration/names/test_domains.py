"""What an effect may be a smooth function of."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np

from calibration.names.scene import Scene
from calibration.names.unknown import domains

ROWS = 200
TRAVEL = 40.0  # turns


def scene(slip: float) -> Scene:
    """A drive at one turn a second, which the position leaves by `slip` turns rms."""
    t = np.linspace(0.0, TRAVEL, ROWS)
    response = SimpleNamespace(is_speed=False, channel="force")
    view = SimpleNamespace(rows=np.arange(ROWS), x=t, speed=np.ones(ROWS), clock=t, columns={})
    view.response, view.dynamic = response, False
    made = {"view": view, "span": TRAVEL, "one_speed": (1.0, slip), "both": False, "temperature": None}
    return cast(Scene, cast(Any, SimpleNamespace(**made, force=True)))


def test_a_place_that_is_never_come_back_to_is_a_time() -> None:
    assert [name for name, _ in domains(scene(0.02))] == ["velocity", "time"]


def test_a_place_that_a_second_speed_tells_from_the_clock_is_a_place() -> None:
    assert [name for name, _ in domains(scene(4.0))] == ["axis_angle", "velocity", "time"]
